#!/bin/sh
# make check runs what has changed since it last passed, cheapest first, and says what it has no time for. With planted tests. Prints what
# failed; status 0 when nothing did.
set -u
DIR=build/tmp/check-sh-$$
failed=0
mkdir -p "$DIR/tests"
trap 'rm -rf "$DIR"' EXIT

plant() { # NAME TEXT
	printf '#!/bin/sh\necho %s >>%s/ran\n%s\n' "$1" "$DIR" "$2" >"$DIR/tests/$1"
	chmod +x "$DIR/tests/$1"
}

# check SECONDS STATUS RAN PATTERN; RAN: names in order, or all
check() {
	rm -f "$DIR/ran"
	CHECK_S=$1 tests/check.sh "$DIR" "$DIR/tests/test_a" "$DIR/tests/test_b" "$DIR/tests/test_c" >"$DIR/out" 2>&1
	status=$?
	ran=$(paste -sd ' ' "$DIR/ran" 2>/dev/null)
	[ $status -eq "$2" ] && { [ "$ran" = "$3" ] || [ "$3" = all ]; } && grep -Eq -- "$4" "$DIR/out" || {
		echo "test_check: status $status instead of $2, ran '$ran' instead of '$3', or does not say /$4/: $(cat "$DIR/out")"
		failed=1
	}
}

# a loop takes a tenth of a second or more
plant test_a 'i=0; while [ $i -lt 300000 ]; do i=$((i + 1)); done'
plant test_b exit
plant test_c 'exit 1'
check 20 1 "test_a test_b test_c" '3 of 3 test programs had changed; 2 passed, 1 failed'
check 20 1 "test_c" '1 of 3 test programs had changed; 0 passed, 1 failed'
plant test_c exit
check 20 0 "test_c" '1 of 3 test programs had changed; 1 passed, 0 failed'
check 20 0 "" '0 of 3 test programs had changed'
touch "$DIR/tests/test_a" "$DIR/tests/test_b"
check 20 0 "" '0 of 3 test programs had changed'
plant test_b true
check 20 0 "test_b" '1 of 3 test programs had changed'
# the cheapest first, and what takes longer than there is time is not begun
plant test_a 'i=0; while [ $i -lt 300001 ]; do i=$((i + 1)); done'
plant test_b 'true # again'
check 20 0 "test_b test_a" '2 of 3 test programs had changed; 2 passed'
plant test_a 'i=0; while [ $i -lt 300002 ]; do i=$((i + 1)); done'
check 0.01 0 "" 'not run within 0.01 s of processor time: test_a \([0-9.]+ s\)'
# and what turns out to take longer is not a failure, but no success
plant test_a 'while :; do :; done'
check 1 0 "test_a" 'not run to its end: test_a'
check 1 0 "" 'not run within 1 s of processor time: test_a'
# modules are loaded by any test
plant test_a exit
check 20 0 "test_a" '1 of 3 test programs had changed; 1 passed'
echo module >"$DIR/ecomodule.so"
check 20 0 all '3 of 3 test programs had changed; 3 passed'
exit $failed
