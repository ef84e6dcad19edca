/* A plant's impostor, as bytes for a pack. */
#ifndef LOD_PLANT_IMPOSTOR_H
#define LOD_PLANT_IMPOSTOR_H

#include "lod/build/plant.h"
#include "lod/impostor.h"

/* Makes the impostor's levels and adds them to the plant and its last ladder, which shows the whole plant
 * with splats. A draft has fewer levels. `rgb` as in lod_impostors_options. */
enum eco_code lod_plant_add_impostor(struct lod_plant *plant, const struct eco_model *model,
	const uint8_t (*rgb)[3], const struct lod_plant_options *options, struct eco_error *error);

/* Opens a level as a client does. Close it. */
enum eco_code lod_plant_open_impostor(struct lod_impostor *impostor, const struct lod_plant *plant,
	uint32_t level, struct eco_error *error);

#endif
