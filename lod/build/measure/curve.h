/* Curves: the error of a ladder's picture at each share of its vertices, and the scale with the least
 * loss. */
#ifndef LOD_CURVE_H
#define LOD_CURVE_H

#include "lod/build/plant.h"

#define LOD_CURVE_SAMPLES_MAX 48u

/* Replaces the plant's curves by measured ones and assigns them to the ladders: one for each organ and
 * texture (shared by the whole plant's ladder and those of its cells) and one for each organ's FAR ladders.
 * Each is followed by a curve from above, for the same cuts at their best scale there. options: views,
 * pixels, progress. */
enum eco_code lod_curve_measure(struct lod_plant *plant, const struct eco_model *model,
	const struct lod_plant_options *options, struct eco_error *error);

#endif
