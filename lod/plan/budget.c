/* Spending a budget to the last vertex: see lod/plan/budget.h. */
#include "lod/plan/budget.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "lod/plan/swap_steps.h"
#include "lod/heap.h"
#include "lod/ladder.h"

#define HALVINGS 14              /* of the interval of prices: what is left is spent step by step */
#define FALL 1.4                 /* of the price, while a price is looked for that does not fit */
#define FALLS_FEW 24
#define NO_PRICE 1e-30           /* of a price: below all at which something gains */
#define FALLS_MAX 400            /* 1e58: more than any two prices can be apart */

/* ---- Bids ---- */

static double drawn_share(const struct lod_node *node) { return 1 - (double)node->left / ECO_SHARE_ONE; }

/* Cells are drawn of plants before the gate alone. */
static double shown(const struct lod_planning *p, const struct lod_tally *t)
{
	const struct lod_slot *slot = &p->visible.slots[t->slot];
	return t->count * (slot->cell ? lod_planning_near(p, slot->plant, t->whole_band) : 1);
}

/* What of a slot's plants is seen in the tiles that are open: their count, each tile's times its factor. */
static void see_slots(const struct lod_market *m, double *seen)
{
	const struct lod_planning *p = m->p;
	for (uint32_t n = 0; n < p->visible.node_count; n++) {
		const struct lod_node *node = &p->visible.nodes[n];
		for (uint32_t i = 0; node->state == LOD_OPEN && i < node->tally_count; i++)
			seen[node->tallies[i].slot] += drawn_share(node) * shown(p, &node->tallies[i]) * m->stalls[n].factor;
	}
}

/* A summary that nothing is drawn beside: it may have as many points as are worth it. */
static bool alone(const struct lod_node *node) { return node->state == LOD_SUMMARY && node->points >= 1; }

/* Its plants are the first of the slot by hash, the last, or all. */
static uint64_t plants_of(const struct lod_planning *p, const struct lod_offer *offer)
{
	const struct lod_slot *slot = &p->visible.slots[offer->slot];
	return offer->when == LOD_NEAR ? slot->near : offer->when == LOD_FAR ? slot->count - slot->near : slot->count;
}

enum eco_code lod_spend_make(struct lod_spend *spend, struct lod_market *m, struct eco_error *error)
{
	const struct lod_planning *p = m->p;
	*spend = (struct lod_spend){ .market = m, .bids = malloc(((size_t)m->offer_count + p->visible.node_count + 1) * sizeof *spend->bids) };
	if (!spend->bids)
		return eco_fail(error, ECO_NO_MEMORY, "planning: no memory for %u amounts", m->offer_count);
	memset(m->scratch, 0, p->visible.slot_count * sizeof *m->scratch);
	see_slots(m, m->scratch);
	for (uint32_t i = 0; i < m->offer_count; i++) {
		const struct lod_offer *o = &m->offers[i];
		uint64_t count = plants_of(p, o);
		if (count)
			spend->bids[spend->bid_count++] = (struct lod_bid){ .offer = i, .node = ECO_NONE, .steps = &o->steps, .count = count, .worth = o->worth,
				.seen = o->worth * m->scratch[o->slot] * ((double)count / (double)p->visible.slots[o->slot].count) };
	}
	for (uint32_t n = 0; n < p->visible.node_count; n++) {
		const struct lod_node *node = &p->visible.nodes[n];
		const struct lod_stall *stall = &m->stalls[n];
		if (node->points > 0)
			spend->bids[spend->bid_count++] = (struct lod_bid){ .offer = ECO_NONE, .node = n,
				.steps = alone(node) ? &stall->points.steps : &stall->parts, .count = 1, .worth = stall->worth,
				.seen = stall->weight * (1 - stall->share) * stall->worth };
	}
	return ECO_OK;
}

void lod_spend_free(struct lod_spend *spend)
{
	free(spend->bids);
	free(spend->hash_first);
	free(spend->hashes);
	free(spend->sorted);
	*spend = (struct lod_spend){ 0 };
}

/* ---- At a price ---- */

static void add_vertices(struct lod_spend *spend, uint64_t count, uint64_t each)
{
	uint64_t product;
	if (__builtin_mul_overflow(count, each, &product) || __builtin_add_overflow(spend->vertices, product, &spend->vertices))
		spend->vertices = UINT64_MAX;
}

