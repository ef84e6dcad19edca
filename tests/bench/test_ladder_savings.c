/* The section ladder: savings from curves, and a small plant measured whole. */
#include <math.h>
#include <string.h>

#include "tests/bench/ladder/bench_ladder_plant.h"
#include "tests/support/plant_models.h"
#include "tests/support/unit_test.h"

UNIT_TEST(the_least_lambda_reaches_q_by_the_curve_that_tuning_views_prefer)
{
	/* Q rises with lambda, by falling lambda */
	const struct bench_ladder_curve lists = { { { 1, 1, 1 }, { 0.25, 0.5, 0.5 }, { 0.04, 0.2, 0.2 } },
		3 };
	/* tuned Q and Q of one point of splats at .1: none where tuned is negative */
	static const struct { double tuned, splat_q, q, reach; } cases[] = { { -1, 0, 0.5, 0.25 }, { -1, 0,
		0.75, 0.625 },
		{ -1, 0, 0.1, 0.04 }, { -1, 0, 1, 1 }, { -1, 0, 1.1, 1 }, { 0.6, 0.6, 0.55, 0.1 },
		/* at 0.25 splats of 0.1 are better, at 1 the lists are */
		{ 0.6, 0.6, 0.7, 1 }, { 0.2, 0.6, 0.55, 0.325 }, { 0.6, 0.1, 0.45, 1 } };
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		const struct bench_ladder_curve splats = { { { 0.1, cases[i].tuned, cases[i].splat_q } }, 1 };
		double reach = bench_ladder_reach(&lists, cases[i].tuned < 0 ? NULL : &splats, cases[i].q);
		if (fabs(reach - cases[i].reach) > 1e-12)
			fail_msg("case %zu: %g", i, reach);
	}
}

UNIT_TEST(cook_saves_nothing_against_himself)
{
	static struct bench_ladder ladder;
	struct bench_ladder_curve *curve = &ladder.kind[BENCH_LADDER_GREEDY];
	for (int g = 0; g < BENCH_SPACINGS; g++)
		for (uint32_t d = 0; d < BENCH_DISTANCES; d++)
			ladder.cook_q[g][d] = 1 - bench_distance((enum bench_spacing)g, d);
	for (double left = 1; left > 0.04; left -= 0.02)
		curve->at[curve->count++] = (struct bench_ladder_point){ left * left, left, left };
	for (int quarter = 0; quarter < 2; quarter++) {
		for (int total = 0; total < 2; total++)
			assert_true(fabs(bench_ladder_saving(&ladder, NULL, BENCH_LADDER_LISTS, BENCH_NEAR,
				total) - 0.75 * quarter) < 2e-3);
		for (uint32_t i = 0; i < curve->count; i++)
			curve->at[i].lambda /= 4;
	}
}

UNIT_TEST(intervals_hold_the_mean_and_shrink)
{
	double values[64];
	for (uint32_t i = 0; i < 64; i++)
		values[i] = i % 4;
	struct bench_interval few = bench_interval_of(values, 4), many = bench_interval_of(values, 64);
	assert_true(few.mean == 1.5 && many.mean == 1.5 && few.low < few.mean && few.mean < few.high);
	/* 1.96 standard errors of the mean, within a tenth */
	assert_true(fabs((many.high - many.low) / (2 * 1.96 * sqrt(1.25 / 64)) - 1) < 0.1);
	assert_true(isnan(bench_interval_of(values, 0).mean));
}

UNIT_TEST(a_small_tree_is_measured)
{
	static struct bench_ladder ladder, again;
	struct bench_ladder_curve splats;
	struct bench bench = { .full = false };
	struct eco_error error = { 0 };
	struct soup soup;
	soup_tree(&soup, 150, 0, false);
	assert_ok(bench_ladder_measure(&bench, &ladder, &soup.model, 1, &error), error);
	assert_ok(bench_ladder_measure(&bench, &again, &soup.model, 1, &error), error);
	assert_ok(bench_ladder_splats(&bench, &splats, &soup.model, &error), error);
	assert_int_equal(ladder.elements, 150);
	for (int k = 0; k < BENCH_LADDER_KINDS; k++) {
		const struct bench_ladder_curve *curve = &ladder.kind[k];
		assert_true(curve->count > 20 && curve->at[0].lambda == 1 && curve->at[0].q == 1);
		assert_memory_equal(curve, &again.kind[k], sizeof *curve);
		for (uint32_t i = 1; i < curve->count; i++)
			assert_true(curve->at[i].lambda <= curve->at[i - 1].lambda);
	}
	assert_true(ladder.cook_q[BENCH_NEAR][0] == 1 && ladder.cook_q[BENCH_NEAR][15] < 0.9);
	double ours = bench_ladder_saving(&ladder, &splats, BENCH_LADDER_OURS, BENCH_EVEN, true),
	       lists = bench_ladder_saving(&ladder, &splats, BENCH_LADDER_LISTS, BENCH_EVEN, true),
	       random = bench_ladder_saving(&ladder, &splats, BENCH_LADDER_RANDOM_LISTS, BENCH_EVEN, true);
	assert_true(ours >= lists - 0.02 && lists > random && random > 0);
	assert_true(splats.count > 5 && splats.at[0].q > 0.5);
	/* the impostor is one vertex */
	assert_true(fabs(splats.at[splats.count - 1].lambda * ladder.vertices - 1) < 1e-6);
	soup_free(&soup);
}
