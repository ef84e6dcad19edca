/* Where a few plants are in view, what is left of a budget is no small part of it, and steps are large: a lambda finds hull points that are good and not
 * the best. So each candidate is changed by itself, and the others make up for it; that is kept where less is wrong then.
 *
 *   It gives back a step, or all it has: others go on with that, those that gain most first.
 *   It takes a step that the budget does not allow, for one plant more or for all: others give back steps until it does, first those that lose
 *   least for each vertex that is needed. One dear step for some cheap ones is found no other way.
 *
 * Some rounds, until nothing is better. Takes the square of the candidates. */
#ifndef LOD_SWAP_STEPS_H
#define LOD_SWAP_STEPS_H

#include "lod/plan/fill_budget.h"

/* Of candidates whose rest is spent; spend->wrong is what they leave wrong, before and after. False without memory. */
bool lod_swap_steps(struct lod_fill *fill, uint64_t budget);

#endif
