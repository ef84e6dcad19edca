/* A plant's ladder of splats, which shows the plant as a whole (ECO_LADDER_WHOLE). */
#ifndef LOD_PLANT_SPLATS_H
#define LOD_PLANT_SPLATS_H

#include "lod/build/plant.h"

/* Fits splats to the model (splat_fit.h) and appends their list and ladder to a built plant. Appends nothing
 * to a plant that shows nothing. */
enum eco_code lod_plant_add_splats(struct lod_plant *plant, const struct eco_model *model,
	const struct lod_plant_options *options, struct eco_error *error);

#endif
