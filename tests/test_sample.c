/* Points of triangles: on them, one in each half, on opaque texels; and palettes for their colours. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "ecofiles/list.h"
#include "lod/palette.h"
#include "lod/sample.h"
#include "lod/texel.h"
#include "tests/plant_models.h"

static const uint8_t green[3] = { 20, 200, 40 };

/* Barycentric coordinates of p's projection, and its distance from the plane, in grid steps. */
static double locate(int32_t corner[3][3], const int32_t *p, double w[3])
{
	struct lod_v3 a = { corner[0][0], corner[0][1], corner[0][2] }, b = { corner[1][0], corner[1][1], corner[1][2] },
		c = { corner[2][0], corner[2][1], corner[2][2] }, q = { p[0], p[1], p[2] };
	struct lod_v3 n = lod_v3_cross(lod_v3_sub(b, a), lod_v3_sub(c, a));
	double nn = lod_v3_dot(n, n);
	w[1] = lod_v3_dot(n, lod_v3_cross(lod_v3_sub(q, a), lod_v3_sub(c, a))) / nn;
	w[2] = lod_v3_dot(n, lod_v3_cross(lod_v3_sub(b, a), lod_v3_sub(q, a))) / nn;
	w[0] = 1 - w[1] - w[2];
	return fabs(lod_v3_dot(n, lod_v3_sub(q, a))) / sqrt(nn);
}

static void points_lie_on_their_triangle_one_in_each_half(void **state)
{
	(void)state;
	struct soup dice = { .state = 9 };
	for (uint32_t i = 0; i < 2000; i++) {
		int32_t corner[3][3], position[2][3], again[2][3];
		uint8_t rgb[2][3];
		for (int k = 0; k < 9; k++)
			corner[k / 3][k % 3] = (int32_t)soup_random(&dice, 0, 100000);
		struct lod_sample_input in = { .corner = { corner[0], corner[1], corner[2] }, .tint = green, .seed = i };
		lod_sample_triangle(&in, position, rgb);
		lod_sample_triangle(&in, again, rgb);
		assert_memory_equal(position, again, sizeof position);
		assert_memory_equal(rgb[0], green, 3);
		assert_memory_equal(rgb[1], green, 3);
		double longest = 0;
		int apex = 0;
		for (int k = 0; k < 3; k++) {
			double d2 = 0;
			for (int a = 0; a < 3; a++)
				d2 += ((double)corner[(k + 1) % 3][a] - corner[(k + 2) % 3][a]) * ((double)corner[(k + 1) % 3][a] - corner[(k + 2) % 3][a]);
			apex = d2 > longest ? k : apex;
			longest = d2 > longest ? d2 : longest;
		}
		double w[2][3];
		for (int k = 0; k < 2; k++) {
			assert_true(locate(corner, position[k], w[k]) < 0.9);
			for (int a = 0; a < 3; a++)
				assert_true(w[k][a] > -0.2 && w[k][a] < 1.2);
		}
		assert_true(w[0][(apex + 1) % 3] >= w[0][(apex + 2) % 3] - 0.2);
		assert_true(w[1][(apex + 1) % 3] <= w[1][(apex + 2) % 3] + 0.2);
	}
}

static void points_of_cut_outs_are_on_opaque_texels(void **state)
{
	(void)state;
	struct soup soup;
	soup_begin(&soup);
	soup_disc_image(&soup, 64);
	int32_t corner[3][3] = { { 0, 0, 0 }, { 64000, 0, 0 }, { 0, 64000, 0 } }, uv[6] = { 0, 0, ECO_UV_ONE, 0, 0, ECO_UV_ONE };
	const uint8_t white[3] = { 255, 255, 255 };
	struct lod_arena arena = { 0 };
	struct lod_texels texels;
	assert_int_equal(setjmp(arena.failed), 0);
	lod_texels_open(&texels, soup.image, true, &arena);
	for (uint32_t i = 0; i < 500; i++) {
		int32_t position[2][3];
		uint8_t rgb[2][3];
		struct lod_sample_input in = { .corner = { corner[0], corner[1], corner[2] }, .uv = uv, .texels = &texels,
			.tint = white, .seed = i };
		lod_sample_triangle(&in, position, rgb);
		for (int k = 0; k < 2; k++) {
			double dx = position[k][0] / 64000.0 - 0.5, dy = position[k][1] / 64000.0 - 0.5;
			assert_true(dx * dx + dy * dy < 0.18);
			assert_true(position[k][0] + position[k][1] <= 64001);
		}
		assert_in_range(rgb[0][0], 67, 71);          /* half of its texels are dark, half bright: the mean light */
		assert_int_equal(rgb[1][0], 40);
	}
	lod_arena_free(&arena);
	soup_free(&soup);
}

