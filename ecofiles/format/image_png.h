/* PNG through libpng: the picture format of most models and of all output. It takes two small libraries,
 * where the module for all other formats takes two hundred and sixty. */
#ifndef ECO_IMAGE_PNG_H
#define ECO_IMAGE_PNG_H

#include "ecofiles/format/image.h"

bool eco_png_is(const uint8_t *bytes, size_t size_bytes);

/* Any PNG as 8-bit RGBA with straight alpha: palettes and gray are converted, 16 bits are rounded,
 * interlacing is allowed; gamma and profiles are ignored. A file that is cut off or damaged anywhere is
 * refused. As eco_image_read_memory. */
enum eco_code eco_png_decode(struct eco_image *image, const uint8_t *bytes, size_t size_bytes,
	const char *name, struct eco_error *error);

/* As eco_png_encode, several times faster and larger: for files. */
enum eco_code eco_png_encode_fast(const struct eco_pixels *pixels, uint8_t **bytes, size_t *size_bytes,
	struct eco_error *error);

#endif
