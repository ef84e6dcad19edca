/* PNG through libpng, the one format of pictures that every textured scene has: it is in packs, on the wire and what is written. Two small
 * libraries instead of the two hundred and sixty of the module that reads all others. */
#ifndef ECO_IMAGE_PNG_H
#define ECO_IMAGE_PNG_H

#include "ecofiles/format/image.h"

bool eco_png_is(const uint8_t *bytes, size_t size_bytes);

/* Any PNG as 8-bit RGBA with straight alpha: palettes and gray are spread, 16 bits are rounded, interlaced or not; what the file says of
 * gamma and profiles is left alone. What is cut off or damaged anywhere is refused. As eco_image_read_memory. */
enum eco_code eco_png_decode(struct eco_image *image, const uint8_t *bytes, size_t size_bytes, const char *name, struct eco_error *error);

/* As eco_png_encode, several times faster and not as small: for files. */
enum eco_code eco_png_encode_fast(const struct eco_pixels *pixels, uint8_t **bytes, size_t *size_bytes, struct eco_error *error);

#endif
