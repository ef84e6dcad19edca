/* How fine a plant's grids must be: as coarse as its picture allows. */
#ifndef LOD_GRID_H
#define LOD_GRID_H

#include "lod/plant.h"

#define LOD_GRID_BITS_MIN 12u
#define LOD_GRID_BITS_MAX 18u
#define LOD_GRID_LOSS 0.003          /* 1 - Q, worst of 8 views, 512 pixels high */

/* Worst 1 - Q of the plant's full detail against the source model's own triangles: quantization, welding and whatever else was lost
 * on the way in. 0 for a model that covers nothing. */
enum eco_code lod_grid_loss(const struct lod_plant *plant, const struct eco_model *model, double *loss, struct eco_error *error);

/* Takes a plant built with LOD_GRID_BITS_MIN bits and, where its loss is above LOD_GRID_LOSS, builds it again with the fewest bits
 * that stay below. Where more bits do not help, the loss is not the grid's and the coarser plant is kept. */
enum eco_code lod_grid_choose(struct lod_plant *plant, const struct eco_model *model, const struct lod_plant_options *options,
	struct eco_error *error);

#endif
