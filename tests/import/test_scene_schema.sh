#!/bin/sh
# scene.schema.json says of scenes what their reader says: it allows every scene that test_scene reads, that README.md and ecofiles/README.md
# show, that ecopack generate writes and that fuzzing starts from; and it refuses what the reader refuses, but for what a schema cannot say.
# BUILD is the folder of the programs. Prints what failed; status 0 when nothing did.
set -u
BUILD=${BUILD:-build}
DIR=build/tmp/scene-schema-sh-$$
SCHEMA=ecofiles/scene/scene.schema.json
failed=0
mkdir -p "$DIR/kept" "$DIR/generated"
trap 'rm -rf "$DIR"' EXIT

complain() { echo "test_scene_schema: $*"; failed=1; }

SCENES_KEPT=$DIR/kept "$BUILD/tests/test_scene" >"$DIR/log" 2>&1 || complain "test_scene failed: $(tail -n 3 "$DIR/log")"
[ "$(ls "$DIR"/kept/good-*.json | wc -l)" -ge 6 ] && [ "$(ls "$DIR"/kept/bad-*.json | wc -l)" -ge 50 ] || complain "test_scene kept too few scenes"
for name in park forest meadow grove palms sunflowers outdoor billion city; do
	"$BUILD/ecopack" generate $name -o "$DIR/generated/$name" --plants 100 --quiet || complain "generate $name"
	rm -f "$DIR/generated/$name/camera.json"
done
sed -n '/^```json$/,/^```$/{/^```/d;p}' ecofiles/README.md >"$DIR/readme.json"
sed -n 's/^    \({"plants".*\)/\1/p' README.md >"$DIR/smallest.json"
[ -s "$DIR/readme.json" ] && [ -s "$DIR/smallest.json" ] || complain "the READMEs show no scene"

# escapes.json and types.json are what the reader refuses
corpus=$(ls tests/fuzz/corpus/scene/*.json | grep -v '/\(escapes\|types\)\.json$')
tests/support/validate.py $SCHEMA "$DIR"/kept/good-*.json "$DIR"/generated/*/*.json "$DIR/readme.json" "$DIR/smallest.json" $corpus >"$DIR/out" ||
	complain "the schema refuses scenes that are read: $(head -n 5 "$DIR/out")"

# a name that no plant has, a key twice, what depends on another field's value: the reader alone knows
for file in "$DIR"/kept/bad-*.json tests/fuzz/corpus/scene/escapes.json tests/fuzz/corpus/scene/types.json; do echo "$file"; done >"$DIR/bad"
tests/support/validate.py $SCHEMA $(cat "$DIR/bad") >"$DIR/out" && complain "the schema refuses nothing"
for file in $(cat "$DIR/bad"); do
	grep -q "^$file: " "$DIR/out" && continue
	grep -Eq 'is not among "plants"|duplicate|the scene has no CRS|"crs" is missing|a world file|are one species|no habit|no genus of|each has its own|a plant of the library is|breaks need|numbers that ascend|needs "max"|are different signs|no class of the ground is|which the ground does not have' "${file%.json}.says" ||
		complain "the schema allows what the reader refuses: $(cat "${file%.json}.says" "$file")"
done
exit $failed
