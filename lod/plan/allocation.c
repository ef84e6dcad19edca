/* What is bought at a price: see lod/plan/allocation.h. */
#include "lod/plan/allocation.h"

#include <math.h>

#define GIVING_WAY 0.07          /* tiles and gates are open in part where both choices differ by less than this share of what the finer saves */
#define LAST_PRICE 1e-200        /* of what is bought where nothing else is left to buy */

/* ---- At a price ---- */

static void buy(struct lod_cost *cost, const struct lod_steps *steps, double worth, double position)
{
	uint32_t whole = (uint32_t)position;
	double part = position - whole;
	const struct lod_amount *a = &steps->amounts[whole], *b = part > 0 ? a + 1 : a;
	cost->fp += worth * (a->fp + part * (b->fp - a->fp));
	cost->fn += worth * (a->fn + part * (b->fn - a->fn));
	cost->above_fp += worth * (a->above_fp + part * (b->above_fp - a->above_fp));
	cost->above_fn += worth * (a->above_fn + part * (b->above_fn - a->above_fn));
	cost->vertices += (double)a->vertices + part * (double)(b->vertices - a->vertices);
}

static void add_cost(struct lod_cost *sum, const struct lod_cost *cost, double extra, double times, double seen)
{
	sum->fp += seen * extra * cost->fp;
	sum->fn += seen * cost->fn;
	sum->above_fp += seen * extra * cost->above_fp;
	sum->above_fn += seen * cost->above_fn;
	sum->vertices += times * cost->vertices;
}

static double paid(const struct lod_cost *cost, double extra, double price)
{
	return extra * cost->fp + cost->fn + price * cost->vertices;
}

static void price_lots(struct lod_market *m)
{
	for (uint32_t s = 0; s < m->p->visible.slot_count; s++) {
		struct lod_lot *lot = &m->lots[s];
		lot->cost[0] = lot->cost[1] = lot->cells = (struct lod_cost){ 0 };
		lot->cells_worth = 0;
		for (uint32_t i = lot->offer_first; i < lot->offer_first + lot->offer_count; i++) {
			struct lod_offer *offer = &m->offers[i];
			offer->position = offer->worth > 0 ? lod_steps_position(&offer->steps, m->price / offer->worth, offer->position) : 0;
			if (offer->when != LOD_NEAR)
				buy(&lot->cost[0], &offer->steps, offer->worth, offer->position);
			if (offer->when != LOD_FAR)
				buy(&lot->cost[1], &offer->steps, offer->worth, offer->position);
		}
	}
}

static void sum_cells(struct lod_market *m, const struct lod_tally *t, struct lod_lot *cell, struct lod_lot *whole)
{
	(void)m;
	add_cost(&whole->cells, &cell->cost[1], 1, t->count, t->count);
	whole->cells_worth += t->count * cell->worth[1];
}

/* How far what is coarse, and saves so much, has given way to what is fine: 1 where that saves much more. */
static double fine_share(const struct lod_market *m, double fine, double coarse)
{
	if (m->sharp || !(fine > 0))
		return fine > coarse;
	double share = 0.5 + (fine - coarse) / (2 * GIVING_WAY * fine);
	return share < 0 ? 0 : share > 1 ? 1 : share;
}

struct bands { double plants, near, far; };              /* of a plant, side by side: what they save with cells, and without */

/* Plants before a gate draw cells, and are the nearest. So where cells are worth more in a band than in the one before it, both decide as one. */
static uint32_t join_bands(struct bands *bands, uint32_t count)
{
	while (count > 1) {
		struct bands *a = &bands[count - 2], *b = &bands[count - 1];
		if (a->near * b->far >= b->near * a->far)
			break;
		*a = (struct bands){ a->plants + b->plants, a->near + b->near, a->far + b->far };
		count--;
	}
	return count;
}

