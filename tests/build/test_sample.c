/* Means of textures over triangles, and light. */
#include "ecofiles/format/list.h"
#include "lod/light.h"
#include "lod/raster/texel.h"
#include "tests/support/plant_models.h"
#include "tests/support/unit_test.h"

/* ---- Means, against brute force ---- */

/* Blotches of colour, holes with a colour of their own that must never show. */
static struct eco_image blotched_image(uint32_t width, uint32_t height)
{
	struct eco_image image = { width, height, malloc((size_t)width * height * 4) };
	for (uint32_t y = 0; y < height; y++)
		for (uint32_t x = 0; x < width; x++) {
			uint64_t blotch = lod_mix(x / 7 + 1000 * (y / 5));
			bool hole = blotch % 3 == 0;
			uint8_t rgba[4] = { hole ? 255 : 0, (uint8_t)(40 + blotch % 160),
				(uint8_t)(20 + y * 200 / height), hole ? 90 : 200 };
			memcpy(image.rgba + 4 * ((size_t)y * width + x), rgba, 4);
		}
	return image;
}

/* n * n points of the triangle, looked up one by one. */
static double brute_mean(const struct eco_image *image, bool cutout, const int32_t uv[6], int n,
	double light[3])
{
	double hits = 0, all = 0;
	light[0] = light[1] = light[2] = 0;
	for (int i = 0; i < n; i++)
		for (int j = 0; i + j < n; j++) {
			double b = (i + 1 / 3.0) / n, c = (j + 1 / 3.0) / n, a = 1 - b - c;
			const uint8_t *texel =
				lod_texel_at(image, (a * uv[0] + b * uv[2] + c * uv[4]) / ECO_UV_ONE,
				(a * uv[1] + b * uv[3] + c * uv[5]) / ECO_UV_ONE);
			all++;
			if (cutout && texel[3] < 128)
				continue;
			hits++;
			for (int k = 0; k < 3; k++)
				light[k] += lod_light_of[texel[k]];
		}
	for (int k = 0; k < 3 && hits > 0; k++)
		light[k] /= hits * 65535;
	return hits / all;
}

/* size: of the triangles, in turns of the texture; share: allowed error */
struct mean_case { uint32_t width, height; double size, shift, share; };

static __attribute__((noinline)) void compare_means(const struct mean_case *c, bool cutout, struct soup *dice,
	struct lod_arena *arena)
{
	static const uint8_t white[3] = { 255, 255, 255 };
	struct eco_image image = blotched_image(c->width, c->height);
	struct lod_texels texels;
	lod_texels_open(&texels, &image, cutout, arena);
	for (int n = 0; n < 8; n++) {
		int32_t uv[6];
		double light[3];
		uint8_t rgb[3] = { 0, 0, 0 }, again[3];
		for (int a = 0; a < 2; a++) {
			double at = c->shift + soup_random(dice, -1, 1) * c->size,
				along = c->size * soup_random(dice, 0.7, 1);
			uv[a] = (int32_t)(at * ECO_UV_ONE);
			uv[2 + a] =
				(int32_t)((at + along * (a == 0 ? 1 : soup_random(dice, -0.3, 0.3)))
				* ECO_UV_ONE);
			uv[4 + a] =
				(int32_t)((at + along * (a == 1 ? 1 : soup_random(dice, -0.3, 0.3)))
				* ECO_UV_ONE);
		}
		double want = brute_mean(&image, cutout, uv, 400, light),
			share = lod_texels_mean(&texels, white, uv, rgb);
		assert_true(fabs(share - want) <= c->share + 1e-9);
		assert_true(lod_texels_mean(&texels, white, uv, again) == share);
		assert_true(share == 0 || memcmp(rgb, again, 3) == 0);
		assert_true(!cutout || share == 0 || rgb[0] == 0);       /* holes are bright red */
		for (int k = 1; k < 3 && c->share <= 0.03 && share > 0; k++)
			assert_true(fabs(lod_light_of[rgb[k]] / 65535.0 - light[k]) < 0.02);
	}
	free(image.rgba);
}

UNIT_TEST(means_are_those_of_brute_force)
{
	static const struct mean_case cases[] = {
		{ 256, 256, 0.002, 0, 0.03 },        /* less than a texel */
		{ 256, 256, 0.02, 3.7, 0.03 },
		{ 256, 256, 0.3, 0, 0.02 }, { 256, 256, 1, -2.25, 0.01 }, { 100, 300, 0.9, 12, 0.01 },
		{ 256, 256, 25, -700, 0.02 },        /* repeated, far away */
		{ 16, 16, 90, 0, 0.02 }, { 1, 1, 5, 0, 0 }, { 1, 64, 3, 0, 0.02 },
		{ 3000, 900, 0.2, 0, 0.02 }, { 3000, 900, 1.5, -1, 0.02 },   /* summed in blocks */
	};
	struct soup dice = { .state = 3 };
	struct lod_arena arena = { 0 };
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
		for (int cutout = 0; cutout < 2; cutout++) {
			compare_means(&cases[i], cutout, &dice, &arena);
			lod_arena_free(&arena);
		}
}

UNIT_TEST(light_survives_the_way_there_and_back)
{
	for (uint32_t i = 0; i < 256; i++) {
		double c = i / 255.0, linear = c <= 0.04045 ? c / 12.92 : pow((c + 0.055) / 1.055, 2.4);
		assert_int_equal(lod_light_byte(lod_light_of[i]), i);
		assert_true(fabs(lod_light_of[i] - 65535 * linear) <= 0.5 + 1e-6);
	}
	assert_int_equal(lod_light_byte(-5), 0);
	assert_int_equal(lod_light_byte(1e9), 255);
	assert_int_equal(lod_light_byte(65535 / 2.0), 188);         /* half the light of white */
}

