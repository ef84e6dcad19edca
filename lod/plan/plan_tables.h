/* What the planner needs of a scene whatever the view: which ladders each anchor has, its plants as proxy shapes, and of each ladder its way and
 * its steps (hulls of its curve). None of it depends on a view or a budget.
 *
 *   lod_plan_tables_make(&tables, scene, &error);            when a scene is opened; takes milliseconds
 *   lod_plan(..., { .tables = tables }, ...) ...        from any number of threads
 *   lod_plan_tables_free(tables);
 *
 * A ladder's part is made when a plan first asks for it, published by one atomic exchange, and never changes then: two threads that
 * need it at a time both make it, the same, and one is thrown away. So a scene of many species costs only for what is looked at: about
 * 5 kB and 0.1 ms a ladder. Plans are the same with tables as without, where each plan makes its own. */
#ifndef LOD_PLAN_TABLES_H
#define LOD_PLAN_TABLES_H

#include "lod/plan/visibility.h"
#include "lod/plan/hull.h"

struct lod_plan_tables_ladder {
	struct lod_way way;
	struct lod_hull hull[2];   /* alone; and beside the plant's cells, of whole-plant lists that are drawn there, else none; for any extra */
};

struct lod_plan_tables;
/* `scene` must outlive the tables. */
enum eco_code lod_plan_tables_make(struct lod_plan_tables **tables, const struct eco_scene *scene, struct eco_error *error);
void lod_plan_tables_free(struct lod_plan_tables *tables);         /* NULL is allowed */

/* NULL without memory, but never once it has been given. */
const struct lod_plan_tables_ladder *lod_plan_tables_ladder(struct lod_plan_tables *tables, uint32_t ladder);

/* The ladders of an anchor, in the scene's order. */
const uint32_t *lod_plan_tables_anchor(const struct lod_plan_tables *tables, uint32_t anchor, uint32_t *count);
/* Per plant, at scale 1; and the mean over plants of their crown's ellipse over their area. */
const struct lod_proxy_shape *lod_plan_tables_proxy_shapes(const struct lod_plan_tables *tables);
double lod_plan_tables_ellipse(const struct lod_plan_tables *tables);

/* Bytes of memory that they take now: of a ladder's part at most the second. */
#define LOD_PLAN_TABLES_LADDER_BYTES_MAX (2 * LOD_HULL_POINTS_MAX * sizeof(struct lod_hull_point) + (1u << 15))
size_t lod_plan_tables_bytes(const struct lod_plan_tables *tables);

#endif
