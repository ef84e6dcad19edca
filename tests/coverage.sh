#!/bin/sh
# make coverage: lines and branches of the product that the tests reach, by room, after `make test config=coverage`.
#
#   coverage.sh BUILD     BUILD: the coverage build's folder; BUILD/coverage.csv gets a row for each file
set -eu
cd "$(dirname "$0")/.."
gcovr --root . --exclude tests/ --gcov-ignore-parse-errors -j "$(nproc)" --csv "$1/coverage.csv" "$1/obj" >/dev/null
awk -F, "$(cat tests/rooms.awk)"'
	NR > 1 { lines[room($1)] += $2; reached[room($1)] += $3; branches[room($1)] += $5; taken[room($1)] += $6 }
	function row(name, l, r, b, t) { printf "%-30s %8d %6.1f %% %8d %6.1f %%\n", name, l, 100 * r / l, b, 100 * t / b }
	END {
		printf "%-30s %8s %8s %8s %8s\n", "room", "lines", "reached", "branches", "taken"
		for (i = 1; i <= room_count; i++) {
			name = room_name[i]
			if (!(name in lines)) continue
			row(name, lines[name], reached[name], branches[name], taken[name])
			l += lines[name]; r += reached[name]; b += branches[name]; t += taken[name]
		}
		row("all", l, r, b, t)
	}' "$1/coverage.csv"
