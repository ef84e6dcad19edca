#!/bin/sh
# A test is stopped when it has used its processor time, or after its wall time; one that waits is not. With short limits. Prints what failed;
# status 0 when nothing did.
set -u
DIR=build/tmp/limit-sh-$$
failed=0
mkdir -p "$DIR"
trap 'rm -rf "$DIR"' EXIT

complain() { echo "test_limit: $*"; failed=1; }

# planted NAME CPU_S WALL_S PATTERN: what run.sh says of a test whose text is on stdin
planted() {
	{ echo '#!/bin/sh'; cat; } >"$DIR/test_$1.sh"
	chmod +x "$DIR/test_$1.sh"
	env -u CHECK BUILD="$DIR" RESULTS="$DIR" LIMIT_CPU_S="$2" LIMIT_WALL_S="$3" sh tests/run.sh --one "$DIR/test_$1.sh" >"$DIR/out"
	grep -Eq -- "$4" "$DIR/out" || complain "$1: $(cat "$DIR/out")"
}

planted busy 1 60 '^FAILED: test_busy.sh, 1 of 1 \(stopped after 1 s of processor time' <<'SH'
while :; do :; done
SH
planted sleeper 1 60 '^ok: test_sleeper.sh, 1$' <<'SH'
sleep 2.5
SH
planted patient 60 1 '^FAILED: test_patient.sh, 1 of 1 \(stopped after 1 s of wall time' <<'SH'
sleep 1000.5
SH
planted stubborn 60 1 '^FAILED: test_stubborn.sh, 1 of 1 \(status 137' <<'SH'
trap '' TERM
sleep 1000.5
sleep 1000.5
SH
planted failing 60 60 '^FAILED: test_failing.sh, 1 of 1 \(status 3\)' <<'SH'
exit 3
SH
planted killed 60 60 '^FAILED: test_killed.sh, 1 of 1 \(status 139\)' <<'SH'
kill -SEGV $$
SH
exit $failed
