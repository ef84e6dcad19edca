/* From an image of a model to the chunks of a texture (ecofiles/format/texture.h).
 *
 *   lod_texture_make(&texture, &model, image, &error);
 *   ... texture.colors[0 .. count) and, where texels are clear, texture.outlines: levels, as strips ...
 *   lod_texture_free(&texture);
 *
 * Levels halve until TEXTURE_SMALLEST. Each is as opaque as the finest, everywhere, by error diffusion (Floyd
 * and Steinberg 1976). Colours are means of light over opaque texels; clear texels take those around them
 * (pull-push: Gortler et al. 1996, 3.4.1). The finest level is the coarsest whose texels are no larger than a
 * pixel of a picture 1080 pixels high, of 45 degrees, taken 1 m from the plant. Outlines are coded without
 * loss, colours as lossy WebP. */
#pragma once

#include "ecofiles/base/bytes.h"
#include "ecofiles/format/ground_tile.h"
#include "ecofiles/format/model.h"
#include "ecofiles/format/texture.h"

struct lod_texture {
	struct eco_writer *colors, *outlines;        /* eco_texture_write_strips; NULL: it is opaque */
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
void lod_texture_shrink(struct eco_image *image, uint32_t side_most);

/* The levels before they are encoded, smallest first. */
struct lod_texture_level { struct eco_texture_part outline, colors; };
struct lod_texture_levels {
	struct lod_texture_level levels[ECO_TEXTURE_LEVELS_MAX];
	uint32_t count;
	float texel_area;            /* as of struct lod_texture; 0: no triangle shows the image */
};

void lod_texture_levels_make(struct lod_texture_levels *levels, const struct eco_model *model, uint32_t image);
void lod_texture_levels_free(struct lod_texture_levels *levels);

/* From a square of ground to the levels of its tile (ecofiles/format/ground_tile.h). Means are means of light
 * over opaque texels; clear ones take the tile's mean, which costs few bytes. */

/* A tile from its four children, which are quarters as eco_ground_image_quarter says. All have
 * ECO_GROUND_IMAGE_SIDE texels a side, rows from the north. */
void lod_image_join(uint8_t *rgba, const uint8_t *const quarters[4]);

/* levels: ECO_GROUND_IMAGE_LEVELS writers that are zero; the caller frees them in any case. */
enum eco_code lod_image_levels(struct eco_writer *levels, const uint8_t *rgba, struct eco_error *error);
