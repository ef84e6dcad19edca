/* Pictures: what is written comes back, what is read has straight alpha, what is no picture is an error. */
#include "ecofiles/format/image.h"
#include "tests/support/input_files.h"
#include "tests/support/unit_test.h"

/* 4 x 3 pixels in which every channel and every row differs. */
static void sample(uint8_t *bytes, uint32_t channels)
{
	for (uint32_t i = 0; i < 12 * channels; i++)
		bytes[i] = (uint8_t)(i * 37 + channels);
}

UNIT_TEST(png_gives_back_every_pixel)
{
	static const uint32_t kinds[] = { 1, 3, 4 };
	for (size_t k = 0; k < 3; k++) {
		uint32_t channels = kinds[k];
		struct eco_error error = { .code = ECO_OK };
		struct eco_image image;
		uint8_t bytes[48];
		const struct eco_pixels pixels = { 4, 3, channels, bytes };
		const char *path = input_path("image", "a.png");
		sample(bytes, channels);
		if (eco_png_write(&pixels, path, &error) != ECO_OK || eco_image_read(&image, path, &error)
				!= ECO_OK)
			fail_msg("%s", error.text);
		assert_int_equal(image.width, 4);
		assert_int_equal(image.height, 3);
		for (uint32_t i = 0; i < 12; i++) {
			for (uint32_t c = 0; c < 3; c++)
				assert_int_equal(image.rgba[i * 4 + c],
					bytes[i * channels + (channels == 1 ? 0 : c)]);
			assert_int_equal(image.rgba[i * 4 + 3], channels == 4 ? bytes[i * 4 + 3] : 255);
		}
		eco_image_free(&image);
		assert_null(image.rgba);
	}
}

/* A lossless WebP of 4 x 1 pixels: (200,0,0) at alpha 128, opaque green, transparent, (90,180,40) at alpha
 * 64. */
static const uint8_t webp[] = {
	0x52, 0x49, 0x46, 0x46, 0x32, 0x00, 0x00, 0x00, 0x57, 0x45, 0x42, 0x50, 0x56, 0x50, 0x38, 0x4c, 0x25,
		0x00, 0x00, 0x00,
	0x2f, 0x03, 0x00, 0x00, 0x10, 0x1f, 0x20, 0x10, 0x20, 0xf8, 0xdf, 0xf1, 0x67, 0x43, 0x2c, 0x98, 0xcc,
	0xff, 0x8c, 0x2a, 0xac, 0x41, 0x11, 0x08, 0x10, 0xd6, 0x9d, 0x39, 0x13, 0xc0, 0xec, 0xac, 0xa1, 0xc6,
	0x11, 0xfd, 0x0f, 0x00
};

UNIT_TEST(colours_are_not_multiplied_by_alpha)
{
	static const uint8_t wanted[] = { 200, 0, 0, 128, 0, 255, 0, 255, 0, 0, 0, 0, 90, 180, 40, 64 };
	FREED(eco_image) image;
	assert_good(eco_image_read_memory(&image, webp, sizeof webp, "a.webp", &cause));
	assert_int_equal(image.width, 4);
	/* one way through the reader's own multiplication loses up to 2 at alpha 64 */
	for (int i = 0; i < 16; i++)
		if (i / 4 != 2)
			assert_in_range(image.rgba[i], wanted[i] > 2 ? wanted[i] - 2 : 0, wanted[i] + 2);
	assert_int_equal(image.rgba[11], 0);
}

/* "DDS ", its head, and two pixels of blue, green, red, alpha. */
UNIT_TEST(pictures_of_games_are_read)
{
	static const uint8_t head[128] = { 0x44, 0x44, 0x53, 0x20, 124, [8] = 0x0f, 0x10, [12] = 1, [16] = 2,
		[20] = 8,
		[76] = 32, [80] = 0x41, [88] = 32, [94] = 255, [97] = 255, [100] = 255, [107] = 255, [109] = 0x10 };
	static const uint8_t wanted[] = { 30, 20, 10, 255, 60, 50, 40, 0 };
	uint8_t dds[136], tga[26] = { [2] = 2, [12] = 2, [14] = 1, [16] = 32, 0x28 };
	static const uint8_t pixels[] = { 10, 20, 30, 255, 40, 50, 60, 0 };
	struct eco_image image;
	memcpy(dds, head, sizeof head);
	memcpy(dds + sizeof head, pixels, sizeof pixels);
	memcpy(tga + 18, pixels, sizeof pixels);
	const char *paths[] = { input_bytes("image", "two.dds", dds, sizeof dds),
		input_bytes("image", "two.tga", tga, sizeof tga) };
	for (size_t i = 0; i < 2; i++) {
		assert_good(eco_image_read(&image, paths[i], &cause));
		assert_true(image.width == 2 && image.height == 1);
		assert_memory_equal(image.rgba, wanted, sizeof wanted);
		eco_image_free(&image);
	}
	static const char ktx[] = "\xabKTX 20\xbb\r\n\x1a\n";
	assert_code(eco_image_read(&image, input_bytes("image", "no.ktx2", ktx, 12),
		&cause), ECO_UNSUPPORTED, "no.ktx2: KTX is not read: save it as PNG");
}

