#!/bin/sh
# hierarchy.sh BUILD PACK VIEWS HALF_M OUT: serves a pack, asks for streams of so many random views from a walker's eyes to orbit, and writes to OUT
# the server's resident megabytes at the end, the most of them ever, and how many answers were not streams.
set -eu
build=$1 pack=$2 views=$3 half=$4 out=$5
log=$out.log
"$build/ecoserve" -l 127.0.0.1:0 "scene=$pack" >"$log" 2>&1 &
server=$!
trap 'kill $server 2>/dev/null; rm -f "$log"' EXIT INT TERM
until grep -q ready "$log"; do kill -0 $server; sleep 0.1; done
url=$(sed -n 's/.* \(http[^ ]*\) .*/\1/p' "$log")/v1/scenes/scene/stream
awk -v n="$views" -v half="$half" -v url="$url" 'BEGIN {
	srand(5)
	for (i = 0; i < n; i++) {
		h = 1.7 * exp(log(3 * half / 1.7) * rand()); a = 6.28318 * rand(); x = (1.8 * rand() - 0.9) * half; y = (1.8 * rand() - 0.9) * half
		slope = 0.05 + 1.2 * rand(); d = h > 5 ? h / slope : 50
		printf "url=\"%s?eye=%.2f,%.2f,%.2f&target=%.2f,%.2f,%.2f&fov_y_deg=50&width=800&height=600&vertices=%d\"\noutput=/dev/null\nwrite-out=\"%%{http_code}\\n\"\n",
			url, x, y, h, x + d * cos(a), y + d * sin(a), (h > 5 ? 0 : 3), 30000 + int(270000 * rand())
	}
}' | curl -s -K - >"$out.codes" || true
bad=$(grep -vc '^20[04]$' "$out.codes" || true)
awk -v bad="$bad" -v got="$(wc -l <"$out.codes")" '/VmRSS/ { now = $2 / 1024 } /VmHWM/ { most = $2 / 1024 } END { printf "%.1f %.1f %d %d\n", now, most, bad, got }' \
	/proc/$server/status >"$out"
rm -f "$out.codes"
