/* Where a scene stands, how it is looked at and when: extreme places, cameras and times. */
#include "tests/support/extreme_test.h"

extern const struct extreme_family extreme_place, extreme_camera, extreme_time;

static void scenes_at_extreme_places_are_drawn_alike(void **state)
{
	(void)state;
	assert_int_equal(extreme_failed(&extreme_place), 0);
}

static void extreme_cameras_are_answered(void **state)
{
	(void)state;
	assert_int_equal(extreme_failed(&extreme_camera), 0);
}

static void a_camera_that_stands_or_trembles_swings_nothing(void **state)
{
	(void)state;
	assert_int_equal(extreme_failed(&extreme_time), 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(scenes_at_extreme_places_are_drawn_alike),
		cmocka_unit_test(extreme_cameras_are_answered),
		cmocka_unit_test(a_camera_that_stands_or_trembles_swings_nothing),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
