/* Pictures in and out: textures of models, PNG frames of the viewer.
 *
 * libpng reads and writes PNG, libjpeg reads JPEG. OpenImageIO reads all other formats and what libjpeg
 * refuses, in a module (module.h) that is loaded for the first such picture: linking it would cost every
 * program 200 ms and 131 MB at start. Without the module these calls fail with ECO_NOT_FOUND. All functions
 * are thread-safe. */
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "ecofiles/format/model.h"
#include "ecofiles/base/status.h"

#define ECO_PIXELS_MAX (1u << 26)        /* of a picture read or written */
#define ECO_IMAGE_FILE_MAX (1u << 28)    /* bytes of a picture file */

/* Reads any picture OpenImageIO knows (PNG, JPEG, WebP, TIFF, TGA, ...) as 8-bit RGBA with straight alpha,
 * 255 where the file has none; gray becomes RGB, 16 bits and floats are rounded. The format is taken from
 * the content, else from the name. *image receives a malloc'ed array; on failure it is empty. Errors name
 * the file. */
enum eco_code eco_image_read(struct eco_image *image, const char *path, struct eco_error *error);
/* The same from memory; `name` is for messages and, by its extension, for formats that cannot be told from
 * their content. */
enum eco_code eco_image_read_memory(struct eco_image *image, const void *bytes, size_t size_bytes,
	const char *name, struct eco_error *error);

/* 8-bit pixels to be written, rows from the top without gaps: channels 1 (gray), 3 (RGB) or 4 (RGBA,
 * straight alpha). */
struct eco_pixels {
	uint32_t width, height, channels;
	const uint8_t *bytes;
};

/* Encodes a PNG file, as small as is possible without taking long; *bytes is malloc'ed. The same pixels
 * give the same bytes. */
enum eco_code eco_png_encode(const struct eco_pixels *pixels, uint8_t **bytes, size_t *size_bytes,
	struct eco_error *error);
/* Writes a PNG beside `path` (path.tmp-PID), then renames it: what is at `path` is always whole. */
enum eco_code eco_png_write(const struct eco_pixels *pixels, const char *path, struct eco_error *error);

/* libjpeg gives the same texels as OpenImageIO, which uses it too but takes a quarter of a second to load, in
 * each child process that reads a model.
 *
 * A gray or a colour JPEG as RGBA. False, and an empty image: the bytes end before the picture (*cut_off), or
 * another reader must try, or say what is wrong, as the file has inks (CMYK) or samples of 12 bits, is
 * damaged anywhere, or has more than ECO_PIXELS_MAX pixels. A file that lacks only the mark of its end is
 * whole, and so is a progressive one without its last scans. */
bool eco_jpeg_decode(struct eco_image *image, const uint8_t *bytes, size_t size_bytes, bool *cut_off);
