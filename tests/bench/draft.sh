#!/bin/sh
# CPU of `ecopack make --draft` at the limits of a first look: draft.sh [FOLDER] makes in FOLDER (build/bench/draft) a scene of twenty
# models of together half a million triangles, 20 MB of textures and 100,000 plants from a table, all generated, then packs a draft on one
# thread and prints its processor seconds by stage. BUILD is the folder of the programs, bench/paint among them (make build/bench/paint), RUNS
# how many drafts; AS="--draft --jobs 1" are make's options.
set -eu
BUILD=${BUILD:-build}
OUT=${1:-$BUILD/bench/draft}
PACK=$BUILD/ecopack
MODELS="oak beech birch linden maple spruce pine palm shrub azalea sunflower fern grass turf poppy daisy cornflower cards-1 cards-2 cards-3"

# The first material of a model becomes a photographed one; models without texture coordinates get planar ones.
photograph() {
	awk -v image="$1.jpg" '{ print } /^newmtl/ && !done { print "map_Kd " image; done = 1 }' "$2/$1.mtl" >"$OUT/models/$1.mtl"
	awk 'FNR == NR { textured = textured || /^vt / ; next } textured { print; next }
		/^v / { print; print "vt", $2 + $4 / 2, $3; next } /^f / { for (i = 2; i <= NF; i++) $i = $i "/" $i } { print }' \
		"$2/$1.obj" "$2/$1.obj" >"$OUT/models/$1.obj"
	"$BUILD/bench/paint" "$OUT/models/$1.jpg" "${SIDE:-1570}" "$3"
}

models() {
	mkdir -p "$OUT/models" "$OUT/plain" "$OUT/scenes"
	for scene in forest outdoor palms sunflowers park city; do
		"$PACK" generate $scene -o "$OUT/scenes/$scene" --plants 10 --detail "${DETAIL:-4.45}" --quiet
		cp "$OUT/scenes/$scene/models"/* "$OUT/plain"
	done
	cp "$OUT/plain"/*.png "$OUT/models"
	seed=0
	for model in $MODELS; do
		photograph $model "$OUT/plain" $((seed += 1))
	done
}

plants() {
	echo x,y,kind
	awk -v models="$MODELS" 'BEGIN { count = split(models, name, " "); for (i = 0; i < 100000; i++) {
		a = 2.399963 * i; r = 2 * sqrt(i); printf "%.2f,%.2f,%s\n", r * cos(a), r * sin(a), name[i * 7919 % 100003 % count + 1] } }'
}

scene() {
	printf '{ "name": "draft", "plants": {'
	separator=
	for model in $MODELS; do
		printf '%s\n\t"%s": {"model": "models/%s.obj", "unit": "m"}' "$separator" $model $model
		separator=,
	done
	printf '},\n\t"instances": [{"from": "plants.csv", "x": "x", "y": "y", "species": "kind", "seed": 1, "map": {'
	separator=
	for model in $MODELS; do
		printf '%s"%s": "%s"' "$separator" $model $model
		separator=,
	done
	printf '}}] }\n'
}

[ -f "$OUT/scene.json" ] || {
	models
	plants >"$OUT/plants.csv"
	scene >"$OUT/scene.json"
}
triangles=$(awk '/^f / { sum += NF - 3 } END { print sum }' "$OUT"/models/*.obj)
textures=$(cat "$OUT"/models/*.jpg "$OUT"/models/*.png | wc -c)
echo "20 models of $triangles triangles, $textures bytes of textures, 100,000 plants; load $(cut -d' ' -f1 /proc/loadavg)"
for run in $(seq "${RUNS:-1}"); do
	"$PACK" make ${AS:---draft --jobs 1} --no-cache --times --quiet "$OUT/scene.json" -o "$OUT/draft.eco" |
		awk '$NF == "MB" { sum += $(NF - 3) } { print } END { printf "%-32s %7.2f s\n", "together", sum }'
done
