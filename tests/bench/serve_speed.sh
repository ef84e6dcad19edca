#!/bin/sh
# serve_speed.sh [RUNS [SECONDS [PACK...]]]: how fast ecoserve is. Chunks per CPU second against nginx (sendfile, open_file_cache, no access log, two
# workers) with the same bytes as static files: wrk with 64 connections, medians of RUNS alternating runs. Then what a cached answer costs, and
# 304; 64 cameras in an open loop; and first visits of each PACK. Processor time is that of the servers' own processes, so that a busy machine disturbs less. Needs nginx-light and wrk.
#   SIZES="400 10000"      which chunks
set -eu
BUILD=${BUILD:-build}
. "$(dirname "$0")/../demo/common.sh"
tests/packages.sh nginx-light wrk
make --no-print-directory "$BUILD/ecoserve" "$BUILD/ecopack" "$BUILD/ecoload" "$BUILD/bench/chunk_pack" >/dev/null
RUNS=${1:-7} SECONDS_EACH=${2:-2} SIZES=${SIZES:-400 10000 46000 256000}
OUT=$BUILD/serve-speed
PORT=${PORT:-18431}
rm -rf "$OUT"
mkdir -p "$OUT/nginx/tmp"

"$BUILD/bench/chunk_pack" "$OUT/chunks.eco" 400 10000 46000 256000
"$BUILD/ecopack" export "$OUT/chunks.eco" --static "$OUT/files" --from 1 --quiet
chmod -R a+rX "$OUT"
user=
[ "$(id -u)" -ne 0 ] || user="user root;"
cat >"$OUT/nginx/nginx.conf" <<NGINX
$user
worker_processes 2;
daemon off;
pid nginx.pid;
error_log nginx.err warn;
events { worker_connections 1024; }
http {
	access_log off;
	sendfile on;
	tcp_nopush on;
	keepalive_requests 1000000000;
	open_file_cache max=1000 inactive=1h;
	client_body_temp_path tmp/b; fastcgi_temp_path tmp/f; uwsgi_temp_path tmp/u; scgi_temp_path tmp/s; proxy_temp_path tmp/p;
	server { listen 127.0.0.1:$PORT; root $(realpath "$OUT/files"); }
}
NGINX
nginx -p "$OUT/nginx" -c nginx.conf 2>"$OUT/nginx/start.log" &
NGINX=$!
serve "$OUT/serve.log" --connections 4000 --connections-per-address 4000 "chunks=$OUT/chunks.eco"
trap 'kill $NGINX $SERVER_PID 2>/dev/null' EXIT
sleep 0.5
kill -0 $NGINX || die "nginx: $(cat "$OUT/nginx/start.log")"

# CPU ticks of a process and its children
ticks() {
	for pid in "$1" $(pgrep -P "$1"); do sed 's/.*) //' "/proc/$pid/stat" | cut -d ' ' -f 12,13; done | awk '{ n += $1 + $2 } END { print n }'
}
# measure PID URL [WRK-OPTION...]: answers per CPU second of the server
measure() {
	pid=$1 url=$2; shift 2
	before=$(ticks "$pid")
	answers=$(wrk -t 1 -c 64 -d "${SECONDS_EACH}s" "$@" "$url" | tee "$OUT/wrk.txt" | sed -n 's/^ *\([0-9]*\) requests in.*/\1/p')
	! grep -q 'Non-2xx\|Socket errors' "$OUT/wrk.txt" || die "$(cat "$OUT/wrk.txt")"
	after=$(ticks "$pid")
	awk -v n="$answers" -v t=$((after - before)) -v hz="$(getconf CLK_TCK)" 'BEGIN { printf "%.0f\n", n * hz / t }'
}
median() { sort -n | awk '{ v[NR] = $1 } END { print v[int((NR + 1) / 2)] }'; }

for size in $SIZES; do
	id=$(find "$OUT/files" -size "${size}c" -printf '%f\n')
	: >"$OUT/ours" && : >"$OUT/theirs"
	for _ in $(seq "$RUNS"); do
		measure "$SERVER_PID" "$BASE/v1/scenes/chunks/chunks/$id" >>"$OUT/ours"
		measure "$NGINX" "http://127.0.0.1:$PORT/$id" >>"$OUT/theirs"
	done
	awk -v size="$size" -v a="$(median <"$OUT/ours")" -v b="$(median <"$OUT/theirs")" \
		'BEGIN { printf "chunks of %.1f kB: %d per CPU second, nginx %d: %.2f\n", size / 1e3, a, b, a / b }'
