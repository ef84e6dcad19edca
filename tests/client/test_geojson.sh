#!/bin/sh
# The plants of a view, from an inventory to a GIS: those that the eye sees, each with its own species, though all share a model, and with the
# row that it comes from, where the row says.
set -u
dir=$(mktemp -d)
trap 'jobs -p >"$dir/jobs"; kill $(cat "$dir/jobs") 2>/dev/null; rm -rf "$dir"' EXIT     # dash knows no jobs in $(...)
fail() { echo "test_geojson: $*"; exit 1; }

# three stand side by side, one behind another, one behind the eye
cat >"$dir/trees.csv" <<'CSV'
x,y,kind,height
447000,5411010,oak,2
447003,5411010,ash,1.5
446997,5411010,linden,1
447000,5411012,ash,1
447000,5410980,oak,2
CSV
# two boards that cross, Y up
printf 'v -0.5 0 0\nv 0.5 0 0\nv 0.5 1 0\nv -0.5 1 0\nv 0 0 -0.5\nv 0 0 0.5\nv 0 1 0.5\nv 0 1 -0.5\nf 1 2 3\nf 1 3 4\nf 5 6 7\nf 5 7 8\n' \
	>"$dir/board.obj"
echo '{ "crs": "EPSG:32632", "origin": [447000, 5411000, 0],
	"plants": {"oak": {"model": "board.obj"}, "ash": {"model": "board.obj"}},
	"instances": [{"from": "trees.csv", "x": "x", "y": "y", "species": "kind", "map": {"oak": "oak", "ash": "ash", "*": "oak"},
		"height_m": {"column": "height"}, "tint": {"column": "kind", "palette": "owner"}}] }' >"$dir/scene.json"
echo '{"fps": 1, "keyframes": [{"time_s": 0, "eye": [0, 0, 1], "target": [0, 10, 1], "fov_y_deg": 60}]}' >"$dir/camera.json"
"$BUILD/ecopack" make "$dir/scene.json" -o "$dir/board.eco" --draft --no-cache -q || fail "no pack"
"$BUILD/ecopack" make "$dir/scene.json" -o "$dir/bare.eco" --no-rows --draft --no-cache -q || fail "no bare pack"
"$BUILD/ecopack" map "$dir/scene.json" -o "$dir/all.geojson" -q || fail "no map"
mkfifo "$dir/said"
"$BUILD/ecoserve" --listen 127.0.0.1:0 "scene=$dir/board.eco" "bare=$dir/bare.eco" >"$dir/said" &
read -r said <"$dir/said"
url=$(echo "$said" | sed -n 's/.*ready on \([^ ]*\) .*/\1/p')/v1/scenes

view() { name=$1 && shift && "$BUILD/ecoview" "$url/$name" --camera "$dir/camera.json" --size 160x120 --vertices 1000 "$@" >"$dir/out" 2>&1; }
view scene --geojson -o "$dir/view" || fail "$(cat "$dir/out")"
seen=$dir/view/frame-0000.geojson
[ "$(jq -c '[.features[].properties.row] | sort' "$seen")" = '[1,2,3]' ] || fail "other plants: $(cat "$seen")"
jq -e '.summary_pixels == 0 and ([.features[].properties.pixels] | . == (sort | reverse) and .[-1] > 0)' "$seen" >/dev/null ||
	fail "pixels: $(cat "$seen")"
jq -e --slurpfile all "$dir/all.geojson" 'all(.features[]; . as $a | any($all[0].features[]; .properties.row == $a.properties.row
	and .properties.species == $a.properties.species and .properties.file == $a.properties.file
	and (.properties.height_m - $a.properties.height_m | fabs) < 0.02
	and ([range(2) as $k | .geometry.coordinates[$k] - $a.geometry.coordinates[$k] | fabs] | max) < 1e-7))' "$seen" >/dev/null ||
	fail "not as in the map: $(cat "$seen" "$dir/all.geojson")"
jq -e 'all(.features[].properties; .line == .row + 1)' "$seen" >/dev/null || fail "no lines: $(cat "$seen")"
jq -e '[.features[].properties | select(.species != .plant) | .species] == ["ash", "linden"]' "$seen" >/dev/null ||
	fail "what they are shown as: $(cat "$seen")"
jq -e 'all(.features[].properties; .class == .species)' "$seen" "$dir/all.geojson" >/dev/null || fail "classes: $(cat "$seen")"
curl -s "$url/scene" | jq -e '.needs[-1] == "tints" and .tints[0].column == "kind"
	and ([.tints[0].classes[] | [.name, .plants]] == [["ash", 2], ["oak", 2], ["linden", 1]]) and all(.tints[0].classes[]; .color[:1] == "#")' \
	>/dev/null || fail "the legend: $(curl -s "$url/scene")"
view bare --geojson -o "$dir/plain" || fail "$(cat "$dir/out")"
jq -e '[.features[].properties | select(.row == null and .file == null) | .species] | sort == ["ash", "oak", "oak"]' \
	"$dir/plain/frame-0000.geojson" >/dev/null || fail "without rows: $(cat "$dir/plain/frame-0000.geojson")"
# also while an answer comes, of which a picture is drawn on the way
view scene --geojson --progressive 500,1000 -o "$dir/steps" || fail "in steps: $(cat "$dir/out")"
jq -e 'all(.features[].properties; .row > 0)' "$dir/steps/frame-0000.geojson" >/dev/null || fail "in steps: no rows"
echo "ok: plants of a view with their rows"
