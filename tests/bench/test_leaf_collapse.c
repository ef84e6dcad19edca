/* Leaf collapse: which pairs collapse, into which quads, and how levels lie in one array. */
#include <math.h>
#include <string.h>

#include "tests/bench/baseline/leaf_collapse_atlas.h"
#include "tests/bench/collapse/bench_collapse_plant.h"
#include "tests/support/foliage_random.h"
#include "tests/support/unit_test.h"

#define MOST 512u

static struct lod_arena arena;
static uint32_t first[MOST + 1];
static float corner[4 * MOST][3];
static struct lod_collapse_leaves leaves;
static struct lod_collapse collapse;

static const struct lod_v3 X = { 1, 0, 0 }, Y = { 0, 1, 0 }, Z = { 0, 0, 1 };

static void none(void) { leaves = (struct lod_collapse_leaves){ .first = first,
	.corner = (const float (*)[3])corner }; }

/* A rectangle: centre and both half axes. */
static void rectangle(struct lod_v3 at, struct lod_v3 along, struct lod_v3 across)
{
	static const int sign[4][2] = { { -1, -1 }, { 1, -1 }, { 1, 1 }, { -1, 1 } };
	for (uint32_t k = 0; k < 4; k++) {
		struct lod_v3 p = lod_v3_add(at, lod_v3_add(lod_v3_scale(along, sign[k][0]),
			lod_v3_scale(across, sign[k][1])));
		float *to = corner[4 * leaves.count + k];
		to[0] = (float)p.x, to[1] = (float)p.y, to[2] = (float)p.z;
	}
	leaves.count++;
	first[leaves.count] = 4 * leaves.count;
}

static void square(double x, double y, double z, double half)
{
	rectangle((struct lod_v3){ x, y, z }, lod_v3_scale(X, half), lod_v3_scale(Y, half));
}

static void make(const struct lod_collapse_options *options)
{
	lod_arena_free(&arena);
	assert_int_equal(setjmp(arena.failed), 0);
	lod_collapse_make(&collapse, &leaves, options, &arena);
}

static void strew(uint32_t count, uint64_t seed)
{
	none();
	for (uint32_t i = 0; i < count; i++) {
		struct lod_v3 at = { 3 * foliage_dice(&seed), 3 * foliage_dice(&seed),
			3 * foliage_dice(&seed) };
		struct lod_v3 n = { foliage_dice(&seed), foliage_dice(&seed), foliage_dice(&seed) };
		struct lod_v3 along = lod_v3_unit(lod_v3_cross(n, X)), across =
			lod_v3_unit(lod_v3_cross(n, along));
		rectangle(at, lod_v3_scale(along, 0.2 + 0.05 * foliage_dice(&seed)),
			lod_v3_scale(across, 0.1));
	}
}

static const struct lod_collapse_options free_of_limits = { .weight = { 1, 0.25, 1, 0.5, 0.1 },
	.distance_most = 4, .angle_most_rad = LOD_PI / 2 };

/* ---- Levels ---- */

/* Which of the nodes shown at a level stands for the leaf; none may stand for it twice. */
static uint32_t stands_for(const bool *shown, uint32_t leaf)
{
	uint32_t found = ECO_NONE;
	for (uint32_t id = leaf; id != ECO_NONE; id = collapse.node[id].parent)
		if (shown[id]) {
			assert_true(found == ECO_NONE);
			found = id;
		}
	return found;
}

static void check_level(const struct lod_collapse_level *level)
{
	bool shown[2 * MOST] = { false };
	uint32_t by[MOST], n = collapse.leaves;
	uint64_t represented = 0;
	assert_true(level->a <= n && level->b >= n && level->b + level->c <= n + collapse.made);
	for (uint32_t i = 0; i < level->a; i++) {
		assert_true(collapse.place[i] < n);
		shown[collapse.place[i]] = true;
	}
	for (uint32_t i = level->b; i < level->b + level->c; i++) {
		assert_true(collapse.place[i] >= n);
		shown[collapse.place[i]] = true;
	}
	for (uint32_t id = 0; id < n + collapse.made; id++)
		represented += shown[id] ? collapse.node[id].represents : 0;
	assert_int_equal(represented, n);
	lod_collapse_shown(&collapse, level, by);
	for (uint32_t leaf = 0; leaf < n; leaf++) {
		assert_true(stands_for(shown, leaf) != ECO_NONE);
		assert_int_equal(by[leaf], stands_for(shown, leaf));
	}
}

