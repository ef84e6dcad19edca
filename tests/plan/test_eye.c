/* Frame, bands and culling of a view, against plain arithmetic. */
#include <math.h>
#include <string.h>

#include "lod/eye.h"
#include "tests/support/scene_random.h"
#include "tests/support/unit_test.h"

static struct scene_builder source;       /* of random numbers */

static struct eco_view view_of(double fov, uint32_t width, uint32_t height)
{
	return (struct eco_view){ .eye = { 1, 2, 3 }, .target = { 11, -4, 5 }, .up = { 0, 0, 1 },
		.fov_y_deg = fov, .width = width,
		.height = height };
}

UNIT_TEST(the_frame_is_orthonormal_and_right_handed_for_any_up)
{
	double ups[][3] = { { 0, 0, 1 }, { 10, -6, 2 }, { 0, 0, 0 }, { 1e-200, 0, 1e200 }, { -10, 6, -2 } };
	for (size_t i = 0; i < sizeof ups / sizeof *ups; i++) {
		struct eco_view view = view_of(45, 800, 600);
		struct lod_eye e;
		memcpy(view.up, ups[i], sizeof ups[i]);
		lod_eye_make(&e, &view);
		const double *axes[3] = { e.right, e.up, e.forward };
		for (int a = 0; a < 3; a++)
			for (int b = 0; b < 3; b++) {
				double dot = axes[a][0] * axes[b][0] + axes[a][1] * axes[b][1]
					+ axes[a][2] * axes[b][2];
				assert_float_equal(dot, a == b, 1e-12);
			}
		double z = e.right[0] * e.up[1] - e.right[1] * e.up[0];
		assert_float_equal(z, -e.forward[2], 1e-12);
	}
}

static double blurred(uint32_t hash)
{
	return 0.5 * log2(exp2(-0.25) + (hash * 40503u & 65535) / 65536.0 * (exp2(0.25) - exp2(-0.25)));
}

UNIT_TEST(bands_are_quarter_octaves_blurred_by_the_hash)
{
	struct eco_view view = view_of(45, 800, 600);
	struct lod_eye e;
	lod_eye_make(&e, &view);
	for (int i = 0; i < 20000; i++) {
		double d = exp2(random_real(&source, -19.9, 19.9)), scale = exp2(random_real(&source, -3, 3));
		double at[3] = { e.at[0] + d * scale, e.at[1], e.at[2] };
		uint32_t hash = (uint32_t)random_real(&source, 0, 65536);
		double bands = 4 * (log2((at[0] - e.at[0]) / scale) + blurred(hash) + 20),
			exact = floor(bands), fraction = bands - exact;
		if (exact < 0 || exact >= ECO_BANDS)
			continue;
		if (fraction < 1e-9 || fraction > 1 - 1e-9)
			continue;
		uint8_t band = lod_eye_band(&e, at, scale, hash);
		assert_int_equal(band, (int)exact);
		assert_true(fabs(log2(lod_band_distance_m(band) / ((at[0] - e.at[0]) / scale))) <= 0.2501);
	}
	assert_int_equal(lod_eye_band(&e, e.at, 1, 7), 0);
	double far[3] = { 1e30, 0, 0 };
	assert_int_equal(lod_eye_band(&e, far, 1, 7), ECO_BANDS - 1);
}

/* As the eye comes nearer, plants leave a band one after the other: never more than their share of the way,
 * whatever the share of hashes. */
UNIT_TEST(plants_cross_a_border_one_after_the_other)
{
	struct eco_view view = view_of(45, 800, 600);
	struct lod_eye e;
	enum { STEPS = 64, PLANTS = 4096 };
	uint32_t before[2] = { 0 }, all[2] = { 0 };
	lod_eye_make(&e, &view);
	for (int step = 0; step <= STEPS; step++) {
		double at[3] = { e.at[0] + 32 * exp2((step - STEPS / 2) * 0.25 / STEPS), e.at[1], e.at[2] };
		uint32_t beyond[2] = { 0 };
		all[0] = all[1] = 0;
		for (uint32_t i = 0; i < PLANTS; i++) {
			uint32_t hash = lod_share_hash(1, 2, i), part = hash < ECO_SHARE_ONE / 8;
			all[part]++;
			beyond[part] += lod_eye_band(&e, at, 1, hash) >= 100;    /* a border at 32 m */
		}
		for (int part = 0; part < 2; part++) {
			assert_true(beyond[part] >= before[part]);
			if (step > 0)
				assert_true(beyond[part] - before[part] <= all[part] / 24);
			before[part] = beyond[part];
		}
		if (step == 0)
			assert_int_equal(beyond[0] + beyond[1], 0);
	}
	assert_int_equal(before[0], all[0]);
	assert_int_equal(before[1], all[1]);
}

UNIT_TEST(a_sphere_is_seen_exactly_where_a_point_of_it_projects_inside)
{
	struct eco_view view = view_of(50, 640, 480);
	struct lod_eye e;
	lod_eye_make(&e, &view);
	for (int i = 0; i < 20000; i++) {
		double p[3], inside[3];
		double depth = random_real(&source, 0.1, 100), x = random_real(&source, -1, 1),
			y = random_real(&source, -1, 1);
		double radius = random_real(&source, 0, 5);
		for (int k = 0; k < 3; k++) {
			inside[k] = e.at[k]
				+ depth * (e.forward[k] + x * e.tan_x * e.right[k] + y * e.tan_y * e.up[k]);
			p[k] = inside[k] + radius * (k == 0 ? 0.6 : k == 1 ? -0.64 : 0.48);
		}
		assert_true(lod_eye_sees(&e, inside, 0));
		assert_true(lod_eye_sees(&e, p, radius * 1.001));
		double behind[3] = { e.at[0] - e.forward[0] * 10, e.at[1] - e.forward[1] * 10,
			e.at[2] - e.forward[2] * 10 };
		assert_false(lod_eye_sees(&e, behind, 5));
	}
}

UNIT_TEST(a_placement_turns_then_scales_then_shifts)
{
	struct eco_placement placement = { .at = { 100, 200, 300 }, .turn = 16384, .scale = 2 };
	struct eco_list list = { .grid_origin = { 1, 0, 0 }, .grid_step = { 0.5, 0.5, 0.5 } };
	struct eco_place stored = { .position = { 2, 4, 6 }, .turn = 16384, .scale = 32768 };
	struct lod_place place;
	double world[3];
	lod_place_instance(&place, &placement, &list, &stored);
	/* (2,2,3) turned by a quarter is (-2,2,3); the plant's own yaw adds to half a turn, its scale halves
	 */
	assert_float_equal(place.at[0], 96, 1e-9);
	assert_float_equal(place.at[1], 204, 1e-9);
	assert_float_equal(place.at[2], 306, 1e-9);
	assert_float_equal(place.scale, 1, 1e-12);
	lod_place_point(&place, (float[3]){ 1, 0, 5 }, world);
	assert_float_equal(world[0], 95, 1e-9);
	assert_float_equal(world[1], 204, 1e-9);
	assert_float_equal(world[2], 311, 1e-9);
}
