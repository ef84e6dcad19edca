#!/bin/sh
# The client in a browser holds and draws what ecoview does: tests/client/web/compare.mjs says how it is
# compared, here are the scenes and views. Skipped (77) where `make web` was not run since what it is made of
# changed, or in part where there is no Chromium.
set -u
dir=build/tmp/test_web
fail() { echo "test_web: $*"; exit 1; }
skip() { echo "test_web: skipped: $*"; exit 77; }
. tests/support/nginx.sh

command -v node >/dev/null || skip "there is no node; make web installs it"
${MAKE:-make} --no-print-directory -q web-site 2>/dev/null \
	|| skip "make web was not run, or not since its sources changed"
chromium=$(command -v chromium || command -v chromium-browser || true)
rm -rf "$dir"
mkdir -p "$dir"

make_scene() { # NAME PLANTS [--draft]
	"$BUILD/ecopack" generate "$1" -o "$dir/source-$1" --plants "$2" --quiet >/dev/null \
		|| fail "generate $1"
	"$BUILD/ecopack" make ${3-} "$dir/source-$1/scene.json" -o "$dir/$1.eco" --quiet || fail "make $1"
}
# a draft has no impostors, which those of a city have
make_scene city 20
# a model stands for species that the map does not have
jq '.instances[0].map = {"cards-1": "cards-1", "*": "cards-2"}' "$dir/source-city/scene.json" >"$dir/source-city/few.json" || fail "no map"
"$BUILD/ecopack" make "$dir/source-city/few.json" -o "$dir/city.eco" --quiet || fail "make few"
make_scene meadow 12 --draft
make_scene park 20 --draft
# a picture on the ground: three grids of numbers as the bands of a virtual raster
lay_picture() { # NAME: of a scene, 600 m a side about its origin
	from=$dir/source-$1
	set -- $(jq -r '.origin // [0, 0] | "\(.[0] - 300) \(.[1] - 300) \(.[1] + 300)"' "$from/scene.json")
	for band in 1:'10 * x' 2:'10 * y' 3:120; do
		awk "BEGIN { print \"ncols 24\\nnrows 24\\nxllcorner $1\\nyllcorner $2\\ncellsize 25\"
			for (y = 0; y < 24; y++) { for (x = 0; x < 24; x++) printf \"%d \", ${band#*:}; print \"\" } }" \
			>"$from/band${band%%:*}.asc"
	done
	{
		echo "<VRTDataset rasterXSize='24' rasterYSize='24'><GeoTransform>$1,25,0,$3,0,-25</GeoTransform>"
		for b in 1:Red 2:Green 3:Blue; do
			echo "<VRTRasterBand dataType='Byte' band='${b%:*}'><ColorInterp>${b#*:}</ColorInterp>" \
				"<SimpleSource><SourceFilename relativeToVRT='1'>band${b%:*}.asc</SourceFilename>" \
				"<SourceBand>1</SourceBand></SimpleSource></VRTRasterBand>"
		done
		echo '</VRTDataset>'
	} >"$from/picture.vrt"
	jq '.ground.image = {file: "picture.vrt"} + (if .crs then {crs} else {} end)' "$from/scene.json" \
		>"$from/picture.json" || fail "no scene with a picture"
}
lay_picture park
"$BUILD/ecopack" make --draft "$dir/source-park/picture.json" -o "$dir/picture.eco" --quiet \
	|| fail "make picture"
# without a CRS, and with an object
mkdir "$dir/source-bare"
printf 'v -0.5 0 0\nv 0.5 0 0\nv 0 1 0\nf 1 2 3\n' >"$dir/source-bare/blade.obj"
echo '{"plants": {"grass": {"model": "blade.obj"}, "wall": {"model": "blade.obj", "object": true}},
	"instances": [{"plant": "grass", "at": [0, 0]}, {"plant": "wall", "at": [0.6, 0.2]}]}' >"$dir/source-bare/scene.json"
"$BUILD/ecopack" make --draft "$dir/source-bare/scene.json" -o "$dir/bare.eco" --quiet 2>/dev/null || fail "make bare"
"$BUILD/ecoserve" --listen 127.0.0.1:0 --viewer build/web/site "bare=$dir/bare.eco" "city=$dir/city.eco" \
	"$dir/meadow.eco" "$dir/park.eco" "dusk=$dir/park.eco" "kinds=$dir/meadow.eco" "picture=$dir/picture.eco" \
	"shade=$dir/picture.eco" >"$dir/ready" &