UNIT_TEST(every_level_is_two_runs_and_a_cut_of_the_forest)
{
	for (uint64_t seed = 1; seed <= 4; seed++) {
		strew(60 * (uint32_t)seed, seed);
		make(seed % 2 ? &free_of_limits : NULL);
		assert_int_equal(collapse.roots + collapse.made, leaves.count);
		for (uint32_t i = 0; i <= collapse.made; i++) {
			assert_int_equal(lod_collapse_count(&collapse.level[i]), collapse.roots + i);
			check_level(&collapse.level[i]);
		}
	}
}

UNIT_TEST(a_level_has_as_many_leaves_as_are_asked_for)
{
	struct lod_collapse_options options = free_of_limits;
	options.distance_most = 0.3;
	strew(200, 5);
	make(&options);
	assert_true(collapse.roots > 1 && collapse.roots < 100);
	for (uint32_t count = 0; count <= 220; count += 10) {
		uint32_t want = count < collapse.roots ? collapse.roots : count > 200 ? 200 : count;
		assert_int_equal(lod_collapse_count(lod_collapse_level_of(&collapse, count)), want);
	}
}

/* What was placed first is split first: the parents of the second run's quads never go back. */
UNIT_TEST(quads_are_split_in_the_order_of_their_places)
{
	uint32_t at[2 * MOST];
	strew(300, 6);
	make(&free_of_limits);
	for (uint32_t i = 0; i < collapse.leaves + collapse.made; i++)
		at[collapse.place[i]] = i;
	for (uint32_t kind = 0, last = 0; kind < 2; kind++, last = 0)
		for (uint32_t i = kind ? collapse.leaves : 0; i < (kind ? collapse.leaves + collapse.made
				: collapse.leaves); i++) {
			uint32_t parent = collapse.node[collapse.place[i]].parent;
			if (parent == ECO_NONE)
				continue;
			assert_true(at[parent] >= last);
			last = at[parent];
		}
}

UNIT_TEST(leaves_and_opaque_areas_add_up)
{
	strew(200, 7);
	double area[MOST];
	for (uint32_t i = 0; i < 200; i++)
		area[i] = 0.01 * (1 + i % 7);
	leaves.opaque_area = area;
	make(&free_of_limits);
	for (uint32_t i = collapse.leaves; i < collapse.leaves + collapse.made; i++) {
		const struct lod_collapse_node *n = &collapse.node[i], *a = &collapse.node[n->child[0]],
			*b = &collapse.node[n->child[1]];
		assert_int_equal(n->represents, a->represents + b->represents);
		assert_true(fabs(n->opaque_area - a->opaque_area - b->opaque_area) < 1e-12);
		assert_true(a->parent == i && b->parent == i && n->child[0] < i && n->child[1] < i);
	}
}

/* ---- Quads ---- */

static double area_of_corners(uint32_t id)
{
	struct lod_v3 c[ECO_CORNERS_MAX];
	assert_int_equal(lod_collapse_corners(&collapse, &leaves, id, c), 4);
	return lod_v3_length(lod_v3_cross(lod_v3_sub(c[1], c[0]), lod_v3_sub(c[3], c[0])));
}

