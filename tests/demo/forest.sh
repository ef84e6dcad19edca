#!/bin/sh
# make forest DATA=DIR: the SCBI forest plot. Every live stem of the 2018 census (CSV, UTM 17N) on the plot's elevation model, with ten
# plant models chosen by species and heights from trunk diameters, trees and shrubs each by their own allometry; one aerial and one eye-level picture at 1,000,000 vertices.
# DATA is the folder with models/, inventories/ and terrain/ (models may be packed as .xz). Everything lands in build/forest/.
set -eu
BUILD=${BUILD:-build}
. "$(dirname "$0")/common.sh"
DATA=${1:?usage: forest.sh DATA}
OUT=$BUILD/forest
STEMS=$DATA/inventories/scbi_stems_2018_utm17n.csv
DEM=$DATA/terrain/scbi_plot_elevation.tif
[ -f "$STEMS" ] || die "$STEMS is not there: DATA must be the folder that holds inventories/, terrain/ and models/"
[ -f "$DEM" ] || die "$DEM is not there"
mkdir -p "$OUT/models"

# a private copy of the models, unpacked
for dir in eztree sapling quaternius sh3d_scopia/bush sh3d_scopia/poplar; do
	mkdir -p "$OUT/models/$dir"
	for f in "$DATA/models/$dir"/*; do
		case $f in
		*.xz) to=$OUT/models/$dir/$(basename "$f" .xz); [ -f "$to" ] || xz -dc "$f" >"$to" ;;
		*) [ -f "$f" ] && cp -f "$f" "$OUT/models/$dir/" ;;
		esac
	done
done

cat >"$OUT/scene.json" <<JSON
{ "name": "scbi", "crs": "EPSG:26917", "origin": [747375, 4308510, 0],
  "ground": {"heights": "$(realpath "$DEM")", "crs": "EPSG:26917"},
  "plants": {
    "oak":         {"model": "models/eztree/eztree_oak_large.glb", "height_m": 24},
    "tulip":       {"model": "models/sapling/sapling_quaking_aspen_s7.obj", "height_m": 28},
    "hickory":     {"model": "models/sh3d_scopia/poplar/poplar.obj", "height_m": 24},
    "ash":         {"model": "models/sapling/sapling_weeping_willow_s3.glb", "height_m": 22},
    "maple":       {"model": "models/quaternius/CommonTree_1.obj", "height_m": 16},
    "pine":        {"model": "models/eztree/eztree_pine_medium.obj", "height_m": 18},
    "hornbeam":    {"model": "models/sapling/sapling_callistemon_s6.obj", "height_m": 8},
    "pawpaw":      {"model": "models/eztree/eztree_bush_1.glb", "height_m": 4},
    "spicebush":   {"model": "models/sh3d_scopia/bush/bush.obj", "height_m": 2.5},
    "undergrowth": {"model": "models/quaternius/Plant_1.obj", "height_m": 1.2} },
  "instances": [
    {"from": "$(realpath "$STEMS")", "x": "utm17n_e", "y": "utm17n_n", "crs": "EPSG:26917", "species": "sp_code", "seed": 1,
     "map": {"quru": "oak", "qual": "oak", "quve": "oak", "qupr": "oak", "quco": "oak", "qufa": "oak", "qumi": "oak", "qusp": "oak",
             "fagr": "oak", "litu": "tulip", "ploc": "tulip", "caco": "hickory", "cagl": "hickory", "caovl": "hickory",
             "cato": "hickory", "casp": "hickory", "cade": "hickory", "juni": "hickory", "juci": "hickory", "fram": "ash",
             "frni": "ash", "frpe": "ash", "frsp": "ash", "rops": "ash", "acru": "maple", "acpl": "maple", "acsp": "maple",
             "acne": "maple", "tiam": "maple", "nysy": "maple", "prav": "maple", "prse": "maple", "ulru": "maple", "ulam": "maple",
             "ulsp": "maple", "pivi": "pine", "pist": "pine", "juvi": "pine", "*": "hornbeam",
             "libe": null, "vipr": null, "viac": null, "astr": null, "havi": null, "rowi": null, "beth": null, "ruph": null, "rual": null},
     "height_m": {"from_dbh_mm": "dbh_mm", "max": 35, "rate": 0.004, "levels": 6}},
    {"from": "$(realpath "$STEMS")", "x": "utm17n_e", "y": "utm17n_n", "crs": "EPSG:26917", "species": "sp_code", "seed": 2,
     "map": {"astr": "pawpaw", "havi": "pawpaw", "libe": "spicebush", "vipr": "spicebush", "viac": "spicebush",
             "rowi": "undergrowth", "beth": "undergrowth", "ruph": "undergrowth", "rual": "undergrowth"},
     "height_m": {"from_dbh_mm": "dbh_mm", "max": 6, "rate": 0.012, "levels": 4}} ] }
JSON

# Height of the ground at a place: mean of the surveyed stems within 10 m (metres from the scene's origin).
ground_at() {
	awk -F, -v x="$1" -v y="$2" 'NR > 1 { dx = $8 - 747375 - x; dy = $9 - 4308510 - y; if (dx * dx + dy * dy < 100) { sum += $10; n++ } }
		END { if (!n) exit 1; printf "%.2f", sum / n }' "$STEMS" || die "no stem within 10 m of $1,$2"
}
# corners and centre post of the plot: scbi_UTM_plot_corners.csv
SOUTH="210.729 3"; CENTER="202.974 320.966"
SOUTH_Z=$(ground_at $SOUTH); CENTER_Z=$(ground_at $CENTER)
x() { echo "${1% *}"; }; y() { echo "${1#* }"; }
plus() { awk -v a="$1" -v b="$2" 'BEGIN { printf "%.2f", a + b }'; }
camera() {  # FILE FOV EYE TARGET
	printf '{"fps": 1, "keyframes": [{"time_s": 0, "eye": [%s], "target": [%s], "up": [0, 0, 1], "fov_y_deg": %s}]}\n' "$3" "$4" "$2" >"$1"
}
AERIAL_EYE="$(x "$SOUTH"), $(y "$SOUTH"), $(plus "$SOUTH_Z" 150)"
camera "$OUT/aerial.json" 45 "$AERIAL_EYE" "$(x "$CENTER"), $(y "$CENTER"), $CENTER_Z"
EYE_Z=$(plus "$CENTER_Z" 1.7)
camera "$OUT/eye.json" 60 "$(x "$CENTER"), $(y "$CENTER"), $EYE_Z" "$(x "$CENTER"), $(plus "$(y "$CENTER")" 50), $EYE_Z"
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
"$BUILD/ecopack" sheet "$OUT/forest.eco" -o "$OUT/sheet.png"
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
		bytes, precision, recall, q, skill, owner_q, predicted_q, plan_ms, stream_ms, decode_ms, draw_ms, reference_ms};
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
