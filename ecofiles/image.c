/* Loading the module once, checking sizes on this side of it, and writing files so that a reader never sees half of one. */
#include "ecofiles/image.h"

#include <assert.h>
#include <dlfcn.h>
#include <errno.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "ecofiles/image_module.h"

#define MODULE_FILE "ecoimage.so"

static pthread_once_t load_once = PTHREAD_ONCE_INIT;
static const struct eco_image_module *module;
static char load_problem[400];

static bool try_load(const char *path)
{
	void *handle = dlopen(path, RTLD_NOW | RTLD_LOCAL);
	const struct eco_image_module *found;

	if (handle == NULL) {
		snprintf(load_problem, sizeof load_problem, "%.380s", dlerror());
		return false;
	}
	found = dlsym(handle, ECO_IMAGE_MODULE_SYMBOL);
	if (found == NULL || found->version != ECO_IMAGE_MODULE_VERSION) {
		snprintf(load_problem, sizeof load_problem, "%.300s: not the image module of this version", path);
		dlclose(handle);
		return false;
	}
	module = found;              /* never unloaded: OpenImageIO keeps state of its own until exit */
	return true;
}

/* The folder of the executable, then its parent (test programs live one folder below). */
static void load_module(void)
{
	const char *given = getenv("ECO_IMAGE_MODULE");
	char folder[4096], path[4096 + sizeof MODULE_FILE + 1];
	ssize_t length;

	if (given != NULL && *given != 0) {
		try_load(given);
		return;
	}
	length = readlink("/proc/self/exe", folder, sizeof folder - 1);
	if (length <= 0) {
		snprintf(load_problem, sizeof load_problem, "/proc/self/exe cannot be read; set ECO_IMAGE_MODULE to the path of " MODULE_FILE);
		return;
	}
	folder[length] = 0;
	for (int up = 0; up < 2; up++) {
		char *slash = strrchr(folder, '/');

		if (slash == NULL)
			return;
		*slash = 0;
		snprintf(path, sizeof path, "%s/" MODULE_FILE, folder);
		if (access(path, F_OK) == 0) {
			try_load(path);
			return;
		}
	}
	snprintf(load_problem, sizeof load_problem, "no " MODULE_FILE " beside the program nor in %.200s; build it with `make`, or set "
		"ECO_IMAGE_MODULE to its path", folder[0] != 0 ? folder : "/");
}

static enum eco_code need_module(struct eco_error *error)
{
	pthread_once(&load_once, load_module);
	if (module == NULL)
		return eco_fail(error, ECO_NOT_FOUND, "the image module cannot be loaded: %s", load_problem);
	return ECO_OK;
}

static enum eco_code decode(struct eco_image *image, const char *name, const void *bytes, size_t size, struct eco_error *error)
{
	char text[300];

	if (need_module(error) != ECO_OK)
		return ECO_NOT_FOUND;
	if (module->decode(name, bytes, size, ECO_PIXELS_MAX, &image->width, &image->height, &image->rgba, text, sizeof text) == 0)
		return ECO_OK;
	*image = (struct eco_image){ .rgba = NULL };
	return eco_fail(error, ECO_BAD_INPUT, "%s: %s", name, text);
}

/* ---- Formats by their first bytes ---- */

/* A name whose extension suits the content, so that the right reader is tried first; NULL if the content does not tell. */
static const char *name_for(const uint8_t *bytes, size_t size)
{
	static const struct { const char *magic, *name; size_t at, count; } kinds[] = {
		{ "\x89PNG", "memory.png", 0, 4 }, { "\xff\xd8\xff", "memory.jpg", 0, 3 }, { "WEBP", "memory.webp", 8, 4 },
		{ "GIF8", "memory.gif", 0, 4 }, { "BM", "memory.bmp", 0, 2 }, { "DDS ", "memory.dds", 0, 4 },
	};

	for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++)
		if (size >= kinds[i].at + kinds[i].count && memcmp(bytes + kinds[i].at, kinds[i].magic, kinds[i].count) == 0)
			return kinds[i].name;
	return NULL;
}

