/* A model as it comes, drawn as a whole: for pictures that something is fitted to.
 *
 *   rgb = lod_model_colors(model, &arena);                       once
 *   lod_model_draw(model, &raster);                              each picture; rgb[raster.item[pixel]] */
#ifndef LOD_MODEL_DRAW_H
#define LOD_MODEL_DRAW_H

#include "ecofiles/format/model.h"
#include "lod/arena.h"
#include "lod/raster/raster.h"

/* The colour of each triangle, from materials and textures. */
const uint8_t (*lod_model_colors(const struct eco_model *model, struct lod_arena *arena))[3];

/* Draws all usable triangles, with owner 1; items are triangles of the model. */
void lod_model_draw(const struct eco_model *model, struct lod_raster *raster);

#endif
