#!/bin/sh
# Rows of inventories in packs: from tables, through make and link, to what the server says of each plant; two species share a model, a model stands
# for a code that the map has not, and for a row that states none.
set -u
dir=$(mktemp -d)
trap 'jobs -p >"$dir/jobs"; kill $(cat "$dir/jobs") 2>/dev/null; rm -rf "$dir"' EXIT     # dash knows no jobs in $(...)
fail() { echo "test_rows_kept: $*"; exit 1; }
BUILD=$(realpath "$BUILD")
cd "$dir" || exit 1

# titles before the names, a row of two lines, one without a place; a name in capitals, one with a control character that is cut at 255 bytes
cat >a.csv <<'CSV'
Trees of the town
x,y,kind,height,notes
1,1,oak,4,
,,oak,4,no place
3,1,ash,3,"two
lines"
5,1,elm,3,
13,1,cards-3,3,
15,1,NA,3,
17,1,OAK,4,
CSV
long=$(printf 'T\303\251lla %0248d' 0)
printf '19,1,T\303\251lla\001%s\303\251,4,\n' "${long#* }" >>a.csv
echo '{"type": "FeatureCollection", "features": [
	{"type": "Feature", "properties": {"kind": "ash"}, "geometry": {"type": "Point", "coordinates": [7, 3]}},
	{"type": "Feature", "properties": {"kind": "oak"}, "geometry": {"type": "Point", "coordinates": [9, 3]}}]}' >b.geojson