/* Two unit squares two metres apart: their sum is 2, what encloses them 3 by 1. */
UNIT_TEST(the_area_is_the_mean_of_the_sum_and_of_what_encloses_both)
{
	none();
	square(-1, 0, 0, 0.5);
	square(1, 0, 0, 0.5);
	make(&free_of_limits);
	const struct lod_collapse_node *quad = &collapse.node[2];
	assert_int_equal(collapse.made, 1);
	assert_true(fabs(quad->area - 2.5) < 1e-9 && fabs(area_of_corners(2) - 2.5) < 1e-9);
	assert_true(fabs(lod_v3_length(quad->half[0]) / lod_v3_length(quad->half[1]) - 3) < 1e-9);
	assert_true(fabs(fabs(lod_v3_dot(lod_v3_unit(quad->half[0]), X)) - 1) < 1e-9);
	assert_true(lod_v3_length(quad->center) < 1e-9 && fabs(fabs(quad->normal.z) - 1) < 1e-9);
}

UNIT_TEST(centre_and_normal_are_weighted_by_leaves)
{
	none();
	square(0, 0, 0, 0.5);
	square(0.1, 0, 0, 0.5);
	struct lod_v3 tilted = { 0, 0.8, 0.6 };      /* the square's other axis: its normal is (0, -.6, .8) */
	rectangle((struct lod_v3){ 3.05, 0, 0 }, lod_v3_scale(X, 0.5), lod_v3_scale(tilted, 0.5));
	make(&free_of_limits);
	const struct lod_collapse_node *root = &collapse.node[4];
	struct lod_v3 want = lod_v3_unit((struct lod_v3){ 0, -0.6, 2.8 });
	assert_int_equal(root->represents, 3);
	assert_true(fabs(root->center.x - (2 * 0.05 + 3.05) / 3) < 1e-6);
	assert_true(fabs(fabs(lod_v3_dot(root->normal, want)) - 1) < 1e-6);
}

/* A leaf has no back: two that are wound either way lie in one plane. */
UNIT_TEST(opposing_normals_are_turned_to_one_side)
{
	none();
	rectangle((struct lod_v3){ 0, 0, 0 }, lod_v3_scale(Y, 0.5), lod_v3_scale(Z, 0.5));
	rectangle((struct lod_v3){ 0, 1, 0 }, lod_v3_scale(Y, 0.5), lod_v3_scale(Z, -0.5));
	make(NULL);
	assert_true(lod_v3_dot(collapse.node[0].normal, collapse.node[1].normal) < -0.99);
	assert_int_equal(collapse.made, 0);          /* as wide as the crown: beyond the cut-off */
	make(&free_of_limits);
	assert_int_equal(collapse.made, 1);
	assert_true(fabs(fabs(collapse.node[2].normal.x) - 1) < 1e-9);
	assert_true(fabs(collapse.node[2].area - 2) < 1e-6);
}

UNIT_TEST(coincident_centres_take_the_axis_of_the_larger_leaf)
{
	none();
	rectangle((struct lod_v3){ 1, 1, 0 }, lod_v3_scale(X, 0.5), lod_v3_scale(Y, 0.1));
	rectangle((struct lod_v3){ 1, 1, 0 }, lod_v3_scale(Y, 2), lod_v3_scale(X, 0.2));
	make(&free_of_limits);
	struct lod_v3 along = lod_v3_unit(collapse.node[1].half[0]);
	assert_int_equal(collapse.made, 1);
	assert_true(fabs(fabs(lod_v3_dot(lod_v3_unit(collapse.node[2].half[0]), along)) - 1) < 1e-9);
}

static void assert_finite(void)
{
	for (uint32_t i = 0; i < collapse.leaves + collapse.made; i++) {
		const struct lod_collapse_node *n = &collapse.node[i];
		struct lod_v3 c[ECO_CORNERS_MAX];
		uint32_t corners = lod_collapse_corners(&collapse, &leaves, i, c);
		for (uint32_t k = 0; k < corners; k++)
			assert_true(isfinite(c[k].x) && isfinite(c[k].y) && isfinite(c[k].z));
		assert_true(isfinite(lod_v3_length(n->normal)) && isfinite(n->area) && n->area >= 0);
	}
	for (uint32_t i = 0; i <= collapse.made; i++)
		check_level(&collapse.level[i]);
}

