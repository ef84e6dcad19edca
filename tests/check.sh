#!/bin/sh
# Runs, of what it is given, the tests that have changed since they last passed (tests/green.sh), cheapest first, for at most CHECK_S (30)
# seconds of processor time, and says what it did not run. Status 1 if any failed.
#
#   check.sh FOLDER PROGRAM...        FOLDER: the config's output folder; PROGRAM: as for run.sh
set -u
BUILD=$1
shift
. tests/green.sh
limit=${CHECK_S:-30}
results=$BUILD/tests/checked
rm -rf "$results"
mkdir -p "$results" build/tmp
export ASAN_OPTIONS="${ASAN_OPTIONS:-allocator_may_return_null=1}" LSAN_OPTIONS="suppressions=$PWD/tests/support/leaks.txt:print_suppressions=0"
export CMOCKA_MESSAGE_OUTPUT=TAP BUILD RESULTS="$results" CHECK=1 LIMIT_WALL_S=1800

# "SECONDS PROGRAM" of what is not green; a test that never ran is taken for a short one, a script for a longer one
for program in "$@"; do
	! green_is "$program" || continue
	case $program in *.sh) seconds=5 ;; *) seconds=0.5 ;; esac
	echo "$(cat "$green_folder/$(basename "$program").cpu" 2>/dev/null || echo $seconds) $program"
done | sort -n >"$results/changed"

left() { cat "$results"/*.cpu 2>/dev/null | awk -v all="$limit" '{ all -= $1 } END { printf "%.2f", all }'; }
while read -r seconds program; do
	LIMIT_CPU_S=$(left)
	if awk -v need="$seconds" -v left="$LIMIT_CPU_S" 'BEGIN { exit !(need >= left) }'; then
		echo "$(basename "$program") ($seconds s)" >>"$results/omitted"
	else
		export LIMIT_CPU_S
		sh tests/run.sh --one "$program"
	fi
done <"$results/changed"

[ ! -e "$results/omitted" ] || echo "not run within $limit s of processor time: $(paste -sd ' ' "$results/omitted")"
cat "$results"/*.count /dev/null 2>/dev/null | awk -v left="$(left)" -v all="$limit" -v given=$# -v changed="$(wc -l <"$results/changed")" '
	{ passed += $1; failed += $2 }
	END { printf "%d of %d test programs had changed; %d passed, %d failed, in %.0f s of processor time\n", changed, given, passed, failed,
	      all - left; exit failed > 0 }'
