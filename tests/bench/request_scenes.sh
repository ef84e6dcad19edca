#!/bin/sh
# Five scenes for random requests: request_scenes.sh FOLDER makes FOLDER/park.eco, forest.eco, nested.eco, meadow.eco and tree.eco (those
# that are younger than ecopack stay). A park; a forest on hills; eco files in eco files, turned and scaled; a meadow of many small tiles; one tree that is
# four trees in one. BUILD is the folder of the programs. ORDER: the order of leaves,
# DETAIL: how many leaves, CACHE: the folder of finished plants, if not the default, DRAFT: names of those that are drafts.
set -eu
BUILD=${BUILD:-build}
OUT=${1:?usage: request_scenes.sh FOLDER}
mkdir -p "$OUT"
PACK=$BUILD/ecopack

# make NAME SCENE.json
make_pack() {
	case " ${DRAFT:-} " in *" $1 "*) how=--draft ;; *) how=${ORDER:+--order=$ORDER} ;; esac
	[ "$OUT/$1.eco" -nt "$PACK" ] || "$PACK" make "$2" -o "$OUT/$1.eco" --quiet ${how:+"$how"} ${CACHE:+--cache "$CACHE"}
}

[ -f "$OUT/park/scene.json" ] || "$PACK" generate park -o "$OUT/park" --quiet ${DETAIL:+--detail "$DETAIL"}
make_pack park "$OUT/park/scene.json"
[ -f "$OUT/forest/scene.json" ] || "$PACK" generate forest -o "$OUT/forest" --plants 500 --quiet ${DETAIL:+--detail "$DETAIL"}
make_pack forest "$OUT/forest/scene.json"

# models of the park: heights are said, so that nothing is guessed
plants() { printf '"%s": {"model": "park/models/%s.obj", "height_m": %s}' "$1" "$1" "$2"; }

cat >"$OUT/group.json" <<JSON
{ "name": "group", "plants": {$(plants birch 12), $(plants shrub 2.3), $(plants daisy 0.5)},
  "instances": [{"plant": "birch", "at": [0, 0, 0]}, {"plant": "birch", "at": [4, 3, 0], "yaw_deg": 70, "scale": 0.7},
    {"plant": "shrub", "at": [-3, 2, 0]}, {"plant": "shrub", "at": [2, -4, 0], "yaw_deg": 200},
    {"plant": "daisy", "at": [1, 1, 0]}, {"plant": "daisy", "at": [1.4, 0.8, 0], "scale": 1.2}, {"plant": "daisy", "at": [-1, -2, 0]}] }
JSON
# nest NAME CHILD COUNT STEP : COUNT children on a spiral
nest() {
	printf '{ "name": "%s", "plants": {%s}, "instances": [{"plant": "spruce", "at": [0, 0, 0]}], "children": [' "$1" "$(plants spruce 16)"
	awk -v child="$2" -v count="$3" -v step="$4" 'BEGIN { for (i = 1; i <= count; i++) { a = 2.399963 * i; r = step * sqrt(i)
		printf "%s\n  {\"eco\": \"%s.json\", \"at\": [%.3f, %.3f, 0], \"yaw_deg\": %d, \"scale\": %.2f}", (i > 1 ? "," : ""), child, r * cos(a), r * sin(a), i * 37 % 360, 0.6 + i % 5 / 5 } }'
	printf '] }\n'
}
nest grove group 9 8 >"$OUT/grove.json"
nest nested grove 14 34 >"$OUT/nested.json"
make_pack nested "$OUT/nested.json"

awk 'BEGIN { print "x,y,kind"; for (i = 0; i < 9000; i++) { a = 2.399963 * i; r = 0.9 * sqrt(i)
	printf "%.3f,%.3f,%s\n", r * cos(a), r * sin(a), i % 7 == 0 ? "poppy" : i % 11 == 0 ? "daisy" : i % 997 == 0 ? "shrub" : i % 2 ? "turf" : "grass" } }' >"$OUT/meadow.csv"
cat >"$OUT/meadow.json" <<JSON
{ "name": "meadow", "tile": {"instances": 32}, "plants": {$(plants grass 0.6), $(plants turf 0.3), $(plants poppy 0.6), $(plants daisy 0.5), $(plants shrub 2.3)},
  "instances": [{"from": "meadow.csv", "x": "x", "y": "y", "species": "kind", "seed": 3,
    "map": {"grass": "grass", "turf": "turf", "poppy": "poppy", "daisy": "daisy", "shrub": "shrub"}}] }
JSON
make_pack meadow "$OUT/meadow.json"

cat >"$OUT/tree.json" <<JSON
{ "name": "tree", "plants": {"tree": {"model": ["park/models/oak.obj", "park/models/linden.obj", "park/models/birch.obj", "park/models/spruce.obj"],
  "height_m": 20}}, "instances": [{"plant": "tree", "at": [0, 0, 0]}] }
JSON
make_pack tree "$OUT/tree.json"
