/* Footprints cover what the rasteriser covers, and count what they add. */
#include "lod/build/order/footprint.h"
#include "tests/support/plant_models.h"
#include "tests/support/unit_test.h"

#define PIXELS 96u
#define VIEWS 5u

static struct lod_arena arena;
static struct lod_footprint print;

static uint64_t bits_of(uint64_t word) { return (uint64_t)__builtin_popcountll(word); }

static void begin(void)
{
	lod_arena_free(&arena);
}

static struct eco_image holed(void)
{
	static uint8_t rgba[4 * 16 * 16];
	for (uint32_t i = 0; i < 256; i++)
		rgba[4 * i + 3] = (i / 16 + i % 16) % 5 < 3 ? 255 : 0;
	return (struct eco_image){ 16, 16, rgba };
}

/* Number of pixels that differ from what lod_visibilities_draw makes of each element alone; `covered` counts
 * its pixels. */
static uint64_t differing(const struct lod_foliage *f, float scale, uint64_t *covered)
{
	struct lod_sights sights;
	FREED(lod_raster) raster;
	double directions[VIEWS][3];
	uint64_t differ = 0;
	lod_directions_spread(directions, VIEWS, 7);
	lod_sights_make(&sights, f, (const double (*)[3])directions, VIEWS, PIXELS, &arena);
	lod_raster_init(&raster,
		&(struct lod_raster_options){ .width = PIXELS, .height = PIXELS, .silhouette = true });
	uint32_t row_words = sights.words / PIXELS;
	for (uint32_t v = 0; v < VIEWS; v++)
		for (uint32_t i = 0; i < f->count; i++) {
			uint64_t *drawn = lod_arena_take(&arena, sights.words, sizeof *drawn),
				*times = lod_arena_take(&arena, sights.words, 2 * sizeof *times);
			uint64_t *none = lod_arena_take(&arena, sights.words, sizeof *none);
			struct lod_canvas canvas = { row_words, none, (uint64_t (*)[2])times };
			struct lod_fan fan = lod_foliage_fan(f, i);
			struct lod_fan_seen seen;
			lod_sights_draw(&sights, v,
				&(struct lod_sights_drawing){ .order = &i, .count = 1, .scale = scale },
				&raster, drawn);
			lod_fan_see(&seen, &fan, &sights.eyes[v]);
			lod_fan_add(&seen, sqrt(scale), PIXELS, &canvas);
			for (uint32_t w = 0; w < sights.words; w++) {
				differ += bits_of((canvas.times[w][0] ^ drawn[w]) & ~sights.wood[v][w]);
				*covered += bits_of(drawn[w]);
			}
		}
	return differ;
}

UNIT_TEST(footprints_are_what_is_drawn)
{
	static const struct { uint32_t corners; double leaf; float scale; bool cutout; double share;
		} cases[] = {
		{ 3, 0.3, 1, false, 0.002 }, { 4, 0.3, 1, false, 0.002 }, { 6, 0.2, 2.5f, false, 0.002 },
			{ 6, 0.02, 1, false, 0.004 },
		{ 5, 0.5, 40, false, 0.002 }, { 4, 0.4, 1, true, 0.02 }, { 6, 0.3, 3, true, 0.02 } };
	for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
		struct lod_foliage f;
		struct lod_mask mask;
		struct eco_image image = holed();
		uint64_t covered = 0;
		begin();
		lod_mask_open(&mask, &image, &arena);
		foliage_random(&f, &(struct foliage_random){ 40, cases[k].corners, 1, cases[k].leaf, 20 + k },
			&arena);
		f.mask = lod_arena_take(&arena, f.count, sizeof *f.mask);
		for (uint32_t i = 0; i < f.count && cases[k].cutout; i++) {
			f.cutout[i] = &image;
			f.mask[i] = &mask;
			/* around the image's corner */
			for (uint32_t c = f.first[i]; c < f.first[i + 1]; c++)
				for (int a = 0; a < 2; a++)
					f.uv[c][a] = (float)(c * 7 % 11 + (uint32_t)a * 3 % 5) / 16 - 0.25f;
		}
		uint64_t differ = differing(&f, cases[k].scale, &covered);
		if ((double)differ > cases[k].share * (double)covered)
			fail_msg("case %zu: %lu of %lu pixels differ", k, (unsigned long)differ,
				(unsigned long)covered);
	}
}

/* An eye that looks along -z at the square [-1, 1] x [-1, 1]. */
static struct lod_eye eye_above(void)
{
	return (struct lod_eye){ .at = { 0, 0, 1000 }, .right = { 1, 0, 0 }, .up = { 0, 1, 0 },
		.forward = { 0, 0, -1 }, .tan_x = 0.001, .tan_y = 0.001 };
}

