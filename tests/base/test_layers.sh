#!/bin/sh
# make layers names every wrong include: in a copy of a tree with faults of each kind planted, most of them in dependencies as a compiler
# writes them, one in a source that is compiled. Prints what failed; status 0 when nothing did.
set -u
DIR=build/tmp/layers-sh-$$
failed=0
here=$PWD
mkdir -p "$DIR/out/obj"
trap 'rm -rf "$here/$DIR"' EXIT

complain() { echo "test_layers: $*"; failed=1; }

# source FILE HEADER...: a source, and the dependencies of its object
source() {
	file=$1; shift
	mkdir -p "$DIR/$(dirname "$file")" "$DIR/out/obj/$(dirname "$file")"
	: >"$DIR/$file"
	{
		printf 'out/obj/%s.o: %s' "${file%.*}" "$file"
		for header; do printf ' \\\n %s' "$header"; done
		echo
		for header; do printf '%s:\n' "$header"; done
	} >"$DIR/out/obj/${file%.*}.d"
}

layers() { (cd "$DIR" && sh "$here/tests/layers.sh" "$here/tests/layers.txt" out) >"$DIR/said" 2>&1; }

# names SOURCE HEADER PROBLEM
names() { grep -Fqx "$1 includes $2, which $3" "$DIR/said" || complain "no word of $1, $2, $3: $(cat "$DIR/said")"; }

layers && complain "is content with nothing"

# Allowed are its own room, public headers of rooms that it may use, headers that are not ours; programs may include anything.
source lod/plan/planner.c /usr/include/math.h ecofiles/base/status.h ecofiles/format/list.h lod/vector.h lod/plan/planner.h lod/plan/planner_state.h
source lod/build/plant.c lod/build/grid.h lod/build/order/order.h lod/raster/raster.h ./ecofiles/base/bytes.h
source ecofiles/format/chunk/draco_shim.cpp ecofiles/format/chunk/draco_shim.h
source server/main_ecoserve.c ecofiles/ecopack/make.h lod/build/draft.h server/daemon.h
source tests/base/test_angle16.c lod/build/draft.h
layers || complain "finds fault with what is allowed: $(cat "$DIR/said")"

# (a) rooms that a room may not include, (b) private headers, (c) build and plan, (d) ecopack, (e) no room
source ecofiles/base/angle16.c ecofiles/format/list.h
source server/answer.c lod/build/order/order.h ecofiles/scene/scene.h
source client-min/view_store.c server/daemon.h
source lod/seen/hull.c lod/build/grid.h
source lod/build/tile.c lod/plan/planner.h
source server/stream.c lod/plan/planner_state.h
source ecofiles/import/places/rows/rows.c ecofiles/import/model/gltf_parse_inside.h
source ecofiles/scene/scene.c ecofiles/ecopack/make.h
source client-min/view_draw.c ecofiles/ecopack/command.h
source ecofiles/stray.c ecofiles/base/status.h
source lod/light.c ecofiles/stray.h
layers && complain "is content with faults: $(cat "$DIR/said")"
may_not="is of a room that"
names ecofiles/base/angle16 ecofiles/format/list.h "$may_not ecofiles/base may not include"
names server/answer lod/build/order/order.h "$may_not server may not include"
names server/answer ecofiles/scene/scene.h "$may_not server may not include"
names client-min/view_store server/daemon.h "$may_not client-min may not include"
names lod/seen/hull lod/build/grid.h "$may_not lod/seen may not include"
names lod/build/tile lod/plan/planner.h "$may_not lod/build may not include"
names server/stream lod/plan/planner_state.h "is private to lod/plan"
names ecofiles/import/places/rows/rows ecofiles/import/model/gltf_parse_inside.h "is private to ecofiles/import/model"
names ecofiles/scene/scene ecofiles/ecopack/make.h "$may_not ecofiles/scene may not include"
names client-min/view_draw ecofiles/ecopack/command.h "$may_not client-min may not include"
names lod/light ecofiles/stray.h "is in no room"
grep -q '^ecofiles/stray lies in no room' "$DIR/said" || complain "no word of a source in no room: $(cat "$DIR/said")"
[ "$(tail -n 1 "$DIR/said")" = "layers: 15 sources, 12 stray" ] || complain "counts $(tail -n 1 "$DIR/said")"

# Lines that a compiler itself writes, of an include by way of another header.
rm -rf "$DIR/out" "$DIR"/[cels]*/
mkdir -p "$DIR/lod/plan" "$DIR/lod/build" "$DIR/out/obj/lod/plan"
echo '#include "lod/build/grid.h"' >"$DIR/lod/plan/planner.h"
echo 'struct grid;' >"$DIR/lod/build/grid.h"
printf '#include "lod/plan/planner.h"\nstruct grid *planned;\n' >"$DIR/lod/plan/planner.c"
(cd "$DIR" && ${CC:-cc} -I. -MMD -MP -c -o out/obj/lod/plan/planner.o lod/plan/planner.c) || complain "the planted source does not compile"
layers && complain "is content with a compiled fault"
names lod/plan/planner lod/build/grid.h "$may_not lod/plan may not include"

# The top level holds the five rooms and nothing that was built.
stray=$(git ls-files 2>/dev/null | grep -vE '^(\.|LICENSE$|Makefile$|README\.md$|(ecofiles|lod|server|client-min|tests)/)')
[ -z "$stray" ] || complain "at the top level: $stray"

# The table holds what DESIGN says: build and plan never meet, nothing includes ecopack, server and client know neither import nor build.
awk -F '|' '
	/^#/ || NF < 3 { next }
	{ gsub(/ /, "", $1) }
	index($2, "ecofiles/ecopack") { print "test_layers: " $1 " may include ecopack"; bad = 1 }
	$1 ~ /^lod\/build/ && $2 ~ /lod\/plan/ || $1 ~ /^lod\/plan/ && $2 ~ /lod\/build/ { print "test_layers: build and plan meet"; bad = 1 }
	$1 ~ /^(server|client-min)/ && $2 ~ /import|lod\/build|scene|generate/ { print "test_layers: " $1 " may include too much"; bad = 1 }
	END { exit bad }' tests/layers.txt || failed=1
exit $failed
