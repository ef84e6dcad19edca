#!/bin/sh
# layers.sh TABLE FOLDER: each source includes, directly or not, only what its room may. TABLE (tests/layers.txt) names rooms, what each may
# include and which of its headers others may; FOLDER/obj holds the dependencies that the compiler wrote. Program files (main_*) may
# include anything, and so may tests.
set -u
table=$1 objects=$2/obj
find "$objects" -name '*.d' | sed "s|^$objects/||; s|\.d$||" | grep -E '^(ecofiles|lod|server|client-min)/' | sort | while read -r source; do
	# what was left by a source that is gone says nothing
	[ -e "$source.c" ] || [ -e "$source.cpp" ] || continue
	printf '%s' "$source"
	tr -s ' \\:\n' ' ' <"$objects/$source.d" | tr ' ' '\n' | grep -E '^(\./)?[a-z-]+/.*\.h$' | sed 's|^\./||' | sort -u | tr '\n' ' ' | sed 's/^/ /'
	echo
done | awk -v table="$table" '
function room_of(path,   r) {    # the longest room that the path lies in
	for (r = path; sub(/\/[^\/]*$/, "", r); )
		if (r in may) return r
	return ""
}
BEGIN {
	while ((getline line <table) > 0) {
		sub(/#.*/, "", line)
		if (split(line, part, "|") < 3 || part[1] ~ /^part/) continue
		gsub(/ /, "", part[1])
		may[part[1]] = " " part[2] " "
		n = split(part[3], name, " ")
		for (i = 1; i <= n; i++) public[part[1] "/" name[i]] = 1
	}
}
{
	looked++
	room = room_of($1)
	if (room == "") { print $1 " lies in no room of " table; faults++; next }
	if ($1 ~ /\/main_[^\/]*$/) next
	for (i = 2; i <= NF; i++) {
		other = room_of($i)
		if (other == room) continue
		if (other == "") problem = "is in no room"
		else if (!index(may[room], " " other " ")) problem = "is of a room that " room " may not include"
		else if (!($i in public)) problem = "is private to " other
		else continue
		print $1 " includes " $i ", which " problem
		faults++
	}
}
END {
	if (!looked) { print "layers: no dependencies: build first"; exit 1 }
	print "layers: " looked " sources, " faults + 0 " stray"
	exit faults > 0
}'
