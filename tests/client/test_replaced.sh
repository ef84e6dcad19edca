#!/bin/sh
# A pack is replaced while ecoview streams it: it begins anew with the other one, says so in a line, and draws what it would have drawn of
# that alone. Between the two a proxy replaces the pack before it hands on the request of a frame, so that it is always the same one.
set -u
dir=$(mktemp -d)
trap 'jobs -p >"$dir/jobs"; kill $(cat "$dir/jobs") 2>/dev/null; rm -rf "$dir"' EXIT     # dash knows no jobs in $(...)
fail() { echo "test_replaced: $*"; exit 1; }

for height in 1 2; do
	mkdir "$dir/$height"
	printf 'v -0.5 0 0\nv 0.5 0 0\nv 0 0 %s\nf 1 2 3\n' $height >"$dir/$height/blade.obj"
	echo '{ "plants": {"grass": {"model": "blade.obj"}}, "instances": [{"plant": "grass", "at": [0, 0]}, {"plant": "grass", "at": [1, 0]}] }' \
		>"$dir/$height/scene.json"
	"$BUILD/ecopack" make "$dir/$height/scene.json" -o "$dir/$height.eco" --draft --no-cache -q || fail "no pack"
done
cp "$dir/1.eco" "$dir/served.eco"
echo '{"fps": 1, "keyframes": [{"time_s": 0, "eye": [0, -3, 1], "target": [0, 0, 1], "fov_y_deg": 45},
	{"time_s": 3, "eye": [0.5, -3, 1], "target": [0, 0, 1], "fov_y_deg": 45}]}' >"$dir/camera.json"

cat >"$dir/proxy.py" <<'PYTHON'
import http.server, shutil, sys, os, urllib.request, urllib.error
port, folder, replaces = int(sys.argv[1]), sys.argv[2], int(sys.argv[3])
class Proxy(http.server.BaseHTTPRequestHandler):
    streams = 0
    def ask(self, path, body, headers={}):
        try:
            return urllib.request.urlopen(urllib.request.Request(f"http://127.0.0.1:{port}{path}", body, headers))
        except urllib.error.HTTPError as problem:
            return problem
    def do_POST(self):
        Proxy.streams += 1
        if Proxy.streams == replaces:
            shutil.copy(f"{folder}/2.eco", f"{folder}/new")
            os.rename(f"{folder}/new", f"{folder}/served.eco")
            assert self.ask("/v1/admin/reload", b"").status == 200
        body = self.rfile.read(int(self.headers["Content-Length"]))
        self.hand_on(self.ask(self.path, body, {"Content-Type": self.headers["Content-Type"]}))
    def do_GET(self):
        self.hand_on(self.ask(self.path, None))
    def hand_on(self, answer):
        text = answer.read()
        self.send_response(answer.status)
        self.send_header("Content-Type", answer.headers["Content-Type"] or "")
        self.send_header("Content-Length", str(len(text)))
        self.end_headers()
        self.wfile.write(text)
    def log_message(self, *_): pass
server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Proxy)
print(server.server_port, flush=True)
server.serve_forever()
PYTHON

# begin COMMAND... : runs it; its first line goes to $dir/said
begin() {
	rm -f "$dir/said"
	mkfifo "$dir/said"
	"$@" >"$dir/said" &
	read -r said <"$dir/said"
}

# view URL OUT : four frames, each with its reference
view() {
	"$BUILD/ecoview" "$1" --camera "$dir/camera.json" --size 64x64 --vertices 100 --reference=cpu -o "$2" >"$2.out" 2>"$2.err"
}

begin "$BUILD/ecoserve" --listen 127.0.0.1:0 "scene=$dir/served.eco"
port=$(echo "$said" | sed -n 's/.*ready on http:.*:\([0-9]*\) .*/\1/p')
[ -n "$port" ] || fail "ecoserve did not start: $said"
# frames ask twice: before the request for the second frame; and before that for its reference
for at in 3 4; do
	cp "$dir/1.eco" "$dir/served.eco"
	curl -fsS -X POST "http://127.0.0.1:$port/v1/admin/reload" >/dev/null || fail "no reload"
	begin python3 "$dir/proxy.py" "$port" "$dir" "$at"
	view "http://127.0.0.1:$said/v1/scenes/scene" "$dir/over$at" || fail "request $at: $(cat "$dir/over$at.err")"
	grep -q 'frame 1: the server has another pack of the scene now: the client starts again with it' "$dir/over$at.err" || fail "request $at: not said"
	[ "$(grep -c 'starts again with it' "$dir/over$at.err")" -eq 1 ] || fail "request $at: said again: $(cat "$dir/over$at.err")"
	[ "$(jq '.frames | length' "$dir/over$at/report.json")" -eq 4 ] || fail "request $at: not four frames"
	jq -e 'all(.frames[]; .q == 1)' "$dir/over$at/report.json" >/dev/null || fail "request $at: pictures of two packs are mixed"
done
view "http://127.0.0.1:$port/v1/scenes/scene" "$dir/alone" || fail "$(cat "$dir/alone.err")"
for at in 3 4; do
	cmp -s "$dir/over$at/frame-0000.png" "$dir/alone/frame-0000.png" && fail "request $at: the first frame is of the other pack"
	for frame in 0001 0002 0003; do
		cmp "$dir/over$at/frame-$frame.png" "$dir/alone/frame-$frame.png" || fail "request $at: frame $frame"
	done
done
echo "ok: a pack is replaced between and within frames"
