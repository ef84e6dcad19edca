#!/bin/sh
# How long it takes to build packs, by stage (processor seconds), and the most memory.
#
#   import.sh MODEL...              each model as a plant of its own
#   import.sh --rows N MODEL...     one scene: N rows of an inventory on the models, 200 m^2 a plant, heights by dbh
set -eu
BUILD=${BUILD:-build}
OUT=$(mktemp -d)
trap 'rm -rf "$OUT"' EXIT
rows=0
if [ "${1-}" = --rows ]; then rows=$2; shift 2; fi
[ $# -gt 0 ] || { sed -n '2,5s/^# \{0,1\}//p' "$0" >&2; exit 2; }

# build NAME: makes $OUT/scene.json and prints a line of the table
build() {
	"$BUILD/ecopack" make "$OUT/scene.json" -o "$OUT/out.eco" --times --quiet >"$OUT/times" 2>"$OUT/log" \
		|| { printf '%-36s %s\n' "$1" "$(tail -n 1 "$OUT/log")"; return; }
	triangles=$("$BUILD/ecopack" info --json "$OUT/out.eco" | jq '[.plants[].triangles] | add')
	awk -v name="$1" -v triangles="$triangles" -v columns="$columns" '
		/ s  *[0-9.]+ s / { for (i = 1; $i !~ /^[0-9.]+$/; i++) stage = i == 1 ? $i : stage " " $i; spent[stage] = $(i + 2) }
		/^built in/ { total = $3; memory = $8 }
		END {
			count = split(columns, column, ",")
			printf "%-36.36s %9d", name, triangles
			for (i = 1; i <= count; i++) printf " %9.2f", spent[column[i]]
			printf " %9.2f %6d MB\n", total, memory
		}' "$OUT/times"
}

# head TITLE...: the first line
head() {
	printf '%-36s %9s' model triangles
	printf ' %9s' "$@"
	printf ' %9s %9s\n' 'total s' memory
}

if [ "$rows" -gt 0 ]; then
	columns='reading models,curves and scales,positions,tiles,summaries,writing'
	head reading curves positions tiles summaries writing
	awk -v rows="$rows" -v plants=$# 'BEGIN { srand(1); side = sqrt(200 * rows); print "x,y,species,dbh_mm"
		for (i = 0; i < rows; i++) printf "%.2f,%.2f,p%d,%d\n", rand() * side, rand() * side, rand() * plants, 20 + 900 * rand() * rand() }' \
		>"$OUT/rows.csv"
	jq -n '{plants: ($ARGS.positional | to_entries | map({key: "p\(.key)", value: {model: .value, height_m: 12}}) | from_entries),
		instances: [{from: "rows.csv", x: "x", y: "y", species: "species", height_m: {from_dbh_mm: "dbh_mm", max: 35, rate: 0.004}}]}' \
		--args $(for model in "$@"; do realpath "$model"; done) >"$OUT/scene.json"
	build "$rows rows"
	exit
fi
columns='reading models,organs and elements,orders,levels lines points,curves and scales,textures,packing plants'
head reading elements orders lists curves textures packing
for model in "$@"; do
	jq -n --arg model "$(realpath "$model")" '{plants: {it: {model: $model}}, instances: [{plant: "it", at: [0, 0, 0]}]}' >"$OUT/scene.json"
	build "$(basename "$model")"
done
