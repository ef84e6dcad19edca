#!/bin/sh
# The command line of ecopack as users meet it: what it prints, what it returns, and that errors say where and what. BUILD is the folder of
# the programs. Prints what failed; status 0 when nothing did.
set -u
BUILD=${BUILD:-build}
PACK=$BUILD/ecopack
DIR=build/tmp/ecopack-sh-$$
failed=0
mkdir -p "$DIR"
export XDG_CACHE_HOME="$PWD/$DIR/xdg"
trap 'rm -rf "$DIR"' EXIT

complain() { echo "test_ecopack: $*"; failed=1; }

# expect STATUS PATTERN ARGUMENT... : the exit status, and a line of output or error that matches (empty: anything)
expect() {
	wanted=$1 pattern=$2; shift 2
	"$PACK" "$@" >"$DIR/out" 2>&1 </dev/null
	status=$?
	[ $status -eq "$wanted" ] || complain "ecopack $*: status $status instead of $wanted: $(head -c 300 "$DIR/out")"
	[ -z "$pattern" ] || grep -Eq -- "$pattern" "$DIR/out" || complain "ecopack $*: says nothing like /$pattern/: $(head -c 300 "$DIR/out")"
}

# ---- Usage ----
expect 0 '^ecopack 0\.[0-9]+$' --version
expect 0 'ecopack make SCENE.json -o OUT.eco' --help
expect 0 'ecopack generate NAME -o DIR' --help
expect 2 'a command is missing: the commands are start, make'
expect 2 'bake.*make, link, info' bake x
expect 2 'the scene file is missing' make -o "$DIR/x.eco"
expect 2 '-o OUT.eco is missing' make "$DIR/x.json"
expect 2 'a pack to be linked is missing' link
expect 2 '-o OUT.eco is missing' link "$DIR/x.eco"
expect 2 'no --seed' make "$DIR/x.json" -o "$DIR/x.eco" --seed 3
expect 2 'one argument too many' info a.eco b.eco
expect 2 'info has no --frobnicate' info --frobnicate a.eco
expect 2 '--jobs 0: must be a whole number' make x.json -o x.eco --jobs 0
expect 2 '--jobs -3' make x.json -o x.eco --jobs -3
expect 2 '--plants 12x' generate park -o "$DIR/x" --plants 12x
expect 2 'a value must follow' generate park -o
expect 2 'must be one of greedy, stochastic, density, orientation, combined' make x.json -o x.eco --order alphabetical
expect 2 'must be one of' make x.json -o x.eco --order=
expect 2 'leave out --order, or --draft' make x.json -o x.eco --draft --order density
expect 2 'must be the name of a folder' make x.json -o x.eco --cache=
expect 2 '--cache-mb 0' make x.json -o x.eco --cache-mb 0
expect 2 'generate park, forest, meadow' generate desert -o "$DIR/x"

# ---- A small scene of our own ----
cat >"$DIR/blade.obj" <<OBJ
v -0.05 0 0
v 0.05 0 0
v 0.02 0.8 0
v -0.02 0.8 0.1
v 0 1.2 0.2
f 1 2 3 4
f 4 3 5
OBJ
cat >"$DIR/scene.json" <<JSON
{ "name": "tiny", "plants": {"grass": {"model": "blade.obj"}},
  "instances": [{"plant": "grass", "at": [0, 0, 0]}, {"plant": "grass", "at": [2, 1, 0], "yaw_deg": 45, "scale": 0.5}] }
JSON
expect 0 'tiny: 2 plants of 1 kind' make "$DIR/scene.json" -o "$DIR/tiny.eco"
expect 0 '^instances +1 +1 +2 ' info "$DIR/tiny.eco"
expect 0 'all is well' verify "$DIR/tiny.eco"
"$PACK" info --json "$DIR/tiny.eco" >"$DIR/info.json" || complain "info --json failed"
if command -v jq >/dev/null; then
	[ "$(jq -r '[.name, .instances, (.plants | length), .plants[0].triangles_in == .plants[0].triangles_stored + .plants[0].triangles_dropped] | join(" ")' "$DIR/info.json")" \
		= "tiny 2 1 true" ] || complain "info --json: $(head -c 400 "$DIR/info.json")"
	[ "$(jq '.plants[0] | .half_a_pixel_m > 0 and .searches.grid.runs == 1 and .searches.grid.converged <= 1' "$DIR/info.json")" = true ] \
		|| complain "info --json: $(jq -c '.plants[0] | {half_a_pixel_m, searches}' "$DIR/info.json")"
