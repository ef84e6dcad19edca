/* The hull: density and normals. */
#include "lod/build/order/iso_surface.h"
#include "tests/support/plant_models.h"
#include "tests/support/unit_test.h"

#define MOST 4000

static struct lod_arena arena;
static struct soup dice;
static struct lod_v3 center[MOST];
static struct lod_iso_surface hull;

/* A ball of leaves of radius 5 around (0, 0, 10): the iso-surface is a little larger. */
static void ball(void)
{
	assert_int_equal(setjmp(arena.failed), 0);
	dice.state = 9;
	for (uint32_t i = 0; i < MOST; i++)
		center[i] =
			lod_v3_add(lod_v3_scale(soup_direction(&dice), 5 * cbrt(soup_random(&dice, 0, 1))),
			(struct lod_v3){ 0, 0, 10 });
	lod_iso_surface_make(&hull, center, MOST, 30, &arena);
}

UNIT_TEST(density_is_a_sum_of_balls)
{
	assert_int_equal(setjmp(arena.failed), 0);
	struct lod_v3 one = { 1, 2, 3 }, two[2] = { { 0, 0, 0 }, { 100, 0, 0 } };
	lod_iso_surface_make(&hull, &one, 1, 20, &arena);
	/* between nodes half a radius apart */
	assert_true(fabs(lod_iso_surface_density(&hull, one) - 1) < 0.3);
	lod_iso_surface_make(&hull, two, 2, 20, &arena);
	assert_true(hull.radius >= 100 / 64.0);
	assert_true(lod_iso_surface_density(&hull, (struct lod_v3){ 50, 0, 0 }) == 0);
	lod_arena_free(&arena);
}

UNIT_TEST(normals_point_outwards)
{
	ball();
	double worst = 1;
	for (uint32_t i = 0; i < MOST; i++) {
		struct lod_v3 normal, out = lod_v3_unit(lod_v3_sub(center[i], (struct lod_v3){ 0, 0, 10 }));
		if (lod_v3_distance(center[i], (struct lod_v3){ 0, 0, 10 }) < 4)
			continue;
		assert_true(lod_iso_surface_normal(&hull, center[i], &normal));
		worst = fmin(worst, lod_v3_dot(normal, out));
	}
	assert_true(worst > 0.8);
	lod_arena_free(&arena);
}
