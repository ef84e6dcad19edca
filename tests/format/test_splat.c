/* Splats: ellipsoids that are none, and codes that no ellipsoid has. */
#include <math.h>
#include <string.h>

#include "ecofiles/format/splat.h"
#include "tests/support/unit_test.h"

UNIT_TEST(degenerate_ellipsoids_have_codes)
{
	static const struct eco_splat cases[] = { { { { 0 } }, 1, false }, { { { 1, 2, 3 } }, 0.5f, true },
		{ { { 1, 0, 0 }, { 2, 0, 0 }, { 3, 0, 0 } }, 1, true },
		{ { { 1e30f, 0, 0 }, { 0, 1e-30f, 0 } }, 2, false },
		{ { { 0, 0, 1 }, { 0, 0, 1 }, { 0, 0, 1 } }, -1, true }, { { { 0 }, { 0 }, { 0, 0, -2 } }, 1, true } };
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		int32_t code[ECO_SPLAT_CODES];
		struct eco_splat back;
		eco_splat_write(code, &cases[i], 1);
		assert_true(eco_splat_good(code));
		eco_splat_read(&back, code, 1);
		for (int k = 0; k < 9; k++)
			assert_true(isfinite(back.half[k / 3][k % 3]));
		assert_true(back.opacity > 0 && back.opacity <= 1 && back.wood == cases[i].wood);
	}
}

UNIT_TEST(codes_out_of_range_are_named_and_read_without_harm)
{
	const int32_t good[ECO_SPLAT_CODES] = { 64, 0, 127, 16, 0, 31, 15 };
	assert_true(eco_splat_good(good));
	for (uint32_t i = 0; i < ECO_SPLAT_CODES; i++)
		for (int bad = 0; bad < 4; bad++) {
			static const int32_t beyond[4] = { -1, 128, INT32_MIN, INT32_MAX };
			int32_t code[ECO_SPLAT_CODES];
			struct eco_splat splat;
			memcpy(code, good, sizeof code);
			code[i] = beyond[bad];
			assert_false(eco_splat_good(code));
			eco_splat_read(&splat, code, 1);
			assert_true(isfinite(splat.half[0][0]) && splat.opacity <= 1);
		}
}
