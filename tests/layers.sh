#!/bin/sh
# layers.sh FOLDER: a folder of sources includes only from folders to its left in the flow ecofiles -> lod -> server -> client-min, and
# client-min never from server. Read from the dependencies that the compiler wrote to FOLDER/obj. main_* is wiring and may include
# anything.
set -u
objects=$1/obj
faults=0 looked=0

look() { # SOURCE-FOLDER ALLOWED-FOLDERS (separated by |)
	for dependencies in "$objects/$1"/*.d; do
		source=$1/$(basename "$dependencies" .d)
		case $source in */main_*) continue ;; esac
		# what was left by a source that is gone says nothing
		[ -e "$source.c" ] || [ -e "$source.cpp" ] || continue
		looked=$((looked + 1))
		strays=$(tr -s ' \\:' '\n' <"$dependencies" | grep -E '^(ecofiles|lod|server|client-min|tests)/' | sort -u | grep -vE "^($2)/")
		if [ -n "$strays" ]; then
			faults=$((faults + 1))
			echo "$source includes $(echo $strays), but may include only from $(echo "$2" | sed 's/|/, /g')"
		fi
	done
}
look ecofiles 'ecofiles'
look lod 'ecofiles|lod'
look server 'ecofiles|lod|server'
look client-min 'ecofiles|lod|client-min'

if [ $looked -eq 0 ]; then
	echo "layers: there are no dependencies in $objects: build first"
	exit 1
fi
echo "layers: $looked sources, $faults stray"
[ $faults -eq 0 ]
