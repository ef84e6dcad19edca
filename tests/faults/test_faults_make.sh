#!/bin/sh
# ecopack make when the system fails: memory, disk, short writes, kill -9. It ends with an error that says what failed, the pack is the old
# or the new one, whole, and nothing is left over after the next make. FAULTS: how many places of each kind (8; all), KILLS: how many kills
# (12). Status 77 where the library of faults is not built.
set -u
. "$(dirname "$0")/common.sh"

make_pack 1 "$DIR/one.eco" || exit 1
make_pack 2 "$DIR/two.eco" || exit 1
mkdir "$DIR/out"
OUT=$DIR/out/pack.eco

# check WHAT STATUS : after a make of scene 2 over a pack of scene 1
check() {
	tried=$((tried + 1))
	if [ "$2" -eq 0 ]; then
		cmp -s "$OUT" "$DIR/two.eco" || complain "$1: done, but the pack is another"
	elif [ "$2" -eq 1 ]; then
		cmp -s "$OUT" "$DIR/one.eco" || cmp -s "$OUT" "$DIR/two.eco" || complain "$1: the pack is neither the old nor the new one"
		[ -s "$DIR/said" ] || complain "$1: failed without a word"
	else
		complain "$1: status $2: $(head -c 300 "$DIR/said")"
	fi
	# where a library ends the program, the next make tidies up, as after a kill
	grep -q 'within a library' "$DIR/said" && make_pack 2 "$OUT"
	[ "$(ls "$DIR/out")" = pack.eco ] || complain "$1: left $(ls "$DIR/out" | paste -sd ' ')"
	rm -f "$DIR/out"/*
	cp "$DIR/one.eco" "$OUT"
}
: >"$DIR/said"
cp "$DIR/one.eco" "$OUT"

# memory
FAULT_COUNT=9 LD_PRELOAD=$FAULT make_pack 2 "$OUT" 9>"$DIR/count"
check "nothing fails" $?
count=$(tail -n 1 "$DIR/count")
[ "${count:-0}" -gt 100 ] || complain "only ${count:-no} allocations were counted"
for mark in '' -; do
	# the last ones are those of the pack's description, of which nothing may be left out
	for at in $(places "$count") $(seq $((count - 179)) 20 "$count"); do
		FAULT_ALLOC=$at$mark LD_PRELOAD=$FAULT make_pack 2 "$OUT" >"$DIR/said" 2>&1
		check "allocation $at$mark fails" $?
	done
done

# writes that take a few bytes
FAULT_SHORT=1 LD_PRELOAD=$FAULT make_pack 2 "$OUT" >"$DIR/said" 2>&1
check "short writes" $?

# a disk that is full or broken, call by call. The guard's children hand over what they read by writing, too.
traced() { # WHAT... : makes scene 2 under strace, at whose calls WHAT is done
	strace -f --seccomp-bpf -o "$DIR/calls" -e signal=none "$@" "$BUILD/ecopack" make "$DIR/2/scene.json" -o "$OUT" --draft --no-cache -q --jobs 1 \
		>"$DIR/said" 2>&1
}
if traced -e trace=write; then
	for fault in write:ENOSPC write:EIO fsync:EIO rename:ENOSPC openat:EIO newfstatat:EIO close:EIO; do
		call=${fault%:*}
		traced -e trace="$call"
		for at in $(places "$(grep -c "$call(" "$DIR/calls")"); do
			traced -e trace="$call" -e inject="$call:error=${fault#*:}:when=$at"
			status=$?
			# before main it is the loader that fails
			grep -q 'while loading shared libraries' "$DIR/said" || check "$call $at: ${fault#*:}" $status
		done
	done
fi

# kill -9 at any time; what is left over goes with the next make
spent=$( { TIMEFORMAT=%R; date +%s%N; make_pack 2 "$OUT"; date +%s%N; } | awk '{ last = now; now = $1 } END { print (now - last) / 1e9 }')
kills=${KILLS:-12}
for i in $(seq "$kills"); do
	from=$((i % 2 + 1))
	wait=$(awk -v i="$i" -v spent="$spent" 'BEGIN { srand(i); print 1.2 * spent * rand() }')
	timeout -s KILL "$wait" "$BUILD/ecopack" make "$DIR/$from/scene.json" -o "$OUT" --draft --no-cache -q --jobs 1 >"$DIR/said" 2>&1
	cmp -s "$OUT" "$DIR/one.eco" || cmp -s "$OUT" "$DIR/two.eco" || complain "kill $i after $wait s: the pack is neither"
	tried=$((tried + 1))
done
for i in 1 2 3 4 5; do          # children of a killed build may hold its file a moment longer
	make_pack 2 "$OUT"
	[ "$(ls "$DIR/out")" = pack.eco ] && break
	sleep 0.2
done
[ "$(ls "$DIR/out")" = pack.eco ] || complain "left over after $kills kills: $(ls "$DIR/out" | paste -sd ' ')"
cmp -s "$OUT" "$DIR/two.eco" || complain "the make after $kills kills made another pack"

echo "$tried faults of ecopack make, $kills of them kills"
exit $failed
