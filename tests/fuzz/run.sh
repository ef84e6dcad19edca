#!/bin/sh
# run.sh FOLDER SECONDS TARGET...: runs each fuzz target for SECONDS on a copy of its corpus. What it finds stays in
# FOLDER/corpus/NAME for the next run; an input that fails in FOLDER/found/NAME.
set -u
folder=$1 seconds=$2
shift 2
export ASAN_OPTIONS="${ASAN_OPTIONS:-allocator_may_return_null=1}" UBSAN_OPTIONS="${UBSAN_OPTIONS:-print_stacktrace=1}"
failed=0
for target in "$@"; do
	name=$(basename "$target") name=${name#fuzz_}
	work=$folder/corpus/$name found=$folder/found/$name log=$folder/$name.log
	mkdir -p "$work" "$found"
	# four times the longest seed, at least 4 KiB: longer inputs only make it slower
	longest=$(find "tests/fuzz/corpus/$name" -type f -printf '%s\n' 2>/dev/null | sort -n | tail -1)
	length=$((${longest:-0} * 4 > 4096 ? ${longest:-0} * 4 : 4096))
	echo "fuzz $name: $seconds s, inputs up to $length bytes"
	# inputs that are quick are tried more often than those that are slow
	"$target" -max_total_time="$seconds" -max_len="$length" -rss_limit_mb=2048 -timeout=20 -print_final_stats=1 \
		-entropic_scale_per_exec_time=1 -artifact_prefix="$found/" "$work" $([ -d "tests/fuzz/corpus/$name" ] && echo "tests/fuzz/corpus/$name") >"$log" 2>&1
	status=$?
	if [ $status -ne 0 ]; then
		failed=$((failed + 1))
		echo "fuzz $name: FAILED, status $status; inputs in $found, all of it in $log"
		tail -n 40 "$log" | sed 's/^/    /'
	else
		sed -n -e 's/^stat::number_of_executed_units: */    runs: /p' -e 's/^stat::new_units_added: */    new inputs: /p' "$log"
	fi
done
echo "fuzz: $# targets, $failed failed"
[ $failed -eq 0 ]