UNIT_TEST(degenerate_leaves_collapse_without_a_nan)
{
	for (uint32_t kind = 0; kind < 7; kind++) {
		uint32_t count = kind < 3 ? kind : 40;
		none();
		for (uint32_t i = 0; i < count; i++) {
			struct lod_v3 at = { i * 0.01, 0, 0 }, along = lod_v3_scale(X, 0.1), across =
				lod_v3_scale(Y, 0.1);
			if (kind == 3)               /* one spot, one plane */
				at = X;
			if (kind == 4)               /* no area, some no extent */
				across = along = i % 2 ? along : (struct lod_v3){ 0, 0, 0 };
			if (kind == 5)               /* opposing, and on one spot by twos */
				at.x = i / 2, across = lod_v3_scale(Y, i % 2 ? -0.1 : 0.1);
			if (kind == 6)               /* on the axis, at right angles */
				at = (struct lod_v3){ 0, 0, i * 0.01 }, across = i % 2 ? across
					: lod_v3_scale(Z, 0.1);
			rectangle(at, along, across);
		}
		make(&free_of_limits);
		assert_int_equal(collapse.roots, count ? 1 : 0);
		assert_finite();
		make(NULL);
		assert_finite();
	}
}

/* ---- Which pair is first ---- */

/* Leaves 0 and 1 are one candidate, 2 and 3 the other: too far away from each other. The second pair differs
 * less in one term, and the first is a little nearer to each other. */
static void candidates(enum lod_collapse_term term)
{
	double near[2] = { 1, 1.05 }, away[2] = { -40, 40 }, half[2] = { 0.2, 0.2 };
	struct lod_v3 across = Y;
	none();
	if (term == LOD_COLLAPSE_DISTANCE)
		near[0] = 2;
	if (term == LOD_COLLAPSE_AREA)
		half[0] = 0.3;
	if (term == LOD_COLLAPSE_INTERIORITY)
		away[1] = 5;
	if (term == LOD_COLLAPSE_ANGLE)
		across = (struct lod_v3){ 0, 0.8, 0.6 };
	/* the first has a little less to lose in what else counts, so that a tie is not what decides */
	double axis = term == LOD_COLLAPSE_DISTANCE ? 39.9 : 40;
	away[0] = away[0] / 40 * axis;
	rectangle((struct lod_v3){ away[0], -near[0] / 2, 0 }, lod_v3_scale(X, half[0]),
		lod_v3_scale(across, 0.2));
	square(away[0], near[0] / 2, 0, 0.2);
	square(away[1], -near[1] / 2, 0, 0.2);
	square(away[1], near[1] / 2, 0, 0.2);
}

/* Leaves 0 and 1 collapse first. Leaf 2 is a little nearer to their quad than 3 is to 4. */
static void candidates_of_leaves(void)
{
	none();
	for (int i = 0; i < 2; i++)
		square(-40, 0.001 * i, 0, 0.2);
	square(-40, 1, 0, 0.2);
	square(40, -0.51, 0, 0.2);
	square(40, 0.51, 0, 0.2);
}

static bool is_pair(uint32_t quad, uint32_t a, uint32_t b)
{
	const uint32_t *child = collapse.node[quad].child;
	return (child[0] == a && child[1] == b) || (child[0] == b && child[1] == a);
}

UNIT_TEST(each_term_of_the_cost_decides_somewhere)
{
	for (int term = 0; term < LOD_COLLAPSE_TERMS; term++) {
		struct lod_collapse_options options = { .weight = { 1, 0.25, 1, 0.5, 0.5 },
			.distance_most = 0.2, .angle_most_rad = LOD_PI / 2 };
		/* a quad's area differs from a leaf's: that is the other term of the scene of leaves */
		if (term == LOD_COLLAPSE_LEAVES) {
			candidates_of_leaves();
			options.weight[LOD_COLLAPSE_AREA] = 0;
		} else {
			candidates((enum lod_collapse_term)term);
		}
		uint32_t quad = leaves.count + (term == LOD_COLLAPSE_LEAVES);
		make(&options);
		assert_true(term == LOD_COLLAPSE_LEAVES ? is_pair(quad, 3, 4) : is_pair(quad, 2, 3));
		options.weight[term] = 0;
		make(&options);
		assert_true(term == LOD_COLLAPSE_LEAVES ? is_pair(quad, leaves.count, 2)
			: is_pair(quad, 0, 1));
		assert_true(lod_collapse_defaults.weight[term] > 0);
	}
}