static void nothing_opaque_gives_the_middle(void **state)
{
	(void)state;
	struct soup soup;
	soup_begin(&soup);
	soup_disc_image(&soup, 64);
	int32_t corner[3][3] = { { 0, 0, 0 }, { 3000, 0, 0 }, { 0, 3000, 0 } }, uv[6] = { 100, 100, 200, 100, 100, 200 }, position[2][3];
	uint8_t rgb[2][3];
	struct lod_arena arena = { 0 };
	struct lod_texels texels;
	assert_int_equal(setjmp(arena.failed), 0);
	lod_texels_open(&texels, soup.image, true, &arena);
	struct lod_sample_input in = { .corner = { corner[0], corner[1], corner[2] }, .uv = uv, .texels = &texels,
		.tint = green, .seed = 1 };
	lod_sample_triangle(&in, position, rgb);
	assert_int_equal(position[0][0], 1000);
	assert_int_equal(position[1][1], 1000);
	assert_true(lod_texel_hidden(soup.image, uv));
	assert_true(lod_texels_mean(&texels, green, uv, rgb[0]) == 0);
	assert_memory_equal(rgb[0], green, 3);
	lod_arena_free(&arena);
	soup_free(&soup);
}

static void texels_wrap(void **state)
{
	(void)state;
	struct soup soup;
	soup_begin(&soup);
	soup_disc_image(&soup, 64);
	const double places[][2] = { { 0.3, 0.6 }, { 0.01, 0.99 } };
	for (size_t i = 0; i < 2; i++)
		for (int turn = -3; turn <= 3; turn++)
			assert_ptr_equal(lod_texel_at(soup.image, places[i][0] + turn, places[i][1] - turn), lod_texel_at(soup.image, places[i][0], places[i][1]));
	soup_free(&soup);
}

/* ---- Palettes ---- */

static struct lod_palette palette;

static void few_colours_are_kept_exactly(void **state)
{
	(void)state;
	struct lod_arena arena = { 0 };
	uint8_t rgb[200][3];
	uint32_t weights[200];
	assert_int_equal(setjmp(arena.failed), 0);
	for (uint32_t i = 0; i < 200; i++) {
		uint8_t colour[3] = { (uint8_t)(i % 64 * 3), (uint8_t)(i % 64), 7 };
		memcpy(rgb[i], colour, 3);
		weights[i] = i;
	}
	lod_palette_make(&palette, (const uint8_t (*)[3])rgb, weights, 200, &arena);
	assert_int_equal(palette.count, 64);
	for (uint32_t i = 0; i < 200; i++)
		assert_memory_equal(palette.rgb[lod_palette_index(&palette, rgb[i])], rgb[i], 3);
	lod_arena_free(&arena);
}

static void many_colours_are_cut_to_near_ones(void **state)
{
	(void)state;
	struct lod_arena arena = { 0 };
	static uint8_t rgb[30000][3];
	static uint32_t weights[30000];
	struct soup dice = { .state = 4 };
	static double error;
	assert_int_equal(setjmp(arena.failed), 0);
	for (uint32_t i = 0; i < 30000; i++) {       /* greens, and a few reds */
		double t = soup_random(&dice, 0, 1);
		uint8_t colour[3] = { (uint8_t)(i % 100 ? 40 + 80 * t : 200), (uint8_t)(i % 100 ? 90 + 120 * t : 20), (uint8_t)soup_random(&dice, 20, 60) };
		memcpy(rgb[i], colour, 3);
		weights[i] = 1;
	}
	lod_palette_make(&palette, (const uint8_t (*)[3])rgb, weights, 30000, &arena);
	assert_in_range(palette.count, 32, LOD_PALETTE_MAX);
	for (uint32_t i = 0; i < 30000; i++) {
		const uint8_t *entry = palette.rgb[lod_palette_index(&palette, rgb[i])];
		for (int k = 0; k < 3; k++)
			error += abs(entry[k] - rgb[i][k]);
	}
	assert_true(error / 90000 < 4);
	const uint8_t red[3] = { 200, 20, 40 };
	assert_true(abs(palette.rgb[lod_palette_index(&palette, red)][0] - 200) < 8);
	lod_arena_free(&arena);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(points_lie_on_their_triangle_one_in_each_half),
		cmocka_unit_test(points_of_cut_outs_are_on_opaque_texels),
		cmocka_unit_test(nothing_opaque_gives_the_middle),
		cmocka_unit_test(texels_wrap),
		cmocka_unit_test(few_colours_are_kept_exactly),
		cmocka_unit_test(many_colours_are_cut_to_near_ones),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
