#!/bin/sh
# 3D Tiles in other people's programs: tests/ecopack/tiles/viewers.mjs says what is looked at. Skipped (77)
# without them (make tiles-viewers) or without a Chromium.
set -u
dir=build/tmp/test_tiles
modules=build/tiles-viewers/node_modules
fail() { echo "test_tiles: $*"; exit 1; }
skip() { echo "test_tiles: skipped: $*"; exit 77; }

[ -d "$modules" ] || skip "there are no viewers; make tiles-viewers fetches them"
chromium=$(command -v chromium || command -v chromium-browser) || skip "there is no Chromium; make deps-web installs it"
rm -rf "$dir"
mkdir -p "$dir"
"$BUILD/ecopack" generate park -o "$dir/park" --plants 20 --quiet >/dev/null || fail "generate"
"$BUILD/ecopack" make --draft "$dir/park/scene.json" -o "$dir/park.eco" --quiet || fail "make"
"$BUILD/ecopack" export "$dir/park.eco" --3dtiles "$dir/tiles" --quiet || fail "export"
node tests/ecopack/tiles/viewers.mjs "$dir/tiles" "$modules" "$chromium" "$dir/pictures" || fail "a viewer or checker finds fault"
