#!/bin/sh
# Runs what it is given and counts: ends with the one line `N passed, N failed`, and with status 1 if any failed.
#
#   run.sh FOLDER BUILT PROGRAM...        FOLDER: the config's output folder; BUILT: make's exit status for all that is run here
#
# One test each: the build, the checks named in $CHECKS (`make layers`, `make headers`), every cmocka test of a binary FOLDER/tests/test_*,
# every corpus replayed through FOLDER/fuzz/fuzz_*, every script tests/*/test_*.sh (status 0 = passed, 77 = skipped; BUILD=FOLDER in its environment). A
# binary that crashes, hangs or is missing counts as one failed, beside what it counted until then. JOBS of them run at a time.
#
# Each process of a test may use LIMIT_CPU_S seconds of processor time, and the test take LIMIT_WALL_S seconds.
set -u
if [ "${1-}" = --one ]; then
	. "$(dirname "$0")/run_one.sh"
	exit
fi
folder=$1 built=$2
shift 2
results=$folder/tests/results
rm -rf "$results"
mkdir -p "$results" build/tmp

case $folder in
*/sanitize|*/fuzz|*/coverage) limit=1200 ;;
*) limit=600 ;;
esac
# a size that no machine has is an error to be handled, not the sanitizer's business
export ASAN_OPTIONS="${ASAN_OPTIONS:-allocator_may_return_null=1}" LSAN_OPTIONS="suppressions=$PWD/tests/support/leaks.txt:print_suppressions=0"
export UBSAN_OPTIONS="${UBSAN_OPTIONS:-print_stacktrace=1}"
# what looks for leaks, or writes down what was run, makes calls that ecoserve must not
case $folder in */sanitize|*/coverage|*/thread) export ECOSERVE_NO_SANDBOX=yes ;; esac
export CMOCKA_MESSAGE_OUTPUT=TAP BUILD="$folder" RESULTS="$results"
export LIMIT_CPU_S="${LIMIT_CPU_S:-$limit}" LIMIT_WALL_S="${LIMIT_WALL_S:-1800}"

note() { # NAME PASSED FAILED
	echo "$2 $3" >"$results/$1.count"
	[ "$3" -eq 0 ] || echo "FAILED: $1" | tee "$results/$1.failed"
}
if [ "$built" -eq 0 ]; then note build 1 0; else note build 0 1; fi
for check in ${CHECKS-}; do
	if ${MAKE:-make} --no-print-directory "$check" >"$results/$check.log" 2>&1; then
		note $check 1 0
	else
		note $check 0 1
		tail -n 60 "$results/$check.log"
	fi
done

for program in "$@"; do echo "$program"; done | xargs -n 1 -P "${JOBS:-$(nproc 2>/dev/null || echo 1)}" sh "$0" --one

# processor time by test, the longest first
for cpu in "$results"/*.cpu; do
	[ ! -e "$cpu" ] || echo "$(cat "$cpu") $(basename "$cpu" .cpu)"
done | sort -rn | tee "$folder/tests/cpu.txt" | awk -v file="$folder/tests/cpu.txt" '{ all += $1 }
	END { printf "%.0f s of processor time; by test in %s\n", all, file }'
cat "$results"/*.count | awk '{ passed += $1; failed += $2; skipped += $3 }
	END { if (skipped) printf "%d skipped: what they need is not here\n", skipped
	      printf "%d passed, %d failed\n", passed, failed; exit failed > 0 }'
