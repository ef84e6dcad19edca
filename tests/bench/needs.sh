#!/bin/sh
# Costs of each feature of a scene, and that it costs nothing where it is not used: scenes, each with one thing more than the one before,
# from bare wood to everything; and views that draw leaves as splats, or ground without a plant. BUILD is the folder of the programs, DIR where
# to work. Prints a CSV table.
# With `features` after DIR: scenes of one feature each, and the modules that each takes. MAKE_AS: options of make, --order combined if not given.
#
# The modules that ecopack needs for a scene are found by giving it none (ECO_MODULES), then those that it asks for: one not there cannot
# be loaded. It loads most of them in a child process, which may write nothing that could be looked at.
set -eu
BUILD=${BUILD:-build}
DIR=${1:?needs.sh DIR}
mkdir -p "$DIR"
mkdir -p "$DIR/xdg"
XDG_CACHE_HOME=$(cd "$DIR/xdg" && pwd)
export XDG_CACHE_HOME

# ---- Models ----

# trunk.obj: a stem and 24 twigs, three-sided tubes; leaves.awk adds leaves at its twigs: quads of one colour, or with a texture
cat >"$DIR/plant.awk" <<'AWK'
function tube(x0, y0, z0, x1, y1, z1, r,   k, a) {
	for (k = 0; k < 3; k++) { a = k * 2.0944; printf "v %.4f %.4f %.4f\n", x0 + r * cos(a), y0 + r * sin(a), z0 }
	for (k = 0; k < 3; k++) { a = k * 2.0944; printf "v %.4f %.4f %.4f\n", x1 + r / 2 * cos(a), y1 + r / 2 * sin(a), z1 }
	for (k = 0; k < 3; k++)
		printf "f %d %d %d\nf %d %d %d\n", n + 1 + k, n + 1 + (k + 1) % 3, n + 4 + k, n + 1 + (k + 1) % 3, n + 4 + (k + 1) % 3, n + 4 + k
	n += 6
}
function leaf(x, y, z, a, s,   c, d, t) {
	c = cos(a) * s; d = sin(a) * s; t = textured
	printf "v %.4f %.4f %.4f\nv %.4f %.4f %.4f\nv %.4f %.4f %.4f\nv %.4f %.4f %.4f\n", x, y, z, x + c - d / 2, y + d + c / 2, z + s / 4,
		x + 2 * c, y + 2 * d, z, x + c + d / 2, y + d - c / 2, z + s / 4
	if (t)
		printf "f %d/1 %d/2 %d/3 %d/4\n", n + 1, n + 2, n + 3, n + 4
	else
		printf "f %d %d %d %d\n", n + 1, n + 2, n + 3, n + 4
	n += 4
}
BEGIN {
	printf "mtllib plant.mtl\n"
	if (textured)
		printf "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
	printf "usemtl bark\n"
	tube(0, 0, 0, 0, 0, 6, 0.15)
	for (i = 0; i < 24; i++) {
		a = i * 2.39996; z = 1.5 + i * 0.18; l = 1.8 - i * 0.05
		tube(0, 0, z, l * cos(a), l * sin(a), z + l * 0.5, 0.04)
	}
	if (leaves)
		printf "usemtl %s\n", material
	for (i = 0; i < leaves; i++) {
		k = i % 24; a = k * 2.39996; z = 1.5 + k * 0.18; l = (1.8 - k * 0.05) * (0.3 + 0.7 * (i * 0.618 % 1))
		leaf(l * cos(a), l * sin(a), z + l * 0.5, i * 2.1, 0.12 + 0.05 * (i * 0.414 % 1))
	}
}
AWK
awk -v leaves=0 -f "$DIR/plant.awk" >"$DIR/bare.obj"
awk -v leaves=240 -v material=leaf -f "$DIR/plant.awk" >"$DIR/leafy.obj"
awk -v leaves=240 -v material=painted -v textured=1 -f "$DIR/plant.awk" >"$DIR/painted.obj"
awk -v leaves=240 -v material=cut -v textured=1 -f "$DIR/plant.awk" >"$DIR/cut.obj"
awk -v leaves=2200 -v material=cut -v textured=1 -f "$DIR/plant.awk" >"$DIR/large.obj"
cat >"$DIR/plant.mtl" <<'MTL'
newmtl bark
Kd 0.35 0.28 0.22
newmtl leaf
Kd 0.2 0.4 0.1
newmtl painted
map_Kd painted.png
newmtl cut
map_Kd leaf.png
map_d leaf.png
MTL
# a texture with holes from the example scenes, and a picture without
"$BUILD/ecopack" generate park -o "$DIR/park" --plants 12 --quiet >/dev/null
cp "$DIR/park/models/leaf.png" "$DIR/leaf.png"
"$BUILD/ecopack" map "$DIR/park/scene.json" -o "$DIR/painted.png" --size 200 --quiet >/dev/null
cp "$DIR/park/dem.tif" "$DIR/dem.tif"
# a picture that is not PNG, and a model on it
awk 'BEGIN { print "P3\n64 64\n255"; for (i = 0; i < 4096; i++) print 90 + i % 7 * 9, 60 + i % 5 * 8, 40 }' >"$DIR/bark.ppm"
sed 's/plant\.mtl/rough.mtl/' "$DIR/painted.obj" >"$DIR/rough.obj"
printf 'newmtl bark\nKd 0.35 0.28 0.22\nnewmtl painted\nmap_Kd bark.ppm\n' >"$DIR/rough.mtl"
# a model in a format that has no reader of its own
awk '/^v / { v[n++] = $2 " " $3 " " $4 } /^f / { $1 = NF - 1; for (i = 2; i <= NF; i++) $i--; f[m++] = $0 }
	END { printf "ply\nformat ascii 1.0\nelement vertex %d\nproperty float x\nproperty float y\nproperty float z\n", n
		printf "element face %d\nproperty list uchar int vertex_indices\nend_header\n", m
		for (i = 0; i < n; i++) print v[i]; for (i = 0; i < m; i++) print f[i] }' "$DIR/bare.obj" >"$DIR/bare.ply"
