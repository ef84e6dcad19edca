/* A plant's contribution to summaries: points of equal weight, spread over its primitives in proportion to the
 * pixels in which they are nearest, by views from all around; in proportion to area if nothing is visible. */
#pragma once

#include "lod/build/plant.h"

struct lod_pool {                /* owns its arrays */
	uint32_t count;              /* >= 1 */
	float (*position)[3];        /* plant space */
	uint32_t *color;             /* index into the scene's palette */
	bool *keeps;                 /* wood of a plant with leaves: its colour whatever the tint (lod/tint.h) */
	uint8_t level;               /* of the plant's leaves, as in lists of points */
};
/* Points in random order. `palette_first`: start of the plant's palette in the scene's. */
void lod_pool_make(struct lod_pool *pool, const struct lod_plant *plant, uint32_t palette_first, uint32_t count);
void lod_pool_free(struct lod_pool *pool);
