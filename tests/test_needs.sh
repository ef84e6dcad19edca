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

BUILD=$BUILD sh tests/bench/needs.sh "$DIR" >"$DIR/table.csv" 2>"$DIR/errors" || { complain "no table: $(tail -n 3 "$DIR/errors")"; exit 1; }

# field SCENE COLUMN
field() { awk -F, -v scene="$1" -v column="$2" '$1 == scene { print $column }' "$DIR/table.csv"; }
# has SCENE COLUMN WORD, lacks SCENE COLUMN WORD
has() { case " $(field "$1" "$2") " in *" $3 "*) ;; *) complain "$1: no $3 among '$(field "$1" "$2")'" ;; esac; }
lacks() { case " $(field "$1" "$2") " in *" $3 "*) complain "$1: $3 among '$(field "$1" "$2")'" ;; esac; }

[ "$(wc -l <"$DIR/table.csv")" -eq 7 ] || complain "not six scenes: $(cat "$DIR/table.csv")"

# ---- What is stored and listed among the needs ----
for scene in bare leaves; do
	for need in textures cutouts ground cells placements; do lacks $scene 3 $need; done
	lacks $scene 4 images
	lacks $scene 4 ground
done
lacks bare 4 points
for need in cutouts ground cells placements; do lacks textures 3 $need; done
has textures 3 textures
has textures 4 images
for need in ground cells placements; do lacks cutouts 3 $need; done
has cutouts 3 cutouts
has ground 3 ground
has ground 4 ground
for need in cells placements; do lacks ground 3 $need; has everything 3 $need; done

# ---- Shaders: those of what is drawn; none where there is no OpenGL ----
if [ -n "$(field bare 11)" ]; then
	for shader in triangles textured points summary ground; do lacks bare 11 $shader; done
	has bare 11 lines
	for shader in textured ground; do lacks leaves 11 $shader; done
	has textures 11 textured
	lacks textures 11 ground
	lacks cutouts 11 ground
	has ground 11 ground
fi

# ---- Libraries: the image module where there are images; the daemon has the same few whatever it serves ----
for scene in bare leaves; do [ "$(field $scene 10)" = 0 ] || complain "$scene: the image module was loaded"; done
for scene in textures cutouts ground everything; do [ "$(field $scene 10)" = 1 ] || complain "$scene: the image module was not loaded"; done
for scene in leaves textures cutouts ground everything; do
	[ "$(field $scene 7)" = "$(field bare 7)" ] || complain "$scene: the daemon maps $(field $scene 7) libraries, $(field bare 7) for bare lines"
done

# ---- Bytes: more is sent where more is drawn ----
[ "$(field bare 5)" -lt "$(field leaves 5)" ] || complain "bare lines take as many bytes as leaves"
[ "$(field leaves 5)" -lt "$(field cutouts 5)" ] || complain "flat leaves take as many bytes as leaves with textures"
[ "$(field cutouts 5)" -lt "$(field ground 5)" ] || complain "the ground takes no bytes"

exit $failed
