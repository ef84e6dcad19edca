#!/bin/sh
# Nine thousand street trees over three kilometres, seen from the air: a plan of ecoserve's usual work shows them.
set -u
dir=build/tmp/test_wide
fail() { echo "test_wide: $*"; exit 1; }
rm -rf "$dir"
mkdir -p "$dir"
# a trunk and a crown of three cards
echo 'v -.1 0 0
v .1 0 0
v 0 0 2
f 1 2 3' >"$dir/tree.obj"
for card in 0 1 2; do
	awk -v turn="$card" 'BEGIN { c = cos(turn * 1.05) * 2; s = sin(turn * 1.05) * 2
		printf "v %f %f 1.5\nv %f %f 1.5\nv %f %f 6\nv %f %f 6\nf -4 -3 -2 -1\n", -c, -s, c, s, c, s, -c, -s }'
done >>"$dir/tree.obj"
awk 'BEGIN { print "x,y"; for (i = 0; i < 9000; i++) { street = i * 7 % 40 * 75; at = i * 1237 % 3000
	print (i % 2 ? street "," at : at "," street) } }' >"$dir/trees.csv"
echo '{"plants": {"tree": {"model": "tree.obj"}}, "instances": [{"plant": "tree", "from": "trees.csv", "x": "x", "y": "y"}]}' \
	>"$dir/wide.json"
"$BUILD/ecopack" make --draft "$dir/wide.json" -o "$dir/wide.eco" --quiet 2>"$dir/said" || fail "$(cat "$dir/said")"
"$BUILD/ecoserve" --listen 127.0.0.1:0 "$dir/wide.eco" >"$dir/ready" &
server=$!
trap 'kill $server 2>/dev/null' EXIT
for _ in $(seq 100); do grep -q ready "$dir/ready" && break; sleep 0.1; done
url=$(sed -n 's/.*ready on \([^ ]*\) .*/\1/p' "$dir/ready")
for far in 5000 4000 3000; do
	curl -s "$url/v1/scenes/wide/plan?eye=1500,$((1500 - far)),$((far / 2))&target=1500,1500,5&fov_y_deg=45&width=1280&height=800&vertices=300000" \
		>"$dir/plan.json"
	jq -e '.visible_plants > 8000 and .prediction.q > 0.5' "$dir/plan.json" >/dev/null \
		|| fail "from $far m: $(jq -c '[.visible_plants, .vertices, .prediction.q]' "$dir/plan.json")"
done
