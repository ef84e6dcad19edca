#!/bin/sh
# Each feature's cost appears only where a scene uses it: sections, attributes, shaders, libraries. The table is that of tests/bench/needs.sh;
# here counts of it are compared, never times. BUILD is the folder of the programs.
set -u
BUILD=${BUILD:-build}
DIR=build/tmp/needs-sh-$$
failed=0
mkdir -p "$DIR"
trap 'rm -rf "$DIR"' EXIT

complain() { echo "test_needs: $*"; failed=1; }

BUILD=$BUILD MAKE_AS=--draft sh tests/bench/needs.sh "$DIR" >"$DIR/table.csv" 2>"$DIR/errors" || { complain "no table: $(tail -n 3 "$DIR/errors")"; exit 1; }

# field SCENE COLUMN
field() { awk -F, -v scene="$1" -v column="$2" '$1 == scene { print $column }' "$DIR/table.csv"; }
# has SCENE COLUMN WORD, lacks SCENE COLUMN WORD
has() { case " $(field "$1" "$2") " in *" $3 "*) ;; *) complain "$1: no $3 among '$(field "$1" "$2")'" ;; esac; }
lacks() { case " $(field "$1" "$2") " in *" $3 "*) complain "$1: $3 among '$(field "$1" "$2")'" ;; esac; }

[ "$(wc -l <"$DIR/table.csv")" -eq 14 ] || complain "not thirteen rows: $(cat "$DIR/table.csv")"

# ---- What is stored and listed among the needs ----
for scene in bare leaves; do
	for need in textures cutouts ground cells placements; do lacks $scene 3 $need; done
	lacks $scene 4 images
	lacks $scene 4 ground
	has $scene 3 splats
done
lacks bare 4 points
for need in cutouts ground cells placements; do lacks textures 3 $need; done
has textures 3 textures
has textures 4 images
lacks textures 4 outlines
has cutouts 4 outlines
for need in ground cells placements; do lacks cutouts 3 $need; done
has cutouts 3 cutouts
has ground 3 ground
has ground 4 ground
for scene in roads water; do has $scene 4 ground_images; done
for scene in ground objects houses; do lacks $scene 4 ground_images; done
has water 3 water
for scene in roads covered; do lacks $scene 3 water; done
for scene in objects houses; do lacks $scene 3 ground; lacks $scene 3 textures; done
for need in cells placements; do lacks ground 3 $need; has everything 3 $need; done

# ---- Whatever is stored is sound ----
packs=0
for made in "$DIR"/*.eco "$DIR"/*/*.eco; do
	[ -f "$made" ] || continue
	packs=$((packs + 1))
	"$BUILD/ecopack" verify "$made" >"$DIR/verified" 2>&1 || complain "$made: $(head -n 3 "$DIR/verified")"
done
[ $packs -ge 6 ] || complain "$packs packs of six scenes"

# ---- Shaders: those of what is drawn; none where there is no OpenGL ----
if [ -n "$(field bare 11)" ]; then
	for shader in triangles textured points summary ground leafy; do lacks bare 11 $shader; done
	has bare 11 lines
	for shader in textured ground; do lacks leaves 11 $shader; done
	has textures 11 textured
	lacks textures 11 ground
	lacks cutouts 11 ground
	has ground 11 ground
	has bare 11 splats
	has sparse 11 "leafy splats"
	for shader in triangles textured lines points splats leafy; do lacks unplanted 11 "$shader"; done
fi

# ---- Shadow maps: where something casts them ----
for row in bare leaves ground covered; do has $row 14 made; done
lacks unplanted 14 made

# ---- Libraries: a module where a scene takes it; the same few of the daemon and of the viewer for all ----
takes() { [ "$(field "$1" 10)" = "$2" ] || complain "$1: ecopack takes the modules '$(field "$1" 10)', not '$2'"; }
for scene in bare leaves textures cutouts; do
	takes $scene ""
	[ "$(field $scene 12)" = "$(field bare 12)" ] || complain "$scene: ecopack maps $(field $scene 12) libraries, $(field bare 12) for bare lines"
done
takes ground gdal
takes everything "assimp gdal image proj"
takes objects ""
takes houses "gdal proj"
for scene in roads water; do takes $scene "cairo gdal proj"; done
[ "$(field bare 12)" -lt 20 ] || complain "ecopack maps $(field bare 12) libraries for bare lines"
for scene in leaves sparse textures cutouts ground unplanted covered objects houses roads water everything; do
	[ "$(field $scene 7)" = "$(field bare 7)" ] || complain "$scene: the daemon maps $(field $scene 7) libraries, $(field bare 7) for bare lines"
	[ "$(field $scene 9)" = "$(field bare 9)" ] || complain "$scene: the viewer maps $(field $scene 9) libraries, $(field bare 9) for bare lines"
	[ -z "$(field $scene 13)" ] || complain "$scene: the viewer loads the modules '$(field $scene 13)'"
done

# ---- Bytes: more is sent where more is drawn ----
[ "$(field bare 5)" -lt "$(field leaves 5)" ] || complain "bare lines take as many bytes as leaves"
[ "$(field leaves 5)" -lt "$(field cutouts 5)" ] || complain "flat leaves take as many bytes as leaves with textures"
[ "$(field cutouts 5)" -lt "$(field ground 5)" ] || complain "the ground takes no bytes"
[ "$(field sparse 5)" -lt "$(field leaves 5)" ] || complain "splats take as many bytes as leaves"
[ "$(field unplanted 5)" -lt "$(field ground 5)" ] || complain "plants out of sight take bytes"

# ---- Each feature takes its own module and no other ----
BUILD=$BUILD MAKE_AS=--draft sh tests/bench/needs.sh "$DIR" features >"$DIR/table.csv" 2>"$DIR/errors" || complain "no features: $(tail -n 3 "$DIR/errors")"
for feature in "picture,image" "foreign,assimp" "table,proj" "layer,gdal proj" "houses,gdal proj" "roads,cairo gdal proj"; do
	grep -qx "$feature" "$DIR/table.csv" || complain "not '$feature', but '$(grep "^${feature%%,*}," "$DIR/table.csv")'"
done

exit $failed
