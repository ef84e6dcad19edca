/* The simple twin of what evaluates plans: every instance, every anchor, every cut. */
#ifndef TESTS_PLAN_TWIN_H
#define TESTS_PLAN_TWIN_H

#include "ecofiles/format/pack.h"
#include "ecofiles/format/plan.h"
#include "ecofiles/format/view.h"

/* Vertices drawn, the ground's left out. `plants` may be NULL: how many of them are in view. */
uint64_t plan_twin_vertices(const struct eco_scene *scene, const struct eco_plan *plan,
	const struct eco_view *view, uint64_t *plants);

#endif
