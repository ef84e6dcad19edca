#!/bin/sh
# The objects that ecobench's sections name (bench.h, `objects`) all have sources: a name that matches nothing
# would be passed over, or match what an older build has left, and kept figures would be taken for today's.
set -eu
cat tests/bench/*.[ch] tests/bench/*/*.[ch] | grep -o '"[^"]*"' | tr '" ' '\n\n' | grep '\.[oa]$' | sort -u |
{
	looked=0 failed=0
	while read -r name; do
		looked=$((looked + 1))
		# an archive is a folder's, whose slashes have become dashes
		case $name in
		*.o) set -- "${name%.o}.c" none ;;
		*) set -- "${name%.a}" "$(echo "${name%.a}" | tr - /)" ;;
		esac
		# unquoted: patterns
		ls -d $1 >/dev/null 2>&1 || ls -d $2 >/dev/null 2>&1 || {
			echo "test_bench_objects: $name has no source"
			failed=1
		}
	done
	[ "$looked" -gt 20 ] || { echo "test_bench_objects: finds only $looked names"; failed=1; }
	exit $failed
}
