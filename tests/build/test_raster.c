/* Triangles of the rasteriser against a slow twin that tests every pixel with 128-bit edge functions. */
#include <math.h>
#include <string.h>

#include "lod/raster/raster_state.h"
#include "tests/support/raster_flat.h"
#include "tests/support/unit_test.h"

/* ---- The twin ---- */

static bool twin_edge(const int64_t a[2], const int64_t b[2], int64_t x, int64_t y)
{
	__int128 dx = b[0] - a[0], dy = b[1] - a[1], at = dx * (y - a[1]) - dy * (x - a[0]);
	return at > 0 || (at == 0 && (dy < 0 || (dy == 0 && dx > 0)));
}

/* Corners in 1/256 pixel, by the formula of raster.h in the rasteriser's own floats. */
static void twin_snap(const struct lod_raster *raster, const float *p, int64_t out[2])
{
	float c[3];
	for (int i = 0; i < 3; i++) {
		const float *row = raster->state->clip[i];
		c[i] = row[0] * p[0] + row[1] * p[1] + row[2] * p[2] + row[3];
	}
	float z = 1.0f / c[2];
	out[0] = (int64_t)rintf(c[0] * z) + raster->width * 128;
	out[1] = (int64_t)rintf(c[1] * z) + raster->height * 128;
}

static uint64_t twin_differences(const struct lod_raster *raster, const float *position)
{
	int64_t c[3][2];
	for (int i = 0; i < 3; i++)
		twin_snap(raster, position + 3 * i, c[i]);
	__int128 area = (__int128)(c[1][0] - c[0][0]) * (c[2][1] - c[0][1])
		- (__int128)(c[2][0] - c[0][0]) * (c[1][1] - c[0][1]);
	const int64_t *a = c[0], *b = area < 0 ? c[2] : c[1], *d = area < 0 ? c[1] : c[2];
	uint64_t wrong = 0;
	for (uint32_t y = 0; y < raster->height; y++) {
		for (uint32_t x = 0; x < raster->width; x++) {
			int64_t px = x * 256 + 128, py = y * 256 + 128;
			bool in = area != 0 && twin_edge(a, b, px, py) && twin_edge(b, d, px, py)
				&& twin_edge(d, a, px, py);
			wrong += in != (raster->cover[(size_t)y * raster->width + x] != 0);
		}
	}
	return wrong;
}

/* corners within +-size pixels of a centre within +-middle, on a grid of 1/256 */
struct shape { double size, middle; int grid; };

static void random_triangle(float *p, const struct lod_raster *raster, const struct shape *shape)
{
	double x = uniform(-shape->middle, shape->middle) + raster->width / 2.0,
		y = uniform(-shape->middle, shape->middle) + raster->height / 2.0;
	bool sliver = rnd(4) == 0;
	double dx = uniform(-1, 1), dy = uniform(-1, 1);
	for (int i = 0; i < 3; i++) {
		double t = uniform(-shape->size, shape->size), u = sliver ? 0.02 * uniform(-1, 1)
			: uniform(-shape->size, shape->size);
		double cx = sliver ? x + t * dx - u * dy : x + t, cy = sliver ? y + t * dy + u * dx : y + u;
		raster_put(p + 3 * i, raster, rint(cx * 256 / shape->grid) * shape->grid,
			rint(cy * 256 / shape->grid) * shape->grid, (double)(1u << rnd(4)));
	}
}

UNIT_TEST(covers_what_the_exact_twin_covers)
{
	static const struct shape shapes[] = {
		{ 0.4, 20, 1 }, { 1, 20, 1 }, { 2, 20, 128 }, { 3, 22, 1 }, { 4, 20, 64 }, { 6, 20, 1 },
			{ 9, 20, 128 }, { 20, 30, 1 },
		{ 40, 10, 256 }, { 300, 100, 1 }, { 7000, 500, 1 },
	};
	struct lod_raster raster;
	rnd_seed = 1;
	raster_start(&raster, 45, 38, NULL);
	for (size_t s = 0; s < sizeof shapes / sizeof shapes[0]; s++) {
		for (int i = 0; i < 400; i++) {
			float p[9];
			random_triangle(p, &raster, &shapes[s]);
			lod_raster_clear(&raster);
			raster_draw(&raster, p, 1, 7);
			assert_int_equal(twin_differences(&raster, p), 0);
		}
	}
	lod_raster_free(&raster);
}

