/* What lies under a triangle of a textured leaf: colours and, for cut-outs, whether there is anything at all. Texels are looked up as
 * the rasteriser does: nearest, wrapping, opaque from alpha 0.5 on. Transparent texels never lend their colour to anything; means are
 * of light (light.h).
 *
 *   lod_texels_open(&texels, image, cutout, &arena);             once an image
 *   share = lod_texels_mean(&texels, tint, uv, rgb);             for each triangle
 */
#ifndef LOD_TEXEL_H
#define LOD_TEXEL_H

#include <stdbool.h>
#include <stdint.h>

#include "ecofiles/format/model.h"
#include "lod/arena.h"

/* RGBA at uv (any finite numbers; (0,0) is the top left). */
const uint8_t *lod_texel_at(const struct eco_image *image, double u, double v);

/* The material's colour times the texel, as light. */
void lod_texel_tint(const uint8_t *texel, const uint8_t tint[3], uint8_t rgb[3]);

/* Sums over the rows of one image. Images of more than 2^21 texels are summed in blocks of 2 x 2, 4 x 4, ... texels. */
struct lod_texels {
	const struct eco_image *image;
	bool cutout;
	uint32_t shift;              /* a block is 2^shift texels wide and high */
	uint32_t width, height;      /* in blocks */
	struct lod_texel_sum *before;        /* height * (width + 1): of a row's blocks before this one */
	uint8_t rgb[3];              /* mean of all that is opaque */
	struct lod_texel_seen *seen; /* answers so far: leaves share their texture coordinates */
};

/* `image` must outlive it; memory comes from `arena`. */
void lod_texels_open(struct lod_texels *texels, const struct eco_image *image, bool cutout, struct lod_arena *arena);

/* Mean colour of the opaque texels under the triangle (all texels where not a cut-out), times the material's colour. Returns the
 * share that is opaque; where it is 0, rgb is the mean of all that is opaque in the image. The texture is a function of steps: it
 * is integrated exactly along each of 64 to 1024 evenly spread rows of the triangle, one a texel if it is between. So nothing
 * depends on how large a triangle is or how often the texture repeats on it. */
double lod_texels_mean(struct lod_texels *texels, const uint8_t tint[3], const int32_t uv[6], uint8_t rgb[3]);

#endif
