/* All extreme cases: what is made, and what must hold. */
#include "tests/bench/extreme/extreme_cases.h"

#include "lod/build/grid.h"
#include "tests/bench/extreme/extreme_scene.h"

/* ---- Places ---- */

#define SAME "same plan up to rounding; < 0.1 % of pixels differ from the origin's; at 1500 and 20000 " \
	"vertices and in full"
#define SITE(title, slow, ...) { EXTREME_PLACE, title, SAME, extreme_at_site, \
	&(const struct extreme_site)__VA_ARGS__, slow }

/* ---- Cameras ---- */

#define SOUND "planned at 0, 50, 5000 and all vertices: within the budget, finite, the same twice; drawn"
#define LOOK(x, y, z, tx, ty, tz) { { x, y, z }, { tx, ty, tz }, { 0, 0, 1 }, 45, 320, 240 }
/* From beside the stand, with another up, lens or picture. */
#define BESIDE(ux, uy, uz, fov, width, height) { { -26, -21, 6.5 }, { 0, 0, 2 }, { ux, uy, uz }, fov, width, \
	height }
#define SHOTS(title, holds, ...) { EXTREME_CAMERA, title, holds, extreme_look_at, \
	(const struct extreme_shot[]){ __VA_ARGS__, { .name = NULL } }, false }

static const struct extreme_shot images[] = {
	{ .name = "1 x 1", .view = BESIDE(0, 0, 1, 45, 1, 1) },
	{ .name = "16384 x 1", .view = BESIDE(0, 0, 1, 45, 16384, 1) },
	{ .name = "1 x 16384", .view = BESIDE(0, 0, 1, 45, 1, 16384) },
	{ .name = "16384 x 16384, planned", .view = BESIDE(0, 0, 1, 45, 16384, 16384), .planned_only = true },
	{ .name = NULL },
};

/* ---- Budgets and plants ---- */

#define HOLD "the search converges; within the budget; what is left over is less than any step; more " \
	"budget never predicts more error"
#define BUILT "built, packed, planned, drawn, or refused with a reason; triangles in = stored + dropped; " \
	"all numbers finite"
#define HALF "every corner of the source is stored, within half a pixel (1080 rows over 45 degrees) from " \
	"the stated distance on, which is at most " \
	"the plant's size"
#define TREES(...) extreme_rounded, (const struct extreme_tree[]){ __VA_ARGS__, { .name = NULL } }, false

/* ---- The table ---- */

