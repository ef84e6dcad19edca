#!/bin/sh
# ecopack export when the system fails: a folder of 3D Tiles is whole or not there, one of chunks has whole ones only, and all of them once it
# is done; both are on the disk by then, after one wait for all files. FAULTS: how many places of each kind (8; all). Status 77 without strace.
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
"$BUILD/ecopack" export "$DIR/one.eco" --static "$DIR/chunks" --from 1 -q || exit 1

# the folder gets its name after all is on the disk
tail -n 3 "$DIR/calls" | grep -v exited | awk '{ sub(/\(.*/, "", $2); print $2 }' | paste -sd ' ' | grep -qx 'syncfs rename' ||
	complain "not on the disk before it is there: $(tail -n 3 "$DIR/calls")"
[ "$(grep -c 'syncfs(' "$DIR/calls")" -eq 1 ] || complain "waits $(grep -c 'syncfs(' "$DIR/calls") times"

# check WHAT STATUS PART : PART is tiles or chunks
check() {
	tried=$((tried + 1))
	if [ "$2" -eq 0 ]; then
		diff -r "$DIR/$3" "$DIR/out/$3" >/dev/null || complain "$1: done, but $3 are others"
	elif [ "$2" -ne 1 ]; then
		complain "$1: status $2: $(head -c 300 "$DIR/said")"
	elif [ ! -s "$DIR/said" ]; then
		complain "$1: failed without a word"
	elif [ "$3" = tiles ]; then
		[ -z "$(ls "$DIR/out")" ] || complain "$1: left $(ls "$DIR/out" | paste -sd ' ')"
	else
		for file in "$DIR/out/chunks"/*; do
			[ ! -e "$file" ] || cmp -s "$file" "$DIR/chunks/${file##*/}" || complain "$1: ${file##*/} is no whole chunk"
		done
	fi
	rm -rf "$DIR/out"/*
}

# memory: nothing of tilesets and models is left out where there is none for it
exporting() { "$BUILD/ecopack" export "$DIR/one.eco" --3dtiles "$DIR/out/tiles" -q; }
: >"$DIR/said"
FAULT_COUNT=9 LD_PRELOAD=$FAULT exporting 9>"$DIR/count"
check "nothing fails" $? tiles
count=$(tail -n 1 "$DIR/count")
[ "${count:-0}" -gt 100 ] || complain "only ${count:-no} allocations were counted"
for at in $(places "$count") $(seq $((count - 199)) 9 "$count"); do
	FAULT_ALLOC=$at LD_PRELOAD=$FAULT exporting >"$DIR/said" 2>&1
	status=$?
	# a library that ends the program leaves the folder with its first name
	grep -q 'within a library' "$DIR/said" && rm -rf "$DIR/out"/*.tmp-*
	check "allocation $at fails" $status tiles
done

for part in tiles:--3dtiles chunks:--static; do
	set -- "${part#*:}" "$DIR/out/${part%:*}"
	[ "${part%:*}" = tiles ] || set -- "$@" --from 1
	for fault in write:ENOSPC write:EIO syncfs:EIO rename:ENOSPC openat:EIO mkdir:ENOSPC close:EIO; do
		call=${fault%:*}
		traced -e trace="$call" -- "$@"
		check "nothing fails" $? "${part%:*}"
		for at in $(places "$(grep -c "$call(" "$DIR/calls")"); do
			traced -e trace="$call" -e inject="$call:error=${fault#*:}:when=$at" -- "$@"
			status=$?
			grep -q 'while loading shared libraries' "$DIR/said" || check "$call $at: ${fault#*:}" $status "${part%:*}"
		done
	done
done

echo "$tried faults of ecopack export"
exit $failed
