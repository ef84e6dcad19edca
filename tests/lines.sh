#!/bin/sh
# make lines: how long each room is, against its budget. A line of .c, .h and .cpp counts once for each 110 columns that it takes (a tab is
# 8); tests of a room are those of its folders of tests/. Scripts and shaders have a column of their own.
set -eu
cd "$(dirname "$0")/.."
git ls-files -- '*.c' '*.h' '*.cpp' '*.glsl' '*.mjs' '*.py' '*.sh' | while read -r file; do
	[ ! -f "$file" ] || expand "$file" | awk -v file="$file" '{ n += 1 + int((length($0) - (length($0) > 0)) / 110) } END { print file, n + 0 }'
done | awk '
	function room(path) {
		if (path ~ /^ecofiles\/import\//) return "ecofiles/import"
		if (path ~ /^ecofiles\/(ecopack|generate)\//) return "ecofiles/ecopack, generate"
		if (path ~ /^ecofiles\//) return "ecofiles/base, format, scene"
		if (path ~ /^lod\/plan\//) return "lod/plan"
		if (path ~ /^(lod|server|client-min)\//) { split(path, part, "/"); return part[1] }
		return path ~ /^tests\/bench\// ? "tests/bench" : "tests without bench"
	}
	BEGIN {
		count = split("ecofiles/base, format, scene=16000|ecofiles/import=17000|ecofiles/ecopack, generate=13000|lod=19000|lod/plan=9000|" \
			"server=8500|client-min=13000|tests without bench=38000|tests/bench=16000", rows, "|")
		split("base=ecofiles/base, format, scene|format=ecofiles/base, format, scene|import=ecofiles/import|" \
			"ecopack=ecofiles/ecopack, generate|build=lod|plan=lod/plan|server=server|client=client-min", pairs, "|")
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
		for (i = 1; i <= count; i++) {
			split(rows[i], row, "=")
			lines = sum[row[1], "lines"]; other = sum[row[1], "other"]
			printf "%-30s %8d %8d %8s %8d%s\n", row[1], lines, row[2], row[1] in tests ? tests[row[1]] : "", other,
				(lines > row[2] + 0 ? "  over" : "")
			all += lines; budget += row[2]; scripts += other
		}
		printf "%-30s %8d %8d %8s %8d\n", "all", all, budget, "", scripts
	}'
