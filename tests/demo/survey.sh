#!/bin/sh
# make survey DATA=DIR: what import makes of a whole folder. Every model under DATA/models is read, or refused by name; those that are read
# are packed. Then the street trees of a city (Binghamton, NY: CSV in degrees and in feet, height classes, vacant sites and stumps) become a
# map and a pack. Everything lands in build/survey/.
set -eu
BUILD=${BUILD:-build}
. "$(dirname "$0")/common.sh"
DATA=${1:?usage: survey.sh DATA}
OUT=$BUILD/survey
[ -d "$DATA/models" ] || die "$DATA/models is not there: DATA must be the folder that holds models/ and inventories/"
rm -rf "$OUT"
mkdir -p "$OUT"

# ---- Models ----
cp -R "$DATA/models" "$OUT/models"
chmod -R u+w "$OUT/models"
find "$OUT/models" -name '*.xz' -exec xz -d {} +
find "$OUT/models" -type f | grep -iE '\.(glb|gltf|obj|fbx|dae|ply|stl|3ds)$' | LC_ALL=C sort >"$OUT/models.txt"
refused=0
: >"$OUT/read.txt"
while read -r model; do
	if "$BUILD/ecopack" model --json "$model" >"$OUT/model.json" 2>"$OUT/model.log"; then
		printf '%s\n' "${model#"$OUT"/}" >>"$OUT/read.txt"
		jq -r --arg name "${model#"$OUT"/models/}" '[$name, .height_m, .triangles_in, .triangles_kept, .organs_m2.wood, .organs_m2.foliage, .organs_m2.flower]
			| map(tostring) | join("\t")' "$OUT/model.json" >>"$OUT/models.tsv"
	else
		refused=$((refused + 1))
		sed "s|^|refused: |" "$OUT/model.log"
	fi
done <"$OUT/models.txt"
jq -Rn '{name: "models", plants: ([inputs | {key: (sub("^models/"; "") | .[-63:]), value: {model: .}}] | from_entries)}
	| .instances = [.plants | keys[] as $k | {plant: $k, at: [0, 0]}] | .instances |= [to_entries[] | .value.at = [(.key * 40), 0] | .value]' \
	"$OUT/read.txt" >"$OUT/models-scene.json"
"$BUILD/ecopack" make "$OUT/models-scene.json" -o "$OUT/models.eco" --times 2>"$OUT/models.log" >"$OUT/models-info.txt" || { cat "$OUT/models.log"; exit 1; }
echo "$(wc -l <"$OUT/read.txt") models read, $refused refused: $OUT/models.tsv, $OUT/models-info.txt"

# ---- A city ----
TREES=$DATA/inventories/binghamton_ny_street_trees.csv
if [ -f "$TREES" ]; then
	mkdir -p "$OUT/city"
	"$BUILD/ecopack" generate forest -o "$OUT/city/forest" --plants 50 --quiet
	cat >"$OUT/city/scene.json" <<JSON
{ "name": "binghamton", "crs": "EPSG:32618", "origin": [425000, 4661500],
  "plants": {
    "broadleaf": {"variants": ["forest/models/beech.obj", "forest/models/maple.obj"], "height_m": 12},
    "small":     {"model": "forest/models/birch.obj", "height_m": 6},
    "conifer":   {"variants": ["forest/models/spruce.obj", "forest/models/pine.obj"], "height_m": 14},
    "shrub":     {"model": "forest/models/shrub.obj", "height_m": 3} },
  "instances": [
    {"from": "$(realpath "$TREES")", "x": "Longitude", "y": "Latitude", "crs": "EPSG:4326", "species": "Species", "seed": 1,
     "map": {"vacant site*": null, "stump*": null,
             "pine*": "conifer", "spruce*": "conifer", "hemlock*": "conifer", "arborvitae*": "conifer", "fir*": "conifer", "*cedar*": "conifer",
             "lilac*": "shrub", "serviceberry*": "shrub", "shrub*": "shrub",
             "crabapple*": "small", "cherry*": "small", "pear*": "small", "hawthorn*": "small", "dogwood*": "small", "redbud*": "small",
             "*": "broadleaf"},
     "height_m": [{"column": "Height", "unit": "ft"}, {"from_dbh_in": "Diameter", "max": 25, "rate": 0.003}], "levels": 8} ] }
JSON
	"$BUILD/ecopack" map "$OUT/city/scene.json" -o "$OUT/city/map.png"
	"$BUILD/ecopack" make "$OUT/city/scene.json" -o "$OUT/city/binghamton.eco"
	# the same trees by their other coordinates, feet of the state plane
	sed 's/"Longitude"/"X"/; s/"Latitude"/"Y"/; s/"EPSG:4326"/"EPSG:2261"/' "$OUT/city/scene.json" >"$OUT/city/feet.json"
	"$BUILD/ecopack" map "$OUT/city/feet.json" -o "$OUT/city/map-feet.png"
	echo "maps: $OUT/city/map.png, $OUT/city/map-feet.png"
fi
