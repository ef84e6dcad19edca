/* What a file of a game holds beside the plant that it shows: coarser levels of detail of the same plant,
 * shapes to collide with, and the ground that it was made on. */
#ifndef ECO_MODEL_SPARE_H
#define ECO_MODEL_SPARE_H

#include <stdbool.h>

#include "ecofiles/import/model/model_import.h"

struct eco_notes;

/* By a part's name: 0 for tree_LOD0, 1 for Tree.lod1/bark, ECO_SPARE_NONE where it says no level,
 * ECO_SPARE_COLLIDER for UCX_tree and tree_collider, ECO_SPARE_CARD for a billboard, spare where there
 * are levels. */
#define ECO_SPARE_NONE (-1)
#define ECO_SPARE_COLLIDER 1000
#define ECO_SPARE_CARD 999
int eco_model_spare_level(const char *name);

/* Drops and counts (ECO_DROP_LEFT_OUT) all parts but those of the finest level, unless a rule names them or
 * nothing would be left, and notes it. */
void eco_model_drop_spare(struct eco_model *model, const struct eco_part_rule *rules, uint32_t count,
	struct eco_notes *notes);

/* Drops and counts the level sheet at the foot that all else stands on, unless a rule names its part, and
 * notes it: the scene has a ground. The model has z up; place as of eco_model_places. False when memory ran
 * out. */
bool eco_model_drop_sheet(struct eco_model *model, const uint32_t *place, const struct eco_part_rule *rules,
	uint32_t count, struct eco_notes *notes);

#endif
