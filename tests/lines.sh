#!/bin/sh
# make lines: how long each room is, against its budget. A line of .c, .h and .cpp counts once for each 110 columns that it takes (a tab is
# 8); tests of a room are those of its folders of tests/. Scripts and shaders have a column of their own.
set -eu
cd "$(dirname "$0")/.."
git ls-files -- '*.c' '*.h' '*.cpp' '*.glsl' '*.mjs' '*.py' '*.sh' | while read -r file; do
	[ ! -f "$file" ] || expand "$file" | awk -v file="$file" '{ n += 1 + int((length($0) - (length($0) > 0)) / 110) } END { print file, n + 0 }'
done | awk "$(cat tests/rooms.awk)"'
	BEGIN {
		split("base=ecofiles/base, format, scene|format=ecofiles/base, format, scene|import=ecofiles/import|" \
			"ecopack=ecofiles/ecopack, generate|build=lod|plan=lod/plan, seen|seen=lod/plan, seen|server=server|client=client-min", pairs, "|")
		for (i in pairs) { split(pairs[i], pair, "="); of[pair[1]] = pair[2] }
	}
	{
		name = $1 ~ /\.(c|h|cpp)$/ ? "lines" : "other"
		sum[room($1), name] += $2
		split($1, part, "/")
		if (part[1] == "tests" && part[2] in of && name == "lines") tests[of[part[2]]] += $2
	}
	END {
		printf "%-30s %8s %8s %8s %8s\n", "room", "lines", "budget", "tests", "scripts"
		for (i = 1; i <= room_count; i++) {
			name = room_name[i]; lines = sum[name, "lines"]; other = sum[name, "other"]
			printf "%-30s %8d %8d %8s %8d%s\n", name, lines, room_budget[name], name in tests ? tests[name] : "", other,
				(lines > room_budget[name] + 0 ? "  over" : "")
			all += lines; budget += room_budget[name]; scripts += other
		}
		printf "%-30s %8d %8d %8s %8d\n", "all", all, budget, "", scripts
	}'
