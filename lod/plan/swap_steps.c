/* What one bid has is exchanged for what others may have: see lod/plan/swap_steps.h. */
#include "lod/plan/swap_steps.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define PASSES 4                 /* times that all bids are looked at */

/* One step back, or all of them. False where nothing is drawn. */
static bool give_back(struct lod_bid *bid, bool all)
{
	uint32_t step = all ? 0 : bid->step;
	if (bid->low == bid->steps->amounts[0].vertices && bid->ahead == 0)
		return false;
	if (!all && bid->ahead == 0 && bid->low == lod_bid_amount(bid)->vertices)
		step--;
	lod_bid_reach(bid, step);
	return true;
}

/* The next amount for all of a bid's plants, or for one more of them. False at the end. */
static bool take_step(struct lod_spend *spend, struct lod_bid *bid, bool all)
{
	if (lod_bid_ended(bid))
		return false;
	uint64_t ahead = bid->offer != ECO_NONE && bid->high == lod_bid_amount(bid)[1].vertices ? bid->ahead : 0;
	ahead = all || bid->offer == ECO_NONE ? bid->count : lod_spend_share_next(spend, bid, ahead);
	lod_bid_reach(bid, bid->step + (ahead == bid->count));
	bid->ahead = ahead == bid->count ? 0 : ahead;
	return true;
}

struct back { double loss; uint64_t freed; };    /* what a bid's last step back would come to; freed 0: it has none */

static struct back back_of(const struct lod_spend *spend, const struct lod_bid *bid)
{
	struct lod_bid after = *bid;
	if (!give_back(&after, false))
		return (struct back){ 0 };
	return (struct back){ lod_spend_wrong_of(spend, &after) - lod_spend_wrong_of(spend, bid), lod_bid_vertices(bid) - lod_bid_vertices(&after) };
}

/* All but bid `except` give back steps until the budget is kept: first those that lose least for each vertex that is needed. */
static bool pay(struct lod_spend *spend, uint64_t budget, uint32_t except, struct back *backs)
{
	spend->vertices = 0;
	for (uint32_t i = 0; i < spend->bid_count; i++) {
		spend->vertices += lod_bid_vertices(&spend->bids[i]);
		backs[i] = i == except ? (struct back){ 0 } : back_of(spend, &spend->bids[i]);
	}
	while (spend->vertices > budget) {
		uint64_t needed = spend->vertices - budget;
		uint32_t best = ECO_NONE;
		double least = INFINITY;
		for (uint32_t i = 0; i < spend->bid_count; i++) {
			double each = backs[i].freed ? backs[i].loss / (double)(backs[i].freed < needed ? backs[i].freed : needed) : INFINITY;
			if (each < least) {
				least = each;
				best = i;
			}
		}
		if (best == ECO_NONE)
			return false;
		give_back(&spend->bids[best], false);
		spend->vertices -= backs[best].freed;
		backs[best] = back_of(spend, &spend->bids[best]);
	}
	return true;
}

/* What is changed of one bid, and then of others to make up for it. */
enum exchange { GIVE_STEP, GIVE_ALL, TAKE_ONE, TAKE_STEP, EXCHANGE_KINDS };

static bool change(struct lod_spend *spend, uint64_t budget, uint32_t i, enum exchange kind, struct back *backs)
{
	struct lod_bid *bid = &spend->bids[i];
	if (kind == GIVE_STEP || kind == GIVE_ALL)
		return give_back(bid, kind == GIVE_ALL);
	return (kind == TAKE_STEP || bid->count > 1) && take_step(spend, bid, kind == TAKE_STEP) && pay(spend, budget, i, backs);
}

/* Kept if less is wrong then. */
static bool exchange(struct lod_spend *spend, uint64_t budget, uint32_t i, enum exchange kind, struct lod_bid *spare, struct back *backs,
	bool *better)
{
	double before = spend->wrong;
	uint64_t vertices = spend->vertices;
	memcpy(spare, spend->bids, spend->bid_count * sizeof *spare);
	if (change(spend, budget, i, kind, backs)) {
		if (!lod_spend_rest(spend, budget, i) || !lod_spend_rest(spend, budget, ECO_NONE))
			return false;
		lod_spend_sum(spend);
		if (spend->wrong < before) {
			*better = true;
			return true;
		}
	}
	memcpy(spend->bids, spare, spend->bid_count * sizeof *spare);
	spend->wrong = before;
	spend->vertices = vertices;
	return true;
}

bool lod_exchange_all(struct lod_spend *spend, uint64_t budget)
{
	struct lod_bid *spare = malloc(((size_t)spend->bid_count + 1) * sizeof *spare);
	struct back *backs = malloc(((size_t)spend->bid_count + 1) * sizeof *backs);
	bool good = spare && backs, better = true;
	for (int pass = 0; good && better && pass < PASSES; pass++) {
		better = false;
		for (uint32_t i = 0; good && i < EXCHANGE_KINDS * spend->bid_count; i++)
			good = exchange(spend, budget, i / EXCHANGE_KINDS, i % EXCHANGE_KINDS, spare, backs, &better);
	}
	free(backs);
	free(spare);
	return good;
}