/* The amounts of a price; counts vertices, not what is wrong. */
static void spend_at(struct lod_spend *spend, double price)
{
	spend->vertices = 0;
	spend->market->p->looks += spend->bid_count;
	for (uint32_t i = 0; i < spend->bid_count; i++) {
		struct lod_bid *bid = &spend->bids[i];
		double position = bid->worth > 0 ? lod_steps_position(bid->steps, price / bid->worth, bid->step) : price > 0 ? 0 : bid->steps->count - 1;
		lod_bid_reach(bid, (uint32_t)position);
		double part = position - bid->step;
		if (bid->offer == ECO_NONE)          /* points of a summary can be had one by one */
			bid->low += (uint64_t)(part * (double)(bid->high - bid->low));
		else
			bid->ahead = (uint64_t)(part * (double)bid->count);
		add_vertices(spend, bid->count, bid->low);
		add_vertices(spend, bid->ahead, bid->high - bid->low);
	}
}

static double bid_wrong(const struct lod_bid *bid)
{
	const struct lod_amount *a = lod_bid_amount(bid);
	double now = lod_steps_error(bid->steps, a), part = 0;
	if (!lod_bid_ended(bid))
		part = ((double)(bid->low - a->vertices) + (double)bid->ahead / (double)bid->count * (double)(bid->high - bid->low))
			/ (double)(a[1].vertices - a->vertices);
	return bid->seen * (part > 0 ? now + part * (lod_steps_error(bid->steps, a + 1) - now) : now);
}

/* A tile that draws nothing, or whose plants are, is in no bid: what it leaves wrong is added by the caller. */
static void sum_wrong(struct lod_spend *spend)
{
	spend->wrong = 0;
	for (uint32_t i = 0; i < spend->bid_count; i++)
		spend->wrong += bid_wrong(&spend->bids[i]);
}

void lod_spend_search(struct lod_spend *spend, double price, uint64_t budget)
{
	double high = price, low;
	spend_at(spend, 0);
	spend->converged = true;
	if (spend->vertices > budget) {
		int falls = 0;
		for (; spend_at(spend, high), spend->vertices > budget && falls < FALLS_MAX; falls++)
			high *= FALL;
		low = high / FALL;
		for (; spend_at(spend, low), spend->vertices <= budget && falls < FALLS_MAX; falls++) {
			high = low;
			low /= FALL;
			if (falls == FALLS_FEW && (spend_at(spend, high * NO_PRICE), spend->vertices <= budget)) {
				low = high *= NO_PRICE;              /* what is left gains nothing at all */
				break;
			}
		}
		spend->converged = falls < FALLS_MAX;
		for (int i = 0; i < HALVINGS; i++) {
			double middle = 0.5 * (low + high);
			spend_at(spend, middle);
			*(spend->vertices <= budget ? &high : &low) = middle;
		}
		spend_at(spend, high);
	}
	sum_wrong(spend);
}

/* ---- Hashes: which plants are ahead ---- */

static void file_cells(void *ctx, const struct lod_anchor_band *anchors, uint32_t anchor_count, uint32_t plant, uint32_t hash)
{
	struct lod_spend *spend = ctx;
	(void)plant;
	for (uint32_t i = 1; i < anchor_count; i++) {
		uint32_t slot = lod_visible_slot(&spend->market->p->visible, anchors[i].anchor, anchors[i].band);
		if (slot != ECO_NONE)
			spend->hashes[spend->hash_first[slot]++] = (uint16_t)hash;
	}
}

static bool is_drawn(const struct lod_node *node, uint32_t hash)
{
	return node->state == LOD_OPEN && lod_open_hash(hash) >= node->left;
}

