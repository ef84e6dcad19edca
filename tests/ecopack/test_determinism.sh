#!/bin/sh
# Same pack and same plans from lod/ as it is built here and from lod/ without any optimisation: no result hangs on how a compiler rounds, fuses or
# reorders. `make determinism` compares whole builds by other compilers, and under valgrind.
set -eu
BUILD=${BUILD:-build}
out=build/tmp/determinism-$$
trap 'rm -rf "$out"' EXIT INT TERM
mkdir -p "$out"
"$BUILD/ecopack" generate palms --plants 3 --detail 0.1 -o "$out/scene" --quiet >/dev/null
for one in "$BUILD" "$BUILD/o0"; do
	name=$(basename "$one")
	"$one/ecopack" make "$out/scene/scene.json" -o "$out/$name.eco" --order combined --no-cache --quiet >/dev/null
done
cmp "$out/$(basename "$BUILD").eco" "$out/o0.eco"
"$BUILD/bench/plans" "$out/o0.eco" >"$out/plans"
"$BUILD/o0/plans" "$out/o0.eco" >"$out/plans0"
cmp "$out/plans" "$out/plans0"
[ "$(wc -l <"$out/plans")" -eq 96 ]
