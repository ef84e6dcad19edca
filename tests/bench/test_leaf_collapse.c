/* Leaf collapse (Hidalgo 2007): which pairs collapse, into which quads, and how levels lie in one array. */
#include <math.h>

#include "tests/bench/baseline/leaf_collapse.h"
#include "tests/support/plant_models.h"
#include "tests/support/unit_test.h"

#define MOST 512u

static struct lod_arena arena;
static uint32_t first[MOST + 1];
static float corner[4 * MOST][3];
static struct lod_foliage leaves;
static struct lod_collapse collapse;
static const struct lod_collapse_options free_of_limits = { .weight = { 1, 0.25, 1, 0.5, 0.1 },
	.distance_most = 4, .angle_most_rad = LOD_PI / 2 };

static void none(void)
{
	leaves = (struct lod_foliage){ .first = first, .corner = corner };
}

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

static void make(const struct lod_collapse_options *options)
{
	lod_arena_free(&arena);
	lod_collapse_make(&collapse, 1, &leaves, options, &arena);
}

static void strew(uint32_t count, uint64_t seed)
{
	none();
	for (uint32_t i = 0; i < count; i++) {
		struct lod_v3 at = { 3 * foliage_dice(&seed), 3 * foliage_dice(&seed), 3
			* foliage_dice(&seed) };
		struct lod_v3 n = { foliage_dice(&seed), foliage_dice(&seed), foliage_dice(&seed) };
		struct lod_v3 along = lod_v3_unit(lod_v3_cross(n, (struct lod_v3){ 1, 0, 0 })), across =
			lod_v3_unit(lod_v3_cross(n, along));
		rectangle(at, lod_v3_scale(along, 0.2 + 0.05 * foliage_dice(&seed)), lod_v3_scale(across,
			0.1));
	}
}

/* Figures 3 and 4: each level is two runs of leaves and quads, which stand for all leaves. */
UNIT_TEST(every_level_is_two_runs_and_a_cut_of_the_forest)
{
	for (uint64_t seed = 1; seed <= 4; seed++) {
		strew(60 * (uint32_t)seed, seed);
		make(seed % 2 ? &free_of_limits : NULL);
		assert_int_equal(collapse.roots + collapse.made, collapse.leaves);
		for (uint32_t i = 0; i <= collapse.made; i++) {
			const struct lod_collapse_level *level = &collapse.level[i];
			uint64_t represented = 0;
			assert_int_equal(level->a + level->c, collapse.roots + i);
			for (uint32_t k = 0; k < level->a + level->c; k++) {
				uint32_t id = collapse.place[k < level->a ? k : level->b + k - level->a];
				assert_int_equal(k < level->a, id < collapse.leaves);
				represented += collapse.node[id].represents;
			}
			assert_int_equal(represented, collapse.leaves);
		}
	}
}

/* Section 3.2: two leaves and their quad, or no quad within the default cut-offs. Half axes of 0.5 but for
 * the coincident centres, where the axis is that of the larger leaf. */
static const struct {
	struct lod_v3 at[2], along[2], across[2];
	bool apart;
	double area, ratio;          /* of the quad; main half axis over the other */
	struct lod_v3 axis, normal;
} quads[] = {
	/* the sum of areas is 2, what encloses both is 3 by 1 */
	{ { { -1, 0, 0 }, { 1, 0, 0 } }, { { 0.5, 0, 0 }, { 0.5, 0, 0 } }, { { 0, 0.5, 0 }, { 0, 0.5, 0 } },
		true, 2.5, 3, { 1, 0, 0 }, { 0, 0, 1 } },
	/* opposing normals: a leaf has no back */
	{ { { 0, 0, 0 }, { 0, 1, 0 } }, { { 0, 0.5, 0 }, { 0, 0.5, 0 } }, { { 0, 0, 0.5 }, { 0, 0, -0.5 } },
		true, 2, 2, { 0, 1, 0 }, { 1, 0, 0 } },
	{ { { 1, 1, 0 }, { 1, 1, 0 } }, { { 0.5, 0, 0 }, { 0, 2, 0 } }, { { 0, 0.01, 0 }, { 0.01, 0, 0 } },
		false, 2.05, 4, { 0.005, 1, 0 }, { 0, 0, 1 } },
};

