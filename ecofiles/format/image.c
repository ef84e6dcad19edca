/* Chooses a picture's reader by its first bytes. */
#include "ecofiles/format/image.h"

#include <assert.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "ecofiles/base/files.h"
#include "ecofiles/base/module.h"

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

/* A name whose extension suits the content, so that the right reader is tried first; NULL: the content
 * does not tell. */
static const char *name_for(const uint8_t *bytes, size_t size)
{
	static const struct { const char *magic, *name; size_t at, count; } kinds[] = {
		{ "\xff\xd8\xff", "memory.jpg", 0, 3 }, { "WEBP", "memory.webp", 8, 4 },
		{ "GIF8", "memory.gif", 0, 4 }, { "BM", "memory.bmp", 0, 2 },
	};

	for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++)
		if (size >= kinds[i].at + kinds[i].count
				&& memcmp(bytes + kinds[i].at, kinds[i].magic, kinds[i].count) == 0)
			return kinds[i].name;
	return NULL;
}

/* ---- Reading ---- */

static bool is_ktx(const uint8_t *bytes, size_t size)
{
	return size >= 4 && memcmp(bytes, "\xabKTX", 4) == 0;
}

static enum eco_code refuse_ktx(const char *name, struct eco_error *error)
{
	return eco_fail(error, ECO_UNSUPPORTED, "%s: KTX is not read: save it as PNG, JPEG or WebP", name);
}

enum eco_code eco_image_read_memory(struct eco_image *image, const void *bytes, size_t size_bytes,
	const char *name, struct eco_error *error)
{
	struct eco_error inner = { .code = ECO_OK };
	const char *kind = name_for(bytes, size_bytes);
	bool cut_off = false;
	*image = (struct eco_image){ .rgba = NULL };
	if (size_bytes == 0)
		return eco_fail(error, ECO_BAD_INPUT, "%s: an empty picture", name);
	if (size_bytes > ECO_IMAGE_FILE_MAX)
		return eco_fail(error, ECO_TOO_LARGE, "%s: %zu bytes, at most %u are possible", name,
			size_bytes, ECO_IMAGE_FILE_MAX);
	if (eco_png_is(bytes, size_bytes))
		return eco_png_decode(image, bytes, size_bytes, name, error);
	if (eco_jpeg_is(bytes, size_bytes) && eco_jpeg_decode(image, bytes, size_bytes, &cut_off))
		return ECO_OK;
	if (cut_off)
		return eco_fail(error, ECO_BAD_INPUT, "%s: a JPEG that is cut off: it ends too early", name);
	if (is_ktx(bytes, size_bytes))
		return refuse_ktx(name, error);
	enum eco_code code = decode(image, kind ? kind : name, bytes, size_bytes, &inner);
	return code == ECO_OK ? code : eco_fail(error, code, "%.120s: %.380s", name, inner.text);
}

static enum eco_code read_open(struct eco_image *image, FILE *file, const char *path, struct eco_error *error)
{
	struct stat status;
	enum eco_code code;
	if (fstat(fileno(file), &status) != 0 || !S_ISREG(status.st_mode))
		return eco_fail(error, ECO_IO, "%s: not a regular file", path);
	if (status.st_size > (off_t)ECO_IMAGE_FILE_MAX)
		return eco_fail(error, ECO_TOO_LARGE, "%s: %lld bytes, at most %u are possible", path,
			(long long)status.st_size, ECO_IMAGE_FILE_MAX);
	uint8_t *bytes = malloc((size_t)status.st_size + 1);
	if (!bytes)
		return eco_fail(error, ECO_NO_MEMORY, "%s: out of memory", path);
	size_t size = fread(bytes, 1, (size_t)status.st_size, file);
	if (ferror(file))
		code = eco_fail_read(error, path, errno);
	else if (is_ktx(bytes, size))
		code = refuse_ktx(path, error);
	else if (eco_png_is(bytes, size) || name_for(bytes, size) || size == 0)
		code = eco_image_read_memory(image, bytes, size, path, error);
	else
		/* some rarer formats are read from files only; OpenImageIO 2.4 refuses DDS elsewhere */
		code = decode(image, path, NULL, 0, error);
	free(bytes);
	return code;
}

enum eco_code eco_image_read(struct eco_image *image, const char *path, struct eco_error *error)
{
	FILE *file = fopen(path, "rb");
	*image = (struct eco_image){ .rgba = NULL };
	if (!file)
		return eco_fail_read(error, path, errno);
	enum eco_code code = read_open(image, file, path, error);
	fclose(file);
	return code;
}

enum eco_code eco_pixels_compare(const struct eco_pixels *a, const struct eco_pixels *b, uint64_t *differing,
	struct eco_error *error)
{
	char text[300];
	assert(a->width == b->width && a->height == b->height && a->channels == 3 && b->channels == 3);
	assert(a->width > 0 && a->height > 0 && (uint64_t)a->width * a->height <= ECO_PIXELS_MAX);
	*differing = 0;
	const struct eco_image_module *module = eco_module(ECO_MODULE_IMAGE, error);
	if (!module)
		return ECO_NOT_FOUND;
	if (module->compare(a->bytes, b->bytes, a->width, a->height, a->channels, differing, text,
			sizeof text) != 0)
		return eco_fail(error, ECO_NO_MEMORY, "comparing pictures: %s", text);
	return ECO_OK;
}

enum eco_code eco_png_write(const struct eco_pixels *pixels, const char *path, struct eco_error *error)
{
	uint8_t *bytes;
	size_t size;
	enum eco_code code = eco_png_encode_fast(pixels, &bytes, &size, error);
	if (code)
		return code;
	code = eco_file_write(path, bytes, size, error);
	free(bytes);
	return code;
}