fi
"$PACK" make "$DIR/scene.json" -o "$DIR/again.eco" --quiet --jobs 3 >"$DIR/quiet" 2>&1 || complain "make --quiet failed"
[ -s "$DIR/quiet" ] && complain "make --quiet says: $(head -c 200 "$DIR/quiet")"
cmp -s "$DIR/tiny.eco" "$DIR/again.eco" || complain "the same scene gave another pack"

# ---- Orders by name, and plants that were built before ----
same() { cmp -s "$DIR/tiny.eco" "$DIR/$1" || complain "$2: another pack"; }
[ "$(ls "$XDG_CACHE_HOME/ecostream" | wc -l)" -eq 1 ] || complain "the default cache holds, beside the plant: $(ls "$XDG_CACHE_HOME/ecostream")"
expect 0 '^1 of 1 plants were built before and came from .*/xdg/ecostream$' make "$DIR/scene.json" -o "$DIR/again.eco" --times
same again.eco "from the cache"
"$PACK" make "$DIR/scene.json" -o "$DIR/again.eco" --no-cache --times >"$DIR/out" 2>&1 || complain "--no-cache: $(cat "$DIR/out")"
grep -q 'built before' "$DIR/out" && complain "--no-cache took a plant from the cache"
same again.eco --no-cache
expect 0 '^0 of 1 plants' make "$DIR/scene.json" -o "$DIR/again.eco" --cache "$DIR/kept" --times
expect 0 '^1 of 1 plants' make "$DIR/scene.json" -o "$DIR/again.eco" --cache="$DIR/kept" --times
same again.eco --cache
for entry in "$DIR"/kept/*.plant; do printf 'x' | dd of="$entry" bs=1 seek=60 conv=notrunc 2>/dev/null; done
expect 0 'damaged .its hash does not hold.: the plant is built again' make "$DIR/scene.json" -o "$DIR/again.eco" --cache "$DIR/kept"
same again.eco "after damage"
expect 0 '^1 of 1 plants' make "$DIR/scene.json" -o "$DIR/again.eco" --cache "$DIR/kept" --times
expect 0 'cannot keep finished plants; .*scene.json/.*: Not a directory' make "$DIR/scene.json" -o "$DIR/again.eco" --cache "$DIR/scene.json"
same again.eco "without a folder for the cache"
if [ -w /dev/full ] && [ -d /dev/shm ] && [ "$(id -u)" -eq 0 ] && mkdir "$DIR/small" && mount -t tmpfs -o size=4k tmpfs "$DIR/small" 2>/dev/null; then
	head -c 4096 /dev/zero >"$DIR/small/full" 2>/dev/null
	expect 0 'cannot keep finished plants; .*No space left' make "$DIR/scene.json" -o "$DIR/again.eco" --cache "$DIR/small"
	same again.eco "with a full disk"
	[ "$(ls "$DIR/small")" = full ] || complain "a full disk keeps: $(ls "$DIR/small")"
	umount "$DIR/small"
fi
(unset XDG_CACHE_HOME HOME; "$PACK" make "$DIR/scene.json" -o "$DIR/again.eco" >"$DIR/out" 2>&1) || complain "without HOME: $(cat "$DIR/out")"
same again.eco "without HOME"
for order in greedy stochastic density orientation combined; do
	expect 0 "^ +order +$order" make "$DIR/scene.json" -o "$DIR/$order.eco" --order $order
	expect 0 "\"order\": \"$order\"" info --json "$DIR/$order.eco"
	expect 0 'all is well' verify "$DIR/$order.eco"
done
same greedy.eco "greedy is the default"

# ---- What is in a model ----
expect 2 'the model file is missing' model
expect 2 'unknown; units: m, dm, cm, mm' model --unit parsec "$DIR/blade.obj"
expect 2 'x, y or z' model --up w "$DIR/blade.obj"
expect 0 'ecopack model FILE' model --help
expect 0 'triangles_kept +3' model "$DIR/blade.obj"
expect 0 '"blade": \{"model": ".*blade.obj"' model "$DIR/blade.obj"
expect 0 'taken for metres: 1.2 m; add "unit" or "height_m" if not' model "$DIR/blade.obj"
expect 0 'unit_m +0.3048' model --unit ft "$DIR/blade.obj"
expect 0 '^"plants": \{"blade": \{"model": \[".*blade.obj", ".*blade.obj"\], "up": "y", "height_m": 7' model "$DIR/blade.obj" "$DIR/blade.obj" \
	--height 7 --up y --as-plant --quiet
expect 1 'nothing.obj: No such file' model "$DIR/nothing.obj"
expect 1 'scene.json: not a model' model "$DIR/scene.json"
: >"$DIR/empty.glb"
expect 1 'empty.glb: the file is empty' model "$DIR/empty.glb"
"$PACK" model --json "$DIR/blade.obj" >"$DIR/model.json" || complain "model --json failed"
if command -v jq >/dev/null; then
	[ "$(jq -r '[.triangles_in, .triangles_kept + ([.triangles_dropped[]] | add), .component_count, .up, .plant.height_m] | join(" ")' "$DIR/model.json")" \
		= "3 3 1 y 1.2" ] || complain "model --json: $(head -c 400 "$DIR/model.json")"
fi

# ---- An inventory, on the ground ----
printf 'id,kind,e,n,dbh\n1,x,10,20,100\n2,y,11,22,200\n3,x,,5,90\n4,q,12,21,80\n' >"$DIR/stems.csv"
cat >"$DIR/rows.json" <<JSON
{ "name": "rows", "plants": {"grass": {"model": "blade.obj", "height_m": 3}},
  "instances": [{"from": "stems.csv", "x": "e", "y": "n", "species": "kind", "map": {"x": "grass", "y": "grass"},
                 "height_m": {"from_dbh_mm": "dbh", "max": 20, "rate": 0.004}, "seed": 1}] }
JSON
expect 0 'rows: 2 plants' make "$DIR/rows.json" -o "$DIR/rows.eco"
expect 0 'rows +read 4' info "$DIR/rows.eco"
expect 0 'all is well' verify "$DIR/rows.eco"

# ---- A recorded camera: notes, script and summary come from a child ----
printf 't,lon,lat,alt\n0,10,50,5\n1,10.0001,50,5\n2,10.0002,50,NA\n' >"$DIR/walk.csv"
expect 0 'walk.csv: read as CSV' camera "$DIR/walk.csv" -o "$DIR/walk.json"
expect 0 'walk.json: .*keyframes?, 61 frames' camera "$DIR/walk.csv" -o "$DIR/walk.json"
expect 0 'smoothed with' camera "$DIR/walk.csv" -o "$DIR/walk.json"
expect 0 'is a camera script already' camera "$DIR/walk.json" -o "$DIR/again.json"
cmp -s "$DIR/walk.json" "$DIR/again.json" || complain "a copied camera script differs"
echo '{"keyframes": 1}' >"$DIR/broken.json"
expect 1 'broken.json' camera "$DIR/broken.json" -o "$DIR/none.json"
expect 2 'is not a camera script; it is kept' camera "$DIR/walk.csv" -o "$DIR/walk.csv"
printf 'AXXX001\nHFDTE270418\nB1101355206343N00006198WA0058700558\n' >"$DIR/a.igc"
expect 1 'Read are SRT .*GPSBabel' camera "$DIR/a.igc" -o "$DIR/none.json"
expect 1 'walk.csv: read as CSV' camera "$DIR/walk.csv" --height rel --crs EPSG:1 --origin 0,0,0 -o "$DIR/none.json"
[ ! -e "$DIR/none.json" ] || complain "a camera script was written in spite of an error"
# beyond the heights' border, at 30 m, the ground goes on as in the pack: down to their mean, 20 m
printf 'ncols 3\nnrows 3\nxllcorner 0\nyllcorner 0\ncellsize 5\n10 20 30\n10 20 30\n10 20 30\n' >"$DIR/dem.asc"
printf 't,lon,lat\n0,10,50\n1,10.00001,50\n' >"$DIR/step.csv"
sed 's/"plants"/"ground": {"heights": "dem.asc"}, "plants"/' "$DIR/scene.json" >"$DIR/hill.json"
expect 0 '100 % of the way is beyond the border' camera "$DIR/step.csv" --scene "$DIR/hill.json" --to 90000,0,0 -o "$DIR/step.json"
expect 0 'z 2[12]\.[0-9]* to 2[12]\.' camera "$DIR/step.csv" --scene "$DIR/hill.json" --to 90000,0,0 -o "$DIR/step.json"

# ---- Errors name file, place and what ----
expect 1 'nowhere.json' make "$DIR/nowhere.json" -o "$DIR/x.eco"
printf '{ "name": "x",\n  "plant": {} }\n' >"$DIR/bad.json"
expect 1 'bad.json:2:[0-9]+.*plant' make "$DIR/bad.json" -o "$DIR/x.eco"
printf '{ "name": "x",\n' >"$DIR/bad.json"
expect 1 'bad.json:[0-9]+' make "$DIR/bad.json" -o "$DIR/x.eco"
sed 's/blade.obj/gone.obj/' "$DIR/scene.json" >"$DIR/bad.json"
expect 1 'gone.obj' make "$DIR/bad.json" -o "$DIR/x.eco"
sed 's/"e"/"east"/' "$DIR/rows.json" >"$DIR/bad.json"
expect 1 'stems.csv.*east|east.*stems.csv' make "$DIR/bad.json" -o "$DIR/x.eco"
expect 1 '' make "$DIR/scene.json" -o "$DIR/no/such/folder/x.eco"
expect 1 'nothing.eco' info "$DIR/nothing.eco"
expect 1 '' verify "$DIR/scene.json"
head -c 500 "$DIR/tiny.eco" >"$DIR/cut.eco"
expect 1 'cut.eco' verify "$DIR/cut.eco"
[ -e "$DIR/x.eco" ] && complain "a failed build left a pack"
ls "$DIR" | grep -q 'tmp-' && complain "left behind: $(ls "$DIR" | grep tmp-)"

# ---- All or nothing: a build that is told to stop ----
mkdir "$DIR/stop"
if "$PACK" generate forest -o "$DIR/stop/forest" --plants 300 --quiet; then
	"$PACK" make "$DIR/stop/forest/scene.json" -o "$DIR/stop/forest.eco" --quiet >"$DIR/out" 2>&1 &
	pid=$!
	sleep 0.7
	if kill -INT $pid 2>/dev/null || kill -TERM $pid 2>/dev/null; then
		kill -TERM $pid 2>/dev/null              # a shell's background jobs ignore SIGINT
		wait $pid
		status=$?
		[ $status -eq 1 ] || [ -e "$DIR/stop/forest.eco" ] || complain "stopped build: status $status"
		ls "$DIR/stop" | grep -q 'tmp-' && complain "stopped build left: $(ls "$DIR/stop")"
	fi
else
	complain "generate forest failed"
fi

# ---- Killed, it leaves the old pack whole, and its unfinished file to the next build ----
mkdir "$DIR/kill"
"$PACK" make "$DIR/scene.json" -o "$DIR/kill/t.eco" --no-cache --quiet 2>"$DIR/out" || complain "$(cat "$DIR/out")"
old=$(cksum <"$DIR/kill/t.eco")
for wait in 0.02 0.05 0.1 0.2 0.3; do
	timeout -s KILL $wait "$PACK" make "$DIR/scene.json" -o "$DIR/kill/t.eco" --no-cache --quiet >"$DIR/out" 2>&1
	[ "$(cksum <"$DIR/kill/t.eco")" = "$old" ] || complain "killed after $wait s: the pack is another"
done
: >"$DIR/kill/t.eco.tmp-1"
# children of a killed build may hold its file a moment longer
for try in 1 2 3 4 5; do
	expect 0 '' make "$DIR/scene.json" -o "$DIR/kill/t.eco" --no-cache --quiet
	[ "$(ls "$DIR/kill")" = t.eco ] && break
	sleep 1
done
[ "$(ls "$DIR/kill")" = t.eco ] || complain "left after the next build: $(ls "$DIR/kill")"

exit $failed
