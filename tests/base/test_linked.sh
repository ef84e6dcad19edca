#!/bin/sh
# ecoserve links nothing of import, build, raster, ecopack, generate, scene or a method that only measurements run: no function or variable of
# theirs is in it, by nm. BUILD is the folder of the programs. Prints what failed; status 0 when nothing did.
set -u
BUILD=${BUILD:-build}
DIR=build/tmp/linked-sh-$$
failed=0
mkdir -p "$DIR"
trap 'rm -rf "$DIR"' EXIT

complain() { echo "test_linked: $*"; failed=1; }

# Names of functions and variables: in objects those for other files, in a program all, as the linker has made them its own. What begins with
# an underscore or a dot is the compiler's.
of_objects() { nm --defined-only "$@" 2>/dev/null | awk 'NF == 3 && $2 ~ /^[TDBRVWC]$/ && $3 !~ /^[_.]/ { print $3 }' | LC_ALL=C sort -u; }
of_program() { nm --defined-only "$1" | awk 'NF == 3 && toupper($2) ~ /^[TDBRVWC]$/ && $3 !~ /^[_.]/ { print $3 }' | LC_ALL=C sort -u; }

of_objects "$BUILD"/obj/server.a "$BUILD"/obj/lod.a "$BUILD"/obj/lod-plan.a "$BUILD"/obj/ecofiles-format.a "$BUILD"/obj/ecofiles-base.a >"$DIR/ours"
for room in ecofiles/import/model ecofiles/import/ground ecofiles/import/places ecofiles/import/track ecofiles/scene ecofiles/generate \
	ecofiles/ecopack lod/build lod/raster; do
	find "$BUILD/obj/$room" -name '*.o' | xargs nm --defined-only >"$DIR/one" 2>/dev/null
	[ "$(grep -c ' T ' "$DIR/one")" -ge 3 ] || complain "$room defines nothing: is it built?"
done
# baselines are linked into ecobench and tests as they are
find "$BUILD"/obj/ecofiles/import "$BUILD"/obj/ecofiles/scene "$BUILD"/obj/ecofiles/generate "$BUILD"/obj/ecofiles/ecopack "$BUILD"/obj/lod/build \
	"$BUILD"/obj/lod/raster "$BUILD"/obj/tests/bench/baseline -name '*.o' ! -name 'main_*' 2>/dev/null >"$DIR/objects"
of_objects $(cat "$DIR/objects") | LC_ALL=C comm -23 - "$DIR/ours" >"$DIR/foreign"
of_program "$BUILD/ecoserve" >"$DIR/server"
of_program "$BUILD/ecopack" >"$DIR/ecopack"
LC_ALL=C comm -12 "$DIR/server" "$DIR/foreign" >"$DIR/stray"
[ ! -s "$DIR/stray" ] || complain "ecoserve links $(wc -l <"$DIR/stray") that it may not: $(head -n 5 "$DIR/stray" | paste -sd ' ')"

# and that would be seen: what should be there is, and ecopack has of all that ecoserve has not
for name in srv_daemon_start eco_pack_open; do grep -qx "$name" "$DIR/server" || complain "nm does not find $name in ecoserve"; done
for name in make_pack eco_generate eco_model_import lod_plant_build; do
	grep -qx "$name" "$DIR/foreign" || complain "$name is not among what ecoserve may not link"
	grep -qx "$name" "$DIR/ecopack" || complain "nm does not find $name in ecopack"
done
exit $failed
