#!/bin/sh
# The client in a browser holds and draws what ecoview does: tests/client/web/compare.mjs says how it is compared, here are the scenes and
# views. Skipped (77) where `make web` was not run since what it is made of changed, or in part where there is no Chromium.
set -u
dir=build/tmp/test_web
fail() { echo "test_web: $*"; exit 1; }
skip() { echo "test_web: skipped: $*"; exit 77; }

command -v node >/dev/null || skip "there is no node; make web installs it"
${MAKE:-make} --no-print-directory -q web-site 2>/dev/null || skip "make web was not run, or not since its sources changed"
chromium=$(command -v chromium || command -v chromium-browser || true)
rm -rf "$dir"
mkdir -p "$dir"

make_scene() { # NAME PLANTS
	"$BUILD/ecopack" generate "$1" -o "$dir/$1" --plants "$2" --quiet >/dev/null || fail "generate $1"
	"$BUILD/ecopack" make "$dir/$1/scene.json" -o "$dir/$1.eco" --quiet || fail "make $1"
}
make_scene city 20
make_scene meadow 12
"$BUILD/ecoserve" --listen 127.0.0.1:0 --viewer build/web/site "city=$dir/city.eco" "$dir/meadow.eco" >"$dir/ready" &
server=$!
trap 'kill $server 2>/dev/null' EXIT
for _ in $(seq 100); do grep -q ready "$dir/ready" && break; sleep 0.1; done
url=$(sed -n 's/.*ready on \([^ ]*\) .*/\1/p' "$dir/ready")
[ -n "$url" ] || fail "ecoserve did not start"

# near, across and from above, in turns about the middle of the scene's bounds
for scene in city meadow; do
	curl -s "$url/v1/scenes/$scene" | jq '.bounds as {$low, $high} | [range(3) | ($low[.] + $high[.]) / 2] as $m
		| ([range(2) | $high[.] - $low[.]] | max) as $size
		| {fps: 1, keyframes: [[0.9, -0.2, 0.3], [-0.1, 0.3, 0.06], [0.3, 0.5, 0.9]] | to_entries | map({time_s: .key, fov_y_deg: 45,
			target: $m, eye: [$m[0] + .value[0] * $size, $m[1] + .value[1] * $size, $m[2] + .value[2] * $size + 1]})}' \
		>"$dir/$scene.json" || fail "no camera for $scene"
	"$BUILD/ecoview" "$url/v1/scenes/$scene" --camera "$dir/$scene.json" --size 320x240 --vertices 30000 --reference=egl --digest \
		-o "$dir/$scene-out" >"$dir/said" || fail "ecoview $scene"
	mv "$dir/said" "$dir/$scene-out/said"
	# masks of cards cut by textures differ by more than leaves' do (lod/EXPERIMENTS.md, The client in a browser)
	case $scene in city) masks= ;; *) masks=$chromium ;; esac
	node tests/client/web/compare.mjs "$url/v1/scenes/$scene" "$dir/$scene.json" 320x240 30000 build/web/site "$dir/$scene-out" $masks \
		|| fail "$scene differs"
done
# the page, and that ecoview replays what it recorded
if [ -n "$chromium" ]; then
	reload="cp $dir/meadow.eco $dir/next.eco && mv $dir/next.eco $dir/city.eco && kill -HUP $server"
	node tests/client/web/viewer.mjs "$url/v1/scenes/city" "$chromium" "$dir/city/plants.csv" "$dir/recorded.json" "$reload" \
		|| fail "the viewer"
	"$BUILD/ecoview" "$url/v1/scenes/city" --camera "$dir/recorded.json" --size 64x48 --vertices 3000 --glb \
		--sun 2026-06-21T18:00Z -o "$dir/recorded" >/dev/null \
		&& [ -s "$dir/recorded/frame-0001.png" ] && [ -s "$dir/recorded/frame-0001.glb" ] || fail "ecoview does not replay what the viewer recorded"
fi
[ -n "$chromium" ] || skip "no Chromium: only hashes were compared, in node; make deps-web installs it"
