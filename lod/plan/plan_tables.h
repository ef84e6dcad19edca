/* Tables of a scene for planning, whatever the view and the budget: the ladders of each anchor, a proxy shape
 * of each plant, and the way and the hulls of each ladder.
 *
 *   lod_plan_tables_make(&tables, scene, &error);        when a scene is opened; takes milliseconds
 *   lod_plan(..., { .tables = tables }, ...) ...         from any number of threads
 *   lod_plan_tables_free(tables);
 *
 * A ladder's part is made when a plan first asks for it, is published by one atomic exchange, and never
 * changes. Two threads that need it at once both make it, alike, and one copy is freed. So a scene of many
 * species costs only what is looked at: about 5 kB and 0.1 ms a ladder. Plans are the same with or without
 * tables; without, each plan makes its own. */
#pragma once

#include "lod/seen/visibility.h"
#include "lod/seen/hull.h"
#include "lod/plan/planner.h"

struct lod_plan_tables_ladder {
	struct lod_way way;
	struct lod_hull hull[2];     /* [0] alone; [1] beside cells, empty unless it is a whole-plant list
	                              * that is drawn there; of elements larger than a pixel. A ladder that
	                              * shows the whole plant has samples in [0], not reduced */
};

/* NULL without memory; a ladder once returned stays. */
const struct lod_plan_tables_ladder *lod_plan_tables_ladder(struct lod_plan_tables *tables, uint32_t ladder);

/* The ladders of an anchor's organs, in the scene's order; and its ladders that show the whole plant. */
const uint32_t *lod_plan_tables_anchor(const struct lod_plan_tables *tables, uint32_t anchor,
	uint32_t *count);
const uint32_t *lod_plan_tables_whole(const struct lod_plan_tables *tables, uint32_t anchor, uint32_t *count);
/* Per plant, at scale 1; and the mean over plants of the crown's ellipse over the plant's area. */
const struct lod_proxy_shape *lod_plan_tables_proxy_shapes(const struct lod_plan_tables *tables);
double lod_plan_tables_ellipse(const struct lod_plan_tables *tables);