UNIT_TEST(cut_offs_end_the_collapse)
{
	struct lod_collapse_options options = free_of_limits;
	strew(150, 8);
	options.leaves_most = 10;
	make(&options);
	for (uint32_t i = 0; i < collapse.leaves + collapse.made; i++)
		assert_true(collapse.node[i].represents <= 10);
	assert_true(collapse.roots >= 15);
	options = free_of_limits;
	options.angle_most_rad = 0.3;
	options.distance_most = 0.3;
	make(&options);
	assert_true(collapse.made > 10 && collapse.roots > 10);
	for (uint32_t i = collapse.leaves; i < collapse.leaves + collapse.made; i++) {
		const struct lod_collapse_node *a = &collapse.node[collapse.node[i].child[0]],
			*b = &collapse.node[collapse.node[i].child[1]];
		assert_true(lod_arc_cosine(fabs(lod_v3_dot(a->normal, b->normal))) <= 0.3);
		assert_true(lod_v3_distance(a->center, b->center) <= 0.3 * 3 * sqrt(3));
	}
}

/* All pairs are compared at each step. */
UNIT_TEST(the_search_finds_the_cheapest_of_all_pairs)
{
	/* farther pairs may cost less than near ones */
	static const struct lod_collapse_options inward = { .weight = { 0.1, 0.2, 0.1, 0.1, 3 },
		.distance_most = 1, .angle_most_rad = LOD_PI / 2 };
	static const struct lod_collapse_options nearest = { .weight = { 1, 0, 0, 0, 0 }, .distance_most = 4,
		.angle_most_rad = LOD_PI / 2 };
	static const struct lod_collapse_options *const all[] = { &lod_collapse_defaults, &free_of_limits,
		&inward, &nearest };
	for (size_t k = 0; k < sizeof all / sizeof *all; k++) {
		strew(250, 9 + k);
		make(all[k]);
		struct lod_collapse_crown crown = { 0 };
		struct lod_v3 low = collapse.node[0].center, high = low;
		for (uint32_t i = 0; i < collapse.leaves; i++) {
			struct lod_v3 p = collapse.node[i].center;
			low = (struct lod_v3){ fmin(low.x, p.x), fmin(low.y, p.y), fmin(low.z, p.z) };
			high = (struct lod_v3){ fmax(high.x, p.x), fmax(high.y, p.y), fmax(high.z, p.z) };
			crown.across = fmax(crown.across, sqrt(p.x * p.x + p.y * p.y));
		}
		crown.radius = lod_v3_distance(low, high) / 2;
		bool gone[2 * MOST] = { false };
		for (uint32_t end = collapse.leaves; end < collapse.leaves + collapse.made; end++) {
			double least = INFINITY;
			for (uint32_t a = 0; a < end; a++)
				for (uint32_t b = 0; b < a && !gone[a]; b++)
					if (!gone[b])
						least = fmin(least, lod_collapse_cost(&collapse.node[a],
							&collapse.node[b], &crown, all[k]));
			const uint32_t *child = collapse.node[end].child;
			double cost = lod_collapse_cost(&collapse.node[child[0]], &collapse.node[child[1]],
				&crown, all[k]);
			assert_true(!gone[child[0]] && !gone[child[1]] && cost <= least * (1 + 1e-9));
			gone[child[0]] = gone[child[1]] = true;
		}
	}
}

UNIT_TEST(the_same_leaves_collapse_the_same_way)
{
	static uint32_t place[2 * MOST];
	strew(400, 30);
	make(NULL);
	uint32_t nodes = collapse.leaves + collapse.made;
	memcpy(place, collapse.place, nodes * sizeof *place);
	make(NULL);
	assert_int_equal(collapse.leaves + collapse.made, nodes);
	assert_memory_equal(place, collapse.place, nodes * sizeof *place);
}

