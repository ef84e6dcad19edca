/* Down to the last vertex: hull points for tiles and gates that are decided. The lambda falls until the budget is used; what no lambda fits
 * exactly is spent step by step, on single plants if need be: of many, the last one goes part of the way and all others take whole
 * steps, so that what is left of a budget, which differs from picture to picture, changes no more than one.
 *
 *   lod_allocation_fix(&allocation);                       tiles, gates and counts
 *   lod_fill_make(&spend, &allocation, &error);          what can be bought there
 *   lod_fill_search(&spend, lambda, budget)           hull points that fit; spend.wrong is what they leave wrong
 *   lod_fill_finish(&spend, budget, exchanges, &error)       the rest of the budget; then entries of the plan
 *   lod_fill_free(&spend) */
#ifndef LOD_FILL_BUDGET_H
#define LOD_FILL_BUDGET_H

#include "lod/plan/allocation.h"

struct lod_candidate {                     /* an ladder choice for the plants of its slot that are drawn, or a tile's summary */
	uint32_t ladder_choice, node;        /* one is ECO_NONE */
	const struct lod_hull *hull;
	uint64_t count;              /* plants; summary: 1 */
	double weight_px;                /* of one plant, as its lambda is found */
	double seen;                 /* of all of them: what an error of 1 comes to */
	uint32_t step;               /* the last hull point that all have reached */
	uint64_t low;                /* vertices of all ... */
	uint64_t high, ahead;        /* ... but so many, those with the smallest hashes, which have more */
	uint64_t middle, between;    /* and the next, so many of them, which are on the way there. 0: none */
};

struct lod_fill {
	struct lod_allocation *allocation;
	struct lod_candidate *candidates;        uint32_t candidate_count;
	double lambda;               /* after lod_fill_search: the multiplier that was found; 0: everything fits */
	uint64_t vertices;
	uint64_t cheapest;           /* after lod_fill_finish: vertices of the cheapest step that would still gain; UINT64_MAX: none would */
	double wrong;
	bool converged;              /* after lod_fill_search: two lambdas are known, 1/16384 of an interval apart, of which one fits and
	                              * one does not; or all is bought. false: the bound on tries came first; what was found fits all the
	                              * same, if it says so */
	uint32_t *hash_first;        /* per slot, into hashes; slot_count + 1 */
	uint16_t *hashes;            /* of plants that are drawn, slot by slot, ascending where `sorted` */
	uint8_t *sorted;             /* per slot */
};

/* What can be bought for the structure that lod_allocation_fix has decided. */
enum eco_code lod_fill_make(struct lod_fill *fill, struct lod_allocation *allocation, struct eco_error *error);
void lod_fill_free(struct lod_fill *fill);
/* The lowest lambda whose hull points fit, looked for from `lambda` > 0 on. Where not even the least fits, vertices stays above the budget. */
void lod_fill_search(struct lod_fill *fill, double lambda, uint64_t budget);
/* After a search that fits. `exchanges`: then what each candidate gives back is tried on the others (for few candidates: it takes their square). */
enum eco_code lod_fill_finish(struct lod_fill *fill, uint64_t budget, bool swaps, struct eco_error *error);

/* ---- For exchanges (lod/plan/swap_steps.h), in between ---- */

static inline const struct lod_hull_point *lod_candidate_point(const struct lod_candidate *candidate) { return &candidate->hull->points[candidate->step]; }
static inline bool lod_candidate_ended(const struct lod_candidate *candidate) { return candidate->step + 1 == candidate->hull->count; }
static inline uint64_t lod_candidate_vertices(const struct lod_candidate *candidate)
{
	return candidate->count * candidate->low + candidate->ahead * (candidate->high - candidate->low) + candidate->between * (candidate->middle - candidate->low);
}

/* What the next step of its hull saves per vertex; 0 at the end. */
static inline double lod_candidate_next(const struct lod_candidate *candidate)
{
	return lod_candidate_ended(candidate) ? 0 : lod_hull_slope(candidate->hull, candidate->step + 1) * candidate->weight_px;
}

/* All of its plants at an hull point, and none ahead. */
static inline void lod_candidate_reach(struct lod_candidate *candidate, uint32_t step)
{
	candidate->step = step;
	candidate->ahead = candidate->between = 0;
	candidate->low = lod_candidate_point(candidate)->vertices;
	candidate->high = lod_candidate_ended(candidate) ? candidate->low : lod_candidate_point(candidate)[1].vertices;
}

/* The fewest plants that a share can hold and that are more than `plants` < count. */
uint64_t lod_fill_share_next(struct lod_fill *fill, const struct lod_candidate *candidate, uint64_t plants);
/* All but candidate `except` (ECO_NONE: all) go on with what the budget leaves, step by step; sets vertices. False without memory. */
bool lod_fill_rest(struct lod_fill *fill, uint64_t budget, uint32_t except);
/* What a candidate leaves wrong; between two hull points a curve is not a straight line. */
double lod_fill_wrong_of(const struct lod_fill *fill, const struct lod_candidate *candidate);
/* Sets spend->wrong to the sum. */
void lod_fill_sum(struct lod_fill *fill);

#endif