/* How many plants' cells are worth it. */
static double count_near(const struct lod_market *m, uint32_t plant)
{
	struct bands bands[ECO_BANDS];
	uint32_t count = 0;
	double sum = 0;
	for (uint32_t band = 0; band < m->gates_most[plant]; band++) {
		uint32_t s = lod_market_whole(m, plant, (uint8_t)band);
		if (s == ECO_NONE)
			continue;
		const struct lod_lot *lot = &m->lots[s];
		double plants = (double)m->counts[s], extra = lot->extra, worth = plants * lot->worth[0];
		bands[count++] = (struct bands){ plants, worth - plants * paid(&lot->cost[1], extra, m->price) - paid(&lot->cells, extra, m->price),
			worth - plants * paid(&lot->cost[0], extra, m->price) };
		count = join_bands(bands, count);
	}
	for (uint32_t i = 0; i < count; i++)
		sum += bands[i].plants * fine_share(m, bands[i].near, bands[i].far);
	return sum;
}

/* The gate that so many plants are before, the nearest bands first. */
static uint32_t gate_of(const struct lod_market *m, uint32_t plant, double near)
{
	uint32_t gate = 0;
	for (uint32_t band = 0; band < m->gates_most[plant] && near > 0; band++) {
		uint32_t s = lod_market_whole(m, plant, (uint8_t)band);
		if (s == ECO_NONE)
			continue;
		double plants = (double)m->counts[s], share = near < plants ? near / plants : 1;
		gate = eco_gate_place((uint8_t)band, (uint32_t)(share * ECO_SHARE_ONE));
		near -= plants;
	}
	return gate;
}

/* What the cells of each band of a plant come to, and up to where they are worth it. */
static void price_gates(struct lod_market *m)
{
	struct lod_planning *p = m->p;
	lod_market_cells(m, sum_cells);
	for (uint32_t plant = 0; plant < p->scene->plant_count; plant++) {
		if (m->price <= 0)
			p->gates[plant] = gate_of(m, plant, INFINITY);
		else if (m->gates_held[plant])
			p->gates[plant] = (uint32_t)(m->gates_held[plant] - 1) * ECO_SHARE_ONE;
		else
			p->gates[plant] = gate_of(m, plant, count_near(m, plant));
	}
}

static struct lod_cost plants_cost(const struct lod_market *m, uint32_t n)
{
	const struct lod_node *node = &m->p->visible.nodes[n];
	double factor = m->stalls[n].factor;
	struct lod_cost sum = { 0 };
	for (uint32_t i = 0; i < node->tally_count; i++) {
		const struct lod_tally *t = &node->tallies[i];
		const struct lod_slot *slot = &m->p->visible.slots[t->slot];
		const struct lod_lot *lot = &m->lots[t->slot];
		double near = lod_planning_near(m->p, slot->plant, slot->cell ? t->whole_band : slot->band) * t->count, extra = lot->extra;
		if (near > 0)
			add_cost(&sum, &lot->cost[1], extra, near, near * factor);
		if (!slot->cell && near < t->count)
			add_cost(&sum, &lot->cost[0], extra, t->count - near, (t->count - near) * factor);
	}
	return sum;
}

/* How far a tile is open whose plants and children save so much, and its summary so much. */
static double open_share(const struct lod_market *m, const struct lod_stall *stall, double plants, double summary)
{
	if (!stall->summary || m->price <= 0)
		return 1;
	if (stall->held != LOD_HELD_NOT)
		return stall->held == LOD_HELD_OPEN;
	double share = fine_share(m, plants, summary), least = m->sharp || !(plants > 0) ? 0 : 1 - stall->shut_most;
	return share < least ? least : share;
}

/* Points stand for the plants that are left, but no one knows which are whose: all stay until half of the plants are there. */
static double points_share(double share) { return share < 0.5 ? 1 : 2 * (1 - share); }

static void mix(struct lod_stall *stall, const struct lod_cost *fine)
{
	double s = stall->share, points = stall->summary ? points_share(s) : 0;
	stall->cost.fp = s * fine->fp + (1 - s) * stall->cost.fp;
	stall->cost.fn = s * fine->fn + (1 - s) * stall->cost.fn;
	stall->cost.vertices = s * fine->vertices + points * stall->cost.vertices;
}