/* ---- Sectors ---- */

static struct lod_collapse_sectors divided(uint32_t count)
{
	struct lod_collapse_sectors sectors;
	assert_int_equal(setjmp(arena.failed), 0);
	lod_collapse_sectors_make(&sectors, count, &leaves, NULL, &arena);
	return sectors;
}

UNIT_TEST(sectors_hold_every_leaf_once_the_innermost_in_the_first)
{
	bool seen[MOST] = { false };
	double inner = 0, outer = INFINITY;
	strew(203, 12);
	struct lod_collapse_sectors s = divided(6);
	for (uint32_t k = 0; k < 6; k++) {
		uint32_t count = s.first[k + 1] - s.first[k];
		assert_true(count == 33 || count == 34);
		assert_int_equal(s.forest[k].leaves, count);
		for (uint32_t i = 0; i < count; i++) {
			uint32_t leaf = s.leaf[s.first[k] + i];
			struct lod_v3 at = s.forest[k].node[i].center;
			double away = sqrt(at.x * at.x + at.y * at.y);
			assert_false(seen[leaf]);
			seen[leaf] = true;
			assert_memory_equal(s.leaves[k].corner[4 * i], corner[4 * leaf], sizeof corner[0]);
			if (k == 0)
				inner = fmax(inner, away);
			else
				outer = fmin(outer, away);
		}
	}
	assert_true(inner <= outer);
}

/* A sector is smaller than the crown; its leaves may be as far apart as if there were no sectors. */
UNIT_TEST(cut_offs_of_sectors_are_over_the_whole_crown)
{
	strew(400, 13);
	make(NULL);
	uint32_t roots = collapse.roots, divided_roots = 0;
	struct lod_collapse_sectors s = divided(4);
	for (uint32_t k = 0; k < 4; k++)
		divided_roots += s.forest[k].roots;
	assert_true(divided_roots >= roots && divided_roots < roots * 5 / 4);
}

/* ---- Textures ---- */

static struct lod_foliage foliage;
static struct bench_collapse_plant plant;

static void grow_plant(uint32_t sectors)
{
	lod_arena_free(&arena);
	assert_int_equal(setjmp(arena.failed), 0);
	foliage_random(&foliage, &(struct foliage_random){ 2000, 4, 3, 0.25, 21 }, &arena);
	bench_collapse_make(&plant, &foliage, &(struct bench_collapse_options){ .sectors = sectors }, &arena);
}

UNIT_TEST(tiles_have_the_density_of_their_quads)
{
	grow_plant(0);
	const struct lod_collapse *c = plant.sectors.forest;
	double sum[LOD_COLLAPSE_TILES] = { 0 };
	uint32_t quads[LOD_COLLAPSE_TILES] = { 0 };
	for (uint32_t i = 0; i < c->made; i++) {
		const struct lod_collapse_node *quad = &c->node[c->leaves + i];
		uint32_t tile = plant.atlas.of[0][i];
		assert_int_equal(quad->represents == 2, tile < LOD_COLLAPSE_PAIR_TILES);
		assert_true(plant.atlas.tile[tile].side > 0);
		sum[tile] += fmin(1, quad->opaque_area / quad->area);
		quads[tile]++;
	}
	for (uint32_t t = 0; t < LOD_COLLAPSE_TILES; t++) {
		const struct lod_collapse_tile *tile = &plant.atlas.tile[t];
		assert_int_equal(quads[t], tile->quads);
		if (!tile->side)
			continue;
		assert_int_equal(tile->side, t < LOD_COLLAPSE_PAIR_TILES ? 128 : 64);
		assert_true(fabs(lod_collapse_atlas_share(&plant.atlas, t) - tile->density) < 0.02);
		/* tiles of densities lie in their bins; pairs' distances spread theirs more */
		assert_true(quads[t] < 20 || fabs(sum[t] / quads[t] - tile->density) < 0.15);
	}
}