const struct extreme_case extreme_cases[EXTREME_CASES] = {
	SITE("1 km away", false, { .at = { 1e3, -1e3, 0 } }),
	SITE("1000 km away", false, { .at = { 1e6, -1e6, 0 } }),
	SITE("10000 km away", false, { .at = { 1e7, -1e7, 100 } }),
	SITE("earth-centred coordinates", false, { .at = { 4178123.625, 853456.375, 4729876.5 } }),
	SITE("1000 km away without a transform", false, { .at = { 1e6, -1e6, 100 }, .plain = true }),
	SITE("10000 km away without a transform", false, { .at = { 1e7, -1e7, 0 }, .plain = true }),
	SITE("earth-centred without a transform", false,
	{ .at = { 4178123.625, 853456.375, 4729876.5 }, .plain = true }),
	SITE("turned by 90 degrees", false, { .turn = 16384 }),
	SITE("turned by 67.8 degrees", false, { .turn = 12345 }),
	SITE("scaled by 1e-6", false, { .scale = 1e-6 }), SITE("scaled by 1e-3", true, { .scale = 1e-3 }),
	SITE("scaled by 1e3", true, { .scale = 1e3 }),
	SITE("scaled by 1e6", false, { .scale = 1e6 }),
	SITE("10000 km away; turned; scaled by 1/4", false,
	{ .at = { 1e7, -1e7, 100 }, .turn = 54321, .scale = 0.25 }),
	SITE("10000 km away; turned; scaled by 1e6", true,
	{ .at = { 1e7, -1e7, 100 }, .turn = 777, .scale = 1e6 }),
	{ EXTREME_PLACE, "plants of 1 mm beside 100 m", "sound plans and pictures from 3 cm and from 300 m; "
		"< 20 % of pixels differ from full detail "
		"with 20000 vertices", extreme_unlike, NULL, false },

	SHOTS("inside a leaf", SOUND,
		{ "along it", LOOK(0, 0, 0, 0, 0, 0), FROM_LEAF, FROM_CORNER, 0, false },
		{ "across it", LOOK(0, 0, 0, 0, 0, 0), FROM_LEAF, FROM_NORMAL, 0, false }),
	SHOTS("inside the trunk", SOUND ": wood around the eye",
		{ "level", LOOK(0.02, 0, 1, 0, 0, 1), FROM_TREE, FROM_SCENE, 0.5, false },
		{ "up", LOOK(0.02, 0, 1, 0.02, 0, 5), FROM_TREE, FROM_TREE, 0.5, false },
		{ "down", LOOK(0.02, 0, 1, 0.02, 0, -5), FROM_TREE, FROM_TREE, 0.2, false }),
	SHOTS("on a tile's corner", SOUND,
		{ .name = "where four tiles meet", .view = LOOK(0, 0, 1, 10, 10, 1), .least = 0.01 },
		{ .name = "on the ground there", .view = LOOK(0, 0, 0, -1, 0, 0), .least = 0.01 },
		{ .name = "corner of the square",
			.view = LOOK(-EXTREME_SIDE_M / 2, -EXTREME_SIDE_M / 2, 0, 0, 0, 0), .least = 0.01 },
		{ .name = "along an edge", .view = LOOK(-EXTREME_SIDE_M / 2, 0, 2, EXTREME_SIDE_M / 2, 0, 2),
			.least = 0.01 }),
	/* nothing between the eye and what it looks at */
	SHOTS("at distance 0", SOUND,
		{ "at its foot", LOOK(0, 0, 0, 0, 1, 0), FROM_TREE, FROM_TREE, 0, false },
		{ "at its middle", LOOK(0, 0, 0, 1, 0, 0), FROM_MIDDLE, FROM_MIDDLE, 0, false },
		{ "at a cell's middle", LOOK(0, 0, 0, 1, 0, 0), FROM_CELL, FROM_CELL, 0, false }),
	SHOTS("at 1e9 m", SOUND,
		{ .name = "1e9 m", .view = LOOK(-1e9, 0, 1e8, 0, 0, 2) },
		{ .name = "1e12 m", .view = LOOK(-1e12, 1e12, 1e12, 0, 0, 2) },
		{ .name = "1e9 m through 2e-6 degrees",
		.view = { { 0, -1e9, 1e8 }, { 0, 0, 2 }, { 0, 0, 1 }, 2e-6, 320, 240 }, .least = 0.05 }),
	SHOTS("up along the direction", SOUND ": another up is taken",
		{ .name = "up is the direction", .view = BESIDE(26, 21, -4.5, 45, 320, 240), .least = 0.02 },
		{ .name = "up is its opposite", .view = BESIDE(-26, -21, 4.5, 45, 320, 240), .least = 0.02 },
		{ .name = "no up", .view = BESIDE(0, 0, 0, 45, 320, 240), .least = 0.02 },
		{ .name = "straight down", .view = LOOK(0, 0, 40, 0, 0, 0), .least = 0.02 },
		{ .name = "straight up", .view = LOOK(0, 0, -40, 0, 0, 0), .least = 0.02 },
		{ .name = "nearly along", .view = BESIDE(26 * (1 + 1e-13), 21, -4.5, 45, 320, 240),
			.least = 0.02 },
		{ .name = "up of 1e-300", .view = BESIDE(0, 0, 1e-300, 45, 320, 240), .least = 0.02 }),
	SHOTS("field of view 0.001 degrees", SOUND,
		{ .name = "0.001 degrees", .view = BESIDE(0, 0, 1, 0.001, 320, 240) },
		{ .name = "1e-9 degrees", .view = BESIDE(0, 0, 1, 1e-9, 320, 240) },
		{ .name = "0.001 degrees from 1000 km",
		.view = { { -1e6, 0, 1e5 }, { 0, 0, 2 }, { 0, 0, 1 }, 0.001, 320, 240 }, .least = 0.05 }),
	SHOTS("field of view 179.9 degrees", SOUND,
		{ .name = "179.9 degrees",
			.view = { { 0, 0, 2 }, { 10, 0, 2 }, { 0, 0, 1 }, 179.9, 320, 240 } },
		{ .name = "179.999999 degrees",
			.view = { { 0, 0, 2 }, { 10, 0, 2 }, { 0, 0, 1 }, 179.999999, 320, 240 } }),
	{ EXTREME_CAMERA, "pictures of 1 x 1 to 16384 x 16384", SOUND "; the largest: what it covers, "
		"against a small one", extreme_images, images, false },
	{ EXTREME_CAMERA, "everything behind", "nothing is drawn, nothing predicted", extreme_all_behind,
		NULL, false },
	{ EXTREME_CAMERA, "horizon along 4e6 tiles", "1e6 copies of a stand of four tiles: plans within the "
		"budget that use half of it at least",
		extreme_horizon, NULL, false },

	{ EXTREME_STIFF, "budgets 0, 1, 2, 3 ...", "every vertex is used where points cost one; more never "
		"predicts more error", extreme_tiny, NULL,
		false },
	{ EXTREME_STIFF, "each step of V(d'), one less and one more",
		"within the budget, error does not rise, what is left over is less than any step; "
		"by Deussen's rule at most 2 %", extreme_steps, NULL, false },
	{ EXTREME_STIFF, "budgets to 2^63-1", "all there is, exactly", extreme_unbounded, NULL, false },
	{ EXTREME_STIFF, "budgets and views that are no numbers",
		"refused with a reason before anything is computed", extreme_impossible, NULL, false },
	{ EXTREME_STIFF, "1e5 budgets, swept", HOLD, extreme_sweep, NULL, false },
	{ EXTREME_STIFF, "jumps of 1e6 vertices", HOLD, extreme_jumps, NULL, false },
	{ EXTREME_STIFF, "1e6 identical candidates", HOLD "; also for 1e6 plants of one kind",
		extreme_identical, NULL, false },
	{ EXTREME_STIFF, "one candidate 1e9 times better", HOLD "; the best is completed first",
		extreme_one_better, NULL, false },
	{ EXTREME_STIFF, "flat, convex, rising and single-point curves", HOLD, extreme_odd_curves, NULL,
		false },

	{ EXTREME_GEOMETRY, "triangles of no area", BUILT, extreme_zero_area, NULL, false },
	{ EXTREME_GEOMETRY, "needles of 1e3:1 to 1e9:1", BUILT, extreme_needles, NULL, false },
	{ EXTREME_GEOMETRY, "coincident and duplicate triangles", BUILT, extreme_coincident, NULL, false },
	{ EXTREME_GEOMETRY, "non-manifold surfaces", BUILT, extreme_non_manifold, NULL, false },
	{ EXTREME_GEOMETRY, "NaN, infinite, denormal and huge corners", BUILT, extreme_not_finite, NULL,
		false },
	{ EXTREME_GEOMETRY, "empty plants, one triangle", BUILT, extreme_few, NULL, false },
	{ EXTREME_GEOMETRY, "a plant of 1e7 triangles", BUILT "; stochastic order", extreme_ten_million, NULL,
		true },
	{ EXTREME_GEOMETRY, "1e5 materials", BUILT, extreme_materials, NULL, false },
	{ EXTREME_GEOMETRY, "orders of one leaf and of all in one point",
		"every order is finite, whatever the arrangement; such plants are built and "
		"drawn", extreme_orders, NULL, false },
	{ EXTREME_GEOMETRY, "lambda to 0", "curves and area factors are finite and bounded down to one "
		"vertex", extreme_lambda_to_0, NULL, false },

	{ EXTREME_QUANTIZATION, "plants of 6 mm to 108 m", HALF,
		TREES({ "moss", 1e-3, 0, 200, 200, 0, 0, 0, false },
		{ "herb", 0.03, 0, 200, 200, 0, 0, 0, false }, { "tree", 1, 0, 1500, 1500, 0, 0, 0, false },
		{ "giant", 18, 0, 3000, 3000, 0, 0, 0, false }) },
	{ EXTREME_QUANTIZATION, "plants of 30 m to 600 m, with cells",
		HALF "; and is at most 20 m: all lists on one lattice, seams of cells closed",
		TREES({ "30 m", 5, 0, 9000, 2500, 0, 0, 0, true },
		{ "60 m", 10, 0, 9000, 2500, 0, 0, 0, true },
		{ "120 m", 20, 0, 9000, 2500, 0, 0, 0, true },
		{ "600 m", 100, 0, 9000, 2500, 0, 0, 0, true }) },
	{ EXTREME_QUANTIZATION, "a large plant with small leaves",
		HALF "; all its cells on one grid, so that seams stay closed", extreme_large, NULL,
		false },
	{ EXTREME_QUANTIZATION, "grids of 12 to 18 bits", HALF,
		TREES({ "12 bits", 1, 0, 400, 400, 20, 12, 0, false },
		{ "13 bits", 1, 0, 400, 0, 20, 13, 0, false }, { "14 bits", 1, 0, 400, 0, 20, 14, 0, false },
		{ "15 bits", 1, 0, 400, 400, 20, 15, 0, false },
		{ "16 bits", 1, 0, 400, 0, 20, 16, 0, false },
		{ "17 bits", 1, 0, 400, 0, 20, 17, 0, false },
		{ "18 bits", 1, 0, 400, 400, 20, 18, 0, false }) },
	{ EXTREME_QUANTIZATION, "a model far from its own origin",
		HALF "; floats hold no more there: corners that meet in the source may",
		TREES({ "1 km from its own origin", 1, 1000, 400, 400, 0, 0, 0.02, false }) },
	{ EXTREME_QUANTIZATION, "nearer than stated", "error grows as 1 / distance; drawn in full, without "
		"holes", extreme_nearer, NULL, false },

	{ EXTREME_TIME, "a camera that stands still", "10^4 plans of the same request are the same bytes",
		extreme_still, NULL, false },
	{ EXTREME_TIME, "streams to a camera that stands still", "100 bodies are the same bytes, also where "
		"bytes are bounded", extreme_still_streams,
		NULL, false },
	{ EXTREME_TIME, "trembling by 1e-9 m", "at most 1 % of plans differ from the one before; vertices "
		"within 0.1 %, predicted error within 1e-4",
		extreme_jitter, NULL, false },
	{ EXTREME_TIME, "trembling by 1 mm on the way past borders of bands", "predicted error within 2 %",
		extreme_on_border, NULL, false },
	{ EXTREME_TIME, "teleporting", "1000 jumps between six places, from inside the stand to 1e9 m: each "
		"answered as at first", extreme_teleport,
		NULL, false },
};
_Static_assert(LOD_GRID_BITS_MIN == 12 && LOD_GRID_BITS_MAX == 18, "the table names every grid");
