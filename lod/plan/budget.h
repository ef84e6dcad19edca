/* Down to the last vertex: amounts for tiles and gates that are decided. The price falls until the budget is used; what no price fits
 * exactly is spent step by step, on single plants if need be: of many, the last one goes part of the way and all others take whole
 * steps, so that what is left of a budget, which differs from picture to picture, changes no more than one.
 *
 *   lod_market_settle(&market);                       tiles, gates and counts
 *   lod_spend_make(&spend, &market, &error);          what can be bought there
 *   lod_spend_search(&spend, price, budget)           amounts that fit; spend.wrong is what they leave wrong
 *   lod_spend_finish(&spend, budget, exchanges, &error)       the rest of the budget; then entries of the plan
 *   lod_spend_free(&spend) */
#ifndef LOD_BUDGET_H
#define LOD_BUDGET_H

#include "lod/plan/allocation.h"

struct lod_bid {                     /* an offer for the plants of its slot that are drawn, or a tile's summary */
	uint32_t offer, node;        /* one is ECO_NONE */
	const struct lod_steps *steps;
	uint64_t count;              /* plants; summary: 1 */
	double worth;                /* of one plant, as its price is found */
	double seen;                 /* of all of them: what an error of 1 comes to */
	uint32_t step;               /* the last amount that all have reached */
	uint64_t low;                /* vertices of all ... */
	uint64_t high, ahead;        /* ... but so many, those with the smallest hashes, which have more */
	uint64_t middle, between;    /* and the next, so many of them, which are on the way there. 0: none */
};

struct lod_spend {
	struct lod_market *market;
	struct lod_bid *bids;        uint32_t bid_count;
	uint64_t vertices;
	uint64_t cheapest;           /* after lod_spend_finish: vertices of the cheapest step that would still gain; UINT64_MAX: none would */
	double wrong;
	bool converged;              /* after lod_spend_search: two prices are known, 1/16384 of an interval apart, of which one fits and
	                              * one does not; or all is bought. false: the bound on tries came first; what was found fits all the
	                              * same, if it says so */
	uint32_t *hash_first;        /* per slot, into hashes; slot_count + 1 */
	uint16_t *hashes;            /* of plants that are drawn, slot by slot, ascending where `sorted` */
	uint8_t *sorted;             /* per slot */
};

/* What can be bought for the structure that lod_market_settle has decided. */
enum eco_code lod_spend_make(struct lod_spend *spend, struct lod_market *market, struct eco_error *error);
void lod_spend_free(struct lod_spend *spend);
/* The lowest price whose amounts fit, looked for from `price` > 0 on. Where not even the least fits, vertices stays above the budget. */
void lod_spend_search(struct lod_spend *spend, double price, uint64_t budget);
/* After a search that fits. `exchanges`: then what each bid gives back is tried on the others (for few bids: it takes their square). */
enum eco_code lod_spend_finish(struct lod_spend *spend, uint64_t budget, bool exchanges, struct eco_error *error);

/* ---- For exchanges (lod/plan/swap_steps.h), in between ---- */

static inline const struct lod_amount *lod_bid_amount(const struct lod_bid *bid) { return &bid->steps->amounts[bid->step]; }
static inline bool lod_bid_ended(const struct lod_bid *bid) { return bid->step + 1 == bid->steps->count; }
static inline uint64_t lod_bid_vertices(const struct lod_bid *bid)
{
	return bid->count * bid->low + bid->ahead * (bid->high - bid->low) + bid->between * (bid->middle - bid->low);
}

/* All of its plants at an amount, and none ahead. */
static inline void lod_bid_reach(struct lod_bid *bid, uint32_t step)
{
	bid->step = step;
	bid->ahead = bid->between = 0;
	bid->low = lod_bid_amount(bid)->vertices;
	bid->high = lod_bid_ended(bid) ? bid->low : lod_bid_amount(bid)[1].vertices;
}

/* The fewest plants that a share can hold and that are more than `plants` < count. */
uint64_t lod_spend_share_next(struct lod_spend *spend, const struct lod_bid *bid, uint64_t plants);
/* All but bid `except` (ECO_NONE: all) go on with what the budget leaves, step by step; sets vertices. False without memory. */
bool lod_spend_rest(struct lod_spend *spend, uint64_t budget, uint32_t except);
/* What a bid leaves wrong; between two amounts a curve is not a straight line. */
double lod_spend_wrong_of(const struct lod_spend *spend, const struct lod_bid *bid);
/* Sets spend->wrong to the sum. */
void lod_spend_sum(struct lod_spend *spend);

#endif
