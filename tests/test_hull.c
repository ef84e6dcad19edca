/* The hull: density, normals, samples on it, and how many of them a picture hides. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "ecofiles/plan.h"
#include "lod/hull.h"
#include "tests/plant_models.h"

#define MOST 4000
#define ROOM 600
#define SIZE 64

static struct lod_arena arena;
static struct soup dice;
static struct lod_v3 center[MOST];
static struct lod_hull hull;
static struct lod_hull_sample samples[ROOM], again[ROOM];
static float depth[SIZE * SIZE];
static uint64_t owner[SIZE * SIZE];

/* A ball of leaves of radius 5 around (0, 0, 10): the iso-surface is a little larger. */
static void ball(void)
{
	assert_int_equal(setjmp(arena.failed), 0);
	dice.state = 9;
	for (uint32_t i = 0; i < MOST; i++)
		center[i] = lod_v3_add(lod_v3_scale(soup_direction(&dice), 5 * cbrt(soup_random(&dice, 0, 1))), (struct lod_v3){ 0, 0, 10 });
	lod_hull_make(&hull, center, MOST, 30, &arena);
}

static void density_is_a_sum_of_balls(void **state)
{
	(void)state;
	assert_int_equal(setjmp(arena.failed), 0);
	struct lod_v3 one = { 1, 2, 3 }, two[2] = { { 0, 0, 0 }, { 100, 0, 0 } };
	lod_hull_make(&hull, &one, 1, 20, &arena);
	assert_true(fabs(lod_hull_density(&hull, one) - 1) < 0.3);       /* between nodes half a radius apart */
	lod_hull_make(&hull, two, 2, 20, &arena);
	assert_true(hull.radius >= 100 / 64.0);
	assert_true(lod_hull_density(&hull, (struct lod_v3){ 50, 0, 0 }) == 0);
	lod_arena_free(&arena);
}

static void normals_point_outwards(void **state)
{
	(void)state;
	ball();
	double worst = 1;
	for (uint32_t i = 0; i < MOST; i++) {
		struct lod_v3 normal, out = lod_v3_unit(lod_v3_sub(center[i], (struct lod_v3){ 0, 0, 10 }));
		if (lod_v3_distance(center[i], (struct lod_v3){ 0, 0, 10 }) < 4)
			continue;
		assert_true(lod_hull_normal(&hull, center[i], &normal));
		worst = fmin(worst, lod_v3_dot(normal, out));
	}
	assert_true(worst > 0.8);
	lod_arena_free(&arena);
}

static void samples_lie_on_the_surface_all_around(void **state)
{
	(void)state;
	ball();
	uint32_t count = lod_hull_sample(&hull, samples, ROOM, 1), side[8] = { 0 };
	assert_int_equal(count, ROOM);
	for (uint32_t i = 0; i < count; i++) {
		struct lod_v3 p = lod_v3_sub(lod_v3_of(samples[i].at), (struct lod_v3){ 0, 0, 10 });
assert_true(lod_v3_length(p) > 5.3 && lod_v3_length(p) < 6.8);
		assert_true(fabs(lod_hull_density(&hull, lod_v3_of(samples[i].at)) - 0.05) < 1e-4);
		assert_true(lod_v3_dot(lod_v3_of(samples[i].normal), p) > 0);
		side[(p.x > 0) + 2 * (p.y > 0) + 4 * (p.z > 0)]++;
	}
	for (int i = 0; i < 8; i++)
		assert_true(side[i] > ROOM / 12);
	assert_int_equal(lod_hull_sample(&hull, again, ROOM, 1), count);
	assert_memory_equal(samples, again, sizeof samples);
	assert_int_equal(lod_hull_sample(&hull, again, 7, 2), 7);
	assert_int_equal(lod_hull_sample(&hull, again, 0, 2), 0);
	lod_arena_free(&arena);
}

/* An eye on -y looking at the ball; `fill` pixels' columns from the left are covered at a distance. */
static double visible(double eye_y, uint32_t columns, float at_m, uint64_t by, bool owners, double slack)
{
	struct eco_view view = { .eye = { 0, eye_y, 10 }, .target = { 0, 0, 10 }, .up = { 0, 0, 1 }, .fov_y_deg = 40, .width = SIZE, .height = SIZE };
	struct lod_eye eye;
	lod_eye_make(&eye, &view);
	for (uint32_t i = 0; i < SIZE * SIZE; i++) {
		depth[i] = i % SIZE < columns ? 1 / at_m : 0;
		owner[i] = i % SIZE < columns ? by : 0;
	}
	const struct lod_place place = { .cosine = 1, .scale = 1 };
	return lod_hull_visible(samples, ROOM, &(struct lod_hull_sight){ &eye, &place, SIZE, SIZE, depth, owners ? owner : NULL, 1, slack });
}

static void what_stands_in_front_hides_samples(void **state)
{
	(void)state;
	ball();
	assert_int_equal(lod_hull_sample(&hull, samples, ROOM, 1), ROOM);
	assert_true(visible(-20, 0, 10, 2, true, 0) == 1);               /* nothing drawn yet */
	assert_true(visible(-20, SIZE, 10, 2, true, 0) == 0);            /* another in front */
	assert_true(visible(-20, SIZE, 40, 2, true, 0) == 1);            /* behind */
	assert_true(visible(-20, SIZE, 10, 1, true, 0) == 1);            /* itself */
	assert_true(visible(-20, SIZE, 17, 2, false, 6) == 1);           /* as near as its own leaves may be */
	double half = visible(-20, SIZE / 2, 10, 2, true, 0);
	assert_true(half > 0.4 && half < 0.6);
	assert_true(visible(-7, SIZE, 0.5f, 2, true, 0) > 0.1);          /* much of it is outside the picture */
	assert_true(lod_hull_visible(samples, 0, &(struct lod_hull_sight){ 0 }) == 1);   /* no leaf, no hull: nothing is hidden */
	lod_arena_free(&arena);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(density_is_a_sum_of_balls),
		cmocka_unit_test(normals_point_outwards),
		cmocka_unit_test(samples_lie_on_the_surface_all_around),
		cmocka_unit_test(what_stands_in_front_hides_samples),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