/* Hashes of all plants and cells that are drawn, slot by slot. */
static bool file_hashes(struct lod_spend *spend)
{
	struct lod_planning *p = spend->market->p;
	uint32_t slots = p->visible.slot_count, sum = 0;
	spend->hash_first = malloc(((size_t)slots + 2) * sizeof *spend->hash_first);
	spend->sorted = calloc((size_t)slots + 1, 1);
	if (!spend->hash_first || !spend->sorted)
		return false;
	for (uint32_t s = 0; s < slots; s++) {
		spend->hash_first[s] = sum;
		sum += (uint32_t)p->visible.slots[s].count;
	}
	spend->hash_first[slots] = sum;
	spend->hashes = malloc(((size_t)sum + 1) * sizeof *spend->hashes);
	if (!spend->hashes)
		return false;
	for (uint32_t i = 0; i < p->screen.count; i++) {
		const struct lod_sight *sight = &p->screen.sights[i];
		if (sight->slot != ECO_NONE && is_drawn(&p->visible.nodes[sight->node], sight->hash))
			spend->hashes[spend->hash_first[sight->slot]++] = sight->hash;
	}
	for (uint32_t plant = 0; plant < p->scene->plant_count; plant++)
		if (p->gates[plant])
			lod_visible_each(&p->visible, plant, p->gates, file_cells, spend);
	for (uint32_t s = 0, end = 0; s < slots; s++)        /* what is drawn is what was counted */
		assert(spend->hash_first[s] == (end += (uint32_t)p->visible.slots[s].count));
	memmove(spend->hash_first + 1, spend->hash_first, (size_t)slots * sizeof *spend->hash_first);
	spend->hash_first[0] = 0;
	return true;
}

static int ascending(const void *a, const void *b)
{
	return *(const uint16_t *)a - *(const uint16_t *)b;
}

static const uint16_t *hashes_of(struct lod_spend *spend, const struct lod_bid *bid)
{
	const struct lod_offer *offer = &spend->market->offers[bid->offer];
	const struct lod_slot *slot = &spend->market->p->visible.slots[offer->slot];
	uint16_t *hashes = spend->hashes + spend->hash_first[offer->slot];
	if (!spend->sorted[offer->slot])
		qsort(hashes, slot->count, sizeof *hashes, ascending);
	spend->sorted[offer->slot] = 1;
	return offer->when == LOD_FAR ? hashes + slot->near : hashes;
}

/* Plants of one hash are treated alike. The most plants, not above `wanted`, that a share can hold. */
static uint64_t share_floor(struct lod_spend *spend, const struct lod_bid *bid, uint64_t wanted)
{
	if (wanted == 0 || wanted >= bid->count)
		return wanted < bid->count ? wanted : bid->count;
	const uint16_t *hashes = hashes_of(spend, bid);
	while (wanted > 0 && hashes[wanted - 1] == hashes[wanted])
		wanted--;
	return wanted;
}

uint64_t lod_spend_share_next(struct lod_spend *spend, const struct lod_bid *bid, uint64_t plants)
{
	const uint16_t *hashes = hashes_of(spend, bid);
	while (++plants < bid->count && hashes[plants - 1] == hashes[plants])
		;
	return plants;
}

/* ---- What is left ---- */

static double next_price(const struct lod_bid *bid)
{
	return lod_bid_ended(bid) ? 0 : lod_steps_price(bid->steps, bid->step + 1) * bid->worth;
}

static const struct lod_way *way_of(const struct lod_spend *spend, const struct lod_bid *bid)
{
	return lod_planning_way(spend->market->p, spend->market->offers[bid->offer].ladder);
}

/* All have reached `vertices`, on the way to the next amount or there. */
static void reach(struct lod_bid *bid, uint64_t vertices)
{
	bid->low = vertices;
	bid->ahead = 0;
	bid->high = lod_bid_amount(bid)[1].vertices;
	if (bid->low == bid->high)
		lod_bid_reach(bid, bid->step + 1);
}

/* As many plants as `left` takes all the way. */
static uint64_t buy_plants(struct lod_spend *spend, struct lod_bid *bid, uint64_t left)
{
	uint64_t each = bid->high - bid->low, most = left / each, behind = bid->count - bid->ahead;
	uint64_t plants = share_floor(spend, bid, bid->ahead + (most < behind ? most : behind));
	uint64_t spent = plants > bid->ahead ? (plants - bid->ahead) * each : 0;
	if (spent)
		bid->ahead = plants;
	if (bid->ahead == bid->count)
		reach(bid, bid->high);
	return spent;
}

/* Less than a step for one plant is left: all plants go part of the way, and some of them one primitive further. */
static uint64_t buy_evenly(struct lod_spend *spend, struct lod_bid *bid, uint64_t left)
{
	const struct lod_way *way = way_of(spend, bid);
	uint64_t each = left / bid->count, spent = 0, to = lod_way_floor(way, each < bid->high - bid->low ? bid->low + each : bid->high);
	if (to > bid->low) {
		spent = (to - bid->low) * bid->count;
		bid->low = to;
	}
	uint64_t next = lod_way_next(way, bid->low);
	if (next < bid->high && next - bid->low <= left - spent) {
		uint64_t plants = share_floor(spend, bid, (left - spent) / (next - bid->low));
		if (plants > 0) {
			bid->high = next;
			bid->ahead = plants;
			spent += plants * (next - bid->low);
		}
	}
	return spent;
}