# places in degrees: as a plain table, and in a format that OGR reads
awk 'BEGIN { print "lon,lat"; for (i = 0; i < 9; i++) printf "%.6f,%.6f\n", 11.5671 + i * 0.00003, 48.1351 }' >"$DIR/places.csv"
awk 'BEGIN { printf "{\"type\": \"FeatureCollection\", \"features\": ["; for (i = 0; i < 9; i++)
	printf "%s{\"type\": \"Feature\", \"properties\": {}, \"geometry\": {\"type\": \"Point\", \"coordinates\": [%.6f, %.6f]}}", i ? ", " : "",
		11.5671 + i * 0.00003, 48.1352; print "]}" }' >"$DIR/places.geojson"

# ---- Scenes ----

# instances PLANT COUNT: in rows 4 m apart
instances() { awk -v plant="$1" -v count="$2" 'BEGIN { for (i = 0; i < count; i++) printf "%s{\"plant\": \"%s\", \"at\": [%d, %d]}", i ? ", " : "", plant, i % 10 * 4 - 18, int(i / 10) * 4 }'; }

scene() { printf '{"name": "%s", %s"plants": {"plant": {"model": "%s.obj"}}, "instances": [%s]}\n' "$1" "$3" "$2" "$(instances plant 100)" >"$DIR/$1.json"; }
scene bare bare '"ground": null, '
scene picture rough ''
printf '{"name": "foreign", "plants": {"plant": {"model": "bare.ply", "up": "z", "unit": "m"}}, "instances": [%s]}\n' "$(instances plant 9)" >"$DIR/foreign.json"
# rows NAME ENTRY: an inventory that has to be converted
rows() { printf '{"name": "%s", "crs": "EPSG:32632", "origin": [691000, 5334000, 520], "plants": {"plant": {"model": "bare.obj"}}, "instances": [{%s, "plant": "plant"}]}\n' "$1" "$2" >"$DIR/$1.json"; }
rows table '"from": "places.csv", "x": "lon", "y": "lat", "crs": "EPSG:4326"'
rows layer '"from": "places.geojson"'
scene leaves leafy '"ground": null, '
scene textures painted '"ground": null, '
scene cutouts cut '"ground": null, '
scene ground cut '"crs": "EPSG:32632", "origin": [691000, 5334000, 520], "ground": {"heights": "dem.tif"}, '
scene covered cut '"crs": "EPSG:32632", "origin": [691000, 5334000, 520], "ground": {"heights": "dem.tif", "image": {"file": "painted.png", "crs": "EPSG:32632", "north_west": [690900, 5334100], "pixel": 1}}, '
# land GEOJSON: an object, footprints, a road and a pond, each with the bare plants
square='[[[11.5671, 48.1352], [11.5673, 48.1352], [11.5673, 48.1353], [11.5671, 48.1352]]]'
feature() { printf '{"type": "FeatureCollection", "features": [{"type": "Feature", "properties": {%s}, "geometry": {"type": "%s", "coordinates": %s}}]}' "$2" "$3" "$4" >"$DIR/$1.geojson"; }
feature footprint '"height": 9' Polygon "$square"
feature road '"highway": "residential"' LineString '[[11.567, 48.135], [11.568, 48.136]]'
feature pond '"natural": "water"' Polygon "$square"
around() { printf '{"name": "%s", "crs": "EPSG:32632", "origin": [691000, 5334000, 520], "ground": %s, "plants": {"plant": {"model": "bare.obj"%s}}, "instances": [%s%s]}\n' "$1" "$2" "$3" "$(instances plant 9)" "$4" >"$DIR/$1.json"; }
around objects null ', "object": true' ''
around houses null '' ', {"extrude": "footprint.geojson", "height_m": "height"}'
around roads '{"heights": "dem.tif", "draw": [{"from": "road.geojson"}]}' '' ''
around water '{"heights": "dem.tif", "draw": [{"from": "pond.geojson"}]}' '' ''
printf '{"name": "block", "plants": {"plant": {"model": "cut.obj"}}, "instances": [%s]}\n' "$(instances plant 50)" >"$DIR/block.json"
printf '{"name": "everything", "crs": "EPSG:32632", "origin": [691000, 5334000, 520], "ground": {"heights": "dem.tif"}, "tile": {"instances": 16}, "plants": {"plant": {"model": "leafy.obj"}, "large": {"model": "large.obj"}, "rough": {"model": "rough.obj"}, "foreign": {"model": "bare.ply", "up": "z", "unit": "m"}}, "instances": [%s, {"plant": "large", "at": [0, -8]}, {"plant": "rough", "at": [8, -8]}, {"from": "places.csv", "x": "lon", "y": "lat", "crs": "EPSG:4326", "plant": "foreign"}, {"from": "places.geojson", "plant": "foreign"}], "children": [{"eco": "block.json", "at": [-20, 60, 0]}]}\n' \
	"$(instances plant 100)" >"$DIR/everything.json"
