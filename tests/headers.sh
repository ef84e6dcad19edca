#!/bin/sh
# headers.sh COMPILER FLAGS...: every header compiles alone, as C, without a warning.
set -u
faults=0 looked=0
for header in $(find ecofiles lod server client-min tests -name '*.h' | sort); do
	looked=$((looked + 1))
	printf '#include "%s"\n' "$header" | "$@" -Wall -Wextra -Werror -fsyntax-only -x c - || {
		faults=$((faults + 1))
		echo "$header does not compile alone"
	}
done
echo "headers: $looked headers, $faults faulty"
[ $faults -eq 0 ]
