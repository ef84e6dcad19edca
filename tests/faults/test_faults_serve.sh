#!/bin/sh
# ecoserve and ecoview when memory fails, and ecoserve when clocks jump. It does not start, and says why; or it goes on: a request that lacked
# memory is refused or its connection closed, the next is answered, and it ends when it is told to. ecoview ends with a picture or with an
# error. FAULTS: how many places (8; all). Status 77 where the library of faults is not built.
set -u
. "$(dirname "$0")/common.sh"

make_pack 1 "$DIR/one.eco" || exit 1
cp "$DIR/one.eco" "$DIR/served.eco"
VIEW='eye=0,-3,1&target=0,0,1&width=64&height=64&vertices=100'
echo '{"fps": 1, "keyframes": [{"time_s": 0, "eye": [0, -3, 1], "target": [0, 0, 1], "fov_y_deg": 45}]}' >"$DIR/camera.json"
printf '\000\000\000\000' >"$DIR/nothing"

# serve : starts ecoserve with the faults of the environment; $port is empty where it ended
serve() {
	: >"$DIR/ready"
	LD_PRELOAD=$FAULT "$BUILD/ecoserve" --listen 127.0.0.1:0 --log json "scene=$DIR/served.eco" >"$DIR/ready" 2>"$DIR/said" 9>>"$DIR/count" &
	server=$!
	port=
	for _ in $(seq 200); do
		port=$(sed -n 's/.*ready on http:.*:\([0-9]*\) .*/\1/p' "$DIR/ready")
		[ -n "$port" ] && return
		kill -0 $server 2>/dev/null || return
		sleep 0.05
	done
	kill -9 $server          # and it is complained of
}

ask() { # PATH [OPTION...]
	path=$1; shift
	curl -s -m 10 -o "$DIR/body" -w '%{http_code} ' "$@" "http://127.0.0.1:$port$path"
}

# each kind of request, and a reload that opens the pack anew
ask_all() {
	ask /v1/scenes; ask "/v1/scenes/scene/plan?$VIEW"; ask "/v1/scenes/scene/stream?$VIEW"
	ask "/v1/scenes/scene/stream?$VIEW" --data-binary "@$DIR/nothing" -H 'Content-Type: application/octet-stream'
	ask /nowhere; ask /metrics
	cp "$DIR/one.eco" "$DIR/new" && mv "$DIR/new" "$DIR/served.eco"
	ask /v1/admin/reload -X POST; ask "/v1/scenes/scene/plan?$VIEW&explain=1"
}

# stop WHAT : it still serves, and ends well
stop() {
	tried=$((tried + 1))
	[ "$(ask /healthz)" = "200 " ] || complain "$1: it does not serve any more: $(tail -n 3 "$DIR/said")"
	kill $server
	wait $server || complain "$1: ended with $?: $(tail -n 3 "$DIR/said")"
}

: >"$DIR/count"
FAULT_COUNT=9 serve
said=$(ask_all)
case $said in "200 200 200 200 404 200 200 "*) ;; *) complain "nothing fails, and answers are $said" ;; esac
stop "nothing fails"
count=$(tail -n 1 "$DIR/count")
[ "${count:-0}" -gt 100 ] || complain "only ${count:-no} allocations were counted"
for at in $(places "$count"); do
	FAULT_ALLOC=$at serve
	if [ -z "$port" ]; then
		tried=$((tried + 1))
		wait $server
		status=$?
		# glibc 2.36 asserts that its own table of name services is read
		{ [ $status -eq 1 ] && [ -s "$DIR/said" ]; } || grep -q 'nss_database.c.*Assertion' "$DIR/said" || complain "allocation $at: no start, status $status: $(cat "$DIR/said")"
		continue
	fi
	ask_all >/dev/null
	stop "allocation $at fails"
done

for seconds in 315360000 -315360000; do
	FAULT_CLOCK=$seconds serve
	said="$(ask_all)$(ask_all)"
	case $said in "200 200 200 200 404 200 200 "*) ;; *) complain "clocks jump by $seconds s, and answers are $said" ;; esac
	stop "clocks jump by $seconds s"
done

# what it asks for itself: a driver that finds no memory is not ours to mend
view() {
	LD_PRELOAD=$FAULT "$BUILD/ecoview" "http://127.0.0.1:$port/v1/scenes/scene" --camera "$DIR/camera.json" --size 64x64 --vertices 100 \
		-o "$DIR/picture" "$@"
}
FAULT_ALLOC='' serve
: >"$DIR/views"
if FAULT_OWN=1 FAULT_COUNT=9 view >"$DIR/viewed" 2>&1 9>>"$DIR/views"; then
	for at in $(places "$(tail -n 1 "$DIR/views")"); do
		rm -rf "$DIR/picture"
		FAULT_OWN=1 FAULT_ALLOC=$at view >"$DIR/viewed" 2>&1
		status=$?
		tried=$((tried + 1))
		[ $status -le 1 ] && [ -s "$DIR/viewed" ] || complain "ecoview, allocation $at: status $status: $(tail -n 3 "$DIR/viewed")"
	done
else
	complain "ecoview draws nothing: $(cat "$DIR/viewed")"
fi
stop "views were drawn"

echo "$tried faults of ecoserve and ecoview"
exit $failed
