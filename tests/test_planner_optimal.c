/* The planner against an exhaustive search of the same objective. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <stdio.h>

#include "tests/planner_optimum.h"

#define SCENES 150u

static struct random_scene scene;

static void plans_are_close_to_the_best_there_is(void **state)
{
	double sum = 0, worst = 0;
	uint32_t count = 0;
	(void)state;
	for (uint64_t seed = 1; count < SCENES; seed++) {
		struct optimum o;
		if (!optimum_find(&o, &scene, seed))
			continue;
		double gap = (o.plan - o.best) / o.empty;
		if (gap < -1e-6 || gap > 0.06)
			print_message("          seed %llu: %g wrong, %g at best, %g with nothing, %llu vertices\n", (unsigned long long)seed, o.plan, o.best,
				o.empty, (unsigned long long)o.budget);
		assert_true(gap >= -1e-6);
		sum += gap;
		worst = fmax(worst, gap);
		count++;
	}
	print_message("          above the best, of what is wrong with nothing drawn: mean %.4f %%, at most %.4f %%\n", 100 * sum / count, 100 * worst);
	assert_true(sum / count <= 0.01 && worst <= 0.06);
}

int main(void)
{
	const struct CMUnitTest tests[] = { cmocka_unit_test(plans_are_close_to_the_best_there_is) };
	return cmocka_run_group_tests(tests, NULL, NULL);
}
