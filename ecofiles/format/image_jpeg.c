/* libjpeg reports errors by a function that must not return: it leaves by longjmp. */
#include "ecofiles/format/image.h"

#include <setjmp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <jpeglib.h>
#include <jerror.h>

struct reading {
	struct jpeg_error_mgr errors;        /* first: libjpeg hands back its address */
	struct jpeg_decompress_struct jpeg;
	uint8_t *rgba;
	bool ended;                          /* no more bytes: libjpeg goes on as if the picture had ended */
	jmp_buf back;
};

static _Noreturn void give_up(j_common_ptr jpeg)
{
	longjmp(((struct reading *)jpeg->err)->back, 1);
}

/* A warning says that data are damaged, or that there are no more: if some are missed, another one follows. */
static void on_message(j_common_ptr jpeg, int level)
{
	struct reading *r = (struct reading *)jpeg->err;
	if (level < 0 && r->errors.msg_code != JWRN_JPEG_EOF)
		give_up(jpeg);
	r->ended |= level < 0;
}

bool eco_jpeg_is(const uint8_t *bytes, size_t size_bytes)
{
	return size_bytes >= 3 && memcmp(bytes, "\xff\xd8\xff", 3) == 0;
}

static bool has_colours(const struct jpeg_decompress_struct *jpeg)
{
	return jpeg->jpeg_color_space == JCS_GRAYSCALE || jpeg->jpeg_color_space == JCS_YCbCr
		|| jpeg->jpeg_color_space == JCS_RGB;
}

static void read_pixels(struct reading *r, const uint8_t *bytes, size_t size_bytes)
{
	struct jpeg_decompress_struct *jpeg = &r->jpeg;
	jpeg_create_decompress(jpeg);
	jpeg_mem_src(jpeg, bytes, size_bytes);
	jpeg_read_header(jpeg, TRUE);
	if (!has_colours(jpeg) || (uint64_t)jpeg->image_width * jpeg->image_height > ECO_PIXELS_MAX)
		give_up((j_common_ptr)jpeg);
	jpeg->out_color_space = JCS_EXT_RGBA;
	jpeg_start_decompress(jpeg);
	size_t row_bytes = (size_t)jpeg->output_width * 4;
	r->rgba = malloc(row_bytes * jpeg->output_height);
	if (!r->rgba)
		give_up((j_common_ptr)jpeg);
	while (jpeg->output_scanline < jpeg->output_height) {
		JSAMPROW row = r->rgba + row_bytes * jpeg->output_scanline;
		jpeg_read_scanlines(jpeg, &row, 1);
	}
	jpeg_finish_decompress(jpeg);
}

/* False: libjpeg gave up. */
static bool try_read(struct reading *r, const uint8_t *bytes, size_t size_bytes)
{
	if (setjmp(r->back) != 0)
		return false;
	read_pixels(r, bytes, size_bytes);
	return true;
}

bool eco_jpeg_decode(struct eco_image *image, const uint8_t *bytes, size_t size_bytes, bool *cut_off)
{
	struct reading r = { .rgba = NULL };
	r.jpeg.err = jpeg_std_error(&r.errors);
	r.errors.error_exit = give_up;
	r.errors.emit_message = on_message;
	bool read = try_read(&r, bytes, size_bytes);
	*cut_off = !read && r.ended;
	*image = read ? (struct eco_image){ r.jpeg.output_width, r.jpeg.output_height, r.rgba }
		: (struct eco_image){ .rgba = NULL };
	if (!read)
		free(r.rgba);
	jpeg_destroy_decompress(&r.jpeg);
	return read;
}
