#!/bin/sh
# Ground gives way to plants where bytes are few, but not to ground that is coarser and takes more. Prints what failed; status 0 when nothing
# did.
set -u
BUILD=${BUILD:-build}
DIR=$BUILD/tmp/scarce-ground-sh-$$
failed=0
mkdir -p "$DIR"
export XDG_CACHE_HOME="$PWD/$DIR/xdg"
server=
trap '[ -z "$server" ] || kill $server; rm -rf "$DIR"' EXIT

complain() { echo "test_scarce_ground: $*"; failed=1; }

# 513 x 513 heights, 10 m apart: hills, and what looks like noise
awk 'BEGIN { print "ncols 513\nnrows 513\nxllcorner -2565\nyllcorner -2565\ncellsize 10"
	for (y = 0; y < 513; y++) { for (x = 0; x < 513; x++) { n = (n * 1103 + 12345 + x * y) % 65536
		printf "%.2f ", 60 * sin(x / 19) * cos(y / 23) + 12 * sin(x / 5 + y / 7) + n / 65536 * 0.3 } print "" } }' >"$DIR/hills.asc"
# stems and crowns of 1500 leaves, no two alike
for kind in 1 2 3; do awk -v n=$kind 'function next_random() { n = (n * 1103 + 12345) % 65536; return n / 65536 }
	BEGIN { print "# Units: m\nv -0.2 0 0\nv 0.2 0 0\nv 0 7 0.2\nf 1 2 3"
	for (i = 0; i < 1500; i++) { x = 6 * next_random() - 3; y = 4 + 7 * next_random(); z = 6 * next_random() - 3; a = next_random(); b = next_random()
		printf "v %g %g %g\nv %g %g %g\nv %g %g %g\nf -1 -2 -3\n", x, y, z, x + a / 2, y + b / 3, z, x, y + a / 3, z + b / 2 } }' >"$DIR/tree_$kind.obj"; done
awk 'BEGIN { print "x,y"; for (i = 0; i < 400; i++) printf "%d,%d\n", (i % 20 - 10) * 57 + i % 7, (int(i / 20) - 10) * 41 + i % 5 }' >"$DIR/trees.csv"
echo '{"ground": {"heights": "hills.asc"}, "plants": {"tree": {"variants": ["tree_1.obj", "tree_2.obj", "tree_3.obj"]}}, "instances": [{"from": "trees.csv", "x": "x", "y": "y", "plant": "tree"}]}' \
	>"$DIR/hills.json"
"$BUILD/ecopack" make --draft "$DIR/hills.json" -o "$DIR/hills.eco" >"$DIR/out" 2>&1 || complain "make: $(tail -3 "$DIR/out")"
"$BUILD/ecoserve" --listen 127.0.0.1:0 "$DIR/hills.eco" >"$DIR/served" 2>&1 & server=$!
touch "$DIR/served"
for try in 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20; do grep -q 'ready on' "$DIR/served" && break; sleep 0.3; done
URL=$(sed -n 's/.*ready on \(http[^ ]*\).*/\1/p' "$DIR/served")

for bytes in 16000 20000 25000 30000 40000; do
	curl -s "$URL/v1/scenes/hills/plan?eye=0,-300,70&target=0,100,10&up=0,0,1&fov_y_deg=60&width=800&height=600&vertices=300000&bytes=$bytes" \
		>"$DIR/plan.json"
	jq -e '.ground.tiles > 1 and .ground.ground_px > 1 and .ground.ground_px < 1000' "$DIR/plan.json" >/dev/null \
		|| complain "of $bytes bytes: ground $(jq -c .ground "$DIR/plan.json")"
done
exit $failed
