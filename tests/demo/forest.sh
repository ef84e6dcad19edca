#!/bin/sh
# make forest DATA=DIR: the SCBI forest plot. Every live stem of the 2018 census (CSV, UTM 17N) on the plot's elevation model, with ten
# plant models chosen by species and heights from trunk diameters, trees and shrubs each by their own allometry; one aerial and one eye-level picture at 1,000,000 vertices.
# DATA is the folder with models/, inventories/ and terrain/ (models may be packed as .xz). Everything lands in build/forest/.
set -eu
BUILD=${BUILD:-build}
. "$(dirname "$0")/common.sh"
DATA=${1:?usage: forest.sh DATA}
OUT=$BUILD/forest
. "$(dirname "$0")/forest_scene.sh"

# the aerial view, then a step of one metre, then back: what is held is not sent again
cat >"$OUT/step.json" <<JSON
{"fps": 1, "keyframes": [
  {"time_s": 0, "eye": [$AERIAL_EYE], "target": [$(x "$CENTER"), $(y "$CENTER"), $CENTER_Z], "up": [0, 0, 1], "fov_y_deg": 45},
  {"time_s": 1, "eye": [$(plus "$(x "$SOUTH")" 1), $(y "$SOUTH"), $(plus "$SOUTH_Z" 150)], "target": [$(plus "$(x "$CENTER")" 1), $(y "$CENTER"), $CENTER_Z], "up": [0, 0, 1], "fov_y_deg": 45},
  {"time_s": 2, "eye": [$AERIAL_EYE], "target": [$(x "$CENTER"), $(y "$CENTER"), $CENTER_Z], "up": [0, 0, 1], "fov_y_deg": 45} ]}
JSON

[ -n "${KEEP_PACK:-}" ] && [ -f "$OUT/forest.eco" ] || "$BUILD/ecopack" make "$OUT/scene.json" -o "$OUT/forest.eco"
"$BUILD/ecopack" verify "$OUT/forest.eco"
"$BUILD/ecopack" map "$OUT/scene.json" -o "$OUT/map.png"
serve "$OUT/serve.log" "scbi=$OUT/forest.eco"
URL=$BASE/v1/scenes/scbi
for view in aerial eye; do
	rm -rf "$OUT/$view"
	"$BUILD/ecoview" "$URL" --camera "$OUT/$view.json" --size 800x600 --vertices 1000000 --reference -o "$OUT/$view"
done
rm -rf "$OUT/step"
"$BUILD/ecoview" "$URL" --camera "$OUT/step.json" --size 800x600 --vertices 1000000 -o "$OUT/step"
QUERY="eye=$(echo "$AERIAL_EYE" | tr -d ' ')&target=$(x "$CENTER"),$(y "$CENTER"),$CENTER_Z&fov_y_deg=45&width=800&height=600&vertices=1000000"
curl -fsS "$URL/plan?$QUERY" >"$OUT/aerial-plan.json"
stop_serving

jq -n --slurpfile aerial "$OUT/aerial/report.json" --slurpfile eye "$OUT/eye/report.json" --slurpfile step "$OUT/step/report.json" \
	--slurpfile plan "$OUT/aerial-plan.json" '
	def of: .[0].frames[0] | {budget_vertices, vertices, used: (.vertices / .budget_vertices), violation: (.vertices > .budget_vertices),
		bytes, precision, recall, q, skill, owner_q, soft_q, ceiling, picture_error, predicted_q, plan_ms, stream_ms, decode_ms, draw_ms, reference_ms};
	{aerial: ($aerial | of), eye: ($eye | of),
	 step_of_1_m: ($step[0].frames | {first_bytes: .[0].bytes, step_bytes: .[1].bytes, back_bytes: .[2].bytes, share: (.[1].bytes / .[0].bytes)}),
	 visible_plants: $plan[0].visible_plants, plan_bytes: $plan[0].plan_bytes,
	 plan_bytes_allowed: (2048 + 0.5 * $plan[0].visible_plants)}' >"$OUT/summary.json"
page "$OUT/index.html" "ecostream: the SCBI forest plot" \
	"51,253 stems of the 2018 census (SCBI-ForestGEO, CC-BY 4.0) on their elevation model, 1,000,000 vertices a picture." \
	"$OUT/summary.json" "$OUT/aerial" "$OUT/eye"
frame_lines "$OUT/aerial"
frame_lines "$OUT/eye"
jq . "$OUT/summary.json"
echo "pictures: $OUT/index.html   figures: $OUT/summary.json"
