/* Local search for scenes of a few plants, where the rest of a budget is no small part of it and steps are
 * large: there the dual solution and the greedy fill may be far from optimal. One candidate is changed, the
 * others make up for it, and the change is kept if fewer pixels are wrong:
 *
 * - it releases a step, or all its steps, and the others are filled greedily with the vertices
 * - it adds a step that does not fit, for one plant more or for all, and the others release steps until it
 *   fits, those first that lose least per vertex needed; only this trades one large step for several small
 *   ones
 *
 * Ends when no change helps, after some passes, or with half of the plan's work. Takes the square of the
 * number of candidates. */
#ifndef LOD_SWAP_STEPS_H
#define LOD_SWAP_STEPS_H

#include "lod/plan/fill_budget.h"

/* `fill` is filled to its budget; fill->wrong is what it leaves wrong, before and after. False without
 * memory. */
bool lod_swap_steps(struct lod_fill *fill, uint64_t budget);

#endif