static uint32_t big_u32(const uint8_t *p)
{
	return (uint32_t)p[0] << 24 | (uint32_t)p[1] << 16 | (uint32_t)p[2] << 8 | p[3];
}

static uint32_t crc32_of(const uint8_t *bytes, size_t size)
{
	static const uint32_t nibble[16] = { 0x00000000, 0x1db71064, 0x3b6e20c8, 0x26d930ac, 0x76dc4190, 0x6b6b51f4, 0x4db26158, 0x5005713c,
		0xedb88320, 0xf00f9344, 0xd6d6a3e8, 0xcb61b38c, 0x9b64c2b0, 0x86d3d2d4, 0xa00ae278, 0xbdbdf21c };
	uint32_t crc = UINT32_MAX;

	for (size_t i = 0; i < size; i++) {
		crc ^= bytes[i];
		crc = nibble[crc & 15] ^ crc >> 4;
		crc = nibble[crc & 15] ^ crc >> 4;
	}
	return ~crc;
}

/* Walks a PNG's chunks up to IEND: libpng leaves a damaged file by longjmp through OpenImageIO's C++ frames, which leaks, and writes
 * to stderr. Better that it never sees one. */
static bool png_is_whole(const uint8_t *bytes, size_t size)
{
	size_t at = 8;

	while (size - at >= 12) {
		uint32_t length = big_u32(bytes + at);

		if (length > size - at - 12 || crc32_of(bytes + at + 4, (size_t)length + 4) != big_u32(bytes + at + 8 + length))
			return false;
		if (memcmp(bytes + at + 4, "IEND", 4) == 0)
			return true;
		at += (size_t)length + 12;
	}
	return false;
}

/* ---- Reading ---- */

enum eco_code eco_image_read_memory(struct eco_image *image, const void *bytes, size_t size_bytes, const char *name,
	struct eco_error *error)
{
	struct eco_error inner = { .code = ECO_OK };
	const char *kind = name_for(bytes, size_bytes);
	enum eco_code code;

	*image = (struct eco_image){ .rgba = NULL };
	if (size_bytes == 0)
		return eco_fail(error, ECO_BAD_INPUT, "%s: an empty picture", name);
	if (size_bytes > ECO_IMAGE_FILE_MAX)
		return eco_fail(error, ECO_TOO_LARGE, "%s: %zu bytes, at most %u are possible", name, size_bytes, ECO_IMAGE_FILE_MAX);
	if (kind != NULL && strcmp(kind, "memory.png") == 0 && (size_bytes < 8 || !png_is_whole(bytes, size_bytes)))
		return eco_fail(error, ECO_DAMAGED, "%s: a PNG that is cut off or damaged", name);
	code = decode(image, kind != NULL ? kind : name, bytes, size_bytes, &inner);
	return code == ECO_OK ? code : eco_fail(error, code, "%.120s: %.380s", name, inner.text);
}

static enum eco_code read_open(struct eco_image *image, FILE *file, const char *path, struct eco_error *error)
{
	struct stat status;
	uint8_t *bytes;
	size_t size;
	enum eco_code code;

	if (fstat(fileno(file), &status) != 0 || !S_ISREG(status.st_mode))
		return eco_fail(error, ECO_IO, "%s: not a regular file", path);
	if (status.st_size > (off_t)ECO_IMAGE_FILE_MAX)
		return eco_fail(error, ECO_TOO_LARGE, "%s: %lld bytes, at most %u are possible", path, (long long)status.st_size,
			ECO_IMAGE_FILE_MAX);
	bytes = malloc((size_t)status.st_size + 1);
	if (bytes == NULL)
		return eco_fail(error, ECO_NO_MEMORY, "%s: out of memory", path);
	size = fread(bytes, 1, (size_t)status.st_size, file);
	if (ferror(file))
		code = eco_fail(error, ECO_IO, "%s: %s", path, strerror(errno));
	else if (name_for(bytes, size) != NULL || size == 0)
		code = eco_image_read_memory(image, bytes, size, path, error);
	else
		code = decode(image, path, NULL, 0, error);      /* some rarer formats are read from files only */
	free(bytes);
	return code;
}

