/* JPEG through libjpeg: the format of most photographed textures. OpenImageIO reads it with the same library
 * and gives the same texels, but takes a quarter of a second to load, in each child process that reads a
 * model. */
#ifndef ECO_IMAGE_JPEG_H
#define ECO_IMAGE_JPEG_H

#include "ecofiles/format/image.h"

bool eco_jpeg_is(const uint8_t *bytes, size_t size_bytes);

/* A gray or a colour JPEG as RGBA. False, and an empty image: the bytes end before the picture (*cut_off), or
 * another reader must try, or say what is wrong, as the file has inks (CMYK) or samples of 12 bits, is damaged
 * anywhere, or has more than ECO_PIXELS_MAX pixels. What lacks only the mark of its end is whole, and so is a
 * progressive one without its last scans. */
bool eco_jpeg_decode(struct eco_image *image, const uint8_t *bytes, size_t size_bytes, bool *cut_off);

#endif