printf 'v -0.5 0 0\nv 0.5 0 0\nv 0.5 1 0\nv -0.5 1 0\nv 0 0 -0.5\nv 0 0 0.5\nv 0 1 0.5\nv 0 1 -0.5\nf 1 2 3\nf 1 3 4\nf 5 6 7\nf 5 7 8\n' >board.obj
plants='"oak": {"model": "board.obj"}, "ash": {"model": "board.obj"}, "elm": {"model": "board.obj", "height_m": 3}'
echo "{\"plants\": {$plants}, \"instances\": [{\"plant\": \"ash\", \"at\": [11, 1]},
	{\"from\": \"a.csv\", \"crs\": \"EPSG:32632\", \"x\": \"x\", \"y\": \"y\", \"species\": \"kind\",
		\"map\": {\"oak\": \"oak\", \"ash\": \"ash\", \"*\": \"elm\"}, \"height_m\": {\"column\": \"height\", \"unit\": \"m\"}}]}" >a.json
echo "{\"plants\": {\"ash\": {\"model\": \"board.obj\"}, \"oak\": {\"model\": \"board.obj\"}}, \"instances\": [
	{\"from\": \"b.geojson\", \"species\": \"kind\", \"crs\": \"EPSG:32632\"}], \"crs\": \"EPSG:32632\", \"origin\": [0, 0, 0]}" >b.json
sed 's/^{/{"crs": "EPSG:32632", "origin": [0, 0, 0], /' a.json >a1.json && mv a1.json a.json
echo '{"crs": "EPSG:32632", "origin": [0, 0, 0], "children": [{"eco": "a.json", "at": [0, 0]}, {"eco": "b.json", "at": [0, 0]}]}' >both.json

make() { "$BUILD/ecopack" make "$@" --draft --no-cache -q || fail "make $*"; }
make a.json -o a.eco
make b.json -o b.eco
make both.json -o both.eco
make both.json --no-rows -o bare.eco
mkdir linked && "$BUILD/ecopack" link a.eco b.eco -o linked/both.eco -q || fail "link"
cmp both.eco linked/both.eco || fail "the linked pack is not that of a scene that nests its parts"
for scene in a b both; do
	make $scene.json --season winter -o winter-$scene.eco
done
mkdir winter && "$BUILD/ecopack" link winter-a.eco winter-b.eco -o winter/both.eco -q && cmp winter-both.eco winter/both.eco || fail "link of winters"
"$BUILD/ecopack" verify both.eco -q || fail "verify"

# a drawing's bytes do not depend on rows: all chunks but those of rows are the same, and streams have no other
mkfifo said
"$BUILD/ecoserve" --listen 127.0.0.1:0 both=both.eco bare=bare.eco >said &
read -r said <said
base=$(echo "$said" | sed -n 's/.*ready on \([^ ]*\) .*/\1/p')/v1/scenes
ask() { curl -sS "$base/$1"; }
view='eye=5,-9,3&target=5,0,1&width=160&height=120&vertices=1000'
for scene in both bare; do
	ask "$scene/stream?$view" >"$scene.stream"
	ask "$scene/plan?$view" | jq -c '{cuts, bytes, chunk_bytes}' >"$scene.plan"
	lists=$(ask "$scene/plan?$view" | jq '.runs[] | range(.list_first; .list_end)')
	for list in $lists; do
		ask "$scene/plants/$list"
	done | jq -c '.plants[]' | sort >"$scene.rows"
done
[ "$(wc -c <both.stream)" = "$(wc -c <bare.stream)" ] || fail "rows are paid for in a stream"
cmp both.plan bare.plan || fail "rows change a plan"
cat >want <<'ROWS'
{"species":"ash","plant":"ash","file":"a.csv","row":3,"line":5}
{"species":"ash","plant":"ash","file":"b.geojson","row":1}
{"species":"ash","plant":"ash"}
{"species":"elm","plant":"elm","file":"a.csv","row":4,"line":7}
{"species":"cards-3","plant":"elm","file":"a.csv","row":5,"line":8}
{"species":null,"plant":"elm","file":"a.csv","row":6,"line":9}
{"species":"OAK","plant":"ash","file":"a.csv","row":7,"line":10}
{"species":"oak","plant":"ash","file":"a.csv","row":1,"line":3}
{"species":"oak","plant":"ash","file":"b.geojson","row":2}
ROWS
echo "{\"species\":\"$long\",\"plant\":\"elm\",\"file\":\"a.csv\",\"row\":8,\"line\":11}" >>want
sort want | cmp - both.rows || fail "other rows: $(cat both.rows)"
jq -c 'select(.species | IN("oak", "ash", "elm")) |= del(.file, .row, .line)
	| select(.file) |= {species: (if .species == "OAK" then "oak" else "elm" end), plant}' want | sort | cmp - bare.rows ||
	fail "not the bare species: $(cat bare.rows)"
grep -q 'a\.csv\|b\.geojson' bare.eco && fail "--no-rows leaves a name of a file"
grep -q 'cards-3\|OAK' bare.eco && fail "--no-rows leaves what a row states"

# of each plant of the pack the species that it stands for, the commonest first
ask both/species | jq -c '.plants[] | [.plant, .species_count, (.species | map([.species, .plants])[])]' >kinds
printf '%s\n' '["ash",3,["ash",3],["oak",2],["OAK",1]]' "[\"elm\",4,[null,1],[\"$long\",1],[\"cards-3\",1],[\"elm\",1]]" | cmp - kinds || fail "other species: $(cat kinds)"
ask bare/species | jq -c '.plants[] | [.plant, (.species | map([.species, .plants])[])]' >kinds
printf '%s\n' '["ash",["ash",3],["oak",3]]' '["elm",["elm",4]]' | cmp - kinds || fail "other species of the bare: $(cat kinds)"

# 3D Tiles have the plants' own species, too
"$BUILD/ecopack" export both.eco --3dtiles tiles --plain -q || fail "export"
[ "$(cat tiles/tiles/*.bin | grep -ao 'ash\|elm\|oak\|cards-3\|OAK' | LC_ALL=C sort | uniq -c | xargs)" = '1 OAK 3 ash 1 cards-3 1 elm 2 oak' ] || fail "other species in 3D Tiles"

# as ecopack map has them
"$BUILD/ecopack" map both.json -o map.geojson -q || fail "map"
jq -c '.features[].properties | {species, file, row, line} | with_entries(select(.key == "species" or .value))' map.geojson | sort >map.rows
jq -c 'del(.plant)' both.rows | sort | cmp - map.rows || fail "not as in the map: $(cat map.rows)"
[ "$(jq -c '[.features[].properties | .plant] | group_by(.) | map([.[0], length])' map.geojson)" = '[["ash",3],["elm",4],["oak",3]]' ] ||
	fail "other plants in the map"
# columns: none unless they are named, and of those that a pack has only those that are named again are published; no owner's name is left
# where it was not. A part without columns is linked to one that has some
printf 'x,y,kind,height,dbh,owner,health\n1,1,oak,4,,Anna Geheim,good\n3,1,ash,,30,Bernd Privat,\n' >c.csv
echo "{\"date\": \"May 2026\", \"plants\": {$plants}, \"crs\": \"EPSG:32632\", \"origin\": [0, 0, 0], \"instances\": [
	{\"from\": \"c.csv\", \"crs\": \"EPSG:32632\", \"x\": \"x\", \"y\": \"y\", \"species\": \"kind\", \"map\": {\"oak\": \"oak\", \"*\": \"ash\"},
	\"height_m\": [{\"column\": \"height\", \"unit\": \"m\"}, {\"from_dbh_cm\": \"dbh\", \"max\": 30, \"rate\": 0.02}]}]}" >c.json
make c.json -o plain.eco
make c.json --columns health,owner -o owners.eco
make c.json --columns health --no-rows -o health.eco
"$BUILD/ecopack" make c.json --columns nothing -o no.eco --draft -q 2>err && fail "a column that no inventory has"
grep -q 'no inventory of the scene has a column "nothing"' err || fail "a missing column: $(cat err)"
for names in '' 'health,' "$(printf 'h\377')" a,b,c,d,e,f,g,h,i; do
	"$BUILD/ecopack" make c.json --columns "$names" -o no.eco --draft -q 2>err && fail "--columns '$names'"
	grep -q 'must be 1 to 8 names of columns' err || fail "--columns '$names': $(cat err)"
done
grep -aq Geheim plain.eco health.eco && fail "an owner's name in a pack that was made without"
grep -aq 'Anna Geheim' owners.eco || fail "the owners' column is not in the pack"
mkdir viewer && printf '<meta charset="utf-8">\n' >viewer/index.html && gzip -k viewer/index.html && cp viewer/index.html.gz viewer/index.html.br
"$BUILD/ecopack" publish t=owners.eco -o none --viewer viewer -q || fail "publish"
"$BUILD/ecopack" publish t=owners.eco -o some --viewer viewer --columns health -q || fail "publish --columns"
"$BUILD/ecopack" publish t=health.eco -o more --viewer viewer --columns owner -q 2>err && fail "a column that the pack has not"
grep -q 'have no column "owner"' err || fail "a missing column: $(cat err)"
grep -raq 'Geheim\|Privat\|c\.csv' none some && fail "a published folder names owners, or the inventory"
grep -aq good none/t/*/chunks.bin && fail "a column is published that nobody named"
grep -aq good some/t/*/chunks.bin && grep -q '"columns":\["health","height_from","crown_from"\]' some/t/scene.json || fail "the named column is not published"
mkdir linked2 && "$BUILD/ecopack" link a.eco owners.eco -o linked2/all.eco -q || fail "link with columns"
mkfifo said2
"$BUILD/ecoserve" --listen 127.0.0.1:0 health=health.eco all=linked2/all.eco >said2 &
read -r said <said2
base=$(echo "$said" | sed -n 's/.*ready on \([^ ]*\) .*/\1/p')/v1/scenes
[ "$(ask health | jq -r .date)" = 'May 2026' ] || fail "the date is not said"
ask 'health/find?text=GOOD' | jq -c '[.plants[] | .species, .cells]' >found
ask 'all/find?text=privat' | jq -c '[.plants[] | .species, .file, .row, .cells]' >>found
printf '%s\n' '["oak",["good",null,"the model"]]' '["ash","c.csv",2,[null,"Bernd Privat","trunk diameter","the model"]]' | cmp - found ||
	fail "other cells: $(cat found)"
echo "ok: rows are kept, and are those of the tables"
