#!/bin/sh
# ecopack export when the system fails: a folder of 3D Tiles is whole or not there, and on the disk by then, after one wait for all files.
# FAULTS: how many places of each kind (8; all). Status 77 without strace.
set -u
. "$(dirname "$0")/common.sh"

make_pack 1 "$DIR/one.eco" || exit 1
mkdir "$DIR/out"

# traced WHAT... -- OPTIONS : exports under strace, at whose calls WHAT is done
traced() {
	what=
	while [ "$1" != -- ]; do what="$what $1"; shift; done
	shift
	strace -f --seccomp-bpf -o "$DIR/calls" -e signal=none $what "$BUILD/ecopack" export "$DIR/one.eco" "$@" -q >"$DIR/said" 2>&1
}
traced -e trace=syncfs,rename -- --3dtiles "$DIR/tiles" || exit 77

# the folder gets its name after all is on the disk
tail -n 3 "$DIR/calls" | grep -v exited | awk '{ sub(/\(.*/, "", $2); print $2 }' | paste -sd ' ' | grep -qx 'syncfs rename' ||
	complain "not on the disk before it is there: $(tail -n 3 "$DIR/calls")"
[ "$(grep -c 'syncfs(' "$DIR/calls")" -eq 1 ] || complain "waits $(grep -c 'syncfs(' "$DIR/calls") times"

# check WHAT STATUS
check() {
	tried=$((tried + 1))
	if [ "$2" -eq 0 ]; then
		diff -r "$DIR/tiles" "$DIR/out/tiles" >/dev/null || complain "$1: done, but tiles are others"
	elif [ "$2" -ne 1 ]; then
		complain "$1: status $2: $(head -c 300 "$DIR/said")"
	elif [ ! -s "$DIR/said" ]; then
		complain "$1: failed without a word"
	elif [ -n "$(ls "$DIR/out")" ]; then
		complain "$1: left $(ls "$DIR/out" | paste -sd ' ')"
	fi
	rm -rf "$DIR/out"/*
}

# memory: nothing of tilesets and models is left out where there is none for it
exporting() { "$BUILD/ecopack" export "$DIR/one.eco" --3dtiles "$DIR/out/tiles" -q; }
: >"$DIR/said"
FAULT_COUNT=9 LD_PRELOAD=$FAULT exporting 9>"$DIR/count"
check "nothing fails" $?
count=$(tail -n 1 "$DIR/count")
[ "${count:-0}" -gt 100 ] || complain "only ${count:-no} allocations were counted"
for at in $(places "$count") $(seq $((count - 199)) 9 "$count"); do
	FAULT_ALLOC=$at LD_PRELOAD=$FAULT exporting >"$DIR/said" 2>&1
	status=$?
	# a library that ends the program leaves the folder with its first name
	grep -q 'within a library' "$DIR/said" && rm -rf "$DIR/out"/*.tmp-*
	check "allocation $at fails" $status
done

set -- --3dtiles "$DIR/out/tiles"
for fault in write:ENOSPC write:EIO syncfs:EIO rename:ENOSPC openat:EIO mkdir:ENOSPC close:EIO; do
	call=${fault%:*}
	traced -e trace="$call" -- "$@"
	check "nothing fails" $?
	for at in $(places "$(grep -c "$call(" "$DIR/calls")"); do
		traced -e trace="$call" -e inject="$call:error=${fault#*:}:when=$at" -- "$@"
		status=$?
		grep -q 'while loading shared libraries' "$DIR/said" || check "$call $at: ${fault#*:}" $status
	done
done

echo "$tried faults of ecopack export"
exit $failed
