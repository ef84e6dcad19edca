/* Uses a budget to the last vertex that gains, with tiles and gates fixed. First come the hull points of a lambda
 * that fits: the dual solution. The rest of the budget goes to further steps in falling order of slope (greedy fill,
 * as in the linear relaxation of the knapsack), down to steps of single plants; a plant by itself goes part of its step.
 *
 *   lod_allocation_fix(&allocation);                      tiles, gates, counts
 *   lod_fill_make(&fill, &allocation, &error);            the candidates
 *   lod_fill_search(&fill, lambda, budget)                hull points that fit, and the pixels left wrong
 *   lod_fill_few(&fill, budget, &error)                   few plants in view: the best of all points that fit
 *   lod_fill_finish(&fill, budget, &error)                the rest of the budget; then entries of the plan
 *   lod_fill_free(&fill) */
#pragma once

#include "lod/plan/allocation.h"
#include "lod/plan/explain.h"

#define LOD_LAMBDA_MOST 1e60     /* beyond any at which something gains, whatever a pack says */

struct lod_candidate {               /* a ladder choice for the plants of its slot that are drawn, or a tile's
                                      * summary */
	uint32_t ladder_choice, node; /* one of them is ECO_NONE */
	const struct lod_hull *hull;
	uint64_t count;              /* plants; 1 of a summary */
	double weight_px;            /* of one plant: its lambda is that of the hull times this; where many plants
	                              * are in view the slot's, which changes slowly as a camera moves */
	double seen;                 /* wrong pixels of all plants at an error of 1 */
	uint32_t step;               /* the last hull point that all plants have reached */
	uint64_t low;                /* vertices of each plant, ... */
	uint64_t high, ahead;        /* ... but `ahead` plants of the smallest hashes have `high` */
};

struct lod_fill {
	struct lod_allocation *allocation;
	struct lod_candidate *candidates;        uint32_t candidate_count;
	double lambda;               /* after search: the lambda found; 0: everything fits */
	uint64_t vertices;
	uint64_t cheapest;           /* after finish: vertices of the cheapest step of a hull that is left;
	                              * UINT64_MAX: none */
	double wrong;
	bool converged;              /* after search: it fits */
	uint32_t *hash_first;        /* per slot, into hashes; slot_count + 1 */
	uint16_t *hashes;            /* of drawn plants, slot by slot, ascending where `sorted` */
	uint8_t *sorted;             /* per slot */
};

/* Makes the candidates of the tiles and gates that lod_allocation_fix has set. */
enum eco_code lod_fill_make(struct lod_fill *fill, struct lod_allocation *allocation,
	struct eco_error *error);
void lod_fill_free(struct lod_fill *fill);
/* Sets the hull points of a lambda that fits, about the lowest from `lambda` > 0 on; those of 0 if these fit. If not
 * even the first hull points fit, `vertices` stays above the budget. */
void lod_fill_search(struct lod_fill *fill, double lambda, uint64_t budget);
/* After a search that fits, where few plants are in view: what all of them draw, and which of them draw a ladder for
 * the whole plant. */
enum eco_code lod_fill_few(struct lod_fill *fill, uint64_t budget, struct eco_error *error);
/* After a search that fits. */
enum eco_code lod_fill_finish(struct lod_fill *fill, uint64_t budget, struct eco_error *error);

/* After it: the picture. Slots are no longer those of a lambda. */
enum eco_code lod_fill_predict(struct lod_fill *fill, struct eco_prediction *prediction, struct eco_error *error);

/* Sets the hull points of a lambda; sums vertices, not what is wrong. */
void lod_fill_at(struct lod_fill *fill, double lambda);
static inline uint64_t lod_candidate_vertices(const struct lod_candidate *candidate)
{
	return candidate->count * candidate->low + candidate->ahead * (candidate->high - candidate->low);
}
/* All plants of a candidate have `vertices`, at a hull point or on the way to the next; its step is no further. */
void lod_candidate_reach(struct lod_candidate *candidate, uint64_t vertices);
/* The error at `vertices`, which a plant may draw: by the curve. */
double lod_fill_error(const struct lod_fill *fill, const struct lod_candidate *candidate, uint64_t vertices);
/* The number that a plant may draw: the greatest up to `to`, but above `vertices`. */
uint64_t lod_fill_next(const struct lod_fill *fill, const struct lod_candidate *candidate, uint64_t vertices,
	uint64_t to);

/* ---- For explain.c ---- */

static inline const struct lod_hull_point *lod_candidate_point(const struct lod_candidate *candidate)
{
	return &candidate->hull->points[candidate->step];
}
static inline bool lod_candidate_ended(const struct lod_candidate *candidate)
{
	return candidate->step + 1 == candidate->hull->count;
}

/* Wrong pixels that the next step of one plant saves per vertex; 0 at the end. */
static inline double lod_candidate_next(const struct lod_candidate *candidate)
{
	return lod_candidate_ended(candidate) ? 0
		: lod_hull_slope(candidate->hull, candidate->step + 1) * candidate->weight_px;
}

/* Wrong pixels that a candidate leaves, by its curve: between two hull points a curve is no straight line. */
double lod_fill_wrong_of(const struct lod_fill *fill, const struct lod_candidate *candidate);

/* Explaining inside the planner. Nothing is recorded unless an explanation is asked for. */

/* The plan may take so much work; 0: any. */
void lod_explain_begin(struct lod_explanation *explanation, uint64_t work_max);

/* The reason for a candidate's vertices. */
struct lod_reason lod_explain_candidate(const struct lod_fill *fill, const struct lod_candidate *candidate);

/* Adds rows of tiles whose plants are drawn though they have a summary. Drops rows of a coarser level. */
void lod_explain_tiles(const struct lod_fill *fill);

/* Adds the row of a cut that `plants` of an entry draw; NULL: nowhere. Those of the ground. */
void lod_explain_cut(const struct lod_planner *p, struct lod_explanation *why, const struct lod_entry *entry,
	const struct eco_cut *cut, uint64_t plants);
void lod_explain_ground(const struct lod_planner *p, const struct eco_plan *plan);