/* The same where there are many plants: one goes part of the way, and all others stay as they are. What is left differs from one
 * picture to the next, and may not be seen. */
static uint64_t buy_part(struct lod_spend *spend, struct lod_bid *bid, uint64_t left)
{
	uint64_t plants = bid->between ? 0 : lod_spend_share_next(spend, bid, bid->ahead) - bid->ahead;
	uint64_t to = plants ? lod_way_floor(way_of(spend, bid), bid->low + left / plants) : 0;
	if (to <= bid->low)
		return 0;
	bid->middle = to;
	bid->between = plants;
	return plants * (to - bid->low);
}

/* Some plants are ahead, and one more is too many: so many, but all of them not as far. */
static uint64_t buy_thinly(struct lod_spend *spend, struct lod_bid *bid, uint64_t left)
{
	uint64_t had = bid->ahead * (bid->high - bid->low), plants = lod_spend_share_next(spend, bid, bid->ahead);
	uint64_t to = lod_way_floor(way_of(spend, bid), bid->low + (had + left) / plants);
	if (to <= bid->low || to >= bid->high || plants * (to - bid->low) <= had)
		return 0;
	uint64_t spent = plants * (to - bid->low) - had;
	bid->ahead = plants;
	bid->high = to;
	if (plants == bid->count)
		reach(bid, to);
	return spent;
}

static uint64_t buy_points(struct lod_bid *bid, uint64_t left)
{
	uint64_t points = left < bid->high - bid->low ? left : bid->high - bid->low;
	reach(bid, bid->low + points);
	return points;
}

/* As much as `left` allows of the way to the bid's next amount. */
static uint64_t buy(struct lod_spend *spend, struct lod_bid *bid, uint64_t left)
{
	if (bid->offer == ECO_NONE)
		return buy_points(bid, left);
	uint64_t spent = buy_plants(spend, bid, left);
	if (spent == 0 && !spend->market->sharp)
		spent = buy_part(spend, bid, left);
	else if (spent == 0)
		spent = bid->ahead ? buy_thinly(spend, bid, left) : buy_evenly(spend, bid, left);
	return spent;
}

bool lod_spend_rest(struct lod_spend *spend, uint64_t budget, uint32_t except)
{
	struct lod_candidate *heap = malloc(((size_t)spend->bid_count + 1) * sizeof *heap);
	uint32_t count = 0;
	if (!heap)
		return false;
	spend->vertices = 0;
	spend->market->p->gains += spend->bid_count;
	for (uint32_t i = 0; i < spend->bid_count; i++) {
		struct lod_bid *bid = &spend->bids[i];
		bid->ahead = bid->ahead ? share_floor(spend, bid, bid->ahead) : 0;
		add_vertices(spend, bid->count, bid->low);
		add_vertices(spend, bid->ahead, bid->high - bid->low);
		if (i != except && next_price(bid) > 0)
			heap[count++] = (struct lod_candidate){ next_price(bid), i };
	}
	lod_heap_make(heap, count);
	uint64_t left = budget - spend->vertices;
	while (count && left) {
		struct lod_bid *bid = &spend->bids[heap[0].id];
		uint32_t step = bid->step;
		uint64_t spent = buy(spend, bid, left);
		left -= spent;
		spend->market->p->gains += bid->step != step;
		if (bid->step != step && next_price(bid) > 0)
			heap[0].key = next_price(bid);
		else if (spent == 0 || bid->step != step)
			heap[0] = heap[--count];
		lod_heap_sift(heap, count, 0);
	}
	spend->vertices = budget - left;
	free(heap);
	return true;
}

/* Of one primitive more for the plants that are on the way, or would be. */
static uint64_t part_cost(struct lod_spend *spend, const struct lod_bid *bid)
{
	uint64_t plants = bid->between ? bid->between : lod_spend_share_next(spend, bid, bid->ahead) - bid->ahead;
	uint64_t at = bid->between ? bid->middle : bid->low;
	return plants * (lod_way_next(way_of(spend, bid), at) - at);
}

