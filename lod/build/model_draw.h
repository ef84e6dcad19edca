/* A model as it comes, drawn as a whole: for pictures that something is fitted to.
 *
 *   rgb = lod_model_colors(model, &arena);                       once
 *   masks = lod_model_masks(model, &arena);                      once
 *   lod_model_draw(model, masks, &raster);                       each picture; rgb[raster.item[pixel]] */
#pragma once

#include "ecofiles/format/model.h"
#include "lod/arena.h"
#include "lod/raster/texel.h"
#include "lod/raster/raster.h"

/* The box around the usable triangles; false, and nothing is set, if there are none. */
bool lod_model_bounds(const struct eco_model *model, float low[3], float high[3]);
/* The radius of the sphere around the middle of that box; 0 for a model that is a point or nothing. */
double lod_model_sphere(const struct eco_model *model, double center[3]);

/* The colour of each triangle, from materials and textures. */
const uint8_t (*lod_model_colors(const struct eco_model *model, struct lod_arena *arena))[3];

/* Draws all usable triangles, with owner 1; items are triangles of the model. masks: lod_model_masks, or
 * NULL. */
void lod_model_draw(const struct eco_model *model, const struct lod_mask *masks, struct lod_raster *raster);

/* The masks of cut-outs, by image; of others they have no words. */
const struct lod_mask *lod_model_masks(const struct eco_model *model, struct lod_arena *arena);
/* The mask of an image of the model; NULL: it has none. `masks` may be NULL. */
static inline const struct lod_mask *lod_model_mask(const struct eco_model *model,
	const struct lod_mask *masks, const struct eco_image *image)
{
	const struct lod_mask *mask = masks && image ? &masks[image - model->images] : NULL;
	return mask && mask->words ? mask : NULL;
}