# camera NAME EYE TARGET
camera() { printf '{"fps": 1, "keyframes": [{"time_s": 0, "eye": [%s], "target": [%s], "up": [0, 0, 1], "fov_y_deg": 50}]}\n' "$2" "$3" >"$DIR/$1.json"; }
camera near "0, -16, 6" "0, 10, 3"
camera away "0, -60, 20" "0, -90, 0"
camera down "1, 6, 30" "0, 6, 0"

# ---- Measuring ----

# libraries COMMAND...: names of the libraries that a program and what it starts load, into $DIR/libraries
libraries() {
	rm -f "$DIR"/ld.*
	LD_DEBUG=files LD_DEBUG_OUTPUT="$DIR/ld" "$@" || return 1
	sed -n 's/.*calling init: .*\/\([^/]*\)$/\1/p' "$DIR"/ld.* | sort -u >"$DIR/libraries"
	rm -f "$DIR"/ld.*
}

# pack SCENE: with the fewest modules that it takes, whose names (without eco, .so) come to $modules
pack() {
	rm -rf "$DIR/modules" "$DIR/xdg"
	mkdir -p "$DIR/modules"
	modules=
	while :; do
		ECO_MODULES=$DIR/modules libraries "$BUILD/ecopack" make "$DIR/$1.json" -o "$DIR/$1.eco" ${MAKE_AS:---order combined} >"$DIR/said" 2>&1 && done=1 || done=
		missing=$(sed -n 's/.*eco\([a-z]*\)\.so, needed for.*/\1/p' "$DIR/said" | head -n 1)
		[ -n "$missing" ] || break
		[ ! -e "$DIR/modules/eco$missing.so" ] || break
		cp "$BUILD/eco$missing.so" "$DIR/modules/"
		modules="$modules${modules:+ }$missing"
	done
	[ -n "$done" ] || { cat "$DIR/said" >&2; exit 1; }
	for module in $modules; do
		ldd "$BUILD/eco$module.so" | sed -n 's/^[^=]*=> *\/.*\/\([^ ]*\) .*/\1/p'
		echo "eco$module.so"
	done | sort -u - "$DIR/libraries" >"$DIR/packer"
	modules=$(echo "$modules" | tr ' ' '\n' | sort | tr '\n' ' ')
}

