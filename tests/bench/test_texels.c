/* Figures of the section "texels": what does not depend on the programs that it runs. */
#include <math.h>
#include <string.h>

#include "tests/bench/bench_texels.h"
#include "tests/support/unit_test.h"

UNIT_TEST(bytes_lie_between_two_settings)
{
	/* bytes halve where the error doubles, in any order */
	static const struct texels_trial trials[] = { { .bytes = 800, .error = 1 }, { .bytes = 200, .error = 4 },
		{ .bytes = 400, .error = 2 } };
	uint32_t nearest = 9;
	assert_true(fabs(texels_bytes_at(trials, 3, 3, &nearest) - 800.0 / 3) < 1e-9);
	assert_int_equal(nearest, 1);
	assert_true(fabs(texels_bytes_at(trials, 3, 1.2, &nearest) - 800 / 1.2) < 1e-9);
	assert_int_equal(nearest, 0);
	assert_true(texels_bytes_at(trials, 3, 2, &nearest) == 400);
	assert_int_equal(nearest, 2);
}

UNIT_TEST(nothing_is_said_beyond_the_settings)
{
	static const struct texels_trial trials[] = { { .bytes = 800, .error = 1 }, { .bytes = 200, .error = 4 },
		{ .bytes = 900, .error = 0 } };
	uint32_t nearest;
	assert_true(isnan(texels_bytes_at(trials, 3, 5, &nearest)));
	assert_true(isnan(texels_bytes_at(trials, 2, 0.5, &nearest)));
	assert_true(isnan(texels_bytes_at(trials, 3, 0.5, &nearest)));
	assert_true(isnan(texels_bytes_at(trials, 1, 2, &nearest)));
}

UNIT_TEST(errors_are_those_of_opaque_texels)
{
	uint8_t a[9] = { 10, 20, 30, 1, 2, 3, 40, 50, 60 },
		b[12] = { 10, 20, 33, 255, 99, 99, 99, 255, 40, 54, 60, 0 }, cut[3] = { 255, 0, 255 };
	struct eco_texture_part x = { 3, 1, 3, a }, y = { 3, 1, 4, b }, outline = { 3, 1, 1, cut };
	assert_true(fabs(texels_error(&x, &y, &outline) - 5 / sqrt(6)) < 1e-12);
	memset(cut, 0, sizeof cut);
	assert_true(isnan(texels_error(&x, &y, &outline)));
}

UNIT_TEST(heads_of_avif_are_all_but_the_coded_data)
{
	static const uint8_t file[] = "\0\0\0\x0c""ftypavif\0\0\0\x08""meta\0\0\0\x0b""mdatxyz";
	assert_int_equal(texels_avif_head(file, sizeof file - 1), sizeof file - 1 - 3);
	for (size_t size = 0; size + 1 < sizeof file; size++)        /* cut off: no box is whole that is not there */
		assert_int_equal(texels_avif_head(file, size), 0);
}

UNIT_TEST(webp_is_what_packs_have)
{
	uint8_t texels[3 * 1024], cut[1024];
	struct eco_texture_part colors = { 32, 32, 3, texels }, outline = { 32, 32, 1, cut };
	struct eco_error error = { 0 };
	struct eco_writer w = { 0 };
	struct texels_trial stored;
	memset(cut, 255, sizeof cut);
	for (size_t i = 0; i < sizeof texels; i++)
		texels[i] = (uint8_t)(i * i / 97 + i % 3 * 40);
	assert_ok(eco_texture_write_colors(&w, &colors, ECO_TEXTURE_QUALITY, &error), error);
	assert_ok(texels_code(&stored, NULL, TEXELS_WEBP, &colors, &outline, 0, &error), error);
	assert_true(stored.bytes == (double)w.size && stored.error > 0);
	eco_writer_free(&w);
}
