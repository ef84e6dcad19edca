#!/bin/sh
# A test is stopped when it and all that it started have used their processor time, or after its wall time; one that waits is not; and nothing
# that a test started is left. With short limits. Prints what failed; status 0 when nothing did.
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
# the one that is busy is a grandchild in a session of its own, and its parent is gone
planted hidden 1 60 '^FAILED: test_hidden.sh.*of processor time' <<'SH'
(setsid sh -c 'while :; do :; done' &)
sleep 50
SH
# many short ones count together
planted many 1 60 '^FAILED: test_many.sh.*of processor time' <<'SH'
while :; do sh -c 'i=0; while [ $i -lt 20000 ]; do i=$((i + 1)); done'; done
SH
planted sleeper 1 60 '^ok: test_sleeper.sh, 1$' <<'SH'
sleep 2.5
SH
planted patient 60 1 '^FAILED: test_patient.sh, 1 of 1 \(stopped after 1 s of wall time' <<'SH'
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
planted leaving 60 60 '^ok: test_leaving.sh' <<SH
setsid sleep 1001.5 &
echo \$! >"$DIR/left"
SH
[ ! -e "/proc/$(cat "$DIR/left")" ] || complain "what a test left behind goes on"
exit $failed
