#!/bin/sh
# ecopack make --confine: what a stranger's scene names outside of its folder is not read, however it is named; what lies inside is read as
# without. BUILD is the folder of the programs. Prints what failed; status 0 when nothing did, 77 where the kernel has no Landlock.
set -u
BUILD=${BUILD:-build}
PACK=$BUILD/ecopack
DIR=$(mktemp -d)
failed=0
trap 'rm -rf "$DIR"' EXIT
mkdir "$DIR/in" "$DIR/in/deep" "$DIR/out" "$DIR/secret"

complain() { echo "test_confine: $*"; failed=1; }

# make_confined NAME [OPTION...] : packs in/NAME.json to out/NAME.eco; what it printed is in $DIR/said
make_confined() {
	name=$1; shift
	"$PACK" make "$DIR/in/$name.json" -o "$DIR/out/$name.eco" --draft --no-cache --jobs 2 "$@" >"$DIR/said" 2>&1 </dev/null
}

# refused NAME PATTERN : not made, with a line that matches and a word on --confine; made without it
refused() {
	make_confined "$1" --confine && complain "$1: made although it reads outside"
	grep -Eq -- "$2" "$DIR/said" || complain "$1: says nothing like /$2/: $(head -c 300 "$DIR/said")"
	grep -q -- '--confine' "$DIR/said" || complain "$1: does not name --confine: $(head -c 300 "$DIR/said")"
	[ ! -e "$DIR/out/$1.eco" ] || complain "$1: left a pack"
	make_confined "$1" || complain "$1: not made without --confine either: $(head -c 300 "$DIR/said")"
}

for folder in in secret; do
	printf 'v -0.05 0 0\nv 0.05 0 0\nv 0 0 1\nf 1 2 3\n' >"$DIR/$folder/blade.obj"
	printf 'plant,x,y\ngrass,1,1\ngrass,2,3\n' >"$DIR/$folder/rows.csv"
done
cp "$DIR/in/blade.obj" "$DIR/in/deep/"
plants='"plants": {"grass": {"model": "blade.obj"}}'
echo "{ $plants, \"instances\": [{\"plant\": \"grass\", \"at\": [0, 0]}, {\"from\": \"rows.csv\", \"species\": \"plant\", \"map\":
	{\"grass\": \"grass\"}, \"x\": \"x\", \"y\": \"y\"}] }" >"$DIR/in/inside.json"

if ! make_confined inside --confine; then
	grep -q 'has no Landlock' "$DIR/said" && { echo "test_confine: skipped: $(cat "$DIR/said")"; exit 77; }
	complain "inside: $(head -c 500 "$DIR/said")"
fi
mv "$DIR/out/inside.eco" "$DIR/out/confined.eco"
make_confined inside
cmp -s "$DIR/out/inside.eco" "$DIR/out/confined.eco" || complain "--confine changes the pack"

# a model elsewhere, by a path and by a link
echo '{ "plants": {"grass": {"model": "../secret/blade.obj"}}, "instances": [{"plant": "grass", "at": [0, 0]}] }' >"$DIR/in/model.json"
refused model 'secret/blade.obj'
ln -s ../secret/blade.obj "$DIR/in/linked.obj"
echo '{ "plants": {"grass": {"model": "linked.obj"}}, "instances": [{"plant": "grass", "at": [0, 0]}] }' >"$DIR/in/link.json"
refused link 'linked.obj'

# an inventory elsewhere
sed 's|"rows.csv"|"../secret/rows.csv"|' "$DIR/in/inside.json" >"$DIR/in/rows.json"
refused rows 'secret/rows.csv'

# a nested scene elsewhere
echo "{ $plants, \"instances\": [{\"plant\": \"grass\", \"at\": [0, 0]}] }" >"$DIR/secret/nested.json"
echo '{ "children": [{"eco": "../secret/nested.json", "at": [0, 0, 0]}] }' >"$DIR/in/child.json"
refused child 'secret/nested.json'

# a glTF whose buffer lies elsewhere
head -c 36 /dev/zero >"$DIR/secret/mesh.bin"
printf '\000\000\200\077' | dd of="$DIR/secret/mesh.bin" bs=1 seek=12 conv=notrunc 2>/dev/null
printf '\000\000\200\077' | dd of="$DIR/secret/mesh.bin" bs=1 seek=28 conv=notrunc 2>/dev/null
echo '{"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
	"meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
	"accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]}],
	"bufferViews": [{"buffer": 0, "byteLength": 36}], "buffers": [{"uri": "../secret/mesh.bin", "byteLength": 36}]}' >"$DIR/in/leaf.gltf"
echo '{ "plants": {"leaf": {"model": "leaf.gltf"}}, "instances": [{"plant": "leaf", "at": [0, 0]}] }' >"$DIR/in/gltf.json"
refused gltf 'mesh.bin'

# a raster that names another, with the pack's folder above both: what may be written may not be read by importers
printf 'ncols 4\nnrows 4\nxllcorner -20\nyllcorner -20\ncellsize 10\n1 2 3 4\n1 2 3 4\n1 2 3 4\n1 2 3 4\n' >"$DIR/secret/heights.asc"
echo '<VRTDataset rasterXSize="4" rasterYSize="4"><SRS>EPSG:32617</SRS><GeoTransform>-20,10,0,20,0,-10</GeoTransform><VRTRasterBand
	dataType="Float32" band="1"><SimpleSource><SourceFilename relativeToVRT="1">../secret/heights.asc</SourceFilename><SourceBand>1</SourceBand>
	</SimpleSource></VRTRasterBand></VRTDataset>' >"$DIR/in/heights.vrt"
echo "{ $plants, \"crs\": \"EPSG:32617\", \"origin\": [0, 0, 0], \"ground\": {\"heights\": \"heights.vrt\"}, \"instances\":
	[{\"plant\": \"grass\", \"at\": [0, 0]}] }" >"$DIR/in/vrt.json"
"$PACK" make "$DIR/in/vrt.json" -o "$DIR/vrt.eco" --no-cache --confine >"$DIR/said" 2>&1 && complain "vrt: made although its raster lies outside"
refused vrt 'heights'

# elsewhere is where it is told that everything lies
make_confined model "--confine=$DIR" || complain "--confine=DIR does not read below DIR: $(head -c 300 "$DIR/said")"
make_confined inside "--confine=$DIR/secret" && complain "a scene that lies elsewhere was made"
grep -q 'does not lie below' "$DIR/said" || complain "a scene that lies elsewhere: $(head -c 300 "$DIR/said")"
exit $failed