UNIT_TEST(two_leaves_become_the_quad_of_the_paper)
{
	for (size_t i = 0; i < sizeof quads / sizeof *quads; i++) {
		struct lod_v3 c[ECO_CORNERS_MAX];
		none();
		for (int k = 0; k < 2; k++)
			rectangle(quads[i].at[k], quads[i].along[k], quads[i].across[k]);
		make(NULL);
		assert_int_equal(collapse.made, !quads[i].apart);
		make(&free_of_limits);
		const struct lod_collapse_node *quad = &collapse.node[2];
		assert_int_equal(lod_collapse_corners(&collapse, &leaves, 2, c), 4);
		double area = lod_v3_length(lod_v3_cross(lod_v3_sub(c[1], c[0]), lod_v3_sub(c[3], c[0])));
		assert_true(fabs(quad->area - quads[i].area) < 0.01 && fabs(area - quad->area) < 1e-6);
		assert_true(fabs(lod_v3_length(quad->half[0]) / lod_v3_length(quad->half[1])
			- quads[i].ratio) < 0.1);
		assert_true(fabs(lod_v3_dot(lod_v3_unit(quad->half[0]), quads[i].axis)) > 0.9999);
		assert_true(fabs(lod_v3_dot(quad->normal, quads[i].normal)) > 0.9999);
	}
}

/* Section 3.1, one term after the other. `crown`: its radius, and that around the axis. */
static double cost_of(const struct lod_collapse_node *a, const struct lod_collapse_node *b,
	const double crown[2], const struct lod_collapse_options *options)
{
	double apart = lod_v3_distance(a->center, b->center) / (options->distance_most * crown[0]),
		angle = lod_arc_cosine(fabs(lod_v3_dot(a->normal, b->normal)));
	const double term[LOD_COLLAPSE_TERMS] = { apart, angle / (LOD_PI / 2),
		fabs((double)a->represents - b->represents) / ((double)a->represents + b->represents),
		fabs(a->area - b->area) / (a->area + b->area),
		hypot(a->center.x + b->center.x, a->center.y + b->center.y) / 2 / crown[1] };
	double sum = 0;
	for (int i = 0; i < LOD_COLLAPSE_TERMS; i++)
		sum += options->weight[i] * term[i];
	return apart > 1 || angle > options->angle_most_rad ? INFINITY : sum;
}

static void measure_crown(double crown[2])
{
	struct lod_v3 low = collapse.node[0].center, high = low;
	crown[1] = 0;
	for (uint32_t i = 0; i < collapse.leaves; i++) {
		struct lod_v3 p = collapse.node[i].center;
		low = (struct lod_v3){ fmin(low.x, p.x), fmin(low.y, p.y), fmin(low.z, p.z) };
		high = (struct lod_v3){ fmax(high.x, p.x), fmax(high.y, p.y), fmax(high.z, p.z) };
		crown[1] = fmax(crown[1], hypot(p.x, p.y));
	}
	crown[0] = lod_v3_distance(low, high) / 2;
}

/* All pairs are compared at each step, also with options by which farther pairs may cost less than near ones.
 * */
UNIT_TEST(the_search_finds_the_cheapest_of_all_pairs)
{
	static const struct lod_collapse_options inward = { .weight = { 0.1, 0.2, 0.1, 0.1, 3 },
		.distance_most = 1, .angle_most_rad = LOD_PI / 2 }, nearest = { .weight = { 1, 0, 0, 0, 0 },
		.distance_most = 4, .angle_most_rad = LOD_PI / 2 };
	const struct lod_collapse_options *const all[] = { &lod_collapse_defaults, &free_of_limits, &inward,
		&nearest };
	for (size_t k = 0; k < sizeof all / sizeof *all; k++) {
		strew(250, 9 + k);
		make(all[k]);
		double crown[2];
		measure_crown(crown);
		bool gone[2 * MOST] = { false };
		for (uint32_t end = collapse.leaves; end < collapse.leaves + collapse.made; end++) {
			double least = INFINITY;
			for (uint32_t a = 0; a < end; a++)
				for (uint32_t b = 0; b < a && !gone[a]; b++)
					if (!gone[b])
						least = fmin(least, cost_of(&collapse.node[a],
							&collapse.node[b], crown, all[k]));
			const uint32_t *child = collapse.node[end].child;
			assert_true(!gone[child[0]] && !gone[child[1]]);
			assert_true(cost_of(&collapse.node[child[0]], &collapse.node[child[1]], crown,
				all[k]) <= least * (1 + 1e-9));
			gone[child[0]] = gone[child[1]] = true;
		}
	}
}
