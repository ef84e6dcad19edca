/* libpng reports errors by longjmp: everything that must be freed lives in one struct, outside the frame
 * that is left. */
#include "ecofiles/format/image.h"

#include <assert.h>
#include <png.h>
#include <setjmp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct coding {
	png_structp png;
	png_infop info;
	const uint8_t *from; size_t size, at;        /* input */
	uint8_t *bytes; size_t used, capacity;       /* output */
	uint8_t *rgba;
	png_bytep *rows;
	char text[200];                              /* libpng's message */
	bool too_large, no_memory;
	jmp_buf back;
};

static _Noreturn void on_error(png_structp png, const char *text)
{
	struct coding *c = png_get_error_ptr(png);
	snprintf(c->text, sizeof c->text, "%s", text);
	longjmp(c->back, 1);
}

static void on_warning(png_structp png, const char *text)
{
	(void)png;
	(void)text;
}

static void need(struct coding *c, const void *memory)
{
	c->no_memory |= !memory;
	if (!memory)
		png_error(c->png, "out of memory");
}

static void release(struct coding *c)
{
	free(c->rows);
	free(c->rgba);
	free(c->bytes);
}

/* ---- Reading ---- */

bool eco_png_is(const uint8_t *bytes, size_t size_bytes)
{
	return size_bytes >= 4 && memcmp(bytes, "\x89PNG", 4) == 0;
}

static void take(png_structp png, png_bytep to, size_t count)
{
	struct coding *c = png_get_io_ptr(png);
	if (count > c->size - c->at)
		png_error(png, "it ends too early");
	memcpy(to, c->from + c->at, count);
	c->at += count;
}

/* Has libpng convert any samples to 8-bit RGBA. */
static void spread(struct coding *c)
{
	png_set_expand(c->png);
	png_set_scale_16(c->png);
	png_set_gray_to_rgb(c->png);
	png_set_add_alpha(c->png, 255, PNG_FILLER_AFTER);
	png_set_interlace_handling(c->png);
	png_read_update_info(c->png, c->info);
}

static void read_pixels(struct coding *c, struct eco_image *image)
{
	png_set_read_fn(c->png, c, take);
	png_set_crc_action(c->png, PNG_CRC_ERROR_QUIT, PNG_CRC_ERROR_QUIT);
	png_read_info(c->png, c->info);
	image->width = png_get_image_width(c->png, c->info);
	image->height = png_get_image_height(c->png, c->info);
	c->too_large = (uint64_t)image->width * image->height > ECO_PIXELS_MAX;
	if (c->too_large)
		png_error(c->png, "too large");
	spread(c);
	assert(png_get_rowbytes(c->png, c->info) == (size_t)image->width * 4);
	need(c, c->rgba = malloc((size_t)image->width * image->height * 4));
	need(c, c->rows = malloc((size_t)image->height * sizeof *c->rows));
	for (uint32_t y = 0; y < image->height; y++)
		c->rows[y] = c->rgba + (size_t)y * image->width * 4;
	png_read_image(c->png, c->rows);
	png_read_end(c->png, NULL);
	image->rgba = c->rgba;
	c->rgba = NULL;
}

/* False: libpng gave up. */
static bool try_read(struct coding *c, struct eco_image *image)
{
	if (setjmp(c->back) != 0)
		return false;
	read_pixels(c, image);
	return true;
}

enum eco_code eco_png_decode(struct eco_image *image, const uint8_t *bytes, size_t size_bytes,
	const char *name, struct eco_error *error)
{
	struct coding c = { .from = bytes, .size = size_bytes };
	enum eco_code code;
	*image = (struct eco_image){ .rgba = NULL };
	c.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &c, on_error, on_warning);
	c.info = c.png ? png_create_info_struct(c.png) : NULL;
	if (!c.info)
		code = eco_fail(error, ECO_NO_MEMORY, "%s: out of memory", name);
	else if (try_read(&c, image))
		code = ECO_OK;
	else if (c.too_large)
		code = eco_fail(error, ECO_TOO_LARGE, "%.300s: %ux%u pixels, at most %u are possible", name,
			image->width, image->height, ECO_PIXELS_MAX);
	else if (c.no_memory)
		code = eco_fail(error, ECO_NO_MEMORY, "%.300s: out of memory", name);
	else
		code = eco_fail(error, ECO_DAMAGED, "%.200s: a PNG that is cut off or damaged: %s", name,
			c.text);
	if (code)
		*image = (struct eco_image){ .rgba = NULL };
	png_destroy_read_struct(&c.png, &c.info, NULL);
	release(&c);
	return code;
}

