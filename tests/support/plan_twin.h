/* Plans, and the simple twin of what evaluates them: every instance, every anchor, every cut. */
#pragma once

#include "ecofiles/format/pack.h"
#include "lod/plan/planner.h"

/* Vertices drawn, the ground's left out. `plants` may be NULL: how many of them are in view. */
uint64_t plan_twin_vertices(const struct eco_scene *scene, const struct eco_plan *plan,
	const struct eco_view *view, uint64_t *plants);
/* Tells each plant in view of the plan's runs, as `cut` NULL, and each cut that is drawn of it. */
typedef void plan_twin_seen(void *ctx, uint64_t place, const struct eco_cut *cut);
uint64_t plan_twin_draw(const struct eco_scene *scene, const struct eco_plan *plan,
	const struct eco_view *view, uint64_t *plants, plan_twin_seen *seen, void *ctx);

/* A plan, without which the test fails. input.stats is not read. */
struct lod_planner_stats plan_make(struct eco_plan *plan, struct lod_planner_input input);
