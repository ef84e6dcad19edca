/* Two points for every triangle of a leaf (Deussen 2002, 4.1, the stratified case), so that points [2i, 2i + 2) stand for triangle i
 * and one can give way to the other. One point in each half of the triangle, cut at the middle of its longest edge; on cut-outs only
 * where the texture is opaque. */
#ifndef LOD_SAMPLE_H
#define LOD_SAMPLE_H

#include <stdbool.h>
#include <stdint.h>

#include "lod/texel.h"

struct lod_sample_input {
	const int32_t *corner[3];    /* on the grid */
	const int32_t *uv;           /* 6, in 1/ECO_UV_ONE; used with an image only */
	struct lod_texels *texels;   /* of its image; or NULL */
	const uint8_t *tint;         /* 3: the material's colour, times the texel */
	uint64_t seed;               /* of this triangle */
};

/* Grid positions (nearest grid point to a point of the triangle) and sRGB colours of the two points: each the mean of what is opaque in
 * its half, for which it stands. A cut-out without any opaque texel to be found gives its middle, in
 * the image's mean colour. */
void lod_sample_triangle(const struct lod_sample_input *input, int32_t position[2][3], uint8_t rgb[2][3]);

#endif
