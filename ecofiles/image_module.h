/* The seam between image.c and ecoimage.so: plain C, one table of three functions. */
#ifndef ECO_IMAGE_MODULE_H
#define ECO_IMAGE_MODULE_H

#include <stddef.h>
#include <stdint.h>

#define ECO_IMAGE_MODULE_VERSION 2
#define ECO_IMAGE_MODULE_SYMBOL "eco_image_module"

#ifdef __cplusplus
extern "C" {
#endif

/* All return 0 or write a sentence to `text`. Results are malloc'ed. Thread-safe. */
struct eco_image_module {
	uint32_t version;
	/* `name`: a file to open when bytes is NULL, else only its extension counts. More than pixels_max pixels is an error. */
	int (*decode)(const char *name, const void *bytes, size_t size, uint64_t pixels_max, uint32_t *width, uint32_t *height,
		uint8_t **rgba, char *text, size_t text_size);
	int (*encode_png)(const uint8_t *pixels, uint32_t width, uint32_t height, uint32_t channels, uint8_t **bytes, size_t *size,
		char *text, size_t text_size);
	/* Pixels that a person would see to differ: as eco_pixels_compare. */
	int (*compare)(const uint8_t *a, const uint8_t *b, uint32_t width, uint32_t height, uint32_t channels, uint64_t *differing, char *text,
		size_t text_size);
};

#ifdef __cplusplus
}
#endif

#endif
