/* The extreme cases that take little time. Each case is told; see tests/bench/extreme/extreme.h. */
#include "tests/bench/extreme/extreme.h"
#include "tests/support/unit_test.h"

static void tell(void *ctx, const struct extreme_case *row, const struct extreme *x, bool ran)
{
	(void)ctx;
	if (!ran)
		print_message("          %s, %s: in ecobench --extreme only\n", extreme_kind_names[row->kind],
			row->name);
	else
		print_message("          %s%s, %s: %s\n", x->failed ? "FAILED: " : "",
			extreme_kind_names[row->kind], row->name, x->measured);
}

static void run(void **state)
{
	assert_int_equal(extreme_run(*(const enum extreme_kind *)*state, true, tell, NULL), 0);
}

int main(void)
{
	static enum extreme_kind kinds[] = { EXTREME_PLACE, EXTREME_CAMERA, EXTREME_STIFF, EXTREME_GEOMETRY,
		EXTREME_QUANTIZATION, EXTREME_TIME };
	const struct CMUnitTest tests[EXTREME_KINDS] = {
		{ "scenes_at_extreme_places_are_drawn_alike", run, NULL, NULL, &kinds[0] },
		{ "extreme_cameras_are_answered", run, NULL, NULL, &kinds[1] },
		{ "extreme_budgets_and_curves_are_planned", run, NULL, NULL, &kinds[2] },
		{ "extreme_plants_are_built_or_refused", run, NULL, NULL, &kinds[3] },
		{ "rounding_stays_below_half_a_pixel_at_the_stated_distance", run, NULL, NULL, &kinds[4] },
		{ "a_camera_that_stands_or_trembles_swings_nothing", run, NULL, NULL, &kinds[5] },
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