server=
stop() { [ -z "$server" ] || { kill "$server" 2>/dev/null || true; wait "$server" 2>/dev/null || true; }; server=; }
trap stop EXIT

if [ "${2-}" = features ]; then
	for name in picture foreign table layer houses roads; do
		pack "$name"
		echo "$name,${modules% }"
	done
	exit
fi

echo "scene,pack bytes,sections,lists,stream bytes,server kB,server libraries,server ready ms,viewer libraries,packer modules,shaders,packer libraries,viewer modules,shadow map"
# ROW SCENE CAMERA VERTICES: as many as draw wood as lines and splats, or leaves as splats, or everything
packed=
while read -r row name camera budget <&3; do
	[ "$packed" = "$name" ] || pack "$name"
	packed=$name
	packer=$(grep -c . "$DIR/packer")
	sections=$("$BUILD/ecopack" info "$DIR/$name.eco" --json | jq -r '.needs | join(" ")')
	lists=$("$BUILD/ecopack" info "$DIR/$name.eco" --json | jq -r '[.lists | to_entries[] | select(.value.lists > 0) | .key] | join(" ")' 2>/dev/null || echo "?")
	started=$(date +%s%N)
	: >"$DIR/ready"
	"$BUILD/ecoserve" --listen 127.0.0.1:0 "$DIR/$name.eco" >"$DIR/ready" 2>&1 &
	server=$!
	until grep -q '127.0.0.1:' "$DIR/ready"; do kill -0 "$server"; sleep 0.005; done
	ready=$((($(date +%s%N) - started) / 1000000))
	url=$(sed -n 's/.*\(127\.0\.0\.1:[0-9]*\).*/http:\/\/\1/p' "$DIR/ready" | head -n 1)
	libraries "$BUILD/ecoview" "$url/v1/scenes/$name" --camera "$DIR/$camera.json" --size 160x120 --vertices "$budget" -o "$DIR/$row" >/dev/null 2>&1
	viewer=$(grep -c . "$DIR/libraries")
	viewing=$(sed -n 's/^eco\(.*\)\.so$/\1/p' "$DIR/libraries" | tr '\n' ' ')
	stream=$(jq '.frames[0].bytes' "$DIR/$row/report.json")
	shaders=$(jq -r '.shaders | join(" ")' "$DIR/$row/report.json")
	resident=$(sed -n 's/^VmHWM:[^0-9]*\([0-9]*\) kB/\1/p' /proc/$server/status)
	mapped=$(sed -n 's/.* \(\/.*\.so[^ ]*\)$/\1/p' /proc/$server/maps | sort -u | wc -l)
	shadow=$(jq -r 'if .frames[0].shadow_ms > 0 then "made" else "" end' "$DIR/$row/report.json")
	stop
	echo "$row,$(wc -c <"$DIR/$name.eco" | tr -d ' '),$sections,$lists,$stream,$resident,$mapped,$ready,$viewer,${modules% },$shaders,$packer,${viewing% },$shadow"
done 3<<'ROWS'
bare bare near 1000
leaves leaves near 1000000
sparse leaves near 300
textures textures near 1000000
cutouts cutouts near 1000000
ground ground near 1000000
unplanted ground away 1000000
covered covered down 1000000
objects objects near 1000000
houses houses near 1000000
roads roads near 1000000
water water near 1000000
everything everything near 1000000
ROWS