/* Vertices that one step more would take, of any kind. */
static uint64_t cheapest_step(struct lod_spend *spend)
{
	uint64_t cheapest = UINT64_MAX;
	for (uint32_t i = 0; i < spend->bid_count; i++) {
		const struct lod_bid *bid = &spend->bids[i];
		if (!(next_price(bid) > 0))
			continue;
		uint64_t cost = 1;
		if (bid->offer != ECO_NONE && !spend->market->sharp)
			cost = part_cost(spend, bid);
		else if (bid->offer != ECO_NONE && bid->ahead)
			cost = (lod_spend_share_next(spend, bid, bid->ahead) - bid->ahead) * (bid->high - bid->low);
		else if (bid->offer != ECO_NONE)
			cost = lod_spend_share_next(spend, bid, 0) * (lod_way_next(way_of(spend, bid), bid->low) - bid->low);
		cheapest = cost < cheapest ? cost : cheapest;
	}
	return cheapest;
}

/* ---- Entries ---- */

static double between_densities(const struct lod_way *way, uint64_t low, uint64_t high, double part)
{
	double density = lod_way_density(way, low);
	return part > 0 ? density + part * (lod_way_density(way, high) - density) : density;
}

/* Of the plants of a bid together. Where there are many, as the price has it: cells are few, and where one takes a step all plants that it is a part
 * of would change. Of few, what is drawn may be far from that. */
static double mean_density(const struct lod_spend *spend, const struct lod_bid *bid)
{
	const struct lod_way *way = way_of(spend, bid);
	if (spend->market->sharp)
		return between_densities(way, bid->low, bid->high, (double)bid->ahead / (double)bid->count);
	double position = spend->market->offers[bid->offer].position;
	const struct lod_amount *a = &bid->steps->amounts[(uint32_t)position];
	bool last = (uint32_t)position + 1 == bid->steps->count;
	return between_densities(way, a->vertices, last ? a->vertices : a[1].vertices, position - floor(position));
}

/* How much of each organ's points the plants of a slot show together with their cells: the coarse list is scaled to that. */
static void find_densities(const struct lod_spend *spend, double (*drawn)[ECO_ORGAN_COUNT], double (*all)[ECO_ORGAN_COUNT])
{
	const struct lod_market *m = spend->market;
	const struct lod_planning *p = m->p;
	for (uint32_t i = 0; i < spend->bid_count; i++) {
		const struct lod_bid *bid = &spend->bids[i];
		if (bid->offer == ECO_NONE || !p->visible.slots[m->offers[bid->offer].slot].cell)
			continue;
		const struct eco_ladder *ladder = &p->scene->ladders[m->offers[bid->offer].ladder];
		uint32_t slot = m->offers[bid->offer].slot;
		drawn[slot][ladder->organ] += mean_density(spend, bid) * ladder->area;
		all[slot][ladder->organ] += ladder->area;
	}
	for (uint32_t n = 0; n < p->visible.node_count; n++)
		for (uint32_t i = 0; p->visible.nodes[n].state == LOD_OPEN && i < p->visible.nodes[n].tally_count; i++) {
			const struct lod_tally *t = &p->visible.nodes[n].tallies[i];
			const struct lod_slot *slot = &p->visible.slots[t->slot];
			if (!slot->cell || eco_gate_place(t->whole_band, 0) >= p->gates[slot->plant])
				continue;
			uint32_t whole = lod_market_whole(m, slot->plant, t->whole_band);
			double count = drawn_share(&p->visible.nodes[n]) * shown(p, t);
			for (int o = 0; o < ECO_ORGAN_COUNT; o++) {
				drawn[whole][o] += count * drawn[t->slot][o];
				all[whole][o] += count * all[t->slot][o];
			}
		}
}

/* In the band where the gate ends, the first of the slot's plants draw cells, and the others do not. */
static void find_hashes(const struct lod_planning *p, const struct lod_offer *offer, struct lod_entry *entry)
{
	const struct lod_slot *slot = &p->visible.slots[offer->slot];
	uint32_t place = eco_gate_place(slot->band, 0), gate = p->gates[slot->plant];
	uint32_t end = gate < place ? 0 : gate - place < ECO_SHARE_ONE ? gate - place : ECO_SHARE_ONE;
	entry->first = offer->when == LOD_FAR ? end : 0;
	entry->end = offer->when == LOD_NEAR ? end : ECO_SHARE_ONE;
}

