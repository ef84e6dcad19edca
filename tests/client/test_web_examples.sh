#!/bin/sh
# The pages of client-min/web/examples as hosts of a scene: tests/client/web/examples.mjs says what is
# looked at. Skipped (77) where `make web-examples` was not run since they changed, or where there is no
# Chromium.
set -u
dir=build/tmp/test_web_examples
fail() { echo "test_web_examples: $*"; exit 1; }
skip() { echo "test_web_examples: skipped: $*"; exit 77; }

${MAKE:-make} --no-print-directory -q web-site examples-site 2>/dev/null \
	|| skip "make web-examples was not run, or not since sources changed"
chromium=$(command -v chromium || command -v chromium-browser) \
	|| skip "there is no Chromium; make deps-web installs it"
rm -rf "$dir"
mkdir -p "$dir"
cp -r build/web/examples "$dir/pages" || fail "no pages"
"$BUILD/ecopack" generate city -o "$dir/city" --plants 20 --quiet >/dev/null \
	&& "$BUILD/ecopack" make "$dir/city/scene.json" -o "$dir/city.eco" --quiet || fail "no city"
rm -f "$dir/pages/basemap.geojson"
"$BUILD/ecopack" map "$dir/city/scene.json" -o "$dir/pages/basemap.geojson" --quiet || fail "no map"
"$BUILD/ecoserve" --listen 127.0.0.1:0 --viewer build/web/site --cors '*' "$dir/city.eco" >"$dir/ready" &
server=$!
trap 'kill $server 2>/dev/null' EXIT
for _ in $(seq 100); do grep -q ready "$dir/ready" && break; sleep 0.1; done
url=$(sed -n 's/.*ready on \([^ ]*\) .*/\1/p' "$dir/ready")
[ -n "$url" ] || fail "ecoserve did not start"
node tests/client/web/examples.mjs "$url/v1/scenes/city" "$dir/pages" "$chromium" "$dir/city/plants.csv" \
	"$dir" \
	|| fail "an example fails"