/* ---- Writing ---- */

static void append(png_structp png, png_bytep from, size_t count)
{
	struct coding *c = png_get_io_ptr(png);
	if (count > c->capacity - c->used) {
		size_t capacity = 2 * c->capacity + count;
		uint8_t *bytes = realloc(c->bytes, capacity);
		need(c, bytes);
		c->bytes = bytes;
		c->capacity = capacity;
	}
	memcpy(c->bytes + c->used, from, count);
	c->used += count;
}

static void flush(png_structp png)
{
	(void)png;
}

static void write_pixels(struct coding *c, const struct eco_pixels *pixels, int filters)
{
	int kind = pixels->channels == 1 ? PNG_COLOR_TYPE_GRAY : pixels->channels == 3 ? PNG_COLOR_TYPE_RGB
		: PNG_COLOR_TYPE_RGB_ALPHA;
	png_set_write_fn(c->png, c, append, flush);
	png_set_IHDR(c->png, c->info, pixels->width, pixels->height, 8, kind, PNG_INTERLACE_NONE,
		PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
	png_set_filter(c->png, PNG_FILTER_TYPE_DEFAULT, filters);
	png_write_info(c->png, c->info);
	for (uint32_t y = 0; y < pixels->height; y++)
		png_write_row(c->png, pixels->bytes + (size_t)y * pixels->width * pixels->channels);
	png_write_end(c->png, NULL);
}

static bool try_write(struct coding *c, const struct eco_pixels *pixels, int filters)
{
	if (setjmp(c->back) != 0)
		return false;
	write_pixels(c, pixels, filters);
	return true;
}

static enum eco_code encode(const struct eco_pixels *pixels, int filters, uint8_t **bytes, size_t *size_bytes,
	struct eco_error *error)
{
	struct coding c = { .bytes = NULL };
	enum eco_code code = ECO_OK;
	assert(pixels->channels == 1 || pixels->channels == 3 || pixels->channels == 4);
	*bytes = NULL;
	*size_bytes = 0;
	if (pixels->width == 0 || pixels->height == 0 || (uint64_t)pixels->width * pixels->height
			> ECO_PIXELS_MAX)
		return eco_fail(error, ECO_TOO_LARGE, "a picture of %u x %u pixels: 1 to %u are possible",
			pixels->width, pixels->height, ECO_PIXELS_MAX);
	c.png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &c, on_error, on_warning);
	c.info = c.png ? png_create_info_struct(c.png) : NULL;
	if (!c.info || !try_write(&c, pixels, filters)) {
		code = eco_fail(error, ECO_NO_MEMORY, "a picture of %u x %u pixels cannot be written: %s",
			pixels->width, pixels->height, !c.info ? "out of memory" : c.text);
	} else {
		*bytes = c.bytes;
		*size_bytes = c.used;
		c.bytes = NULL;
	}
	png_destroy_write_struct(&c.png, &c.info);
	release(&c);
	return code;
}

/* Encodes without filters and with them, and keeps the smaller file: painted leaves are smaller without,
 * photographs with. libpng's own rule for a row is wrong half of the time. */
enum eco_code eco_png_encode(const struct eco_pixels *pixels, uint8_t **bytes, size_t *size_bytes,
	struct eco_error *error)
{
	uint8_t *differences;
	size_t size;
	enum eco_code code = encode(pixels, PNG_FILTER_NONE, bytes, size_bytes, error);
	if (code != ECO_OK || encode(pixels, PNG_ALL_FILTERS, &differences, &size, NULL) != ECO_OK)
		return code;
	if (size < *size_bytes) {
		free(*bytes);
		*bytes = differences;
		*size_bytes = size;
	} else {
		free(differences);
	}
	return ECO_OK;
}

enum eco_code eco_png_encode_fast(const struct eco_pixels *pixels, uint8_t **bytes, size_t *size_bytes,
	struct eco_error *error)
{
	return encode(pixels, PNG_FILTER_NONE, bytes, size_bytes, error);
}