static enum eco_code add_entries(struct lod_spend *spend, struct eco_error *error)
{
	struct lod_market *m = spend->market;
	struct lod_planning *p = m->p;
	double (*drawn)[ECO_ORGAN_COUNT] = calloc(2 * (size_t)p->visible.slot_count + 1, sizeof *drawn);
	double (*all)[ECO_ORGAN_COUNT] = drawn ? drawn + p->visible.slot_count : NULL;
	enum eco_code code = drawn ? ECO_OK : eco_fail(error, ECO_NO_MEMORY, "planning: no memory for %u slots", p->visible.slot_count);
	if (drawn)
		find_densities(spend, drawn, all);
	p->vertices = spend->vertices;
	p->entry_count = 0;
	for (uint32_t i = 0; !code && i < spend->bid_count; i++) {
		const struct lod_bid *bid = &spend->bids[i];
		struct lod_entry entry = { .slot = ECO_NONE, .ladder = bid->node, .count = bid->count, .vertices = bid->low };
		if (bid->offer == ECO_NONE) {
			const struct lod_node *node = &p->visible.nodes[bid->node];
			entry.full = lod_planning_count(p->scene, p->scene->tiles[node->tile].summary);
			entry.wanted = alone(node) ? 0 : (double)m->stalls[bid->node].part[1].vertices;
		} else {
			const struct lod_offer *o = &m->offers[bid->offer];
			const struct eco_ladder *ladder = &p->scene->ladders[o->ladder];
			entry.slot = o->slot;
			entry.among = 1 - (m->lots[o->slot].seen > 0 ? m->lots[o->slot].bare / m->lots[o->slot].seen : 1);
			entry.ladder = o->ladder;
			entry.full = lod_planning_way(p, o->ladder)->full;
			double organ = o->when == LOD_NEAR ? all[o->slot][ladder->organ] : 0;
			find_hashes(p, o, &entry);
			entry.wanted = organ > 0 ? ladder->total * drawn[o->slot][ladder->organ] / organ : 0;
			if (bid->ahead) {        /* and less than all */
				entry.more = bid->high;
				entry.share = hashes_of(spend, bid)[bid->ahead];
			}
			if (bid->between) {
				uint64_t end = bid->ahead + bid->between;
				entry.middle = bid->middle;
				entry.between = end < bid->count ? hashes_of(spend, bid)[end] : entry.end;
			}
		}
		code = lod_planning_add(p, &entry, error);
	}
	free(drawn);
	return code;
}

/* Between two amounts a curve is not a straight line. */
static double error_at(const struct lod_spend *spend, const struct lod_bid *bid, uint64_t vertices)
{
	struct lod_amount amount = lod_steps_amount(way_of(spend, bid), vertices);
	return lod_steps_error(bid->steps, &amount);
}

double lod_spend_wrong_of(const struct lod_spend *spend, const struct lod_bid *bid)
{
	const struct lod_amount *a = lod_bid_amount(bid);
	bool at_steps = lod_bid_ended(bid) || (!bid->between && bid->low == a->vertices && (!bid->ahead || bid->high == a[1].vertices));
	if (bid->offer == ECO_NONE || at_steps)
		return bid_wrong(bid);
	double now = error_at(spend, bid, bid->low), wrong = now;
	if (bid->ahead)
		wrong += (double)bid->ahead / (double)bid->count * (error_at(spend, bid, bid->high) - now);
	if (bid->between)
		wrong += (double)bid->between / (double)bid->count * (error_at(spend, bid, bid->middle) - now);
	return bid->seen * wrong;
}

void lod_spend_sum(struct lod_spend *spend)
{
	spend->wrong = 0;
	for (uint32_t i = 0; i < spend->bid_count; i++)
		spend->wrong += lod_spend_wrong_of(spend, &spend->bids[i]);
}

enum eco_code lod_spend_finish(struct lod_spend *spend, uint64_t budget, bool exchanges, struct eco_error *error)
{
	bool good = file_hashes(spend) && lod_spend_rest(spend, budget, ECO_NONE);
	if (good)
		lod_spend_sum(spend);
	if (!good || (exchanges && !lod_exchange_all(spend, budget)))
		return eco_fail(error, ECO_NO_MEMORY, "planning: no memory for %u amounts", spend->bid_count);
	spend->cheapest = cheapest_step(spend);
	return add_entries(spend, error);
}