/* What the summary comes to at the price; false where that need not be known: the tile draws its plants and children alone, as they save
 * `plants`. */
static bool price_summary(struct lod_market *m, struct lod_stall *stall, double plants)
{
	struct lod_points *points = &stall->points;
	double price = m->price / stall->worth;
	m->p->looks++;
	do {
		if (stall->open && open_share(m, stall, plants, stall->worth * lod_points_most(points, price)) >= 1)
			return false;
	} while (lod_points_step(points, price));
	stall->position = lod_steps_position(&points->steps, price, 0);
	buy(&stall->cost, &points->steps, stall->worth, stall->position);
	stall->cost.fp *= points->steps.extra;
	return true;
}

static struct lod_cost fine_cost(const struct lod_market *m, uint32_t n)
{
	const struct lod_node *node = &m->p->visible.nodes[n];
	struct lod_cost fine = plants_cost(m, n);
	for (uint32_t c = 0; c < node->child_count; c++)
		add_cost(&fine, &m->stalls[node->child_first + c].cost, 1, 1, 1);
	return fine;
}

/* Children follow their parents. */
static void price_stalls(struct lod_market *m)
{
	for (uint32_t n = m->p->visible.node_count; n-- > 0;) {
		struct lod_stall *stall = &m->stalls[n];
		struct lod_cost fine = stall->open ? fine_cost(m, n) : (struct lod_cost){ .fn = stall->worth };
		double plants = stall->worth - paid(&fine, 1, m->price);
		stall->cost = (struct lod_cost){ 0 };
		stall->position = 0;
		if (!stall->summary)
			stall->cost.fn = stall->worth;
		stall->share = stall->open;
		if (stall->summary && price_summary(m, stall, plants) && stall->open)
			stall->share = open_share(m, stall, plants, stall->worth - paid(&stall->cost, 1, m->price));
		stall->opened = stall->share >= 0.5;
		if (stall->open)
			mix(stall, &fine);
	}
}

static void widen(const struct lod_steps *steps, double worth, double *high, double *low)
{
	for (uint32_t i = 1; i < steps->count && lod_steps_price(steps, i) > 0; i++) {
		double price = lod_steps_price(steps, i) * worth;
		*high = fmax(*high, price * LOD_STEPS_BLUR);
		*low = fmin(*low, price / LOD_STEPS_BLUR);
	}
}

static void widen_points(const struct lod_stall *stall, double *high, double *low)
{
	double first, last;
	lod_points_prices(&stall->points, &first, &last);
	*high = fmax(*high, first * stall->worth * LOD_STEPS_BLUR);
	if (last > 0)
		*low = fmin(*low, last * stall->worth / LOD_STEPS_BLUR);
}

void lod_market_prices(const struct lod_market *m, double *high, double *low)
{
	*high = 0;
	*low = INFINITY;
	for (uint32_t i = 0; i < m->offer_count; i++)
		widen(&m->offers[i].steps, m->offers[i].worth, high, low);
	for (uint32_t n = 0; n < m->p->visible.node_count; n++)
		if (m->stalls[n].summary)
			widen_points(&m->stalls[n], high, low);
}

void lod_market_price(struct lod_market *m, double price)
{
	m->price = price;
	m->p->looks += m->offer_count;
	price_lots(m);
	price_gates(m);
	price_stalls(m);
	m->cost = m->stalls[0].cost;
}

/* ---- The picture ---- */

