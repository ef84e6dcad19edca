/* The opaque texels of a cut-out, one bit each: does a triangle show anything at all?
 *
 *   lod_mask_open(&mask, image, &arena);                         once an image
 *   if (lod_mask_hidden(&mask, uv, &work)) ...                   for each triangle */
#ifndef LOD_MASK_H
#define LOD_MASK_H

#include <stdbool.h>
#include <stdint.h>

#include "ecofiles/format/model.h"
#include "lod/arena.h"

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

#endif