UNIT_TEST(what_is_no_picture_is_an_error_that_names_it)
{
	static const struct { const char *name; const void *bytes; size_t size; } inputs[] = {
		{ "text.png", "not a picture at all", 20 }, { "empty.png", "", 0 },
			{ "cut.webp", webp, sizeof webp / 2 },
		{ "head.png", "\x89PNG\r\n\x1a\n", 8 }, { "none.jpg", "\xff\xd8\xff\xe0", 4 },
		{ "noise.bin", "\0\1\2\3\4\5\6\7", 8 },
	};

	for (size_t i = 0; i < sizeof inputs / sizeof *inputs; i++) {
		struct eco_error error = { .code = ECO_OK };
		struct eco_image image;
		assert_int_not_equal(eco_image_read_memory(&image, inputs[i].bytes, inputs[i].size,
			inputs[i].name, &error), ECO_OK);
		assert_null(image.rgba);
		assert_non_null(strstr(error.text, inputs[i].name));
		error.code = ECO_OK;
		assert_int_not_equal(eco_image_read(&image,
			input_bytes("image", inputs[i].name, inputs[i].bytes, inputs[i].size), &error),
			ECO_OK);
		assert_non_null(strstr(error.text, inputs[i].name));
	}
	assert_int_equal(eco_image_read(&(struct eco_image){ .rgba = NULL }, "build/tmp/image/gone.png",
		NULL), ECO_NOT_FOUND);
}

UNIT_TEST(every_damage_to_a_png_is_found)
{
	uint8_t bytes[48], *png;
	const struct eco_pixels pixels = { 4, 3, 4, bytes };
	struct eco_image image;
	size_t size;
	sample(bytes, 4);
	assert_int_equal(eco_png_encode(&pixels, &png, &size, NULL), ECO_OK);
	for (size_t cut = 0; cut < size; cut++)
		assert_int_not_equal(eco_image_read_memory(&image, png, cut, "cut.png", NULL), ECO_OK);
	for (size_t at = 8; at < size; at++) {
		png[at] ^= 0x10;
		assert_int_not_equal(eco_image_read_memory(&image, png, size, "bits.png", NULL), ECO_OK);
		png[at] ^= 0x10;
	}
	free(png);
}

UNIT_TEST(a_huge_picture_is_refused_before_it_is_read)
{
	/* header of a PNG of 60000 x 60000 pixels */
	static const uint8_t huge[] = { 0x89, 'P', 'N', 'G', 13, 10, 26, 10, 0, 0, 0, 13, 'I', 'H', 'D', 'R',
		0, 0, 0xea, 0x60, 0, 0, 0xea, 0x60, 8, 6, 0, 0, 0, 0x80, 0xd2, 0x75, 0x42, 0, 0, 0, 0, 'I',
		'D', 'A', 'T', 0x35, 0xaf, 0x06, 0x1e, 0, 0, 0, 0, 'I', 'E', 'N', 'D', 0xae, 0x42, 0x60,
		0x82 };
	struct eco_image image;
	uint8_t byte = 0, *png;
	const struct eco_pixels pixels = { 60000, 60000, 1, &byte };
	size_t size;

	assert_code(eco_image_read_memory(&image, huge, sizeof huge, "huge.png", &cause), ECO_CODE_COUNT, "60000x60000");
	assert_int_equal(eco_png_encode(&pixels, &png, &size, NULL), ECO_TOO_LARGE);
}

UNIT_TEST(a_picture_that_cannot_be_written_leaves_nothing)
{
	uint8_t bytes[48];
	const struct eco_pixels pixels = { 4, 3, 4, bytes };
	sample(bytes, 4);
	assert_code(eco_png_write(&pixels, "build/tmp/image/no/such/folder.png", &cause), ECO_IO,
		"folder.png");
}