static struct lod_eye turned_eye(uint32_t width, uint32_t height)
{
	struct eco_view view = { { 1e6 + 3, -20, 9 }, { 1e6, 0, 5 }, { 0.1, 0, 1 }, 50, width, height };
	struct lod_eye eye;
	lod_eye_make(&eye, &view);
	return eye;
}

UNIT_TEST(covers_what_the_twin_covers_in_perspective)
{
	struct lod_raster raster;
	struct lod_eye eye = turned_eye(64, 48);
	rnd_seed = 2;
	raster_start(&raster, 64, 48, &eye);
	struct lod_place place = { { 1e6 + 1, 2, 0 }, 0.6, 0.8, 1.25 };
	lod_raster_object(&raster, &place);
	uint64_t drawn = 0;
	for (int i = 0; i < 2500; i++) {
		float p[9], size = i % 5 ? 0.5f : 6.0f,
			c[3] = { (float)uniform(-6, 6), (float)uniform(-6, 6), (float)uniform(0, 10) };
		for (int k = 0; k < 9; k++)
			p[k] = c[k % 3] + (float)uniform(-size, size);
		lod_raster_clear(&raster);
		raster_draw(&raster, p, 1, 7);
		assert_int_equal(twin_differences(&raster, p), 0);
		drawn += raster_covered(&raster);
	}
	assert_true(drawn > 10000);
	lod_raster_free(&raster);
}

/* A plane below the eye, from behind it to far beyond: what is in front of the near plane covers, the rest
 * does not. */
UNIT_TEST(planes_through_the_near_plane_cover_up_to_the_horizon)
{
	static const float reach[] = { 3, 100, 1e5f, 1e9f, 1e14f };
	struct lod_raster raster;
	for (size_t r = 0; r < sizeof reach / sizeof reach[0]; r++) {
		struct lod_eye eye = flat_eye(80, 60);
		eye.tan_x = eye.tan_y = 1;
		raster_start(&raster, 80, 60, &eye);
		lod_raster_camera(&raster, &eye, 0.1);
		float f = reach[r], z = -1, p[18] = { -f, -f, z, f, -f, z, f, f, z, -f, -f, z, f, f, z, -f, f,
			z };
		raster_draw(&raster, p, 2, 3);
		uint64_t wrong = 0;
		for (int y = 0; y < 60; y++) {
			for (int x = 0; x < 80; x++) {
				double down = (y + 0.5 - 30) / 30, w = down > 0 ? 1 / down : INFINITY,
					across = (x + 0.5 - 40) / 40 * w;
				bool in = w < f && fabs(across) < f;
				size_t i = (size_t)y * 80 + (size_t)x;
				wrong += in != (raster.cover[i] != 0);
				if (in && raster.cover[i])
					assert_true(fabs(raster.depth[i] * w - 1) < 2e-3);
			}
		}
		assert_true(wrong <= 2);
		lod_raster_free(&raster);
	}
}

UNIT_TEST(what_is_no_number_or_behind_draws_nothing)
{
	static const float bad[][9] = {
		{ NAN, 1, 0, 1, 1, 0, 0, 1, 1 }, { INFINITY, 1, 0, 1, 1, 0, 0, 1, 1 },
			{ 0, 1, 0, 1, 1, 0, 0, NAN, 1 },
		{ 0, -1, 0, 1, -1, 0, 0, -1, 1 }, { 0, 0, 0, 0, 0, 0, 0, 0, 0 },
		{ 3e38f, 3e38f, 3e38f, -3e38f, 3e38f, 0, 0, 3e38f, 3e38f },
		{ 0, 1, 0, 0, 1, 0, 0, 1, 0 },
	};
	struct lod_raster raster;
	raster_start(&raster, 32, 32, NULL);
	for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
		float width = 3;
		struct lod_raster_batch batch = { .count = 1, .position = bad[i], .width = &width,
			.area = i == 3 ? 5 : NAN, .owner = 1 };
		raster_draw(&raster, bad[i], 1, 1);
		if (i != 2 && i != 6)
			lod_raster_lines(&raster,
				&(struct lod_raster_batch){ .count = 1, .position = bad[i],
				.width = (float[]){ NAN } });
		lod_raster_splats(&raster, &batch);
		if (i != 5)
			assert_int_equal(raster_covered(&raster), 0);
		lod_raster_clear(&raster);
	}
	lod_raster_free(&raster);
}
