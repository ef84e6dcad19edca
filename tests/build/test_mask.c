/* Triangles of cut-outs that show nothing, against sampling; rims of thick leaves; a bound on all the work.
 */
#include "ecofiles/format/list.h"
#include "lod/raster/texel.h"
#include "lod/build/organ/organ.h"
#include "tests/support/plant_models.h"
#include "tests/support/unit_test.h"

static void open_disc(struct soup *soup, struct lod_mask *mask, struct lod_arena *arena, uint32_t size)
{
	soup_begin(soup);
	soup_disc_image(soup, size);
	*arena = (struct lod_arena){ 0 };
	lod_mask_open(mask, soup->image, arena);
}

static void close_disc(struct soup *soup, struct lod_arena *arena)
{
	lod_arena_free(arena);
	soup_free(soup);
}

/* ---- Against samples ---- */

static bool a_sample_is_opaque(const struct eco_image *image, const int32_t uv[6], int steps)
{
	for (int i = 0; i <= steps; i++)
		for (int j = 0; i + j <= steps; j++) {
			double a = (double)i / steps, b = (double)j / steps, c = 1 - a - b;
			if (lod_texel_at(image, (a * uv[0] + b * uv[2] + c * uv[4]) / ECO_UV_ONE,
				(a * uv[1] + b * uv[3] + c * uv[5]) / ECO_UV_ONE)[3] >= 128)
				return true;
		}
	return false;
}

/* Distance of the triangle from the disc of radius 0.4 around the middle of each turn, by samples. */
static double distance_from_discs(const int32_t uv[6], int steps)
{
	double least = 1;
	for (int i = 0; i <= steps; i++)
		for (int j = 0; i + j <= steps; j++) {
			double a = (double)i / steps, b = (double)j / steps, c = 1 - a - b;
			double u = (a * uv[0] + b * uv[2] + c * uv[4]) / ECO_UV_ONE,
				v = (a * uv[1] + b * uv[3] + c * uv[5]) / ECO_UV_ONE;
			u -= floor(u) + 0.5;
			v -= floor(v) + 0.5;
			least = fmin(least, sqrt(u * u + v * v) - 0.4);
		}
	return least;
}

UNIT_TEST(hidden_is_what_no_sample_sees)
{
	for (uint32_t size = 8; size <= 200; size = size * 2 + 3) {
		struct soup soup;
		struct lod_mask mask;
		struct lod_arena arena;
		uint64_t work = 0;
		uint32_t hidden = 0, seen = 0;
		open_disc(&soup, &mask, &arena, size);
		for (int i = 0; i < 1500; i++) {
			int32_t uv[6];
			double extent = i % 2 ? ECO_UV_ONE : ECO_UV_ONE / 8.0,
				u = soup_random(&soup, -3, 3) * ECO_UV_ONE,
				v = soup_random(&soup, -3, 3) * ECO_UV_ONE;
			for (int k = 0; k < 3; k++) {
				uv[2 * k] = (int32_t)(u + soup_random(&soup, 0, extent));
				uv[2 * k + 1] = (int32_t)(v + soup_random(&soup, 0, extent));
			}
			if (i % 3 == 0)                      /* a line */
				memcpy(uv + 4, uv, 2 * sizeof *uv);
			bool is = lod_mask_hidden(&mask, uv, &work);
			hidden += is;
			seen += !is;
			if (is)
				assert_false(a_sample_is_opaque(soup.image, uv, 40));
			else
				assert_true(distance_from_discs(uv, 40) < 2.5 / size + 0.02);
		}
		assert_true(hidden > 100 && seen > 1000);
		close_disc(&soup, &arena);
	}
}

UNIT_TEST(work_is_bounded)
{
	struct soup soup;
	struct lod_mask mask;
	struct lod_arena arena;
	uint64_t work = 0;
	open_disc(&soup, &mask, &arena, 64);
	/* 2^22 rows at the transparent border */
	int32_t tall[6] = { 20, -(1 << 27), 40, 1 << 27, 20, -(1 << 27) };
	assert_false(lod_mask_hidden(&mask, tall, &work));
	assert_int_equal(work, 0);
	int32_t column[6] = { 20, 0, 40, 900 * ECO_UV_ONE, 20, 0 };          /* 57,600 rows */
	assert_true(lod_mask_hidden(&mask, column, &work));
	assert_in_range(work, 57600, 5 * 57700);
	for (int i = 0; i < 20000 && work <= LOD_MASK_WORK; i++)
		lod_mask_hidden(&mask, column, &work);
	assert_true(work > LOD_MASK_WORK);
	uint64_t before = work;
	for (int i = 0; i < 100000; i++)
		assert_false(lod_mask_hidden(&mask, column, &work));
	assert_true(work - before <= 100000 * 5);
	close_disc(&soup, &arena);
}

/* ---- Thick leaves: two large cards, and rims that are lines in the texture ---- */

static void make_slab(struct soup *soup, uint32_t material)
{
	static const double square[4][2] = { { 0.02, 0.04 }, { 0.98, 0.04 }, { 0.98, 0.97 }, { 0.02, 0.97 } };
	for (int leaf = 0; leaf < 30; leaf++) {
		uint32_t v[2][4];
		for (int side = 0; side < 2; side++)
			for (int k = 0; k < 4; k++)
				v[side][k] =
					soup_vertex(soup,
					(struct lod_v3){ leaf % 6 + 0.8 * square[k][0],
					leaf / 6 + 0.8 * square[k][1], 1 + leaf * 0.1 + 0.05 * side },
					square[k][0], square[k][1]);
		for (int k = 0; k < 4; k++) {
			int next = (k + 1) % 4;
			soup_triangle(soup, material, v[0][k], v[0][next], v[1][next]);
			soup_triangle(soup, material, v[0][k], v[1][next], v[1][k]);
		}
		soup_triangle(soup, material, v[0][0], v[0][2], v[0][1]);
		soup_triangle(soup, material, v[0][0], v[0][3], v[0][2]);
		soup_triangle(soup, material, v[1][0], v[1][1], v[1][2]);
		soup_triangle(soup, material, v[1][0], v[1][2], v[1][3]);
	}
}

UNIT_TEST(rims_that_show_nothing_close_leaves_and_are_not_stored)
{
	FREED(soup) soup;
	FREED(lod_arena) arena = { 0 };
	struct lod_mesh mesh;
	struct lod_organs organs;
	soup_begin(&soup);
	uint32_t material = soup_material(&soup, 255, 255, 255, soup_disc_image(&soup, 64), true);
	make_slab(&soup, material);
	lod_weld(&mesh, &soup.model, 14, &arena);
	assert_int_equal(mesh.dropped[ECO_DROP_TRANSPARENT], 30 * 8);
	assert_int_equal(mesh.unstored, 30 * 8);
	assert_int_equal(mesh.triangle_count, 30 * 12);
	lod_organs_find(&organs, &mesh, &soup.model, &arena);
	struct lod_texels texels;
	lod_texels_open(&texels, soup.image, true, &arena);
	for (uint32_t t = 0; t < mesh.triangle_count; t++) {
		uint8_t rgb[3];
		lod_texels_mean(&texels, soup.material[0].rgb, mesh.uv + 6 * (size_t)t, rgb);
		assert_true(organs.components[mesh.component[t]].closed);
		assert_in_range(rgb[0], 39, 91);
		assert_int_equal(rgb[1], 160);
		assert_int_equal(rgb[2], 30);
	}
}
