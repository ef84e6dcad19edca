/* Lee's orders: which leaves of which groups a budget keeps for a view. */
#include "tests/bench/baseline/lee.h"
#include "tests/support/plant_models.h"
#include "tests/support/unit_test.h"

#define MOST 1000

static struct lod_arena arena;
static struct soup dice;
static struct lod_lee_group groups[MOST];
static uint32_t kept[MOST];
static const struct lod_lee_view from_x = { .eye = { 100, 0, 0 }, .forward = { -1, 0, 0 }, .layers = 4 };

static uint64_t choose(enum lod_lee_method method, uint32_t count, const struct lod_lee_view *view,
	uint64_t budget)
{
	assert_int_equal(setjmp(arena.failed), 0);
	lod_lee_keep(kept, method, groups, count, view, budget, &arena);
	assert_null(arena.last);
	uint64_t sum = 0;
	for (uint32_t i = 0; i < count; i++) {
		assert_true(kept[i] <= groups[i].count);
		sum += kept[i];
	}
	return sum;
}

/* Leaves of a cloud, one a group; leaves with an even index face along x. */
static void cloud(uint32_t count)
{
	dice.state = 11;
	for (uint32_t i = 0; i < count; i++) {
		struct lod_v3 at = lod_v3_scale(soup_direction(&dice), 5), normal = { i % 4 ? -2 : 3, 0, 0 };
		if (i % 2)
			normal = lod_v3_cross(soup_direction(&dice), (struct lod_v3){ 1, 0, 0 });
		lod_lee_group_make(&groups[i], &at, &normal, &(uint32_t){ 0 }, 1);
	}
}

UNIT_TEST(distance_keeps_the_nearest)
{
	cloud(MOST);
	assert_int_equal(choose(LOD_LEE_DISTANCE, MOST, &from_x, 300), 300);
	double last = 0, first = 1e9;
	for (uint32_t i = 0; i < MOST; i++) {
		double d = lod_v3_distance(groups[i].center, from_x.eye);
		last = kept[i] && d > last ? d : last;
		first = !kept[i] && d < first ? d : first;
	}
	assert_true(last <= first);
}

/* Both sides of a leaf count alike. */
UNIT_TEST(normal_keeps_what_faces_the_eye)
{
	cloud(MOST);
	assert_int_equal(choose(LOD_LEE_NORMAL, MOST, &from_x, MOST / 2), MOST / 2);
	for (uint32_t i = 0; i < MOST; i++)
		assert_int_equal(kept[i], i % 2 == 0);
}

static const struct { uint32_t n[4]; uint64_t budget; uint32_t expected[4]; } rows[] = {
	{ { 50, 50, 50, 50 }, 100, { 40, 30, 20, 10 } },
	/* 30 over go to the second; it uses 20 of them */
	{ { 10, 50, 50, 50 }, 100, { 10, 50, 30, 10 } },
	/* what the last cannot use goes to the front */
	{ { 50, 50, 50, 2 }, 100, { 48, 30, 20, 2 } },
	{ { 50, 50, 0, 1 }, 100, { 50, 49, 0, 1 } },
	{ { 5, 5, 5, 5 }, 100, { 5, 5, 5, 5 } },
	{ { 50, 50, 50, 50 }, 0, { 0, 0, 0, 0 } },
	{ { 50, 50, 50, 50 }, 3, { 1, 1, 0, 1 } },
};

/* n[i] leaves in layer i from the front, 4 layers: what of a budget each gets (equation 1 and its two
 * passes). */
UNIT_TEST(layers_share_the_budget)
{
	for (size_t r = 0; r < sizeof rows / sizeof *rows; r++) {
		uint32_t count = 0, got[4] = { 0 };
		for (uint32_t layer = 0; layer < 4; layer++)
			for (uint32_t i = 0; i < rows[r].n[layer]; i++, count++)
				/* the outermost leaves of the first and last layer say how thick layers are
				 */
				groups[count] =
					(struct lod_lee_group){
					.center = { layer == 0 ? 4 : layer == 3 ? 0 : 3.5 - layer, 0, 0 },
					.count = 1 };
		choose(LOD_LEE_LAYER, count, &from_x, rows[r].budget);
		for (uint32_t layer = 0, i = 0; layer < 4; layer++)
			for (uint32_t k = 0; k < rows[r].n[layer]; k++)
				got[layer] += kept[i++];
		for (uint32_t layer = 0; layer < 4; layer++)
			assert_int_equal(got[layer], rows[r].expected[layer]);
	}
}

UNIT_TEST(inside_a_layer_normals_decide)
{
	cloud(MOST);
	assert_int_equal(choose(LOD_LEE_LAYER, MOST, &(struct lod_lee_view){ from_x.eye, from_x.forward, 1 },
		500), 500);
	for (uint32_t i = 0; i < MOST; i++)
		assert_int_equal(kept[i], i % 2 == 0);
}

UNIT_TEST(every_budget_is_used_up)
{
	cloud(MOST);
	for (uint32_t i = 0; i < MOST; i++)
		groups[i].count = i % 7;
	uint64_t all = 0;
	for (uint32_t i = 0; i < MOST; i++)
		all += groups[i].count;
	for (int method = 0; method < LOD_LEE_COUNT; method++)
		for (uint64_t budget = 0; budget < all + 100; budget += 37)
			assert_int_equal(choose((enum lod_lee_method)method, MOST, &from_x, budget),
				budget < all ? budget : all);
	assert_int_equal(choose(LOD_LEE_LAYER, 0, &from_x, 5), 0);
}

/* A group of many leaves faces the eye as the root mean square of its leaves does. */
UNIT_TEST(groups_face_as_their_leaves_do)
{
	struct lod_v3 at[2] = { { 0, 0, 0 }, { 0, 2, 0 } }, across[2] = { { 0, 1, 0 }, { 0, 0, 1 } },
		mixed[2] = { { 1, 0, 0 }, { 0, 0, 1 } };
	uint32_t both[2] = { 0, 1 };
	lod_lee_group_make(&groups[0], at, across, both, 2);
	lod_lee_group_make(&groups[1], at, mixed, both, 2);
	assert_true(groups[0].center.y == 1 && groups[1].count == 2);
	assert_int_equal(choose(LOD_LEE_NORMAL, 2, &from_x, 3), 3);
	assert_int_equal(kept[1], 2);
	assert_int_equal(kept[0], 1);
}

UNIT_TEST(flat_plants_are_one_layer)
{
	for (uint32_t i = 0; i < 10; i++)
		groups[i] = (struct lod_lee_group){ .count = 1 };
	assert_int_equal(choose(LOD_LEE_LAYER, 10, &from_x, 4), 4);
}
