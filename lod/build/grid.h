/* How fine a plant's grids must be: as coarse as its picture allows. */
#ifndef LOD_GRID_H
#define LOD_GRID_H

#include "lod/build/plant.h"

#define LOD_GRID_BITS_MIN 12u
#define LOD_GRID_BITS_MAX 18u
#define LOD_GRID_LOSS 0.003          /* 1 - Q, worst of 8 views, 512 pixels high */
#define LOD_GRID_NEAR_M 20.0         /* half a pixel is reached from here on at the latest, however large the plant (up to 18 bits) */

/* The fewest bits that the model's grid may have: LOD_GRID_BITS_MIN, more where it is so large that LOD_GRID_NEAR_M asks for it. */
uint32_t lod_grid_bits_least(const struct eco_model *model);

/* Worst 1 - Q of the plant's full detail against the source model's own triangles: quantization, welding and whatever else was lost
 * on the way in. 0 for a model that covers nothing. Of the options only `each` and `ctx` count. */
enum eco_code lod_grid_loss(const struct lod_plant *plant, const struct eco_model *model, const struct lod_plant_options *options,
	double *loss, struct eco_error *error);

/* Takes a plant built with lod_grid_bits_least bits and, where its loss is above LOD_GRID_LOSS, builds it again with the fewest bits
 * that stay below. Where more bits do not help, the loss is not the grid's and the coarser plant is kept. */
enum eco_code lod_grid_choose(struct lod_plant *plant, const struct eco_model *model, const struct lod_plant_options *options,
	struct eco_error *error);

/* What rounding to a list's grid comes to. Full detail is within half a pixel of the model down to this distance from the eye, for a picture whose
 * pixels are `pixel_rad` high (lod_eye); nearer it is off by as much more as the eye is nearer, and no more: all lists of a plant are on one
 * grid, so what touches goes on touching, however near. */
double lod_grid_nearest_m(const struct eco_list *list, double pixel_rad);
#define LOD_GRID_PIXEL_RAD 7.671e-4      /* 1080 pixels over 45 degrees: what is stated where no picture is */

#endif
