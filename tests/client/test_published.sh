#!/bin/sh
# A published folder: its planner answers as ecoserve does, byte by byte (tests/client/web/published.mjs), and a browser shows it
# from hosts of plain files, nginx as server/publish/nginx.conf has it among them (published_page.mjs). Skipped (77) where
# `make web` was not run since what it is made of changed, or in part where there is no Chromium.
set -u
dir=build/tmp/test_published
fail() { echo "test_published: $*"; exit 1; }
skip() { echo "test_published: skipped: $*"; exit 77; }
. tests/support/nginx.sh

command -v node >/dev/null || skip "there is no node; make web installs it"
${MAKE:-make} --no-print-directory -q web-site 2>/dev/null || skip "make web was not run, or not since its sources changed"
chromium=$(command -v chromium || command -v chromium-browser || true)
rm -rf "$dir"
mkdir -p "$dir/nginx"
for scene in city:20 park:20 forest:3000; do
	name=${scene%:*}
	"$BUILD/ecopack" generate "$name" -o "$dir/$name" --plants "${scene#*:}" --quiet >/dev/null || fail "generate $name"
	"$BUILD/ecopack" make --draft "$dir/$name/scene.json" -o "$dir/$name.eco" --quiet || fail "make $name"
done
# rows without the inventory's name, whose columns are all published: then answers about plants are ecoserve's, too
printf 'x,y,kind,height,health,owner\n1,1,cards-1,4,good,Anna Geheim\n5,1,cards-2,,poor,\n9,3,cards-1,6,good,\n' >"$dir/park/trees.csv"
plants=$(jq -c '.plants | to_entries[:1] | from_entries' "$dir/park/scene.json") plant=$(jq -r '.plants | keys_unsorted[0]' "$dir/park/scene.json")
echo "{\"plants\": $plants, \"crs\": \"EPSG:32632\", \"origin\": [0, 0, 0], \"instances\": [{\"from\": \"trees.csv\", \"crs\": \"EPSG:32632\",
	\"x\": \"x\", \"y\": \"y\", \"species\": \"kind\", \"map\": {\"*\": \"$plant\"},
	\"tint\": {\"column\": \"health\", \"palette\": \"health\"}}]}" >"$dir/park/trees.json"
"$BUILD/ecopack" make --draft "$dir/park/trees.json" --no-rows --columns health,height -o "$dir/trees.eco" --quiet || fail "make trees"
"$BUILD/ecopack" publish "$dir/trees.eco" --columns health,height --viewer build/web/site -o "$dir/rows" --quiet || fail "publish rows"
# two saved views of a scene of its own
view='"eye": [60, -40, 30], "target": [0, 0, 5], "fov_y_deg": 45'
echo "{\"fps\": 1, \"keyframes\": [{\"time_s\": 0, $view}, {\"time_s\": 6, $view}]}" >"$dir/views.json"
"$BUILD/ecopack" publish "$dir/city.eco" --views "$dir/views.json" --viewer build/web/site -o "$dir/site" --quiet || fail "publish"
"$BUILD/ecopack" publish "$dir/city.eco" "$dir/park.eco" "$dir/forest.eco" --viewer build/web/site -o "$dir/site" --quiet \
	|| fail "publish again"
[ "$(echo "$dir"/site/city/*/first-*.bin | wc -w)" -eq 3 ] || fail "two saved views are $(echo "$dir"/site/city/*/first-*.bin)"
echo mine >"$dir/index.html"
"$BUILD/ecopack" publish "$dir/city.eco" --viewer build/web/site -o "$dir" 2>/dev/null && fail "another page was replaced"
[ "$(cat "$dir/index.html")" = mine ] || fail "another page was replaced"
for file in city/*/first-0.bin city/*/first-1.bin forest/*/index.bin park/scene.json; do
	[ -s "$dir/site/"$file ] || fail "there is no $file"
done
[ -z "$(find "$dir/site" -name '*.mjs' -o -name '*.tmp-*')" ] || fail "files that are none of a published folder"
grep -c . "$dir/site/index.html" >/dev/null && ! grep -rqs '\.mjs' "$dir/site/index.html" "$dir/site/viewer" || fail "the page names .mjs"

"$BUILD/ecoserve" --listen 127.0.0.1:0 --viewer build/web/site "$dir/city.eco" "$dir/park.eco" "$dir/forest.eco" "$dir/trees.eco" >"$dir/ready" &
server=$!
proxy=
trap 'kill $server $proxy 2>/dev/null' EXIT
for _ in $(seq 200); do grep -q ready "$dir/ready" && break; sleep 0.1; done
url=$(sed -n 's/.*ready on \([^ ]*\) .*/\1/p' "$dir/ready")
[ -n "$url" ] || fail "ecoserve did not start"
node tests/client/web/published.mjs build/web/site "$dir/site" "$url/v1/scenes/city" "$url/v1/scenes/park" \
	"$url/v1/scenes/forest" || fail "the planner differs from ecoserve"
node tests/client/web/published.mjs build/web/site "$dir/rows" "$url/v1/scenes/trees" || fail "published rows differ from ecoserve's"

port=$(free_port)
if command -v nginx >/dev/null; then
	nginx_start "$PWD/$dir/nginx" "include /etc/nginx/mime.types; $(sed "s|/srv/trees;|$PWD/$dir/site;|; s|listen 80;|listen 127.0.0.1:$port;|" \
		server/publish/nginx.conf)"
else
	python3 -m http.server "$port" --bind 127.0.0.1 -d "$dir/site" >/dev/null 2>&1 &
	proxy=$!
fi
page=http://127.0.0.1:$port
for _ in $(seq 100); do curl -sf -o /dev/null "$page/" && break; sleep 0.1; done
if command -v nginx >/dev/null; then
	asked() { curl -s -o "$dir/got" -D - "$@" | tr -d '\r' | tr 'A-Z' 'a-z'; }
	chunks=$(cd "$dir/site" && echo city/*/chunks.bin) wasm=$(cd "$dir/site" && echo viewer/*/eco_planner.wasm)
	asked -H 'Range: bytes=10-19' "$page/$chunks" | grep -q '^http/1.1 206' && [ "$(wc -c <"$dir/got")" -eq 10 ] || fail "nginx: no Range"
	asked -H 'Accept-Encoding: gzip' "$page/$wasm" | grep -q '^content-encoding: gzip' || fail "nginx: the planner is not compressed"
	[ "$(wc -c <"$dir/got")" -lt 135000 ] || fail "the planner has $(wc -c <"$dir/got") bytes"
	asked "$page/$chunks" | grep -q '^cache-control: .*immutable' || fail "nginx: chunks are asked for again"
	asked "$page/${chunks%chunks.bin}first-1.bin" | grep -q '^cache-control: no-cache' || fail "nginx: saved views are kept"
	asked "$page/" | grep -q '^cache-control: no-cache' || fail "nginx: the page is kept"
fi
[ -n "$chromium" ] || skip "no Chromium: only bodies were compared, in node; make deps-web installs it"
node tests/client/web/published_page.mjs "$chromium" "$page/" 'scene=city&eye=60,-40,30&target=0,0,5' "$dir/page.png" || fail "the page"
