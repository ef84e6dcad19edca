/* Splats in the rasteriser: ellipses of the right size, place, lean and depth, and shares of pixels. */
#include <math.h>
#include <stdlib.h>

#include "ecofiles/format/view.h"
#include "lod/raster/raster.h"
#include "tests/support/unit_test.h"

#define SIDE 400u

static struct lod_raster raster;

/* A camera at (0, -100, 0) that looks north; `half_m` metres from the picture's middle to its edge at y = 0.
 */
static void look(double half_m)
{
	struct eco_view view = { .eye = { 0, -100, 0 }, .target = { 0, 0, 0 }, .up = { 0, 0, 1 },
		.fov_y_deg = 360 / M_PI * atan(half_m / 100), .width = SIDE, .height = SIDE };
	struct lod_eye eye;
	lod_eye_make(&eye, &view);
	lod_raster_clear(&raster);
	lod_raster_camera(&raster, &eye, 0.1);
	lod_raster_object(&raster, &(struct lod_place){ .cosine = 1, .scale = 1 });
}

static void draw(const float centre[3], const float half[9], float opacity, uint64_t owner)
{
	lod_raster_splats(&raster, &(struct lod_raster_batch){ .count = 1, .position = centre, .half = half,
		.opacity = &opacity, .owner = owner });
}

static uint32_t covered(void)
{
	uint32_t count = 0;
	for (uint32_t i = 0; i < SIDE * SIDE; i++)
		count += raster.cover[i] != 0;
	return count;
}

static int set_up(void **state)
{
	lod_raster_init(&raster, &(struct lod_raster_options){ .width = SIDE, .height = SIDE, .owner = true });
	return 0;
}

static int tear_down(void **state)
{
	lod_raster_free(&raster);
	return 0;
}

/* Close by, against rays: the outline is that of the ellipsoid in perspective, wherever it is in the picture.
 */
UNIT_TEST(ellipsoids_close_by_have_their_outline)
{
	uint32_t drawn = 0;
	srand(5);
	look(60);
	for (int k = 0; k < 120; k++) {
		float center[3], half[9];
		for (int i = 0; i < 9; i++)
			half[i] = (float)rand() / (float)RAND_MAX * 20 - 10;
		center[0] = (float)rand() / (float)RAND_MAX * 60 - 30;
		center[1] = (float)rand() / (float)RAND_MAX * 60 - 70;
		center[2] = (float)rand() / (float)RAND_MAX * 60 - 30;
		/* any axes do: the points of the ellipsoid are center + half^T b with |b| = 1 */
		double m[3][3], det, inverse[3][3];
		for (int i = 0; i < 9; i++)
			m[i % 3][i / 3] = half[i];
		for (int i = 0; i < 3; i++)
			for (int j = 0; j < 3; j++)
				inverse[j][i] = m[(i + 1) % 3][(j + 1) % 3] * m[(i + 2) % 3][(j + 2) % 3]
					- m[(i + 1) % 3][(j + 2) % 3] * m[(i + 2) % 3][(j + 1) % 3];
		det = m[0][0] * inverse[0][0] + m[0][1] * inverse[1][0] + m[0][2] * inverse[2][0];
		double reach =
			sqrt(half[1] * (double)half[1] + half[4] * (double)half[4]
			+ half[7] * (double)half[7]);
		if (fabs(det) < 50 || center[1] + 100 - reach < 5)
			continue;
		lod_raster_clear(&raster);
		draw(center, half, 1, 1);
		for (uint32_t y = 0; y < SIDE; y += 3)
			for (uint32_t x = 0; x < SIDE; x += 3) {
				double ray[3] = { (x + 0.5 - SIDE / 2) / (SIDE / 2) * 0.6, 1,
					-(y + 0.5 - SIDE / 2) / (SIDE / 2) * 0.6 }, o[3], d[3], od = 0,
					dd = 0, oo = 0;
				for (int i = 0; i < 3; i++) {
					o[i] = d[i] = 0;
					for (int j = 0; j < 3; j++) {
						o[i] += inverse[i][j] / det
							* ((j == 1 ? -100 : 0) - (double)center[j]);
						d[i] += inverse[i][j] / det * ray[j];
					}
					od += o[i] * d[i], dd += d[i] * d[i], oo += o[i] * o[i];
				}
				double nearest = oo - od * od / dd;      /* squared, from the ball's centre */
				if (fabs(nearest - 1) > 0.02)
					assert_int_equal(raster.cover[y * SIDE + x] != 0, nearest < 1);
			}
		drawn++;
	}
	assert_true(drawn > 30);
}

UNIT_TEST(opacity_is_a_share_of_pixels)
{
	const float half[9] = { 6, 0, 0, 0, 6, 0, 0, 0, 6 };
	uint32_t all = 0;
	for (int k = 16; k > 0; k--) {
		uint32_t here = 0;
		for (int i = 0; i < 8; i++) {
			const float centre[3] = { (float)i * 0.1f, 0, (float)i * 0.07f };
			look(10);
			draw(centre, half, (float)k / 16, 1);
			here += covered();
		}
		all = k == 16 ? here : all;
		assert_float_equal(here, all * (k / 16.0), 0.02 * all);
	}
}

UNIT_TEST(what_cannot_be_drawn_is_left_out)
{
	static const float behind[3] = { 0, -101, 0 }, here[3] = { 0, 0, 0 }, wild[3] = { 1e30f, 0, 1e30f },
		ball[9] = { 1, 0, 0, 0, 1, 0, 0, 0, 1 }, none[9] = { 0 },
		bad[9] = { INFINITY, 0, 0, 0, NAN, 0, 0, 0, 1 };
	look(10);
	draw(behind, ball, 1, 1);
	draw(here, none, 1, 1);
	draw(here, bad, 1, 1);
	draw(wild, ball, 1, 1);
	draw(here, ball, 0, 1);
	assert_int_equal(covered(), 0);
}

UNIT_MAIN(set_up, tear_down)
