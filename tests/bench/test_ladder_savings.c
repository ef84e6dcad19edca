/* The section ladder: what curves reach, what is saved, intervals; and a small plant measured whole. */
#include <math.h>
#include <string.h>

#include "tests/bench/ladder/bench_ladder_plant.h"
#include "tests/bench/ladder/bench_savings.h"
#include "tests/support/plant_models.h"
#include "tests/support/unit_test.h"

/* Q rises with lambda, by falling lambda: 1 at 1, 0.5 at 0.25, 0.2 at 0.04. */
static struct bench_ladder_curve rising(double q_more, double tuned_more)
{
	struct bench_ladder_curve curve = { .count = 3 };
	const double lambda[3] = { 1, 0.25, 0.04 }, q[3] = { 1, 0.5, 0.2 };
	for (uint32_t i = 0; i < 3; i++)
		curve.at[i] = (struct bench_ladder_point){ lambda[i], q[i] + tuned_more, q[i] + q_more };
	return curve;
}

/* A comma would be a column more: bench_table_row ends the section. */
UNIT_TEST(names_of_methods_are_cells_of_tables)
{
	for (int m = 0; m < BENCH_METHODS; m++)
		assert_null(strchr(bench_method_names[m], ','));
	for (int r = 0; r < BENCH_LADDER_ROWS; r++)
		assert_null(strchr(bench_ladder_names[r], ','));
}

UNIT_TEST(the_least_lambda_that_reaches_q)
{
	struct bench_ladder_curve curve = rising(0, 0);
	assert_true(bench_ladder_reach(&curve, NULL, 0.5) == 0.25);
	assert_true(fabs(bench_ladder_reach(&curve, NULL, 0.75) - 0.625) < 1e-12);
	assert_true(bench_ladder_reach(&curve, NULL, 0.1) == 0.04);
	assert_true(bench_ladder_reach(&curve, NULL, 1) == 1);
	assert_true(bench_ladder_reach(&curve, NULL, 1.1) == 1);
}

UNIT_TEST(splats_count_where_tuning_views_prefer_them)
{
	struct bench_ladder_curve lists = rising(0, 0), splats = { .count = 1 };
	splats.at[0] = (struct bench_ladder_point){ 0.1, 0.6, 0.6 };
	assert_true(bench_ladder_reach(&lists, &splats, 0.55) == 0.1);
	/* at 0.25 splats of 0.1 are better, at 1 the lists are */
	assert_true(fabs(bench_ladder_reach(&lists, &splats, 0.7) - 1) < 1e-12);
	splats.at[0].tuned = 0.2; /* better in the test views alone: not chosen by them */
	assert_true(bench_ladder_reach(&lists, &splats, 0.55) > 0.25);
	splats.at[0] = (struct bench_ladder_point){ 0.1, 0.6, 0.1 };
	assert_true(fabs(bench_ladder_reach(&lists, &splats, 0.45) - 1) < 1e-12);
}

UNIT_TEST(cook_saves_nothing_against_himself)
{
	static struct bench_ladder ladder;
	struct bench_ladder_curve *curve = &ladder.kind[BENCH_LADDER_GREEDY];
	for (int g = 0; g < BENCH_SPACINGS; g++)
		for (uint32_t d = 0; d < BENCH_DISTANCES; d++) {
			double left = 1 - bench_distance((enum bench_spacing)g, d);
			ladder.cook_q[g][d] = left;
		}
	for (double left = 1; left > 0.04; left -= 0.02)
		curve->at[curve->count++] = (struct bench_ladder_point){ left * left, left, left };
	for (int total = 0; total < 2; total++)
		assert_true(fabs(bench_ladder_saving(&ladder, NULL, BENCH_LADDER_LISTS, BENCH_NEAR, total)) <
			2e-3);
	for (uint32_t i = 0; i < curve->count; i++)
		curve->at[i].lambda /= 4;
	for (int total = 0; total < 2; total++)
		assert_true(fabs(bench_ladder_saving(&ladder, NULL, BENCH_LADDER_LISTS, BENCH_NEAR, total) -
				    0.75) < 2e-3);
}

UNIT_TEST(intervals_hold_the_mean_and_shrink)
{
	double values[64];
	for (uint32_t i = 0; i < 64; i++)
		values[i] = i % 4;
	struct bench_interval few = bench_interval_of(values, 4), many = bench_interval_of(values, 64);
	assert_true(few.mean == 1.5 && many.mean == 1.5);
	assert_true(few.low < few.mean && few.mean < few.high);
	assert_true(many.high - many.low < 0.5 * (few.high - few.low));
	/* 1.96 standard errors of the mean, within a tenth */
	assert_true(fabs((many.high - many.low) / (2 * 1.96 * sqrt(1.25 / 64)) - 1) < 0.1);
	assert_true(isnan(bench_interval_of(values, 0).mean));
}

UNIT_TEST(tuned_plants_are_told_by_name)
{
	assert_true(bench_ladder_tuned("sapling_quaking_aspen_s7.obj"));
	assert_true(bench_ladder_tuned("bush.obj") && !bench_ladder_tuned("bush_2.obj"));
	assert_false(bench_ladder_tuned("ash_small.obj") || bench_ladder_tuned("flowerBox.obj"));
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
