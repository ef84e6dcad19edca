/* Splats: ellipsoids survive their codes as well as the codes can tell. */
#include <math.h>
#include <string.h>

#include "ecofiles/format/splat.h"
#include "tests/support/unit_test.h"

static uint32_t state = 1;

static float uniform(void)
{
	state = state * 1664525u + 1013904223u;
	return (float)((state >> 8) / 16777216.0);
}

static float dot(const float a[3], const float b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static void random_direction(float d[3])
{
	float length;
	do {
		for (int i = 0; i < 3; i++)
			d[i] = 2 * uniform() - 1;
		length = sqrtf(dot(d, d));
	} while (length > 1 || length < 0.1f);
	for (int i = 0; i < 3; i++)
		d[i] /= length;
}

/* Half axes of the given lengths along a random orthogonal frame, of either hand. */
static void random_splat(struct eco_splat *splat, const float length[3])
{
	float axis[3][3], d[3], along = 0;
	random_direction(axis[0]);
	do {
		random_direction(d);
		along = dot(d, axis[0]);
	} while (fabsf(along) > 0.9f);
	for (int i = 0; i < 3; i++)
		axis[1][i] = (d[i] - along * axis[0][i]) / sqrtf(1 - along * along);
	float hand = uniform() < 0.5f ? -1 : 1;
	for (int i = 0; i < 3; i++)
		axis[2][i] = hand * (axis[0][(i + 1) % 3] * axis[1][(i + 2) % 3]
			- axis[0][(i + 2) % 3] * axis[1][(i + 1) % 3]);
	for (int k = 0; k < 3; k++)
		for (int i = 0; i < 3; i++)
			splat->half[k][i] = length[k] * axis[k][i];
	splat->opacity = uniform();
}

/* Half the width of an ellipsoid along a unit vector. */
static float extent(const struct eco_splat *splat, const float d[3])
{
	float sum = 0;
	for (int k = 0; k < 3; k++)
		sum += dot(splat->half[k], d) * dot(splat->half[k], d);
	return sqrtf(sum);
}

UNIT_TEST(ellipsoids_survive_their_codes)
{
	for (int i = 0; i < 5000; i++) {
		const float unit = 0.3f, length[3] = { exp2f(6 * uniform() - 3), exp2f(6 * uniform() - 3),
			i % 3 ? exp2f(6 * uniform() - 3) : 0.01f };
		struct eco_splat given, back;
		int32_t code[ECO_SPLAT_CODES], again[ECO_SPLAT_CODES];
		random_splat(&given, length);
		eco_splat_write(code, &given, unit);
		assert_true(eco_splat_good(code));
		eco_splat_read(&back, code, unit);
		float longest = fmaxf(length[0], fmaxf(length[1], length[2]));
		for (int k = 0; k < 20; k++) {
			float d[3];
			random_direction(d);
			assert_float_equal(extent(&back, d), extent(&given, d),
				0.046f * extent(&given, d) + 0.02f * longest);
		}
		assert_float_equal(back.opacity, fmaxf(given.opacity, 1.0f / ECO_SPLAT_OPACITIES),
			0.5f / ECO_SPLAT_OPACITIES + 1e-6f);
		eco_splat_write(again, &back, unit);
		struct eco_splat third;
		eco_splat_read(&third, again, unit);
		for (int k = 0; k < 5; k++) {
			float d[3];
			random_direction(d);
			assert_float_equal(extent(&third, d), extent(&back, d), 0.02f * longest);
		}
	}
}

UNIT_TEST(degenerate_ellipsoids_have_codes)
{
	static const struct eco_splat cases[] = { { { { 0 } }, 1 }, { { { 1, 2, 3 } }, 0.5f },
		{ { { 1, 0, 0 }, { 2, 0, 0 }, { 3, 0, 0 } }, 1 },
		{ { { 1e30f, 0, 0 }, { 0, 1e-30f, 0 } }, 2 },
		{ { { 0, 0, 1 }, { 0, 0, 1 }, { 0, 0, 1 } }, -1 }, { { { 0 }, { 0 }, { 0, 0, -2 } }, 1 } };
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		int32_t code[ECO_SPLAT_CODES];
		struct eco_splat back;
		eco_splat_write(code, &cases[i], 1);
		assert_true(eco_splat_good(code));
		eco_splat_read(&back, code, 1);
		for (int k = 0; k < 9; k++)
			assert_true(isfinite(back.half[k / 3][k % 3]));
		assert_true(back.opacity > 0 && back.opacity <= 1);
	}
}

UNIT_TEST(codes_out_of_range_are_named_and_read_without_harm)
{
	const int32_t good[ECO_SPLAT_CODES] = { 64, 0, 127, 64, 0, 127, 15 };
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
