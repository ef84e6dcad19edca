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
# seconds of processor time, of all that it started and waited for, go to NAME.cpu; a busy machine makes them no more
(
	ulimit -S -t "$(awk -v s="$LIMIT_CPU_S" 'BEGIN { print int(s) + (s > int(s)) }')"
	timeout -k 5 "$LIMIT_WALL_S" "$@" >"$log" 2>&1 </dev/null &
	trap 'kill $!' INT TERM
	wait $!
	status=$?
	times >"$RESULTS/$name.times"
	exit $status
)
status=$?
# 152: SIGXCPU, which comes a little before the whole time is counted
awk -v status=$status -v limit="$LIMIT_CPU_S" 'NR == 2 { gsub(/[ms]/, " ")
	printf "%.2f\n", status == 152 ? limit : 60 * ($1 + $3) + $2 + $4 }' "$RESULTS/$name.times" >"$RESULTS/$name.cpu"

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
# check.sh has only so much time, which is no fault of the test
if [ "$failed" -gt 0 ] && [ -n "${CHECK-}" ] && awk "BEGIN { exit !($cpu > .9 * $LIMIT_CPU_S) }"; then
	echo "not run to its end: $name ($cpu s)"
	exit 0
fi
echo "$passed $failed $skipped" >"$RESULTS/$name.count"

if [ "$failed" -gt 0 ]; then
	case $status in
	124) how="stopped after $LIMIT_WALL_S s of wall time" ;;
	127) how="not there or not executable" ;;
	152) how="stopped after $LIMIT_CPU_S s of processor time" ;;
	*) how="status $status" ;;
	esac
	# one write, so that what runs beside does not come between
	text=$(echo "FAILED: $name, $failed of $((passed + failed)) ($how); all of it in $log"
		grep -v -e '^ok ' -e '# SKIP' -e '^1\.\.' -e '^# ok' "$log" | tail -n 60 | sed 's/^/    /')
	printf '%s\n' "$text"
else
	echo "ok: $name, $passed$([ "$skipped" -gt 0 ] && echo ", $skipped skipped")$([ "${cpu%.*}" -ge 5 ] && echo ", ${cpu%.*} s")"
fi
