/* Predictions in order of Q. */
#include <math.h>

#include "lod/plan/expected.h"
#include "tests/support/unit_test.h"

UNIT_TEST(fewer_wrong_pixels_may_be_a_worse_picture)
{
	const struct eco_prediction misses = { 406, 186, 594 }, covers = { 608, 479, 392 };
	const struct eco_prediction worst = LOD_EXPECTED_WORST, none = { .fn = 1000 }, best = { 0 };
	assert_true(misses.fp + misses.fn < covers.fp + covers.fn);
	assert_true(lod_expected_worse(&misses, &covers) && !lod_expected_worse(&covers, &misses));
	assert_true(lod_expected_worse(&worst, &none) && lod_expected_worse(&none, &misses));
	assert_true(lod_expected_worse(&covers, &best) && !lod_expected_worse(&covers, &covers));
}

UNIT_TEST(what_lies_between_two_has_a_q_between_theirs)
{
	/* beside nothing much, at first as much is too much as is right */
	static const struct eco_prediction worse[] = { { 406, 186, 594 }, { 10, 0, 990 }, { 0, 0, 1000 } },
		better[] = { { 608, 479, 392 }, { 900, 900, 100 }, { 1000, 0, 0 } };
	for (int i = 0; i < 3; i++) {
		double from = eco_predicted_q(&worse[i]), to = eco_predicted_q(&better[i]);
		for (double part = 0; part <= 1; part += 0.0625) {
			struct eco_prediction p = lod_expected_between(&worse[i], &better[i], part);
			assert_float_equal(eco_predicted_q(&p), from + part * (to - from), 1e-6);
			assert_float_equal(p.tp + p.fn, 1000, 1e-6);
		}
	}
}

UNIT_TEST(a_prediction_is_clamped_between_two)
{
	const struct eco_prediction low = { 406, 186, 594 }, high = { 608, 479, 392 };
	struct eco_prediction p = { 700, 100, 300 };
	lod_expected_clamp(&p, &low, &high);
	assert_true(p.tp == 608 && p.fp == 479);
	p = (struct eco_prediction){ 100, 0, 900 };
	lod_expected_clamp(&p, &low, &high);
	assert_true(p.tp == 406 && p.fn == 594);
	p = (struct eco_prediction){ 500, 300, 500 };
	lod_expected_clamp(&p, &low, &high);
	assert_true(p.tp == 500);
}
