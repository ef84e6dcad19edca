#!/bin/sh
# Breaks each rule, weight and order of the papers in turn, and runs the test that should find it:
# broken_rules.sh [WORD] tries the lines of the table that hold WORD, all of them without. It works in a copy
# of the tree, OUT (build/broken if not set), and ends with 1 if a change is not found, or if its line of code
# is no longer there.
set -eu
OUT=${OUT:-build/broken}
WORD=${1:-}
mkdir -p "$OUT"
OUT=$(cd "$OUT" && pwd)
LOG=$OUT/build/broken.log

# @ test file, then for each change there: what is broken @ the change, as a script for sed
table() {
	cat <<'TABLE'
@ test_rules tests/bench/baseline/paper_deussen.c
Deussen: points by 1 / d', not its square @ s,/ (2 \* r \* r) / (d \* d),/ (2 * r * r) / d,
Deussen: splats without c_p @ s,return splat_factor \* 2 \* k / p,return 2 * k / p + 0 * splat_factor,
Deussen: a blend of half the triangles @ s,(uint32_t)(asked - 2 \* (uint64_t)k),&/2,
Deussen: lines whatever the distance @ s,return width / (r \* d),return width / d + 0 * r,
@ test_importance lod/plan/planner_deussen.c
Deussen: importance is 1 @ s,double importance = .*,double importance = 1;,
@ test_byte_budget lod/plan/byte_kinds.c
plan: kinds share no bytes @ s,if (bytes >= LOD_KIND_ENOUGH \* target),if (bytes >= 0 * target),
@ test_byte_budget lod/plan/price_search.c
plan: a price whose bytes are half of those that fit @ s,\*(now > target,*(2 * now > target,
@ test_byte_budget lod/plan/byte_price.c
plan: organs are never judged @ s,prices->organs_off\[i\] = true,prices->organs_off[i] = false,
plan: bytes of lists cost nothing @ s,double net = sum - m->price,double net = sum - 0 * m->price,
@ test_planner lod/plan/fill_budget.c
plan: half of the rest of a budget is left @ s,while (count && left),while (count \&\& left > (budget - fill->vertices) / 2),
@ test_planner lod/plan/planner_optimal.c
plan: the lambda of a sixteenth of the budget @ s,if (m->cost.vertices <= (double)budget),if (m->cost.vertices <= (double)budget / 16),
@ test_steadiness lod/plan/allocation.c
plan: tiles and gates switch at once @ s,if (m->few_plants || !(width > 0)),if (m->few_plants || width >= 0),
@ test_image_choice lod/plan/image_choice.c
plan: bytes of the ground's image cost nothing @ s,+ price \* missing_bytes,+ 0 * price * missing_bytes,
@ test_best lod/plan/knapsack.c
plan: the last option that fits, not the best @ s,if (wrong < to\[b\]),if (wrong < INFINITY),
@ test_visibility lod/seen/visibility.c
plan: crowns take no light @ s,row\[c\] \*= 1 - taken;,row[c] *= 1;,
@ test_summary_hull lod/seen/summary_hull.c
plan: a quarter of a summary's points is the most @ s,- 1; i-- > 0;),- 1; i-- > 1;),
@ test_best lod/plan/fill_few.c
few plants: no ladder for the whole plant @ s,for (uint32_t k = 0\, id = s->ladder_choice_first,for (uint32_t k = s->whole_count\, id = s->ladder_choice_first,
few plants: hull points alone @ s,if (k + 1 < hull->count),if (k + 1 < hull->count \&\& k > hull->count),
few plants: none is ahead @ s,ahead = plants; c->count > 1,ahead = plants; c->count > 1000,
few plants: every option costs a bin @ s,+ f->unit - 1) / f->unit,+ f->unit) / f->unit,
@ test_ladder lod/ladder.c
levels: the first limbs of both @ s,cuts\[1\].first = cuts\[1\].end - ,cuts[1].end = cuts[1].first + ,
@ test_chunk_mesh ecofiles/format/chunk/chunk_mesh.c
wood: parts as edgebreaker leaves them @ s,{ e->part\[i\]\, i },{ 0\, i },
@ test_importance lod/plan/allocation_weights.c
ours: importance is 1 @ s,return ladder->importance > 0 .*,return ladder->importance > 0 ? 1 : 1;,
@ test_rules tests/bench/baseline/paper_cook.c
Cook: lambda by distance, not its square @ s,fmax(LAMBDA_LEAST\, x \* x),fmax(LAMBDA_LEAST\, x),
@ test_rules tests/bench/baseline/paper_cook.c
Cook: leaves keep their size @ s,return kept ? (double)count / kept : 0,return kept ? 1 + 0 * count : 0,
Cook: no correction for depth @ /!(share > 0)/s,if (kept == 0,if (kept <= count,
Cook: contrast without the root @ s,return sqrt(after / before),return after / before,
@ test_rules tests/bench/baseline/paper_neubert.c
Neubert: lambda_opt is Cook's lambda @ s,return fmin(found\, lambda),return fmin(2 * found\, lambda),
@ test_rules tests/bench/baseline/paper_neubert.c
Neubert: hidden plants keep nothing @ s,return fmax(f\, LEAST),return fmax(f\, 0),
Neubert: no hysteresis @ s,>= PAPER_SIGHT_HYSTERESIS,>= 0,
Neubert: no smoothing in time @ s,+= SMOOTHING \* (,+= (,
@ test_order lod/build/order/order.c
Neubert: dense regions last @ s,even / (survival\[i\] \* u),even * survival[i] / u,
Neubert: what faces across survives @ s,return 1 - lod_arc_cosine,return lod_arc_cosine,
Neubert: combined is orientation alone @ s,survival\[i\] + density\[i\],survival[i] + 0 * density[i],
@ test_rank lod/build/order/rank.c
greedy: wrong pixels cost nothing @ s,- r->weights.wrong \* gain->wrong,- 0 * gain->wrong,
greedy: a second layer is the first @ s,+ r->weights.second \* gain->second,+ r->weights.right * gain->second,
@ test_rules tests/bench/baseline/paper_lee.c
Lee: the farthest first @ s,? lod_v3_dot(d\, d),? -lod_v3_dot(d\, d),
Lee: what faces away first @ s,: -facing(,: facing(,
Lee: layers of one weight @ s,weight += layers - layer,weight += (layers + 1) / 2,
Lee: no normals inside a layer @ s,lod_sort_key(rank)\, i },method == LOD_LEE_LAYER ? i : lod_sort_key(rank)\, i },
@ test_leaf_collapse tests/bench/baseline/leaf_collapse.c
Hidalgo: distance costs nothing @ s,weight\[LOD_COLLAPSE_DISTANCE\],0 * &,
Hidalgo: angle costs nothing @ s,weight\[LOD_COLLAPSE_ANGLE\],0,
Hidalgo: numbers of leaves cost nothing @ s,weight\[LOD_COLLAPSE_LEAVES\],0,
Hidalgo: area costs nothing @ s,weight\[LOD_COLLAPSE_AREA\],0,
Hidalgo: interiority costs nothing @ s,weight\[LOD_COLLAPSE_INTERIORITY\],0,
Hidalgo: the quad has both leaves' area @ s,(one->area + two->area + enclosing) / 2,one->area + two->area,
@ test_billboard_cloud tests/bench/baseline/billboard_fit.c
Kratt: invalid faces cost nothing @ s,is_valid ? &valid : &invalid,is_valid ? \&valid : \&valid,
Kratt: the first corner may be far @ s,<= epsilon && valid,<= epsilon || k == 0,
@ test_billboard_cloud tests/bench/baseline/billboard_cloud.c
Kratt: dense parts are not hidden @ s,> 0 ? 1 - tree->sigma\[i\] / most : 1,> 0 ? 1 : 1,
TABLE
}

make_test() { make -s -C "$OUT" "build/tests/$1" >"$LOG" 2>&1; }
run_test() { (cd "$OUT" && timeout 900 "build/tests/$1") >"$LOG" 2>&1; }

# try WHAT TEST FILE CHANGE
try() {
	cp "$OUT/$3" "$OUT/$3.whole"
	sed -i "$4" "$OUT/$3"
	if cmp -s "$OUT/$3" "$OUT/$3.whole"; then
		result="no longer applies to $3"
	elif ! make_test "$2"; then
		result="does not compile: $LOG"
	elif run_test "$2"; then
		result="NOT FOUND by $2"
	else
		name=$(sed -n 's/^\[  FAILED  \] \([a-z_0-9]*\)$/\1/p' "$LOG" | sort -u | head -1)
		result="found by $2: $name"
	fi
	mv "$OUT/$3.whole" "$OUT/$3"
	touch "$OUT/$3"
	echo "$1: $result"
	case $result in found*) ;; *) missed=$((missed + 1)) ;; esac
}

mkdir -p "$OUT/build"
git ls-files -z | xargs -0 cp -pu --parents -t "$OUT"
LINES=$(table | awk -v word="$WORD" '/^@/ { at = $2 "@" $3; next } index($0, word) { print at "@" $0 }')
[ -n "$LINES" ] || { echo "no line of the table has $WORD" >&2; exit 2; }
for test in $(echo "$LINES" | cut -d @ -f 1 | sort -u); do
	make_test "$test" && run_test "$test" || { echo "$test fails as it is: $LOG" >&2; exit 1; }
done
count=0 missed=0
while IFS='@' read -r test file what change; do
	try "${what% }" "$test" "$file" "${change# }"
	count=$((count + 1))
done <<LINES
$LINES
LINES
echo "$((count - missed)) of $count found"
[ "$missed" = 0 ]
