/* Colour and contrast of a picture in blocks of 16 x 16 pixels: they see wrong colours and lost or invented
 * contrast, and do not mind where in a block a leaf is. Reported, never stored: libm's cbrt decides last bits. */
#pragma once

#include <stdint.h>

#define LOD_BLOCK_SIDE 16u

/* Lab: CIELAB of the mean light; deviation: of L* within the block; pixels: fewer at right and lower edges. */
struct lod_block { double lab[3], deviation; uint32_t pixels; };
static inline uint32_t lod_block_count(uint32_t width, uint32_t height)
{
	return ((width + LOD_BLOCK_SIDE - 1) / LOD_BLOCK_SIDE) * ((height + LOD_BLOCK_SIDE - 1) / LOD_BLOCK_SIDE);
}
/* Fills lod_block_count blocks, row by row. rgb: sRGB, 3 bytes a pixel, rows without gaps. */
void lod_blocks_make(struct lod_block *blocks, uint32_t width, uint32_t height, const uint8_t *rgb);

/* Means over blocks, by their pixels: distance of colours, and deviation of `test` less that of `reference`. */
struct lod_block_error { double color, contrast, contrast_abs; };
void lod_blocks_compare(struct lod_block_error *error, const struct lod_block *test,
	const struct lod_block *reference, uint32_t count);
/* The largest distance of colours of whole blocks, but for one in a thousand: how strongly a picture pops. */
double lod_blocks_pop(const struct lod_block *before, const struct lod_block *after, uint32_t count);
