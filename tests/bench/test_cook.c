/* Cook's scales: what is expected to be visible stays. */
#include <math.h>

#include "lod/sort.h"
#include "tests/bench/baseline/cook.h"
#include "tests/support/unit_test.h"

static double covered(uint32_t count, double share)
{
	return 1 - pow(1 - share, count);
}

UNIT_TEST(plain_scale_keeps_the_sum_of_areas)
{
	assert_true(lod_cook_scale(10, 100) == 10);
	assert_true(lod_cook_scale(100, 100) == 1);
	assert_true(lod_cook_scale(0, 100) == 0);
}

UNIT_TEST(depth_keeps_the_expected_visible_area)
{
	static const struct { uint32_t kept, count; double share; } rows[] =
		{ { 1, 10, 0.05 }, { 3, 1000, 0.002 }, { 50, 60, 0.1 }, { 500, 5000, 0.001 },
		{ 2, 100000, 1e-5 } };
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
		double s = lod_cook_scale_depth(rows[i].kept, rows[i].count, rows[i].share);
		assert_true(s >= 1 && s <= lod_cook_scale(rows[i].kept, rows[i].count) && s * rows[i].share
			<= 1);
		assert_true(fabs(covered(rows[i].kept, s * rows[i].share)
			- covered(rows[i].count, rows[i].share)) < 1e-9);
	}
}

UNIT_TEST(depth_hardly_matters_for_many_small_elements)
{
	assert_true(fabs(lod_cook_scale_depth(2000, 10000, 1e-4) - 5) < 0.005);
	assert_true(lod_cook_scale_depth(500, 1000, 0) == 2);
}

UNIT_TEST(a_crown_without_gaps_is_covered_by_one_element)
{
	double s = lod_cook_scale_depth(1, 100000, 0.01);
	assert_true(s <= 100 && s > 99.9);
}

UNIT_TEST(the_share_explains_what_is_covered)
{
	for (uint32_t n = 2; n < 100000; n *= 7) {
		double a = 0.3 / sqrt(n), outline = 5000, one = a * outline;
		assert_true(fabs(lod_cook_share(n, n * one, outline * covered(n, a)) - a) < 1e-6 * a);
	}
	assert_true(lod_cook_share(10, 5, 5) == 0);
	assert_true(lod_cook_share(0, 5, 5) == 0);
	assert_true(lod_cook_share(10, 10, 0.5) > 0.999);
}

/* The mean of k colours drawn at random has 1/k of their variance. */
UNIT_TEST(contrast_keeps_the_variance_of_pixels)
{
	double variance[2];
	for (int pruned = 0; pruned < 2; pruned++) {
		double sum = 0, squares = 0, contrast = pruned ? lod_cook_contrast(1, 4, 16) : 1;
		uint32_t per_pixel = pruned ? 4 : 16;
		for (uint32_t pixel = 0; pixel < 20000; pixel++) {
			double mean = 0;
			for (uint32_t i = 0; i < per_pixel; i++)
				mean += contrast * (eco_random_unit(lod_mix(pixel * 100u + i)) - 0.5)
					/ per_pixel;
			sum += mean;
			squares += mean * mean;
		}
		variance[pruned] = squares / 20000 - sum / 20000 * sum / 20000;
	}
	assert_true(fabs(variance[1] / variance[0] - 1) < 0.05);
	assert_true(lod_cook_contrast(1, 100, 0.2) == 1);        /* each larger than a pixel */
	assert_true(lod_cook_contrast(7, 7, 50) == 1);
}
