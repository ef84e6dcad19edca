#!/bin/sh
# make demo: plants and positions -> pack -> server -> streamed pictures with Precision and Recall. Everything lands in build/demo/.
set -eu
BUILD=${BUILD:-build}
. "$(dirname "$0")/common.sh"
OUT=$BUILD/demo
rm -rf "$OUT"; mkdir -p "$OUT"

"$BUILD/ecopack" generate park -o "$OUT/park"
"$BUILD/ecopack" make "$OUT/park/scene.json" -o "$OUT/park.eco"
"$BUILD/ecopack" verify "$OUT/park.eco"
serve "$OUT/serve.log" "park=$OUT/park.eco"
URL=$BASE/v1/scenes/park

"$BUILD/ecoview" "$URL" --camera "$OUT/park/camera.json" --size 800x600 --vertices 300000 --reference -o "$OUT/frames-300k"
"$BUILD/ecoview" "$URL" --camera "$OUT/park/camera.json" --size 800x600 --vertices 30000 --reference -o "$OUT/frames-30k"
"$BUILD/ecoload" "$URL" --camera "$OUT/park/camera.json" --clients 4 --seconds 5 --vertices 100000 --json >"$OUT/load.json"
stop_serving

jq -n --slurpfile a "$OUT/frames-300k/report.json" --slurpfile b "$OUT/frames-30k/report.json" --slurpfile load "$OUT/load.json" '
	def mean(f): map(f | select(. != null)) | if length == 0 then null else add / length end;
	def of: .[0].frames | {frames: length, q_mean: mean(.q), q_min: (map(.q) | min), skill_mean: mean(.skill), owner_q_mean: mean(.owner_q),
		violations: (map(select(.vertices > .budget_vertices)) | length)};
	{budget_300k: ($a | of), budget_30k: ($b | of), load: $load[0]}' >"$OUT/summary.json"
page "$OUT/index.html" "ecostream: a park, streamed" \
	"About sixty plants of six kinds, streamed at 300,000 and at 30,000 vertices a picture." "$OUT/summary.json" "$OUT/frames-300k" "$OUT/frames-30k"
echo
frame_lines "$OUT/frames-300k"
frame_lines "$OUT/frames-30k"
echo "pictures: $OUT/index.html   figures: $OUT/summary.json"
