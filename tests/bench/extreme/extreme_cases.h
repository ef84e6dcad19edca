/* Actions of extreme cases, by kind: extreme_cases.c says which case is made of which, and what must hold. */
#ifndef TESTS_BENCH_EXTREME_CASES_H
#define TESTS_BENCH_EXTREME_CASES_H

#include "ecofiles/format/view.h"
#include "tests/bench/extreme/extreme.h"

/* Place: x->made is a struct extreme_site. */
void extreme_at_site(struct extreme *x);
void extreme_unlike(struct extreme *x);

/* Camera: x->made is an array of shots that ends with one without a name. Eye and target of a shot are metres
 * from somewhere: the scene's origin, its first tree's foot, the middle of that tree or of its first cell; or
 * the middle of one of its leaves, a corner of that leaf, and a metre along its normal. `least`: share of
 * pixels to be covered. */
enum extreme_from { FROM_SCENE, FROM_TREE, FROM_MIDDLE, FROM_CELL, FROM_LEAF, FROM_CORNER, FROM_NORMAL };
struct extreme_shot { const char *name; struct eco_view view; enum extreme_from eye, target; double least;
	bool planned_only; };
void extreme_look_at(struct extreme *x);
void extreme_images(struct extreme *x);
void extreme_all_behind(struct extreme *x);
void extreme_horizon(struct extreme *x);

/* Stiff budgets and curves. */
void extreme_tiny(struct extreme *x);
void extreme_steps(struct extreme *x);
void extreme_unbounded(struct extreme *x);
void extreme_impossible(struct extreme *x);
void extreme_sweep(struct extreme *x);
void extreme_jumps(struct extreme *x);
void extreme_identical(struct extreme *x);
void extreme_one_better(struct extreme *x);
void extreme_odd_curves(struct extreme *x);

/* Geometry. */
void extreme_zero_area(struct extreme *x);
void extreme_needles(struct extreme *x);
void extreme_coincident(struct extreme *x);
void extreme_non_manifold(struct extreme *x);
void extreme_not_finite(struct extreme *x);
void extreme_few(struct extreme *x);
void extreme_ten_million(struct extreme *x);
void extreme_materials(struct extreme *x);
void extreme_orders(struct extreme *x);
void extreme_lambda_to_0(struct extreme *x);

/* Quantization: x->made is an array of trees, scaled and shifted, that ends with one without a name. `bits`
 * 0: the grid is found. */
struct extreme_tree { const char *name; double factor, shift_m; uint32_t leaves, quick_leaves, flowers, bits;
	double lost; bool cells; };
void extreme_rounded(struct extreme *x);
void extreme_large(struct extreme *x);
void extreme_nearer(struct extreme *x);

/* Time. */
void extreme_still(struct extreme *x);
void extreme_still_streams(struct extreme *x);
void extreme_jitter(struct extreme *x);
void extreme_on_border(struct extreme *x);
void extreme_teleport(struct extreme *x);

#endif
