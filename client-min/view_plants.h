/* What plants of a view are by the inventories that they come from: the server reads it from the pack, where
 * it is asked for (openapi.yaml's Plants). */
#ifndef VIEW_PLANTS_H
#define VIEW_PLANTS_H

#include <jansson.h>

#include "client-min/view_fetch.h"

struct view_plant_asked {
	uint32_t list, index;        /* of view_instance */
	json_t **said;               /* the caller's: {species, plant, file, row, line}, as far as known */
};
/* Sorts `plants`, and asks for those of a list together. On failure some may have been said. */
enum eco_code view_plants_ask(struct view_fetch *fetch, const struct eco_chunk_id *pack,
	struct view_plant_asked *plants, uint32_t count, struct eco_error *error);

#endif
