#!/bin/sh
# make cluster-demo: three ecoserve, each in a network namespace of its own where that is allowed, behind nginx that keeps chunks, under load:
# all well; one killed; the others drained and started anew; the pack replaced under all. Ends with 1 if an answer failed for good, if one
# broke where none may, or if chunks of the pack that was replaced were not there for KEEP seconds. About two minutes.
set -eu
BUILD=${BUILD:-build}
. "$(dirname "$0")/common.sh"
OUT=$BUILD/cluster
KEEP=20
NS=eco-$$
failed=0
rm -rf "$OUT"
mkdir -p "$OUT/packs" "$OUT/nginx/tmp"

# ---- Servers ----

PIDS=
clean_up() {
	for pid in $PIDS; do kill "$pid" 2>/dev/null || true; done
	[ -z "${apart-}" ] || for i in 1 2 3; do
		ip link del "eco$i-$$" 2>/dev/null || true
		ip netns del "$NS-$i" 2>/dev/null || true
	done
}
trap clean_up EXIT
trap 'exit 130' INT TERM

# one namespace and one pair of links a server; its own end has 198.18.I.2 (RFC 2544)
make_apart() {
	ip netns add "$NS-$1" && ip link add "eco$1-$$" type veth peer name eth0 netns "$NS-$1" &&
		ip addr add "198.18.$1.1/30" dev "eco$1-$$" && ip link set "eco$1-$$" up &&
		ip -n "$NS-$1" addr add "198.18.$1.2/30" dev eth0 && ip -n "$NS-$1" link set eth0 up
}
apart=1
if make_apart 1 2>"$OUT/netns.log" && make_apart 2 2>>"$OUT/netns.log" && make_apart 3 2>>"$OUT/netns.log"; then
	echo "each server in a network namespace of its own"
else
	clean_up
	apart=
	echo "network namespaces are not allowed here ($(tail -n 1 "$OUT/netns.log")): servers on ports of 127.0.0.1"
fi

# start I: sets AT_I to its address and PID_I
start() {
	if [ -n "$apart" ]; then
		run="ip netns exec $NS-$1" at=198.18.$1.2:8080 proxy=198.18.$1.1
	else
		run= proxy=127.0.0.1
		eval "at=\${AT_$1:-127.0.0.1:0}"
	fi
	: >"$OUT/server-$1.log"
	# shellcheck disable=SC2086
	$run "$BUILD/ecoserve" --listen "$at" --trust-proxy "$proxy" --keep $KEEP --user "$(id -un)" "park=$OUT/packs/park.eco" \
		>"$OUT/server-$1.log" 2>"$OUT/server-$1.err" &
	eval "PID_$1=$!"
	PIDS="$PIDS $!"
	for _ in $(seq 200); do
		at=$(sed -n 's|.*ready on http://\([^ ]*\).*|\1|p' "$OUT/server-$1.log")
		eval "AT_$1=$at"
		[ -z "$at" ] || return 0
		sleep 0.1
	done
	die "server $1 did not become ready: $(cat "$OUT/server-$1.err")"
}

# lines [8mbit]: how much each server's line carries; all there is if not given. Where the system can do that
lines() {
	[ -n "$apart" ] || return 0
	for i in 1 2 3; do
		ip netns exec "$NS-$i" tc qdisc del dev eth0 root 2>/dev/null || true
		[ -z "${1-}" ] || ip netns exec "$NS-$i" tc qdisc add dev eth0 root tbf rate "$1" burst 32k latency 400ms || true
	done
}

# its machine is gone, with what was on its way; without namespaces, its process
lose() {
	[ -z "$apart" ] || ip -n "$NS-$1" link set eth0 down
	eval "kill -KILL \$PID_$1; wait \$PID_$1" 2>/dev/null || true
}

drain() {
	eval "pid=\$PID_$1"
	kill -TERM "$pid"
	wait "$pid" || true
}

# ---- nginx ----

configure() {
	user=
	[ "$(id -u)" -ne 0 ] || user="user root;"
	cat <<-NGINX
	$user
	worker_processes 1;
	daemon off;
	pid nginx.pid;
	error_log nginx.err warn;
	events { worker_connections 1024; }
	http {
		log_format parts '\$upstream_addr|\$upstream_cache_status|\$status|\$body_bytes_sent|\$upstream_bytes_received';
		access_log access.log parts;
		client_body_temp_path tmp/body; fastcgi_temp_path tmp/f; uwsgi_temp_path tmp/u; scgi_temp_path tmp/s; proxy_temp_path tmp/proxy;
		proxy_cache_path cache keys_zone=chunks:10m max_size=256m inactive=1h use_temp_path=off;
		upstream servers {
			server $AT_1 max_fails=1 fail_timeout=2s; server $AT_2 max_fails=1 fail_timeout=2s; server $AT_3 max_fails=1 fail_timeout=2s;
			keepalive 64;
		}
		proxy_connect_timeout 1s;
		proxy_read_timeout 5s;
		proxy_http_version 1.1;
		proxy_set_header Host \$http_host;
		proxy_set_header Connection "";
		proxy_set_header X-Forwarded-For \$remote_addr;
		server {
			listen 127.0.0.1:$1;
			# a POST of holdings changes nothing: it may be asked of another server
			location / {
				proxy_pass http://servers;
				proxy_buffering off;
				proxy_next_upstream error timeout http_502 http_503 http_504 non_idempotent;
			}
			# while packs are replaced, one server may know a chunk that another does not yet
			location ~ ^/v1/scenes/[^/]+/chunks/ {
				proxy_pass http://servers;
				proxy_cache chunks;
				proxy_cache_lock on;
				proxy_next_upstream error timeout http_404 http_502 http_503 http_504;
			}
		}
	}
	NGINX
}

