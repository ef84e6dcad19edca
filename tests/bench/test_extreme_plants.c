/* What is built: extreme geometry, and what rounding it to a grid comes to. */
#include "tests/support/extreme_test.h"

extern const struct extreme_family extreme_geometry, extreme_quantization;

static void extreme_plants_are_built_or_refused(void **state)
{
	(void)state;
	assert_int_equal(extreme_failed(&extreme_geometry), 0);
}

static void rounding_stays_below_half_a_pixel_at_the_stated_distance(void **state)
{
	(void)state;
	assert_int_equal(extreme_failed(&extreme_quantization), 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(extreme_plants_are_built_or_refused),
		cmocka_unit_test(rounding_stays_below_half_a_pixel_at_the_stated_distance),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
