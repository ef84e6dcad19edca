/* Drawing of an image's clear texels where they are mixed with others. */
#include <stdlib.h>
#include <string.h>

#include "client-min/view_texture.h"
#include "tests/support/unit_test.h"

/* Letters: r red, g green, opaque; . clear and white. */
static uint8_t *fill(const char *const *rows, uint32_t width, uint32_t height)
{
	uint8_t *rgba = calloc((size_t)width * height, 4);
	assert_non_null(rgba);
	for (uint32_t i = 0; i < width * height; i++) {
		char c = rows[i / width][i % width];
		memcpy(rgba + 4 * i, c == 'r' ? "\xC8\0\0\xFF" : c == 'g' ? "\0\x64\0\xFF"
			: "\xFF\xFF\xFF\x20", 4);
	}
	uint8_t *filled =
		view_texture_fill(&(struct eco_image){ .width = width, .height = height, .rgba = rgba });
	assert_non_null(filled);
	for (uint32_t i = 0; i < width * height; i++) {
		assert_int_equal(filled[4 * i + 3], rgba[4 * i + 3]);
		if (rgba[4 * i + 3] == 255)
			assert_memory_equal(filled + 4 * i, rgba + 4 * i, 4);
	}
	free(rgba);
	return filled;
}

UNIT_TEST(clear_texels_take_the_colour_beside_them)
{
	static const char *const rows[] = { "r...g...", "........", "..r...g.", "........" };
	uint8_t *filled = fill(rows, 8, 4);
	for (uint32_t i = 0; i < 32; i++)
		assert_memory_equal(filled + 4 * i, i % 8 < 4 ? "\xC8\0\0" : "\0\x64\0", 3);
	free(filled);
}

UNIT_TEST(far_from_all_they_take_the_mean)
{
	static const char *const rows[] = { "r......g", "........", "........", "........", "........",
		"........", "........", "........" };
	uint8_t *filled = fill(rows, 8, 8);
	assert_memory_equal(filled + 4 * (7 * 8), "\x64\x32\0", 3);
	free(filled);
}

UNIT_TEST(one_opaque_texel_is_enough_in_a_picture_of_any_shape)
{
	char row[301];
	const char *rows[] = { row };
	memset(row, '.', 300);
	row[300] = 0;
	row[299] = 'g';
	uint8_t *filled = fill(rows, 300, 1);
	assert_memory_equal(filled, "\0\x64\0", 3);
	free(filled);
}

UNIT_TEST(nothing_opaque_stays_as_it_is)
{
	static const char *const rows[] = { "...", "..." };
	uint8_t *filled = fill(rows, 3, 2);
	for (uint32_t i = 0; i < 6; i++)
		assert_memory_equal(filled + 4 * i, "\xFF\xFF\xFF", 3);
	free(filled);
}
