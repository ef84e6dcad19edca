#!/bin/sh
# parts.sh TABLE FOLDER: each function of a room that is in parts calls only its own part and those before it. TABLE (tests/layers.txt) names
# the parts; the symbols are those of FOLDER/obj.
set -u
table=$1 objects=$2/obj
grep '^part' "$table" | while IFS='|' read -r _ room _ files; do
	number=$((${number-0} + 1)) room=$(echo $room)
	for file in $files; do
		nm "$objects/$room/$file.o" | awk -v file="$room/$file" -v number="$number" '{ print file, number, $(NF - 1), $NF }'
	done
done >"$2/parts"
for room in $(grep '^part' "$table" | cut -d'|' -f2 | sort -u); do
	for file in "$room"/*.c; do
		grep -q "^${file%.c} " "$2/parts" || { echo "$file is in no part"; exit 1; }
	done
done
awk '
$3 ~ /^[TDRB]$/ { part[$4] = $2; home[$4] = $1 }
$3 == "U" { from[++calls] = $1; of[calls] = $2; to[calls] = $4 }
END {
	for (i = 1; i <= calls; i++)
		if (to[i] in part && part[to[i]] > of[i]) { print from[i] " calls " to[i] " of " home[to[i]] ", a later part"; faults++ }
	if (!calls) { print "parts: no symbols: build first"; exit 1 }
	print "parts: " calls " calls, " faults + 0 " upwards"
	exit faults > 0
}' "$2/parts"
