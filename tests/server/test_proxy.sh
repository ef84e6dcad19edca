#!/bin/sh
# TLS by the proxies of server/proxy_*: as they stand there, but for ports, certificate and names of files. What comes through is what
# ecoserve sends; what is the operator's does not; nobody gives himself another address. The viewer's page finds its files and the scenes where
# nginx has the server below a path. Status 77 where neither proxy is installed.
set -u
BUILD=${BUILD:-build}
DIR=$(mktemp -d)
failed=0
tried=0
server= proxy=
trap 'kill $server $proxy 2>/dev/null; rm -rf "$DIR"' EXIT
complain() { echo "test_proxy: $*"; failed=1; }
. tests/support/nginx.sh

for program in openssl curl; do command -v $program >/dev/null || exit 77; done
printf 'v -0.05 0 0\nv 0.05 0 0\nv 0 0 1\nf 1 2 3\n' >"$DIR/blade.obj"
echo '{ "plants": {"grass": {"model": "blade.obj"}}, "instances": [{"plant": "grass", "at": [0, 0]}] }' >"$DIR/scene.json"
"$BUILD/ecopack" make "$DIR/scene.json" -o "$DIR/blade.eco" --draft --no-cache -q || exit 1
openssl req -x509 -newkey ec -pkeyopt ec_paramgen_curve:prime256v1 -nodes -subj /CN=scenes.example -addext subjectAltName=DNS:scenes.example \
	-days 2 -keyout "$DIR/scenes.key" -out "$DIR/scenes.crt" 2>/dev/null || exit 77
cat "$DIR/scenes.crt" "$DIR/scenes.key" >"$DIR/scenes.pem"

# the viewer as it is in the sources, of which the files that are compiled are none
mkdir "$DIR/site"
cp client-min/web/index.html client-min/web/*.mjs client-min/web/*.js client-min/web/*.css client-min/web/*.svg "$DIR/site"
for file in eco_client.mjs eco_client.wasm; do echo 'stands for what is compiled' >"$DIR/site/$file"; done
gzip -k "$DIR"/site/*
for file in "$DIR"/site/*.gz; do cp "$file" "${file%.gz}.br"; done
echo 0123abcd >"$DIR/site/version"

"$BUILD/ecoserve" --listen 127.0.0.1:0 --viewer "$DIR/site" --trust-proxy 127.0.0.1 --log text "blade=$DIR/blade.eco" >"$DIR/ready" 2>"$DIR/log" &
server=$!
for _ in $(seq 100); do
	port=$(sed -n 's/.*ready on http:.*:\([0-9]*\) .*/\1/p' "$DIR/ready")
	[ -n "$port" ] && break
	sleep 0.1
done

# get PATH [OPTION...] : the body to $DIR/body; prints the status and the version of HTTP
get() {
	path=$1; shift
	curl -s -o "$DIR/body" -w '%{http_code} %{http_version}' --cacert "$DIR/scenes.crt" --resolve "scenes.example:$tls:127.0.0.1" \
		"$@" "https://scenes.example:$tls$path"
}

# goes_through NAME : the proxy that has been started at $tls
goes_through() {
	for _ in $(seq 50); do
		[ "$(get /readyz)" = "200 2" ] && break
		sleep 0.1
	done
	stream='/v1/scenes/blade/stream?eye=0,-3,1&target=0,0,1&width=64&height=64&vertices=1000'
	curl -s -o "$DIR/direct" "http://127.0.0.1:$port$stream"
	[ "$(get "$stream")" = "200 2" ] || complain "$1: a stream by HTTP/2: $(get "$stream")"
	cmp -s "$DIR/direct" "$DIR/body" || complain "$1: a stream is another one"
	[ "$(get "$stream" --http1.1)" = "200 1.1" ] || complain "$1: a stream by HTTP/1.1: $(get "$stream" --http1.1)"
	printf '\000\000\000\000' >"$DIR/nothing"
	[ "$(get "$stream" --data-binary "@$DIR/nothing" -H 'Content-Type: application/octet-stream')" = "200 2" ] ||
		complain "$1: a POST is not answered"
	cmp -s "$DIR/direct" "$DIR/body" || complain "$1: a POST's stream is another one"
	[ "$(get "/v1/scenes/blade/plan?eye=0")" = "400 2" ] || complain "$1: a bad request is no 400"
	for path in /metrics /v1/admin/reload /v1/admin; do
		[ "$(get $path)" = "403 2" ] || complain "$1: $path passes: $(get $path)"
	done
	get "/v1/scenes?from=$1" -H 'X-Forwarded-For: 192.0.2.7' >"$DIR/status"
	grep -q "^127.0.0.1 GET /v1/scenes?from=$1 " "$DIR/log" || complain "$1: a client is taken for $(grep "from=$1" "$DIR/log")"
	tried=$((tried + 1))
}

# below_a_path : the viewer by the proxy that has the server at /trees/ of $plain
below_a_path() {
	page=http://127.0.0.1:$plain/trees/
	[ "$(curl -s -o "$DIR/page" -w '%{http_code}' "$page?fbclid=x&utm_source=a")" = 200 ] || complain "below a path: no page at $page?fbclid=x"
	addresses=$(grep -oE '(src|href)="[^"]*"' "$DIR/page" | cut -d '"' -f 2)
	[ "$(echo "$addresses" | wc -l)" -ge 12 ] || complain "below a path: the page names only $addresses"
	for address in $addresses v1/scenes v1/scenes/blade; do
		case $address in /*) found=${page%/trees/}$address ;; *) found=$page$address ;; esac
		status=$(curl -sL -o /dev/null -w '%{http_code}' "$found")
		[ "$status" = 200 ] || complain "below a path: $address is answered $status"
	done
	! grep -nE "^[^/]*['\"\`]/(v1|viewer)\b" client-min/web/*.mjs client-min/web/*.js || complain "below a path: these addresses are of the host's root"
	[ "$(curl -s -o /dev/null -w '%{http_code} %{redirect_url}' "${page}viewer/eco_layer.mjs")" = "307 ${page}viewer/0123abcd/eco_layer.mjs" ] ||
		complain "below a path: a module leads elsewhere"
	tried=$((tried + 1))
}

adapt() { # FILE : as it stands, but for what the machine has
	sed "s|127.0.0.1:8080|127.0.0.1:$port|; s|/etc/ssl/scenes.example.key|$DIR/scenes.key|; s|/etc/ssl/scenes.example.pem|$DIR/scenes.pem|
		s|listen 443|listen 127.0.0.1:$tls|; s|bind :443|bind 127.0.0.1:$tls|" "$1"
}

if command -v nginx >/dev/null; then
	tls=$(free_port)
	plain=$(free_port)
	adapt server/proxy_nginx.conf >"$DIR/ecoserve.conf"
	nginx_start "$DIR" "include $DIR/ecoserve.conf;
		server { listen 127.0.0.1:$plain; location /trees/ { proxy_pass http://127.0.0.1:$port/; proxy_set_header Host \$host; } }"
	goes_through nginx
	below_a_path
	kill $proxy; wait $proxy
fi
if command -v haproxy >/dev/null; then
	tls=$(free_port)
	adapt server/proxy_haproxy.cfg >"$DIR/haproxy.cfg"
	haproxy -db -f "$DIR/haproxy.cfg" >"$DIR/haproxy.log" 2>&1 &
	proxy=$!
	goes_through haproxy
	kill $proxy; wait $proxy 2>/dev/null
fi
[ $failed -eq 0 ] || { tail -n 5 "$DIR"/*.log; exit 1; }
[ $tried -gt 0 ] || exit 77
