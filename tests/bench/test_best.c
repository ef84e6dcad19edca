/* The planner against everything that could be done instead, in scenes so small that it can be tried; and
 * what benches of planning make. */
#include <math.h>

#include "tests/bench/ladder/bench_best.h"
#include "tests/bench/bench_times.h"
#include "tests/support/unit_test.h"

#define SCENES 200u
#define SPLAT_SCENES 400u
#define ROUNDING 1e-9

/* Seeds of scenes where one dear step is worth some cheap ones, or tiles must be looked at with the amounts
 * that they would have. */
static const uint64_t hard[] = { 301, 1191, 2513, 2988, 3450, 3664, 3752, 5435, 5449, 5736 };
#define HARD (sizeof hard / sizeof *hard)

/* The best is never worse than the plan: else something was not tried. */
UNIT_TEST(plans_are_close_to_the_best_there_is)
{
	double sum = 0, worst = 0;
	uint32_t count = 0, tried = 0;
	for (uint64_t i = 0; i < SCENES + HARD; i++) {
		struct bench_best best;
		struct eco_error error = { 0 };
		assert_int_equal(bench_best_find(i < SCENES ? i + 1 : hard[i - SCENES],
			false, &best, &error),
			ECO_OK);
		if (!(best.empty > 0))
			continue;
		assert_true(best.planner >= best.best * (1 - ROUNDING) - ROUNDING);
		assert_true(best.best <= best.empty * (1 + ROUNDING));
		sum += (best.planner - best.best) / best.empty;
		worst = fmax(worst, (best.planner - best.best) / best.empty);
		tried += best.structures;
		count++;
	}
	assert_true(count > SCENES / 2);
	assert_true(tried > 2 * count);
	print_message("          above the best, of what is wrong with nothing drawn: mean %.4f %%, at most "
		"%.4f %%\n", 100 * sum / count, 100 * worst);
	assert_true(sum / count <= 0.01 && worst <= 0.05);
}

/* Not by the objective alone: where organs have the lower Q, a plant keeps its splats. */
UNIT_TEST(plans_with_splats_are_close_to_the_best_there_is)
{
	double sum = 0, worst = 0;
	uint32_t count = 0, above = 0;
	for (uint64_t seed = 1; seed <= SPLAT_SCENES; seed++) {
		struct bench_best best;
		struct eco_error error = { 0 };
		assert_int_equal(bench_best_find(seed, true, &best, &error), ECO_OK);
		if (!(best.empty > 0) || !best.whole_slots)
			continue;
		double over = (best.planner - best.best) / best.empty;
		assert_true(over >= -ROUNDING);
		sum += over;
		worst = fmax(worst, over);
		above += over > 0.005;
		count++;
	}
	print_message("          above the best, of what is wrong with nothing drawn: mean %.4f %%, at most "
		"%.4f %%, above .5 %% in %u of %u\n", 100 * sum / count, 100 * worst, above, count);
	assert_true(count > SPLAT_SCENES / 3);
	assert_true(sum / count <= 0.01 && worst <= 0.25 && above < count / 6);
}

UNIT_TEST(the_best_is_found_again)
{
	for (uint64_t seed = 1; seed <= 5; seed++) {
		struct bench_best a, b;
		struct eco_error error = { 0 };
		assert_int_equal(bench_best_find(seed, seed > 3, &a, &error), ECO_OK);
		assert_int_equal(bench_best_find(seed, seed > 3, &b, &error), ECO_OK);
		assert_true(a.best == b.best && a.planner == b.planner && a.structures == b.structures);
	}
}

UNIT_TEST(scenes_to_choose_in_are_sound_and_grow)
{
	static const uint32_t species[] = { 1, 25, 63, 100, 200 };
	uint64_t before = 0;
	for (size_t i = 0; i < sizeof species / sizeof *species; i++) {
		struct bench_choice choice;
		struct bench_plan_time time;
		struct eco_error error = { 0 };
		bench_choice_make(&choice, species[i]);
		choice.request.vertices = 500ull * species[i];
		assert_int_equal(bench_plan_time(&time, &choice.made.scene, &choice.request, 0, &error),
			ECO_OK);
		assert_true(time.vertices <= choice.request.vertices);
		assert_true(time.cuts > 0 && time.repetitions >= 3);
		assert_true(time.candidates > before);
		before = time.candidates;
		bench_choice_free(&choice);
	}
}
