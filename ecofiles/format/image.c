/* Chooses a picture's reader by its first bytes. libpng and libjpeg report errors by a function that must not
 * return: it leaves by longjmp, and everything that must be freed lives in one struct, outside the frame that
 * is left. */
#include "ecofiles/format/image.h"

#include <assert.h>
#include <png.h>
#include <setjmp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <jpeglib.h>
#include <jerror.h>

#include "ecofiles/base/files.h"
#include "ecofiles/base/module.h"

/* ---- PNG ---- */

struct coding {
	png_structp png;
	png_infop info;
	const uint8_t *from; size_t size, at;        /* input */
	uint8_t *bytes; size_t used, capacity;       /* output */
	uint8_t *rgba;
	char text[200];                              /* libpng's message */
	bool too_large, no_memory;
	struct eco_image *image;                     /* read */
	const struct eco_pixels *pixels;             /* written */
	int filters;
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
	free(c->rgba);
	free(c->bytes);
}

/* False: libpng gave up. */
static bool attempt(struct coding *c, void (*work)(struct coding *c))
{
	if (setjmp(c->back) != 0)
		return false;
	work(c);
	return true;
}

static void take(png_structp png, png_bytep to, size_t count)
{
	struct coding *c = png_get_io_ptr(png);
	if (count > c->size - c->at)
		png_error(png, "it ends too early");
	memcpy(to, c->from + c->at, count);
	c->at += count;
}

/* Has libpng convert any samples to 8-bit RGBA; how often the rows come, as a picture is interlaced. */
static int spread(struct coding *c)
{
	png_set_expand(c->png);
	png_set_scale_16(c->png);
	png_set_gray_to_rgb(c->png);
	png_set_add_alpha(c->png, 255, PNG_FILLER_AFTER);
	int passes = png_set_interlace_handling(c->png);
	png_read_update_info(c->png, c->info);
	return passes;
}

static void read_pixels(struct coding *c)
{
	struct eco_image *image = c->image;
	png_set_read_fn(c->png, c, take);
	png_set_crc_action(c->png, PNG_CRC_ERROR_QUIT, PNG_CRC_ERROR_QUIT);
	png_read_info(c->png, c->info);
	image->width = png_get_image_width(c->png, c->info);
	image->height = png_get_image_height(c->png, c->info);
	c->too_large = (uint64_t)image->width * image->height > ECO_PIXELS_MAX;
	if (c->too_large)
		png_error(c->png, "too large");
	int passes = spread(c);
	assert(png_get_rowbytes(c->png, c->info) == (size_t)image->width * 4);
	need(c, c->rgba = malloc((size_t)image->width * image->height * 4));
	while (passes-- > 0)
		for (uint32_t y = 0; y < image->height; y++)
			png_read_row(c->png, c->rgba + (size_t)y * image->width * 4, NULL);
	png_read_end(c->png, NULL);
	image->rgba = c->rgba;
	c->rgba = NULL;
}

/* As eco_image_read_memory: palettes and gray are converted, 16 bits are rounded, interlacing is allowed;
 * gamma and profiles are ignored. A file that is cut off or damaged anywhere is refused. */
static enum eco_code png_decode(struct eco_image *image, const uint8_t *bytes, size_t size_bytes,
	const char *name, struct eco_error *error)
{
	struct coding c = { .from = bytes, .size = size_bytes, .image = image };
	enum eco_code code;
	*image = (struct eco_image){ .rgba = NULL };
	c.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &c, on_error, on_warning);
	c.info = c.png ? png_create_info_struct(c.png) : NULL;
	if (!c.info)
		code = eco_fail(error, ECO_NO_MEMORY, "%s: out of memory", name);
	else if (attempt(&c, read_pixels))
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

