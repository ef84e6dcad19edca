/* Which levels of impostors are worth their bytes.
 *
 * All levels are one vertex, and the larger one is better at every size. But its bytes are paid once for all
 * plants of a kind, and where few of these are seen they buy more elsewhere. A level is used if the pixels
 * that it sets right are worth at least as much as what its bytes would bring as vertices: about a tenth of
 * a vertex a byte, which saves LOD_IMPOSTOR_WORTH of the pixels seen over the budget. */
#ifndef LOD_IMPOSTOR_WORTH_H
#define LOD_IMPOSTOR_WORTH_H

#include "lod/plan/allocation.h"

#include <stdlib.h>
#define LOD_IMPOSTOR_WORTH (getenv("WORTH") ? atof(getenv("WORTH")) : 0.01)

/* Sets allocation->impostor_levels, per plant, from the pixels that its slots show. */
void lod_impostor_worth(struct lod_allocation *allocation);
/* The level for the plants of a slot; ECO_NONE where the ladder has none, or where they are too large. */
uint32_t lod_impostor_of_slot(const struct lod_allocation *allocation, const struct lod_slot *slot,
	const struct lod_way *way);

#endif