/* Were rare poses drawn, most quads would get a tile that does not look like them. */
UNIT_TEST(pairs_look_as_their_tiles_show_them)
{
	grow_plant(0);
	const struct lod_collapse *c = plant.sectors.forest;
	double off = 0, least = 9, most = 0;
	uint32_t pairs = 0;
	for (uint32_t i = 0; i < c->made; i++) {
		const struct lod_collapse_node *quad = &c->node[c->leaves + i];
		if (quad->represents != 2)
			continue;
		const struct lod_collapse_node *a = &c->node[quad->child[0]], *b = &c->node[quad->child[1]];
		struct lod_v3 d = lod_v3_sub(a->center, b->center);
		d = lod_v3_sub(d, lod_v3_scale(quad->normal, lod_v3_dot(d, quad->normal)));
		double apart = lod_v3_length(d) / (lod_v3_length(a->half[0]) + lod_v3_length(b->half[0])),
			shown = plant.atlas.tile[plant.atlas.of[0][i]].distance;
		off += fabs(apart - shown);
		least = fmin(least, shown);
		most = fmax(most, shown);
		pairs++;
	}
	assert_true(pairs > 200 && most > least + 0.2);
	assert_true(off / pairs < 0.17);
}

UNIT_TEST(texture_coordinates_stay_inside_their_tile)
{
	grow_plant(0);
	for (uint32_t t = 0; t < LOD_COLLAPSE_TILES; t++) {
		const struct lod_collapse_tile *tile = &plant.atlas.tile[t];
		float uv[4][2];
		lod_collapse_atlas_uv(&plant.atlas, t, uv);
		for (uint32_t k = 0; k < 4 && tile->side; k++) {
			double x = floor((double)uv[k][0] * plant.atlas.image.width),
				y = floor((double)uv[k][1] * plant.atlas.image.height);
			assert_true(x >= tile->x && x < tile->x + tile->side);
			assert_true(y >= tile->y && y < tile->y + tile->side);
		}
	}
}

/* ---- As elements ---- */

UNIT_TEST(levels_are_elements_of_the_extended_foliage)
{
	for (uint32_t sectors = 0; sectors <= 5; sectors += 5) {
		grow_plant(sectors);
		uint32_t *order = lod_arena_take(&arena, foliage.count, sizeof *order),
			*shown = lod_arena_take(&arena, foliage.count, sizeof *shown);
		bench_collapse_extend(&plant, &foliage, &arena);
		for (uint32_t s = 0; s < plant.sectors.count; s++)
			for (uint32_t row = 0; row <= plant.sectors.forest[s].made; row += 7) {
				uint64_t vertices = 0;
				uint32_t count = bench_collapse_order(&plant, s, row, order);
				for (uint32_t i = 0; i < count; i++)
					vertices += 3 * (foliage.first[order[i] + 1]
						- foliage.first[order[i]] - 2);
				assert_int_equal(vertices, plant.vertices[s][row]);
				assert_true(bench_collapse_row(&plant, s, (double)vertices) >= row);
			}
		bench_collapse_shown(&plant, 0, plant.sectors.forest[0].made, shown, &arena);
		for (uint32_t i = 0; i < plant.sectors.forest[0].leaves; i++)
			assert_int_equal(shown[plant.sectors.leaf[i]], plant.sectors.leaf[i]);
	}
}

UNIT_TEST(leaves_on_one_spot_do_not_take_long)
{
	static struct lod_foliage many;
	lod_arena_free(&arena);
	assert_int_equal(setjmp(arena.failed), 0);
	foliage_random(&many, &(struct foliage_random){ 6000, 4, 1e-9, 0.1, 3 }, &arena);
	lod_collapse_make(&collapse, &(struct lod_collapse_leaves){ many.count, many.first,
		(const float (*)[3])many.corner, NULL, 0, 0 }, &free_of_limits, &arena);
	assert_int_equal(collapse.roots + collapse.made, 6000);
	lod_arena_free(&arena);
}