static void write_pixels(struct coding *c)
{
	const struct eco_pixels *pixels = c->pixels;
	int kind = pixels->channels == 1 ? PNG_COLOR_TYPE_GRAY : pixels->channels == 3 ? PNG_COLOR_TYPE_RGB
		: PNG_COLOR_TYPE_RGB_ALPHA;
	png_set_write_fn(c->png, c, append, flush);
	png_set_IHDR(c->png, c->info, pixels->width, pixels->height, 8, kind, PNG_INTERLACE_NONE,
		PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
	png_set_filter(c->png, PNG_FILTER_TYPE_DEFAULT, c->filters);
	png_write_info(c->png, c->info);
	for (uint32_t y = 0; y < pixels->height; y++)
		png_write_row(c->png, pixels->bytes + (size_t)y * pixels->width * pixels->channels);
	png_write_end(c->png, NULL);
}

static enum eco_code encode(const struct eco_pixels *pixels, int filters, uint8_t **bytes, size_t *size_bytes,
	struct eco_error *error)
{
	struct coding c = { .pixels = pixels, .filters = filters };
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
	if (!c.info || !attempt(&c, write_pixels)) {
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

enum eco_code eco_png_write(const struct eco_pixels *pixels, const char *path, struct eco_error *error)
{
	uint8_t *bytes;
	size_t size;
	/* several times faster than eco_png_encode, and larger */
	ECO_PASS(encode(pixels, PNG_FILTER_NONE, &bytes, &size, error));
	enum eco_code code = eco_file_write(path, bytes, size, error);
	free(bytes);
	return code;
}

/* ---- JPEG ---- */

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

static bool has_colours(const struct jpeg_decompress_struct *jpeg)
{
	return jpeg->jpeg_color_space == JCS_GRAYSCALE || jpeg->jpeg_color_space == JCS_YCbCr
		|| jpeg->jpeg_color_space == JCS_RGB;
}

static void read_jpeg(struct reading *r, const uint8_t *bytes, size_t size_bytes)
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
static bool try_jpeg(struct reading *r, const uint8_t *bytes, size_t size_bytes)
{
	if (setjmp(r->back) != 0)
		return false;
	read_jpeg(r, bytes, size_bytes);
	return true;
}

bool eco_jpeg_decode(struct eco_image *image, const uint8_t *bytes, size_t size_bytes, bool *cut_off)
{
	struct reading r = { .rgba = NULL };
	r.jpeg.err = jpeg_std_error(&r.errors);
	r.errors.error_exit = give_up;
	r.errors.emit_message = on_message;
	bool read = try_jpeg(&r, bytes, size_bytes);
	*cut_off = !read && r.ended;
	*image = read ? (struct eco_image){ r.jpeg.output_width, r.jpeg.output_height, r.rgba }
		: (struct eco_image){ .rgba = NULL };
	if (!read)
		free(r.rgba);
	jpeg_destroy_decompress(&r.jpeg);
	return read;
}

/* ---- Others, by OpenImageIO ---- */

static enum eco_code decode(struct eco_image *image, const char *name, const void *bytes, size_t size,
	struct eco_error *error)
{
	const struct eco_image_module *module = eco_module(ECO_MODULE_IMAGE, error);
	char text[300];
	if (!module)
		return ECO_NOT_FOUND;
	if (module->decode(name, bytes, size, ECO_PIXELS_MAX, &image->width, &image->height, &image->rgba,
			text, sizeof text) == 0)
		return ECO_OK;
	*image = (struct eco_image){ .rgba = NULL };
	return eco_fail(error, ECO_BAD_INPUT, "%s: %s", name, text);
}

/* ---- Formats by their first bytes ---- */

/* `name` has an extension that suits the content, so that OpenImageIO tries the right reader first. */
struct format {
	enum { UNKNOWN, PNG, JPEG, KTX, OTHER } kind;
	const char *magic, *name;
	size_t at, count;
};

static const struct format *format_of(const uint8_t *bytes, size_t size)
{
	/* the last has nothing to compare: the content does not tell */
	static const struct format formats[] = {
		{ PNG, "\x89PNG", NULL, 0, 4 }, { JPEG, "\xff\xd8\xff", "memory.jpg", 0, 3 },
		{ KTX, "\xabKTX", NULL, 0, 4 }, { OTHER, "WEBP", "memory.webp", 8, 4 },
		{ OTHER, "GIF8", "memory.gif", 0, 4 }, { OTHER, "BM", "memory.bmp", 0, 2 }, { UNKNOWN, "", NULL, 0, 0 },
	};
	const struct format *f = formats;
	while (f->count && (size < f->at + f->count || memcmp(bytes + f->at, f->magic, f->count) != 0))
		f++;
	return f;
}

/* ---- Reading ---- */

enum eco_code eco_image_read_memory(struct eco_image *image, const void *bytes, size_t size_bytes,
	const char *name, struct eco_error *error)
{
	struct eco_error inner = { .code = ECO_OK };
	const struct format *format = format_of(bytes, size_bytes);
	bool cut_off = false;
	*image = (struct eco_image){ .rgba = NULL };
	if (size_bytes == 0)
		return eco_fail(error, ECO_BAD_INPUT, "%s: an empty picture", name);
	if (size_bytes > ECO_IMAGE_FILE_MAX)
		return eco_fail(error, ECO_TOO_LARGE, "%s: %zu bytes, at most %u are possible", name,
			size_bytes, ECO_IMAGE_FILE_MAX);
	if (format->kind == PNG)
		return png_decode(image, bytes, size_bytes, name, error);
	if (format->kind == JPEG && eco_jpeg_decode(image, bytes, size_bytes, &cut_off))
		return ECO_OK;
	if (cut_off)
		return eco_fail(error, ECO_BAD_INPUT, "%s: a JPEG that is cut off: it ends too early", name);
	if (format->kind == KTX)
		return eco_fail(error, ECO_UNSUPPORTED, "%s: KTX is not read: save it as PNG, JPEG or WebP", name);
	enum eco_code code = decode(image, format->name ? format->name : name, bytes, size_bytes, &inner);
	return code == ECO_OK ? code : eco_fail(error, code, "%.120s: %.380s", name, inner.text);
}

enum eco_code eco_image_read(struct eco_image *image, const char *path, struct eco_error *error)
{
	uint8_t *bytes;
	size_t size;
	*image = (struct eco_image){ .rgba = NULL };
	enum eco_code code = eco_file_read(path, ECO_IMAGE_FILE_MAX, &bytes, &size, error);
	if (code)
		return code;
	if (format_of(bytes, size)->kind != UNKNOWN || size == 0)
		code = eco_image_read_memory(image, bytes, size, path, error);
	else
		/* some rarer formats are read from files only; OpenImageIO 2.4 refuses DDS elsewhere */
		code = decode(image, path, NULL, 0, error);
	free(bytes);
	return code;
}
