/* Explaining inside the planner. Nothing is recorded unless an explanation is asked for. */
#ifndef LOD_EXPLAIN_STATE_H
#define LOD_EXPLAIN_STATE_H

#include "lod/plan/explain.h"
#include "lod/plan/fill_budget.h"

/* The plan may take so much work; 0: any. */
void lod_explain_begin(struct lod_explanation *explanation, uint64_t work_max);

/* The reason for a candidate's vertices. */
struct lod_reason lod_explain_candidate(const struct lod_fill *fill, const struct lod_candidate *candidate);

/* Adds rows of tiles whose plants are drawn though they have a summary. Drops rows of a coarser level. */
void lod_explain_tiles(const struct lod_fill *fill);

/* Adds the row of a cut that `plants` of an entry draw. */
void lod_explain_cut(const struct lod_planner *p, const struct lod_entry *entry, const struct eco_cut *cut,
	uint64_t plants);

#endif
