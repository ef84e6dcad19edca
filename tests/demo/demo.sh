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
"$BUILD/ecopack" map "$OUT/park/scene.json" -o "$OUT/map.png" --size 800

# the same park from a table of its plants and models of three: the library grows what these do not show
"$BUILD/ecopack" map "$OUT/park/scene.json" -o "$OUT/plants.geojson" --quiet
mkdir "$OUT/given"
cp "$OUT"/park/models/oak.* "$OUT"/park/models/linden.* "$OUT"/park/models/birch.* "$OUT"/park/models/*.png "$OUT/given"
"$BUILD/ecopack" start "$OUT/plants.geojson" "$OUT/given" "$OUT/park/dem.tif" -o "$OUT/table"
jq --slurpfile park "$OUT/park/scene.json" '.origin = $park[0].origin' "$OUT/table/scene.json" >"$OUT/table/placed.json"
"$BUILD/ecopack" make --draft --season spring "$OUT/table/placed.json" -o "$OUT/table.eco"
serve "$OUT/serve.log" "park=$OUT/park.eco" "table=$OUT/table.eco"
jq '.keyframes |= .[:1]' "$OUT/park/camera.json" >"$OUT/table/first.json"
"$BUILD/ecoview" "$BASE/v1/scenes/table" --camera "$OUT/table/first.json" --size 800x600 --vertices 300000 -o "$OUT/frames-table"
URL=$BASE/v1/scenes/park

# every third frame of the camera: the truth of a view takes some 15 s of processor time, and serves both budgets
jq '.fps /= 3' "$OUT/park/camera.json" >"$OUT/camera.json"
for budget in 300 30; do
	"$BUILD/ecoview" "$URL" --camera "$OUT/camera.json" --size 800x600 --vertices ${budget}000 --reference --truths "$OUT/truths" \
		-o "$OUT/frames-${budget}k"
done
"$BUILD/ecoload" "$URL" --camera "$OUT/park/camera.json" --clients 4 --seconds 5 --vertices 100000 --json >"$OUT/load.json"

# a recorded flight about the park's middle: its SRT becomes a camera script, which both clients fly
sh "$(dirname "$0")/record_flight.sh" 11.567053 48.130570 42 12 >"$OUT/flight.srt"
"$BUILD/ecopack" camera "$OUT/flight.srt" --scene "$OUT/park/scene.json" --height rel --fps 0.25 -o "$OUT/flight.json"
"$BUILD/ecoview" "$URL" --camera "$OUT/flight.json" --size 480x320 --vertices 100000 -o "$OUT/frames-flight"
"$BUILD/ecoload" "$URL" --camera "$OUT/flight.json" --clients 2 --seconds 1 --vertices 100000 --json >"$OUT/load-flight.json"
stop_serving

# one oak from close by, coloured by representation: polygons green, lines red, points blue, blends yellow and orange
mkdir -p "$OUT/near"
jq -n --arg model "$(realpath "$OUT/park/models/oak.obj")" '{name: "oak", plants: {oak: {model: $model, height_m: 14.6}},
	instances: [{plant: "oak", at: [0, 0, 0]}]}' >"$OUT/near/scene.json"
echo '{"fps": 1, "keyframes": [{"time_s": 0, "eye": [7, -2, 4], "target": [0, 0, 9], "up": [0, 0, 1], "fov_y_deg": 80}]}' >"$OUT/near/camera.json"
"$BUILD/ecopack" make "$OUT/near/scene.json" -o "$OUT/near/oak.eco" >"$OUT/near/make.log"
serve "$OUT/near/serve.log" "oak=$OUT/near/oak.eco"
"$BUILD/ecoview" "$BASE/v1/scenes/oak" --camera "$OUT/near/camera.json" --size 800x600 --vertices 40000 --tint=kind -o "$OUT/near/kinds"
"$BUILD/ecoview" "$BASE/v1/scenes/oak" --camera "$OUT/near/camera.json" --size 640x480 --vertices 40000 --reference -o "$OUT/near-oak"
curl -fsS "$BASE/v1/scenes/oak/plan?eye=7,-2,4&target=0,0,9&fov_y_deg=80&width=800&height=600&vertices=40000" >"$OUT/near/plan.json"
stop_serving
cp "$OUT/near/kinds/frame-0000.png" "$OUT/near-kinds.png"

jq -n --slurpfile a "$OUT/frames-300k/report.json" --slurpfile b "$OUT/frames-30k/report.json" --slurpfile load "$OUT/load.json" \
	--slurpfile near "$OUT/near-oak/report.json" --slurpfile plan "$OUT/near/plan.json" '
	def mean(f): map(f | select(. != null)) | if length == 0 then null else add / length end;
	def of: .[0].frames | {frames: length, q_mean: mean(.q), q_min: (map(.q) | min), skill_mean: mean(.skill), owner_q_mean: mean(.owner_q),
		violations: (map(select(.vertices > .budget_vertices)) | length)};
	{budget_300k: ($a | of), budget_30k: ($b | of), load: $load[0],
	 near_oak: ($near[0].frames[0] | {budget_vertices, vertices, q, cuts: ($plan[0].cuts | {triangles: map(select(.kind == "triangles")) | length,
		lines: map(select(.kind == "lines")) | length, points: map(select(.kind == "points")) | length,
		blends: map(select(.kind == "points" and .first > 0)) | length})})}' >"$OUT/summary.json"
page "$OUT/index.html" "ecostream: a park, streamed" \
	"Sixty plants of twelve kinds, streamed at 300,000 and at 30,000 vertices a picture." "$OUT/summary.json" "$OUT/frames-300k" "$OUT/frames-30k" "$OUT/near-oak" "$OUT/frames-flight"
sed -i 's|<h2>Figures|<h2>The park from a table</h2><p>Left: all models given. Right: models of oaks, lindens and birches; the rest is grown by the library.</p><div class="row"><img src="frames-300k/frame-0000.png" alt="models"><img src="frames-table/frame-0000.png" alt="library"></div><h2>Figures|' "$OUT/index.html"
sed -i 's|<h2>Figures|<h2>One oak from close by</h2><p>40,000 vertices: polygons green, lines red, points blue, blends of points and polygons yellow and orange.</p><img style="max-width:800px" src="near-kinds.png" alt="kinds"><h2>Figures|' "$OUT/index.html"
echo
frame_lines "$OUT/frames-300k"
frame_lines "$OUT/frames-30k"
frame_lines "$OUT/near-oak"
echo "pictures: $OUT/index.html   figures: $OUT/summary.json"
