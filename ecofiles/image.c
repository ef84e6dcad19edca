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

enum eco_code eco_image_read(struct eco_image *image, const char *path, struct eco_error *error)
{
	struct stat status;

	*image = (struct eco_image){ .rgba = NULL };
	if (stat(path, &status) != 0)
		return eco_fail(error, errno == ENOENT ? ECO_NOT_FOUND : ECO_IO, "%s: %s", path, strerror(errno));
	if (!S_ISREG(status.st_mode))
		return eco_fail(error, ECO_IO, "%s: not a regular file", path);
	if (status.st_size > (off_t)ECO_IMAGE_FILE_MAX)
		return eco_fail(error, ECO_TOO_LARGE, "%s: %lld bytes, at most %u are possible", path, (long long)status.st_size,
			ECO_IMAGE_FILE_MAX);
	return decode(image, path, NULL, 0, error);
}

/* A name whose extension suits the content, so that the right reader is tried first. */
static const char *name_for(const unsigned char *bytes, size_t size, const char *name)
{
	static const struct { const char *magic, *name; size_t at, count; } kinds[] = {
		{ "\x89PNG", "memory.png", 0, 4 }, { "\xff\xd8\xff", "memory.jpg", 0, 3 }, { "WEBP", "memory.webp", 8, 4 },
		{ "GIF8", "memory.gif", 0, 4 }, { "BM", "memory.bmp", 0, 2 }, { "DDS ", "memory.dds", 0, 4 },
	};

	for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++)
		if (size >= kinds[i].at + kinds[i].count && memcmp(bytes + kinds[i].at, kinds[i].magic, kinds[i].count) == 0)
			return kinds[i].name;
	return name;
}

enum eco_code eco_image_read_memory(struct eco_image *image, const void *bytes, size_t size_bytes, const char *name,
	struct eco_error *error)
{
	struct eco_error inner = { .code = ECO_OK };
	enum eco_code code;

	*image = (struct eco_image){ .rgba = NULL };
	if (size_bytes == 0)
		return eco_fail(error, ECO_BAD_INPUT, "%s: an empty picture", name);
	if (size_bytes > ECO_IMAGE_FILE_MAX)
		return eco_fail(error, ECO_TOO_LARGE, "%s: %zu bytes, at most %u are possible", name, size_bytes, ECO_IMAGE_FILE_MAX);
	code = decode(image, name_for(bytes, size_bytes, name), bytes, size_bytes, &inner);
	return code == ECO_OK ? code : eco_fail(error, code, "%.120s: %.380s", name, inner.text);
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