done

# ---- Answers: cached ones, and 304, which wrk does not understand: 16 connections, one request at a time on each ----

"$BUILD/ecopack" generate park -o "$OUT/park" --quiet
"$BUILD/ecopack" make --draft "$OUT/park/scene.json" -o "$OUT/park.eco" --quiet
stop_serving
serve "$OUT/serve.log" --connections 4000 --connections-per-address 4000 --plans-per-address 64 "park=$OUT/park.eco"
trap 'kill $NGINX $SERVER_PID 2>/dev/null' EXIT
view="$BASE/v1/scenes/park/stream?eye=0,-40,10&target=0,0,2&fov_y_deg=45&width=800&height=600&vertices=100000&bytes=50000"
etag=$(curl -fsS -o "$OUT/answer" -D - "$view" | tr -d '\r' | sed -n 's/^[Ee][Tt]ag: *//p')
printf 'a cached answer of %s bytes: %s per CPU second\n' "$(wc -c <"$OUT/answer")" "$(measure "$SERVER_PID" "$view")"
before=$(ticks "$SERVER_PID")
count=$(python3 - "$view" "$etag" "$SECONDS_EACH" <<'PYTHON'
import socket, sys, time, urllib.parse
at = urllib.parse.urlsplit(sys.argv[1])
request = f"GET {at.path}?{at.query} HTTP/1.1\r\nHost: {at.netloc}\r\nIf-None-Match: {sys.argv[2]}\r\n\r\n".encode()
sockets = [socket.create_connection((at.hostname, at.port)) for _ in range(16)]
end, count = time.monotonic() + 2 * float(sys.argv[3]), 0
while time.monotonic() < end:
    for s in sockets: s.sendall(request)
    for s in sockets:
        answer = b""
        while not answer.endswith(b"\r\n\r\n"): answer += s.recv(4096)
        assert answer.startswith(b"HTTP/1.1 304 "), answer
        count += 1
print(count)
PYTHON
)
printf '304 by its tag: %s per CPU second\n' "$(awk -v n="$count" -v t=$(($(ticks "$SERVER_PID") - before)) 'BEGIN { printf "%.0f", n * 100 / t }')"

# 64 cameras, each asking once a second; ecoload takes its share of the processors, and says how much
"$BUILD/ecoload" "$BASE/v1/scenes/park" --camera flyover --clients 64 --rate 64 --seconds 20 --vertices 100000 --decode 4 --json 2>/dev/null |
	jq -r '"64 cameras of the park, each once a second at 100,000 vertices: p50 \(.latency_ms.p50 | round), p99 \(.latency_ms.p99 | round) ms, " +
		"\(.failures | add) failures; ecoload took \(.cpu_seconds / .seconds * 100 | round / 100) of \(.processors) processors"'
stop_serving

# ---- First visits at 1,000,000 vertices along a flight, nothing of them kept ----

shift $(($# < 2 ? $# : 2))
for pack in "$@"; do
	serve "$OUT/serve.log" --kept-bytes 1 "scene=$pack"
	trap 'kill $NGINX $SERVER_PID 2>/dev/null' EXIT
	"$BUILD/ecoload" "$BASE/v1/scenes/scene" --camera flyover --clients 1 --cold 1 --decode 0 --seconds 0.01 --vertices 1000000 >/dev/null 2>&1 || true
	before=$(ticks "$SERVER_PID")
	count=$("$BUILD/ecoload" "$BASE/v1/scenes/scene" --camera "${CAMERA:-flyover}" --clients 4 --cold 4 --decode 0 --seconds $((5 * SECONDS_EACH)) \
		--vertices 1000000 --json 2>/dev/null | jq .requests)
	awk -v n="$count" -v t=$(($(ticks "$SERVER_PID") - before)) -v pack="$(basename "$pack")" \
		'BEGIN { printf "first visits of %s: %.1f per CPU second\n", pack, n * 100 / t }'
	stop_serving
done
kill $NGINX
