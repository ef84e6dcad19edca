/* The choice of a plant's grid: as coarse as its picture allows. */
#pragma once

#include "lod/build/plant.h"

#define LOD_GRID_BITS_MIN 12u
#define LOD_GRID_BITS_MAX 18u
#define LOD_GRID_LOSS 0.003          /* 1 - Q, worst of 8 views, 512 pixels high */
#define LOD_GRID_NEAR_M 20.0         /* from here on rounding is below half a pixel, up to 18 bits */

/* The fewest bits for the model's grid: LOD_GRID_BITS_MIN, more if it is so large that LOD_GRID_NEAR_M asks
 * for them. */
uint32_t lod_grid_bits_least(const struct eco_model *model);

/* The worst 1 - Q of the plant's full detail against the source model's own triangles: the loss by
 * quantization, welding and everything else at import. 0 for a model that covers nothing. Uses only `each`
 * and `ctx` of the options. */
double lod_grid_loss(const struct lod_plant *plant, const struct eco_model *model,
	const struct lod_plant_options *options);

/* Takes a plant built with lod_grid_bits_least bits. If its loss is above LOD_GRID_LOSS it is built again
 * with the fewest bits that stay below. If more bits do not help, the loss is not the grid's, and the coarser
 * plant is kept. */
enum eco_code lod_grid_choose(struct lod_plant *plant, const struct eco_model *model,
	const struct lod_plant_options *options, struct eco_error *error);

/* The distance in metres from which on full detail is within half a pixel of the model, for pixels
 * `pixel_rad` high (struct lod_eye). Nearer, the error grows in inverse proportion to the distance. All lists
 * of a plant are on one grid, so touching parts touch at any distance. */
double lod_grid_nearest_m(const struct eco_list *list, double pixel_rad);
#define LOD_GRID_PIXEL_RAD 7.671e-4      /* 1080 pixels over 45 degrees, for statements without a picture */
