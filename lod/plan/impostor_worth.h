/* Which levels of impostors are worth their bytes.
 *
 * All levels are one vertex, and the larger one is better at every size. But its bytes are paid once for all
 * plants of a kind, and where few of these are seen they buy more elsewhere. So a level is used if a byte of
 * it sets at least LOD_IMPOSTOR_WORTH of a pixel right, whatever the budget is: with a larger one nothing may
 * become worse. The last level takes four times the bytes of the one before and must set
 * LOD_IMPOSTOR_WORTH_LAST of a pixel right (lod/EXPERIMENTS.md, Bytes of first visits).
 *
 * As a camera moves, a kind must not change its level at once: where a byte is just worth it, only the
 * largest plants have the level, and the others follow, the more a byte sets right, up to twice that. */
#ifndef LOD_IMPOSTOR_WORTH_H
#define LOD_IMPOSTOR_WORTH_H

#include "lod/plan/allocation.h"

#define LOD_IMPOSTOR_WORTH 0.1
#define LOD_IMPOSTOR_WORTH_LAST 0.15
static inline double lod_impostor_worth_least(uint32_t level)
{
	return level + 1 < ECO_IMPOSTOR_LEVELS ? LOD_IMPOSTOR_WORTH : LOD_IMPOSTOR_WORTH_LAST;
}

/* The pixels across from which a level shows plants: what is larger, up to LOD_IMPOSTOR_PIXELS. `times`: how
 * often it is worth its bytes; INFINITY below once. */
double lod_impostor_from(uint32_t level, double times);
/* Sets allocation->impostors, per plant, from the pixels that its slots show, `seen` of each. Above a price of
 * bytes a level must be worth that. */
void lod_impostor_worth(struct lod_allocation *allocation, const double *seen);
/* The level for the plants of a slot; ECO_NONE where the ladder has none, or where they are too large. */
uint32_t lod_impostor_of_slot(const struct lod_allocation *allocation, const struct lod_slot *slot,
	const struct lod_way *way);

#endif
