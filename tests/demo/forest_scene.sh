#!/bin/sh
# The SCBI forest plot as a scene: OUT/scene.json with a private copy of its models, and camera scripts: aerial.json and eye.json (one view
# each) and camera.json, a flight that begins with the one and ends with the other. DATA is the folder with models/, inventories/ and terrain/
# (models may be packed as .xz). Run with OUT and DATA set, or read by forest.sh.
set -eu
command -v die >/dev/null || die() { echo "$0: $*" >&2; exit 1; }
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

# over the plot, down, and 60 m of its middle on foot, northwards
walk() {
	n=0
	while [ "$n" -le 12 ]; do
		y=$(awk -v y="$(y "$CENTER")" -v n="$n" 'BEGIN { printf "%.3f", y + 5 * (n - 12) }')
		z=$(plus "$(ground_at "$(x "$CENTER")" "$y")" 1.7)
		printf ',\n  {"time_s": %d, "eye": [%s, %s, %s], "target": [%s, %s, %s], "up": [0, 0, 1], "fov_y_deg": 60}' $((12 + n)) "$(x "$CENTER")" "$y" "$z" \
			"$(x "$CENTER")" "$(plus "$y" 50)" "$z"
		n=$((n + 1))
	done
}
key() { printf '  {"time_s": %s, "eye": [%s], "target": [%s], "up": [0, 0, 1], "fov_y_deg": %s}' "$1" "$2" "$3" "$4"; }
TARGET="$(x "$CENTER"), $(y "$CENTER"), $CENTER_Z"
{
	printf '{"fps": 1, "keyframes": [\n'
	key 0 "$AERIAL_EYE" "$TARGET" 45
	printf ',\n'
	key 4 "$(plus "$(x "$CENTER")" 260), $(plus "$(y "$CENTER")" -120), $(plus "$CENTER_Z" 130)" "$TARGET" 45
	printf ',\n'
	key 8 "$(plus "$(x "$CENTER")" 90), $(plus "$(y "$CENTER")" -210), $(plus "$CENTER_Z" 75)" "$TARGET" 50
	walk
	printf '\n]}\n'
} >"$OUT/camera.json"
