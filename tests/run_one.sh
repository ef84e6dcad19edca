# Part of run.sh and check.sh: runs $2 (a test binary, a fuzz target's replay or a script), writes its counts to $RESULTS and says what
# failed. What passed is noted as green (tests/green.sh).
. tests/green.sh
program=$2
name=$(basename "$program")
log=$RESULTS/$name.log

case $name in
fuzz_*)
	corpus=tests/fuzz/corpus/${name#fuzz_}
	# a real fuzzer would go on from there
	case $BUILD in */fuzz) set -- "$program" -runs=0 "$corpus" ;; *) set -- "$program" "$corpus" ;; esac
	;;
*) set -- "$program" ;;
esac
key=$(green_key "$program")
"${LIMIT:-build/limit}" "$LIMIT_CPU_S" "$LIMIT_WALL_S" "$RESULTS/$name.cpu" "$@" >"$log" 2>&1 </dev/null
status=$?

# cmocka's TAP counts; anything else is one test
passed=$(grep -c '^ok ' "$log")
skipped=$(grep -c '^not ok .*# SKIP' "$log")
failed=$(($(grep -c '^not ok ' "$log") - skipped))
case $name in *.sh|fuzz_*) passed=0 failed=0 skipped=0 ;; esac
# a script that lacks what it needs says so, and ends with 77
case $name:$status in *.sh:77) skipped=1 status=0; tail -n 1 "$log" ;; esac
if [ $((passed + failed + skipped)) -eq 0 ]; then
	if [ $status -eq 0 ]; then passed=1; else failed=1; fi
elif [ $status -ne 0 ] && { [ "$failed" -eq 0 ] || [ $status -ge 124 ]; }; then
	failed=$((failed + 1))
fi
cpu=$(cat "$RESULTS/$name.cpu" 2>/dev/null || echo 0)
case $name:$skipped in *.sh:1) ;; *) green_note "$program" "$failed" "$cpu" "$key" ;; esac
stopped=$(sed -n 's/^limit: //p' "$log" | tail -n 1)
# check.sh has only so much time, which is no fault of the test
if [ -n "$stopped" ] && [ -n "${CHECK-}" ]; then
	echo "not run to its end: $name ($cpu s)"
	exit 0
fi
echo "$passed $failed $skipped" >"$RESULTS/$name.count"

if [ "$failed" -gt 0 ]; then
	case $status in
	124) how=${stopped:-status 124} ;;
	127) how="not there or not executable" ;;
	*) how="status $status" ;;
	esac
	# one write, so that what runs beside does not come between
	text=$(echo "FAILED: $name, $failed of $((passed + failed)) ($how); all of it in $log"
		grep -v -e '^ok ' -e '# SKIP' -e '^1\.\.' -e '^# ok' "$log" | tail -n 60 | sed 's/^/    /')
	printf '%s\n' "$text"
else
	echo "ok: $name, $passed$([ "$skipped" -gt 0 ] && echo ", $skipped skipped")$([ "${cpu%.*}" -ge 5 ] && echo ", ${cpu%.*} s")"
fi