server=$!
proxy=
trap 'kill $server $proxy 2>/dev/null' EXIT
for _ in $(seq 100); do grep -q ready "$dir/ready" && break; sleep 0.1; done
url=$(sed -n 's/.*ready on \([^ ]*\) .*/\1/p' "$dir/ready")
[ -n "$url" ] || fail "ecoserve did not start"

# seven views of each: near, across, from above, and from among the plants; places in turns of the scene's
# size about its middle
look_at() { # NAME VERTICES [OPTIONS: the layer's, which are ecoview's but for the sun]
	jq -n "{samples: 1} + ${3-{\}}" >"$dir/$1.options"
	options=$(jq -r 'if .sun then .sun |= todate else . end
		| to_entries[] | "--\(.key) \(.value)"' "$dir/$1.options")
	curl -s "$url/v1/scenes/$1" | jq '.bounds as {$low, $high}
		| [range(3) | ($low[.] + $high[.]) / 2] as $m
		| ([range(2) | $high[.] - $low[.]] | max) as $size
		| {fps: 1, keyframes: [[0.9, -0.2, 0.3], [-0.1, 0.3, 0.06], [0.3, 0.5, 0.9], [-0.6, -0.4, 0.1],
			[0.02, 0.05, 3], [0.15, -0.1, 0.02], [-2, 3, 1]] | to_entries
			| map({time_s: .key, fov_y_deg: 45, target: $m, eye: [$m[0] + .value[0] * $size,
				$m[1] + .value[1] * $size, $m[2] + .value[2] * $size + 1]})}' >"$dir/$1.json" \
		|| fail "no camera for $1"
	mkdir "$dir/$1"
	"$BUILD/ecoview" "$url/v1/scenes/$1" --camera "$dir/$1.json" --size 320x240 --vertices "$2" --shadows no \
		$options --owners --digest -o "$dir/$1" >"$dir/$1/said" || fail "ecoview $1"
}
look_at city 30000 '{"shadows": "perspective", "samples": 16}'
look_at meadow 100000 '{"shadows": "standard"}'
look_at dusk 100000 '{"haze": 200, "sun": 1782067500}'
look_at kinds 30000 '{"tint": "kind"}'
look_at park 300000
look_at picture 100000
look_at shade 300000 '{"shadows": "perspective", "sun": 1782050400, "samples": 16}'
node tests/client/web/compare.mjs "$dir" build/web/site "$chromium" "$url/v1/scenes/city" \
	"$url/v1/scenes/meadow" "$url/v1/scenes/park" "$url/v1/scenes/picture" \
	"$url/v1/scenes/dusk" "$url/v1/scenes/kinds" "$url/v1/scenes/shade" \
	|| fail "the browser differs from ecoview"
# the page, and that ecoview replays what it recorded
if [ -n "$chromium" ]; then
	below=
	if command -v nginx >/dev/null; then
		mkdir "$dir/nginx"
		port=$(free_port)
		nginx_start "$PWD/$dir/nginx" "server { listen 127.0.0.1:$port; location /trees/ { proxy_pass $url/; } }"
		below=http://127.0.0.1:$port/trees/
		for _ in $(seq 100); do curl -sf -o /dev/null "$below" && break; sleep 0.1; done
	fi
	reload="cp $dir/meadow.eco $dir/next.eco && mv $dir/next.eco $dir/city.eco && kill -HUP $server"
	node tests/client/web/viewer.mjs "$url/v1/scenes/city" "$chromium" "$dir/source-city/plants.csv" \
		"$dir/recorded.json" "$reload" $below || fail "the viewer"
	"$BUILD/ecoview" "$url/v1/scenes/city" --camera "$dir/recorded.json" --size 64x48 --vertices 3000 \
		--sun 2026-06-21T18:00Z -o "$dir/recorded" >/dev/null \
		&& [ -s "$dir/recorded/frame-0001.png" ] || fail "ecoview does not replay what the viewer recorded"
fi
[ -n "$chromium" ] || skip "no Chromium: only hashes were compared, in node; make deps-web installs it"
