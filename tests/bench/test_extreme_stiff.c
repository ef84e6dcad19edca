/* What is planned with: extreme budgets and curves. */
#include "tests/support/extreme_test.h"

extern const struct extreme_family extreme_stiff;

static void extreme_budgets_and_curves_are_planned(void **state)
{
	(void)state;
	assert_int_equal(extreme_failed(&extreme_stiff), 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(extreme_budgets_and_curves_are_planned),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