static struct lod_wrong wrong_of(void *ctx, const struct lod_sight *sight)
{
	const struct lod_market *m = ctx;
	uint32_t in = m->drawn_by[sight->node];
	const struct lod_stall *stall = &m->stalls[in];
	struct lod_cost cost = { .fn = 1 };
	double worth = 1;
	if (sight->slot != ECO_NONE && in == sight->node && stall->opened) {
		const struct lod_slot *slot = &m->p->visible.slots[sight->slot];
		const struct lod_lot *lot = &m->lots[sight->slot];
		bool near = eco_gate_place(slot->band, sight->hash) < m->p->gates[slot->plant];
		double count = (double)m->counts[sight->slot];
		cost = lot->cost[near];
		worth = lot->worth[near];
		if (near && count > 0) {
			add_cost(&cost, &lot->cells, 1, 0, 1 / count);
			worth += lot->cells_worth / count;
		}
		cost.fp += sight->above * (cost.above_fp - cost.fp);
		cost.fn += sight->above * (cost.above_fn - cost.fn);
	} else if (stall->summary) {
		cost = (struct lod_cost){ 0 };
		buy(&cost, &stall->points.steps, 1, stall->position);
		cost.fn = lod_points_missed(&stall->points, cost.fn);
	}
	return worth > 0 ? (struct lod_wrong){ cost.fp / worth, fmin(1, cost.fn / worth) } : (struct lod_wrong){ 0 };
}

/* Which tile's choice each tile is drawn by: its own where all above it are open. */
static void find_drawn_by(struct lod_market *m)
{
	const struct lod_visible *visible = &m->p->visible;
	m->drawn_by[0] = 0;
	for (uint32_t n = 0; n < visible->node_count; n++)
		for (uint32_t c = 0; visible->nodes[n].expanded && c < visible->nodes[n].child_count; c++)
			m->drawn_by[visible->nodes[n].child_first + c] = m->drawn_by[n] == n && m->stalls[n].opened
				? visible->nodes[n].child_first + c : m->drawn_by[n];
}

enum eco_code lod_market_expect(struct lod_market *m, struct eco_prediction *prediction, struct eco_error *error)
{
	find_drawn_by(m);
	return lod_screen_expect(&m->p->screen, wrong_of, m, prediction, error);
}

/* Of a summary that is drawn beside plants: the points of the last price, fewer of them, each as large. */
static void settle_points(struct lod_stall *stall, double points)
{
	uint32_t whole = (uint32_t)stall->position;
	const struct lod_amount *a = &stall->points.steps.amounts[whole];
	double part = stall->position - whole, all = (double)a->vertices + (part > 0 ? part * (double)(a[1].vertices - a->vertices) : 0);
	stall->part[0] = (struct lod_amount){ .vertices = (uint64_t)(points * floor(all)), .fp = a->fp, .fn = a->fn };
	if (part > 0) {
		stall->part[0].fp += part * (a[1].fp - a->fp);
		stall->part[0].fn += part * (a[1].fn - a->fn);
	}
	stall->part[1] = stall->part[0];
	stall->part[1].vertices = (uint64_t)all;
	stall->part[1].fn_price = LAST_PRICE;
	stall->parts = (struct lod_steps){ stall->part, stall->part[1].vertices > stall->part[0].vertices ? 2 : 1, stall->points.steps.extra };
}

void lod_market_settle(struct lod_market *m)
{
	struct lod_visible *visible = &m->p->visible;
	find_drawn_by(m);
	for (uint32_t n = 0; n < visible->node_count; n++)
		m->stalls[n].weight = n == 0;
	for (uint32_t n = 0; n < visible->node_count; n++) {
		struct lod_node *node = &visible->nodes[n];
		struct lod_stall *stall = &m->stalls[n];
		double plants = stall->open ? stall->weight * stall->share : 0;
		node->points = stall->summary ? stall->weight * points_share(stall->share) : 0;
		node->left = (uint32_t)((1 - plants) * ECO_SHARE_ONE);
		node->state = stall->open && node->left < ECO_SHARE_ONE ? LOD_OPEN : node->points > 0 ? LOD_SUMMARY : LOD_CLOSED;
		if (node->state != LOD_OPEN)
			node->left = 0;
		if (node->points >= 1 && node->state == LOD_SUMMARY)         /* its amounts are for what is left of the budget to decide */
			lod_points_all(&stall->points);
		if (node->points > 0 && (node->points < 1 || node->state == LOD_OPEN))
			settle_points(stall, node->points);
		for (uint32_t c = 0; node->expanded && c < node->child_count; c++)
			m->stalls[node->child_first + c].weight = plants;
	}
	lod_visible_recount(visible, m->p->gates);
}