static struct lod_fan_seen see(const float (*corner)[3], uint32_t corners)
{
	struct lod_eye eye = eye_above();
	struct lod_fan_seen seen;
	lod_fan_see(&seen, &(struct lod_fan){ corner, NULL, corners, NULL }, &eye);
	return seen;
}

static bool cover(const float (*corner)[3], uint32_t corners, double edge)
{
	struct lod_fan_seen seen = see(corner, corners);
	return lod_fan_cover(&print, &seen, edge, 64);
}

static void add(const float (*corner)[3], uint32_t corners, double edge, const struct lod_canvas *canvas)
{
	struct lod_fan_seen seen = see(corner, corners);
	lod_fan_add(&seen, edge, 64, canvas);
}

UNIT_TEST(gains_count_right_wrong_and_second)
{
	static const float half[4][3] = { { -1, -1, 0 }, { 0, -1, 0 }, { 0, 1, 0 }, { -1, 1, 0 } };
	static const float top[4][3] = { { -1, 0, 0 }, { 1, 0, 0 }, { 1, 1, 0 }, { -1, 1, 0 } };
	uint64_t reference[64], times[64][2] = { { 0 } };
	struct lod_canvas canvas = { 1, reference, times };
	struct lod_gain gain = { 0 };
	for (uint32_t y = 0; y < 64; y++)
		reference[y] = y < 16 ? ~UINT64_C(0) : 0;                /* a quarter, at the top */
	assert_true(cover(half, 4, 1));
	lod_footprint_gain(&print, &canvas, &gain);
	assert_int_equal(gain.right, 32 * 16);
	assert_int_equal(gain.wrong, 32 * 48);
	assert_int_equal(gain.second, 0);
	add(half, 4, 1, &canvas);
	assert_true(cover(top, 4, 1));
	gain = (struct lod_gain){ 0 };
	lod_footprint_gain(&print, &canvas, &gain);
	assert_int_equal(gain.right, 32 * 16);
	assert_int_equal(gain.wrong, 32 * 16);
	assert_int_equal(gain.second, 32 * 16);
	add(top, 4, 1, &canvas);
	gain = (struct lod_gain){ 0 };
	lod_footprint_gain(&print, &canvas, &gain);
	assert_int_equal(gain.right + gain.wrong, 0);
}

/* Cut-outs are looked up only where that can make a difference: on canvases that are covered here and there,
 * the whole footprint counts the same. */
UNIT_TEST(gains_of_cutouts_are_those_of_their_footprints)
{
	uint64_t reference[256], times[256][2], dice = 9;
	static const float moved[] = { 0, 0.4f, -1.7f };
	struct eco_image image = holed();
	struct lod_mask mask;
	begin();
	lod_mask_open(&mask, &image, &arena);
	for (uint32_t round = 0; round < 300; round++) {
		float corner[4][3] = { { 0 } }, uv[4][2];
		const struct lod_canvas canvas = { 2, reference, times };
		struct lod_eye eye = eye_above();
		struct lod_fan_seen seen;
		struct lod_gain whole = { 0 }, open = { 0 };
		for (uint32_t k = 0; k < 4; k++)
			for (int a = 0; a < 2; a++) {
				corner[k][a] = (float)foliage_dice(&dice) * 0.9f;
				uv[k][a] = (float)(k / 2 ^ (a ? 0 : (k & 1))) + moved[round % 3];
			}
		for (uint32_t w = 0; w < 256; w++) {
			reference[w] = lod_mix(3 * (round * 1000 + w));
			times[w][0] = lod_mix(3 * (round * 1000 + w) + 1);
			times[w][1] = times[w][0] & lod_mix(3 * (round * 1000 + w) + 2);
		}
		lod_fan_see(&seen, &(struct lod_fan){ (const float (*)[3])corner, (const float (*)[2])uv, 4,
			&mask }, &eye);
		if (lod_fan_cover(&print, &seen, 1, 128))
			lod_footprint_gain(&print, &canvas, &whole);
		lod_fan_gain(&seen, 1, 128, &canvas, &open);
		assert_memory_equal(&whole, &open, sizeof whole);
	}
}

UNIT_TEST(what_lies_outside_covers_nothing)
{
	static const float outside[3][3] = { { 3, 0, 0 }, { 4, 0, 0 }, { 3, 1, 0 } },
		line[3][3] = { { -1, 0, 0 }, { 1, 0, 0 }, { 0, 0, 0 } };
	static const float behind[3][3] = { { 0, 0, 2000 }, { 1, 0, 2000 }, { 0, 1, 2000 } };
	uint64_t bits = 0;
	assert_false(cover(outside, 3, 1));
	if (cover(line, 3, 1))
		for (uint32_t i = 0; i < print.rows * print.words; i++)
			bits |= print.bits[i];
	assert_int_equal(bits, 0);
	cover(behind, 3, 1);
}

static int end(void **state)
{
	lod_arena_free(&arena);
	return 0;
}

UNIT_MAIN(NULL, end)
