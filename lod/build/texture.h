/* From an image of a model to the chunks of a texture (ecofiles/format/texture.h).
 *
 *   lod_texture_make(&texture, &model, image, &error);
 *   ... texture.colors[0 .. count) and, where texels are clear, texture.outlines: payloads of levels ...
 *   lod_texture_free(&texture);
 *
 * texture_levels.h says which levels there are and what their texels are. Outlines are coded without loss,
 * colours as lossy WebP. */
#ifndef LOD_TEXTURE_H
#define LOD_TEXTURE_H

#include "ecofiles/base/bytes.h"
#include "ecofiles/format/model.h"

struct lod_texture {
	struct eco_writer *colors, *outlines;        /* bytes, size; NULL: it is opaque */
	uint32_t count;
	float texel_area;            /* m^2 of the plant that a texel of the last level covers, in the mean */
	uint8_t loss;                /* ECO_LOSS_ONE times the share of opaque texels that the level before the
	                              * last shows clear, and as many the other way round; 1 at least where
	                              * there are outlines of two levels, else 0 */
};

/* A texture that no triangle shows keeps all its texels; its texel_area is 0. */
enum eco_code lod_texture_make(struct lod_texture *texture, const struct eco_model *model, uint32_t image,
	struct eco_error *error);
void lod_texture_free(struct lod_texture *texture);

/* Halves an image until no side has more than `side_most` texels, at least 1: with the colours and the share
 * of opaque texels that such a level of its texture has. */
enum eco_code lod_texture_shrink(struct eco_image *image, uint32_t side_most, struct eco_error *error);

#endif
