/* JPEG: texels are those of OpenImageIO, which is asked only where libjpeg refuses. */
#include "ecofiles/format/image.h"

#include <stdlib.h>
#include <string.h>

#include <stdio.h>
#include <jpeglib.h>

#include "ecofiles/base/module.h"
#include "tests/support/unit_test.h"

#define WIDTH 37u
#define HEIGHT 21u

struct kind { const char *name; J_COLOR_SPACE in, stored; int sampling; bool progressive; };

static const struct kind kinds[] = {
	{ "halved colours", JCS_RGB, JCS_YCbCr, 2, false }, { "full colours", JCS_RGB, JCS_YCbCr, 1, false },
	{ "progressive", JCS_RGB, JCS_YCbCr, 2, true }, { "gray", JCS_GRAYSCALE, JCS_GRAYSCALE, 1, false },
	{ "red, green, blue", JCS_RGB, JCS_RGB, 1, false },
};

static const struct kind inks = { "inks", JCS_CMYK, JCS_YCCK, 1, false };

static void set_up(struct jpeg_compress_struct *jpeg, const struct kind *kind)
{
	jpeg->image_width = WIDTH;
	jpeg->image_height = HEIGHT;
	jpeg->in_color_space = kind->in;
	jpeg->input_components = kind->in == JCS_GRAYSCALE ? 1 : kind->in == JCS_CMYK ? 4 : 3;
	jpeg_set_defaults(jpeg);
	jpeg_set_colorspace(jpeg, kind->stored);
	jpeg_set_quality(jpeg, 80, TRUE);
	jpeg->comp_info[0].h_samp_factor = jpeg->comp_info[0].v_samp_factor = kind->sampling;
	if (kind->progressive)
		jpeg_simple_progression(jpeg);
}

/* *bytes is malloc'ed. */
static void write_jpeg(const struct kind *kind, uint8_t **bytes, unsigned long *size)
{
	struct jpeg_error_mgr errors;
	struct jpeg_compress_struct jpeg = { .err = jpeg_std_error(&errors) };
	uint8_t line[WIDTH * 4];
	*bytes = NULL;
	*size = 0;
	jpeg_create_compress(&jpeg);
	jpeg_mem_dest(&jpeg, bytes, size);
	set_up(&jpeg, kind);
	jpeg_start_compress(&jpeg, TRUE);
	for (uint32_t y = 0; y < HEIGHT; y++) {
		JSAMPROW row = line;
		for (uint32_t i = 0; i < sizeof line; i++)
			line[i] = (uint8_t)(i * i * 3 / 7 + y * 11);
		jpeg_write_scanlines(&jpeg, &row, 1);
	}
	jpeg_finish_compress(&jpeg);
	jpeg_destroy_compress(&jpeg);
}

/* The first test: a module once loaded stays. */
UNIT_TEST(no_module_is_needed)
{
	setenv(ECO_MODULES_VARIABLE, "/no/such/folder", 1);
	for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
		FREED(eco_image) image;
		FREED_MEMORY uint8_t *bytes;
		unsigned long size;
		write_jpeg(&kinds[i], &bytes, &size);
		assert_good(eco_image_read_memory(&image, bytes, size, kinds[i].name, &cause));
	}
	unsetenv(ECO_MODULES_VARIABLE);
}

UNIT_TEST(texels_are_those_of_openimageio)
{
	const struct eco_image_module *module = eco_module(ECO_MODULE_IMAGE, NULL);
	assert_non_null(module);
	for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
		FREED(eco_image) ours, theirs;
		FREED_MEMORY uint8_t *bytes;
		unsigned long size;
		char text[300] = "";
		write_jpeg(&kinds[i], &bytes, &size);
		assert_true(eco_jpeg_decode(&ours, bytes, size, &(bool){ false }));
		if (module->decode("a.jpg", bytes, size, ECO_PIXELS_MAX, &theirs.width, &theirs.height,
				&theirs.rgba, text, sizeof text) != 0)
			fail_msg("%s: %s", kinds[i].name, text);
		assert_int_equal(ours.width, WIDTH);
		assert_int_equal(ours.height, HEIGHT);
		assert_int_equal(theirs.width, WIDTH);
		if (memcmp(ours.rgba, theirs.rgba, WIDTH * HEIGHT * 4) != 0)
			fail_msg("%s: other texels", kinds[i].name);
	}
}

/* Inks, a marker amid the picture, and 61,680 pixels a side: no picture, and not as if it were cut off. */
UNIT_TEST(what_libjpeg_cannot_read_is_left_to_openimageio)
{
	for (int fault = 0; fault < 3; fault++) {
		uint8_t *bytes, *frame;
		unsigned long size;
		FREED(eco_image) image;
		bool cut_off;
		write_jpeg(fault == 0 ? &inks : &kinds[1], &bytes, &size);
		frame = memmem(bytes, size, "\xff\xc0", 2);
		assert_non_null(frame);
		if (fault == 1)
			memcpy(bytes + size - 40, "\xff\xd9", 2);
		else if (fault == 2)
			memset(frame + 5, 0xF0, 4);
		assert_false(eco_jpeg_decode(&image, bytes, size, &cut_off) || cut_off);
		assert_null(image.rgba);
		if (fault == 0)
			assert_good(eco_image_read_memory(&image, bytes, size, "inks.jpg", &cause));
		assert_int_equal(image.width, fault == 0 ? WIDTH : 0);
		free(bytes);
	}
}

/* Never a picture of which a part is gray; without the two bytes that mark its end it is whole. */
UNIT_TEST(what_is_cut_short_is_refused)
{
	FREED_MEMORY uint8_t *bytes;
	unsigned long size;
	struct eco_image whole, image;
	bool cut_off;
	write_jpeg(&kinds[0], &bytes, &size);
	assert_true(eco_jpeg_decode(&whole, bytes, size, &cut_off));
	for (unsigned long cut = 1; cut < size; cut++) {
		struct eco_error error = { .code = ECO_OK };
		enum eco_code code = eco_image_read_memory(&image, bytes, cut, "cut.jpg", &error);
		if (cut >= size - 2)
			assert_memory_equal(image.rgba, whole.rgba, WIDTH * HEIGHT * 4);
		else if (!code || (cut > 2 && !strstr(error.text, "cut.jpg: a JPEG that is cut off")))
			fail_msg("%lu of %lu bytes: %s", cut, size, error.text);
		eco_image_free(&image);
	}
	eco_image_free(&whole);
}
