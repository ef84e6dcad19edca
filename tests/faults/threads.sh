#!/bin/sh
# threads.sh SECONDS: ecoserve under the thread sanitizer, with clients, reloads, metrics and clients that leave. Status 1 at the first race.
set -eu
SECONDS_LONG=${1:-30}
BUILD=${BUILD:-build}
DIR=$(mktemp -d)
server=
trap 'kill $server 2>/dev/null || true; rm -rf "$DIR"' EXIT
${MAKE:-make} --no-print-directory config=thread build/thread/ecoserve >/dev/null

printf 'v -0.05 0 0\nv 0.05 0 0\nv 0 0 1\nf 1 2 3\n' >"$DIR/blade.obj"
echo '{ "plants": {"grass": {"model": "blade.obj"}}, "instances": [{"plant": "grass", "at": [0, 0]}] }' >"$DIR/scene.json"
echo '{"fps": 1, "keyframes": [{"time_s": 0, "eye": [0, -3, 1], "target": [0, 0, 1], "fov_y_deg": 45},
	{"time_s": 9, "eye": [0, -9, 5], "target": [0, 0, 1], "fov_y_deg": 45}]}' >"$DIR/camera.json"
"$BUILD/ecopack" make "$DIR/scene.json" -o "$DIR/blade.eco" --draft --no-cache -q

# the sanitizer makes calls that the sandbox refuses
TSAN_OPTIONS="exitcode=66 ${TSAN_OPTIONS-}" build/thread/ecoserve --no-sandbox --listen 127.0.0.1:0 --log json --connections-per-address 500 \
	"blade=$DIR/blade.eco" >"$DIR/ready" 2>"$DIR/log" &
server=$!
for _ in $(seq 300); do
	base=$(sed -n 's/.*ready on \(http:[^ ]*\).*/\1/p' "$DIR/ready")
	[ -n "$base" ] && break
	sleep 0.1
done
"$BUILD/ecoload" "$base/v1/scenes/blade" --camera "$DIR/camera.json" --clients 8 --seconds "$SECONDS_LONG" --vertices 1000 >"$DIR/load" 2>&1 &
load=$!
i=0
while kill -0 $load 2>/dev/null; do
	i=$((i + 1))
	touch "$DIR/blade.eco"
	kill -HUP $server
	curl -s -m 20 -o /dev/null "$base/metrics" || true
	# leaves before its plan is made
	curl -s -m 0.05 -o /dev/null "$base/v1/scenes/blade/stream?eye=0,-$i,1&target=0,0,1&width=64&height=64&vertices=9" || true
	sleep 1
done
wait $load || { cat "$DIR/load"; exit 1; }
kill $server
status=0
wait $server || status=$?
echo "threads: $(grep -c '"event":"request"' "$DIR/log") requests and $(grep -c 'reload:' "$DIR/log") reloads under the thread sanitizer," \
	"$(grep -c 'WARNING: ThreadSanitizer' "$DIR/log") races, status $status"
[ $status -eq 0 ] || { grep -A30 'WARNING: ThreadSanitizer' "$DIR/log" | head -n 60; exit 1; }
