#!/bin/sh
# Is a single plant, streamed at full detail, the file it came from? For each MODEL: pack it alone, stream everything, draw 8 views of 512
# pixels, and compare with the source model rasterised by a path of its own (source_check.c). Prints a line a model and writes
# OUT/fidelity.json: least Q over the views, triangles in = stored + dropped by reason.
#
#   fidelity.sh OUT MODEL[=HEIGHT_M]...
set -eu
BUILD=${BUILD:-build}
. "$(dirname "$0")/../demo/common.sh"
OUT=$1; shift
mkdir -p "$OUT"
: >"$OUT/lines"
for item in "$@"; do
	model=${item%%=*}; height=${item#"$model"}; height=${height#=}
	name=$(basename "$model" | tr 'A-Z' 'a-z' | sed 's/[^a-z0-9]/-/g')
	dir=$OUT/$name
	mkdir -p "$dir"
	jq -n --arg model "$(realpath "$model")" --argjson height "${height:-0}" '{name: "one",
		plants: {it: ({model: $model} + if $height > 0 then {height_m: $height} else {} end)},
		instances: [{plant: "it", at: [0, 0, 0]}]}' >"$dir/scene.json"
	if ! "$BUILD/ecopack" make "$dir/scene.json" -o "$dir/one.eco" >"$dir/make.log" 2>&1; then
		echo "$name: refused: $(tail -n 1 "$dir/make.log")"
		continue
	fi
	"$BUILD/ecopack" info "$dir/one.eco" --json >"$dir/info.json"
	# eight views around, the plant's bounding sphere inside the picture
	jq '.plants[0] as $p | ($p.radius_m / 0.2588 * 1.02) as $d | $p.center_m as $c |
		{fps: 1, keyframes: [range(8) as $i | ($i * 0.785398 + 0.1) as $a | (0.15 + 0.1 * $i) as $e | {time_s: $i,
		 eye: [$c[0] + $d * ($e | cos) * ($a | cos), $c[1] + $d * ($e | cos) * ($a | sin), $c[2] + $d * ($e | sin)],
		 target: $c, up: [0, 0, 1], fov_y_deg: 30}]}' "$dir/info.json" >"$dir/camera.json"
	serve "$dir/serve.log" "one=$dir/one.eco"
	"$BUILD/ecoview" "$BASE/v1/scenes/one" --camera "$dir/camera.json" --size 512x512 --vertices 9223372036854775807 --reference=cpu \
		-o "$dir/frames" >"$dir/view.log" 2>&1 || die "$name: $(tail -n 1 "$dir/view.log")"
	stop_serving
	scale=$(jq -r '.plants[0].scale' "$dir/info.json"); foot=$(jq -r '.plants[0].foot | map(tostring) | join(",")' "$dir/info.json")
	"$BUILD/bench/source_check" "$model" "$scale" "$foot" "$dir/camera.json" "$dir/frames" >"$dir/check.log" 2>&1 && rc=0 || rc=$?
	[ $rc = 3 ] && { cat "$dir/check.log"; continue; }
	[ $rc = 0 ] || die "$(tail -n 1 "$dir/check.log")"
	q=$(sed -n 's/.*least Q //p' "$dir/check.log")
	jq -c --arg name "$name" --argjson q "$q" '.plants[0] | {model: $name, q_min: $q, triangles_in, triangles_stored, dropped,
		adds_up: (.triangles_in == .triangles_stored + ([.dropped[]] | add)), grid_bits}' "$dir/info.json" | tee -a "$OUT/lines"
done
jq -s . "$OUT/lines" >"$OUT/fidelity.json"
rm -f "$OUT/lines"
