#!/bin/sh
# Nine thousand street trees over three kilometres and fifty thousand over eight, seen from the air: a plan of ecoserve's usual work shows
# them.
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
# scene NAME TREES WIDE
scene() {
	awk -v trees="$2" -v wide="$3" 'BEGIN { print "x,y"; for (i = 0; i < trees; i++) { street = i * 7 % 40 * wide / 40; at = i * 1237 % wide
		print (i % 2 ? street "," at : at "," street) } }' >"$dir/$1.csv"
	echo '{"plants": {"tree": {"model": "tree.obj"}}, "instances": [{"plant": "tree", "from": "'"$1"'.csv", "x": "x", "y": "y"}]}' >"$dir/$1.json"
	"$BUILD/ecopack" make --draft "$dir/$1.json" -o "$dir/$1.eco" --quiet 2>"$dir/said" || fail "$(cat "$dir/said")"
}
# sees NAME MIDDLE METRES TREES: so many at least are planned from so far away
sees() {
	curl -s "$url/v1/scenes/$1/plan?eye=$2,$(($2 - $3)),$(($3 / 2))&target=$2,$2,5&fov_y_deg=45&width=1280&height=800&vertices=300000" >"$dir/plan.json"
	jq -e ".visible_plants > $4 and .prediction.q > 0.5" "$dir/plan.json" >/dev/null \
		|| fail "$1 from $3 m: $(jq -c '[.visible_plants, .vertices, .prediction.q]' "$dir/plan.json")"
}
scene wide 9000 3000
scene wider 50000 8000
"$BUILD/ecoserve" --listen 127.0.0.1:0 "$dir/wide.eco" "$dir/wider.eco" >"$dir/ready" &
server=$!
trap 'kill $server 2>/dev/null' EXIT
for _ in $(seq 100); do grep -q ready "$dir/ready" && break; sleep 0.1; done
url=$(sed -n 's/.*ready on \([^ ]*\) .*/\1/p' "$dir/ready")
sees wide 1500 5000 8000
sees wide 1500 4000 8000
sees wide 1500 3000 8000
sees wider 4000 12000 49000
sees wider 4000 6000 40000