# on the first port that nobody has
start_nginx() {
	for port in $(seq $((20000 + $$ % 20000)) 41000); do
		configure "$port" >"$OUT/nginx/nginx.conf"
		nginx -p "$OUT/nginx" -c nginx.conf 2>"$OUT/nginx/start.log" &
		NGINX=$!
		sleep 0.5
		if kill -0 $NGINX 2>/dev/null; then
			PIDS="$PIDS $NGINX"
			BASE=http://127.0.0.1:$port
			return
		fi
		grep -q 'Address already in use' "$OUT/nginx/start.log" || die "nginx: $(cat "$OUT/nginx/start.log")"
	done
}

# ---- Load ----

# load NAME SECONDS [OPTION...]: 12 clients, 4 of them on first visits, on lines of 1 MB/s
load() {
	name=$1 seconds=$2; shift 2
	"$BUILD/ecoload" "$BASE/v1/scenes/park" --chunks "$BASE/v1/scenes/park/chunks" --camera flyover --clients 12 --cold 4 --decode 2 \
		--seconds "$seconds" --vertices 60000 --bandwidth 1000000 --resume 3 --json --csv "$OUT/$name.csv" "$@" \
		>"$OUT/$name.json" 2>"$OUT/$name.err" &
	LOAD=$!
}
# judge NAME BROKEN: what came of it; none may fail, and none may break unless BROKEN says so
judge() {
	wait $LOAD || { failed=1; tail -n 2 "$OUT/$1.err"; }
	jq -r --arg name "$1" '"\($name): \(.requests) answers, \(.failures | add) failed, \(.resumed) broke off and came again, " +
		"\(.renewed) times a client began anew; latency p50 \(.latency_ms.p50 | floor) p99 \(.latency_ms.p99 | floor) ms" +
		(if .first_failure then "; \(.first_failure)" else "" end)' "$OUT/$1.json"
	[ "$2" = may-break ] || [ "$(jq .resumed "$OUT/$1.json")" = 0 ] || { echo "$1: none may break off"; failed=1; }
}
# of all since the last call: share of chunks that nginx had, bytes sent to clients and by each server
tell_origins() {
	awk -F '|' -v name="$1" '{ out += $4
		if ($2 != "" && $2 != "-") { chunks++; hits += $2 == "HIT" }
		n = split($1, at, ", "); split($5, bytes, ", ")
		for (i = 1; i <= n; i++) if (at[i] ~ /:/) from[at[i]] += bytes[i] }
		END { printf "%s: %.1f %% of %d chunks came from the cache; %.2f MB to clients", name, chunks ? 100 * hits / chunks : 0, chunks, out / 1e6
		for (a in from) printf ", %.2f MB from %s", from[a] / 1e6, a; print "" }' "$OUT/nginx/access.log"
	: >"$OUT/nginx/access.log"
}

# ---- What happens ----

for seed in 1 2; do
	"$BUILD/ecopack" generate park --seed $seed -o "$OUT/park-$seed" --quiet
	"$BUILD/ecopack" make --draft "$OUT/park-$seed/scene.json" -o "$OUT/park-$seed.eco" --quiet
	python3 tests/demo/chunk_ids.py "$OUT/park-$seed.eco" | sort >"$OUT/chunks-$seed"
done
cp "$OUT/park-1.eco" "$OUT/packs/park.eco"
for i in 1 2 3; do start $i; done
start_nginx
echo "nginx on $BASE, servers on $AT_1, $AT_2, $AT_3"

load well 10
judge well none
tell_origins well

# answers that carry all and take seconds on slow lines: some have begun when it happens
lines 8mbit
load killed 10 --cold 12 --vertices 300000 --bandwidth 200000 --name-from 1000000000
sleep 4
lose 1
judge killed may-break
tell_origins killed
[ -z "$apart" ] || ip -n "$NS-1" link set eth0 up
lines
start 1

load drained 12
for i in 2 3; do sleep 3; drain $i; start $i; done
judge drained none
tell_origins drained

# a chunk that only the first pack has, asked through nginx and then left to it
old=$(comm -23 "$OUT/chunks-1" "$OUT/chunks-2" | head -n 1)
curl -fsS -o /dev/null "$BASE/v1/scenes/park/chunks/$old"
load replaced 12
sleep 3
cp "$OUT/park-2.eco" "$OUT/packs/next.tmp"
mv "$OUT/packs/next.tmp" "$OUT/packs/park.eco"
for i in 1 2 3; do eval "kill -HUP \$PID_$i"; sleep 1; done
status() { curl -sS -o /dev/null -w '%{http_code}' $3 "http://$1/v1/scenes/park/chunks/$2"; }
kept=$(status "$AT_1" "$old" "")
judge replaced none
tell_origins replaced
sleep $((KEEP - 5))
gone=$(status "$AT_1" "$old" "") cached=$(status "${BASE#http://}" "$old" "")
echo "a chunk of the pack that was replaced: $kept within $KEEP s, $gone after, $cached from nginx's cache"
[ "$kept $gone $cached" = "200 404 200" ] || failed=1
[ "$(jq .renewed "$OUT/replaced.json")" -gt 0 ] || { echo "no client saw the new pack"; failed=1; }
echo "a line an answer: $OUT/{well,killed,drained,replaced}.csv"
[ $failed = 0 ] && echo "cluster-demo: well" || echo "cluster-demo: not well"
exit $failed
