/* The texture under a triangle of a leaf: its mean colour and, for cut-outs, the share that is opaque. Texels
 * are read as in the rasteriser: nearest, wrapping, opaque from alpha 0.5 on. Transparent texels never
 * contribute colour; means are means of light (light.h).
 *
 *   lod_texels_open(&texels, image, cutout, &arena);             once an image
 *   share = lod_texels_mean(&texels, tint, uv, rgb);             for each triangle */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "ecofiles/format/model.h"
#include "lod/arena.h"

/* RGBA at uv (any finite numbers; (0,0) is the top left). */
const uint8_t *lod_texel_at(const struct eco_image *image, double u, double v);

/* The material's colour times the texel, as light. */
void lod_texel_tint(const uint8_t *texel, const uint8_t tint[3], uint8_t rgb[3]);

/* Sums along the rows of one image. Images of more than 2^21 texels are summed in blocks of 2 x 2, 4 x 4, ...
 * texels. */
struct lod_texels {
	const struct eco_image *image;
	bool cutout;
	uint32_t shift;              /* a block is 2^shift texels wide and high */
	uint32_t width, height;      /* in blocks */
	struct lod_texel_sum *before; /* height * (width + 1): sums of the row's blocks before this one */
	uint8_t rgb[3];              /* mean of the opaque texels */
	struct lod_texel_seen *seen; /* cached answers: leaves share their texture coordinates */
};

/* `image` must outlive it; memory comes from `arena`. */
void lod_texels_open(struct lod_texels *texels, const struct eco_image *image, bool cutout,
	struct lod_arena *arena);

/* The mean colour of the opaque texels under the triangle (of all texels if not a cut-out), times the
 * material's colour. Returns the share that is opaque; if it is 0, rgb is the mean of the image's opaque
 * texels. The texture is a step function: it is integrated exactly along each of 64 to 1024 evenly spread
 * rows of the triangle (one a texel within these limits). So the result does not depend on the triangle's
 * size nor on how often the texture repeats on it. */
double lod_texels_mean(struct lod_texels *texels, const uint8_t tint[3], const int32_t uv[6], uint8_t rgb[3]);

/* ---- Masks ---- */

/* The opaque texels of a cut-out, one bit each: does a triangle show anything at all?
 *
 *   lod_mask_open(&mask, image, &arena);                         once an image
 *   if (lod_mask_hidden(&mask, uv, &work)) ...                   for each triangle */
struct lod_mask {
	uint32_t width, height, words;       /* words of 64 texels a row */
	const uint64_t *opaque;
};

/* Memory comes from `arena`; the image is not needed afterwards. */
void lod_mask_open(struct lod_mask *mask, const struct eco_image *image, struct lod_arena *arena);

static inline bool lod_mask_opaque(const struct lod_mask *mask, uint32_t column, uint32_t row)
{
	return mask->opaque[(size_t)row * mask->words + column / 64] >> column % 64 & 1;
}

/* True only if no sample of the triangle reads an opaque texel (nearest, wrapping, as all renderers read
 * alpha). Texels that it touches only by rounding count as read. uv as in struct lod_mesh. `*work`, zero at
 * first, sums the work for all triangles of a model; beyond LOD_MASK_WORK every triangle counts as visible,
 * so that no file takes long. */
#define LOD_MASK_WORK (UINT64_C(1) << 28)
bool lod_mask_hidden(const struct lod_mask *mask, const int32_t uv[6], uint64_t *work);
