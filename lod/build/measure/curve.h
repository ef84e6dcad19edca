/* Curves: what a ladder's picture is worth at each share of its vertices, and the scale that serves it best. */
#ifndef LOD_CURVE_H
#define LOD_CURVE_H

#include "lod/build/plant.h"

#define LOD_CURVE_SAMPLES_MAX 48u

/* Replaces the plant's curves by measured ones, one for each organ and texture (shared by the whole plant's ladder and those of its
 * cells) and one for each organ's FAR ladders, and points the ladders to them. Each is followed by one of
 * what is seen from above, for what is drawn alike but for its scale. options: views, pixels, progress. */
enum eco_code lod_curve_measure(struct lod_plant *plant, const struct eco_model *model, const struct lod_plant_options *options,
	struct eco_error *error);

#endif