enum eco_code eco_image_read(struct eco_image *image, const char *path, struct eco_error *error)
{
	FILE *file = fopen(path, "rb");
	enum eco_code code;

	*image = (struct eco_image){ .rgba = NULL };
	if (file == NULL)
		return eco_fail(error, errno == ENOENT ? ECO_NOT_FOUND : ECO_IO, "%s: %s", path, strerror(errno));
	code = read_open(image, file, path, error);
	fclose(file);
	return code;
}

void eco_image_free(struct eco_image *image)
{
	free(image->rgba);
	*image = (struct eco_image){ .rgba = NULL };
}

enum eco_code eco_png_encode(const struct eco_pixels *pixels, uint8_t **bytes, size_t *size_bytes, struct eco_error *error)
{
	char text[300];

	assert(pixels->channels == 1 || pixels->channels == 3 || pixels->channels == 4);
	*bytes = NULL;
	*size_bytes = 0;
	if (pixels->width == 0 || pixels->height == 0 || (uint64_t)pixels->width * pixels->height > ECO_PIXELS_MAX)
		return eco_fail(error, ECO_TOO_LARGE, "a picture of %u x %u pixels: 1 to %u are possible", pixels->width, pixels->height,
			ECO_PIXELS_MAX);
	if (need_module(error) != ECO_OK)
		return ECO_NOT_FOUND;
	if (module->encode_png(pixels->bytes, pixels->width, pixels->height, pixels->channels, bytes, size_bytes, text, sizeof text) != 0)
		return eco_fail(error, ECO_IO, "PNG: %s", text);
	return ECO_OK;
}

enum eco_code eco_pixels_compare(const struct eco_pixels *a, const struct eco_pixels *b, uint64_t *differing, struct eco_error *error)
{
	char text[300];

	assert(a->width == b->width && a->height == b->height && a->channels == 3 && b->channels == 3);
	assert(a->width > 0 && a->height > 0 && (uint64_t)a->width * a->height <= ECO_PIXELS_MAX);
	*differing = 0;
	if (need_module(error) != ECO_OK)
		return ECO_NOT_FOUND;
	if (module->compare(a->bytes, b->bytes, a->width, a->height, a->channels, differing, text, sizeof text) != 0)
		return eco_fail(error, ECO_NO_MEMORY, "comparing pictures: %s", text);
	return ECO_OK;
}

static bool write_all(FILE *file, const uint8_t *bytes, size_t size)
{
	bool good = fwrite(bytes, 1, size, file) == size;

	return fclose(file) == 0 && good;
}

enum eco_code eco_png_write(const struct eco_pixels *pixels, const char *path, struct eco_error *error)
{
	char beside[4096];
	uint8_t *bytes;
	size_t size;
	FILE *file;
	enum eco_code code = eco_png_encode(pixels, &bytes, &size, error);

	if (code != ECO_OK)
		return code;
	if (snprintf(beside, sizeof beside, "%s.tmp-%ld", path, (long)getpid()) >= (int)sizeof beside) {
		free(bytes);
		return eco_fail(error, ECO_BAD_INPUT, "%.200s...: the path is too long", path);
	}
	file = fopen(beside, "wb");
	if (file == NULL || !write_all(file, bytes, size) || rename(beside, path) != 0) {
		code = eco_fail(error, ECO_IO, "%s: %s", path, strerror(errno));
		if (file != NULL)
			unlink(beside);
	}
	free(bytes);
	return code;
}
