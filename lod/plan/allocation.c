/* The relaxation at a lambda: see lod/plan/allocation.h.
 * Longer than 600 lines: slots, gates and tiles are relaxed together. */
#include "lod/plan/allocation.h"

#include <math.h>
#include <string.h>

#include "lod/plan/byte_price.h"

/* ---- At a lambda ---- */

static void add_at(struct lod_cost *cost, const struct lod_hull *hull, double weight_px, double position)
{
	uint32_t whole = (uint32_t)position;
	double part = position - whole;
	const struct lod_hull_point *a = &hull->points[whole], *b = part > 0 ? a + 1 : a;
	cost->alike += weight_px * (a->alike + part * (b->alike - a->alike));
	cost->open += weight_px * (a->open + part * (b->open - a->open));
	cost->vertices += (double)a->vertices + part * (double)(b->vertices - a->vertices);
}

static double lagrangian(const struct lod_allocation *m, const struct lod_cost *cost, double open)
{
	return cost->alike + open * cost->open + m->lambda * cost->vertices
		+ m->price * cost->bytes;
}

/* Share of the fine choice, which is better than the coarse one by `gain`: 0 to 1, between them where that is
 * less than `width` either way. */
static double fine_share(const struct lod_allocation *m, double gain, double width)
{
	if (m->few_plants || !(width > 0))
		return gain > 0;
	double share = 0.5 + gain / (2 * width);
	return share < 0 ? 0 : share > 1 ? 1 : share;
}

static struct lod_cost whole_cost(const struct lod_allocation *m, uint32_t ladder_choice)
{
	const struct lod_ladder_choice *choice = &m->ladder_choices[ladder_choice];
	struct lod_cost cost = { 0 };
	add_at(&cost, &choice->hull, choice->weight_px, choice->position);
	return cost;
}

/* Whether a far plant's organs are all that there is of it; those of a plant with cells are coarse. */
static bool is_whole_detail(const struct lod_allocation *m, const struct lod_slot *slot)
{
	return slot->band < m->gates_counted[slot->plant] || m->p->scene->plants[slot->plant].anchor_count < 2;
}

/* Share of far plants that draw the ladder which costs `whole`, in place of organs that cost `organs`. Both are
 * nearly right, so a tie is measured by what differs between them, not by all that they save
 * (lod/EXPERIMENTS.md, Ties of splats). */
static double whole_share(const struct lod_allocation *m, const struct lod_slot_choice *choice,
	const struct lod_cost *organs, const struct lod_cost *whole)
{
	uint32_t slot = (uint32_t)(choice - m->slot_choices);
	if (lod_prices_organs_off(m, m->p->visible.slots[slot].plant))
		return 1;
	if (m->lambda <= 0 && is_whole_detail(m, &m->p->visible.slots[slot]))
		return 0;
	double spent = m->lambda * (organs->vertices - whole->vertices),
		gain = lagrangian(m, whole, choice->open) - lagrangian(m, organs, choice->open);
	return 1 - fine_share(m, gain, LOD_TIE_STEP * (fabs(gain + spent) + fabs(spent)));
}

/* Sets the mean cost of far plants: some draw organs, at cost[0] each, and others are shown whole. */
static void blend_whole(const struct lod_allocation *m, struct lod_slot_choice *choice)
{
	const struct lod_cost organs = choice->cost[0], whole = whole_cost(m, choice->whole);
	const double share = choice->whole_share;
	choice->cost[0] = (struct lod_cost){ 0 };
	lod_cost_add(&choice->cost[0], &organs, 1, 1 - share, 1 - share);
	lod_cost_add(&choice->cost[0], &whole, 1, share, share);
}

/* Takes the best of the ladders that show the whole plant, and blends it with the organs, in cost[0]. */
static void relax_whole(struct lod_allocation *m, struct lod_slot_choice *choice)
{
	uint32_t end = choice->ladder_choice_first + choice->ladder_choice_count;
	struct lod_cost organs = choice->cost[0], best = { 0 };
	double least = INFINITY;
	for (uint32_t i = end - choice->whole_count; i < end; i++) {
		struct lod_cost cost = whole_cost(m, i);
		double l = lagrangian(m, &cost, choice->open);
		if (l < least) {
			least = l;
			best = cost;
			choice->whole = i;
		}
	}
	choice->whole_share = whole_share(m, choice, &organs, &best);
	choice->whole_saved = choice->weight_px[0] - least;
	choice->organs_saved -= choice->whole_saved;
	blend_whole(m, choice);
}

static double position_at_lambda(const struct lod_allocation *m, const struct lod_ladder_choice *choice)
{
	if (!(choice->weight_px > 0))
		return 0;
	return lod_hull_position(&choice->hull, m->lambda / choice->weight_px, choice->position);
}

/* Sums what a slot costs at the positions of its choices; [0] by its organs alone. */
static void sum_slot(const struct lod_allocation *m, struct lod_slot_choice *slot_choice)
{
	uint32_t end = slot_choice->ladder_choice_first + slot_choice->ladder_choice_count;
	slot_choice->cost[0] = slot_choice->cost[1] = (struct lod_cost){ 0 };
	for (uint32_t i = slot_choice->ladder_choice_first; i < end; i++) {
		const struct lod_ladder_choice *choice = &m->ladder_choices[i];
		if (choice->when < LOD_NEAR)
			add_at(&slot_choice->cost[0], &choice->hull, choice->weight_px, choice->position);
		if (choice->when == LOD_ALWAYS || choice->when == LOD_NEAR)
			add_at(&slot_choice->cost[1], &choice->hull, choice->weight_px, choice->position);
	}
}

static void relax_slot(struct lod_allocation *m, struct lod_slot_choice *slot_choice)
{
	for (uint32_t i = 0; i < slot_choice->ladder_choice_count; i++) {
		struct lod_ladder_choice *choice = &m->ladder_choices[slot_choice->ladder_choice_first + i];
		choice->position = position_at_lambda(m, choice);
	}
	sum_slot(m, slot_choice);
	slot_choice->organs_saved = slot_choice->weight_px[0]
		- lagrangian(m, &slot_choice->cost[0], slot_choice->open);
	if (slot_choice->whole_count)
		relax_whole(m, slot_choice);
}

/* Bytes are none of a slot's costs, so at the same lambda it chooses the same at any price. Returns the
 * choices looked at. */
static uint64_t relax_slots(struct lod_allocation *m)
{
	uint64_t looks = 0;
	for (uint32_t s = 0; s < m->p->visible.slot_count; s++) {
		struct lod_slot_choice *slot_choice = &m->slot_choices[s];
		bool organs_off = lod_prices_organs_off(m, m->p->visible.slots[s].plant);
		slot_choice->cells = (struct lod_cost){ 0 };
		if (slot_choice->lambda == m->lambda && slot_choice->organs_off == organs_off)
			continue;
		relax_slot(m, slot_choice);
		slot_choice->lambda = m->lambda;
		slot_choice->organs_off = organs_off;
		looks += slot_choice->ladder_choice_count;
	}
	return looks;
}

struct bands { double plants, near, far, cost; };   /* bands of one plant that decide together: what they save with cells, and
                                                     * without; what cells cost */

/* Plants before a gate are the nearest, so what cells gain must fall from band to band. Bands where it rises
 * are pooled and decide as one (pool adjacent violators: Barlow and others 1972). */
static uint32_t pool_bands(struct bands *bands, uint32_t count)
{
	while (count > 1) {
		struct bands *a = &bands[count - 2], *b = &bands[count - 1];
		if (a->near * b->far >= b->near * a->far)
			break;
		*a = (struct bands){ a->plants + b->plants, a->near + b->near, a->far + b->far, a->cost + b->cost };
		count--;
	}
	return count;
}

/* Plants whose cells are worth drawing. */
static double count_near(struct lod_allocation *m, uint32_t plant)
{
	struct bands bands[ECO_BANDS];
	uint32_t count = 0;
	double sum = 0;
	for (uint32_t band = 0; band < m->gates_counted[plant]; band++) {
		uint32_t s = lod_allocation_slot(m, plant, (uint8_t)band);
		if (s == ECO_NONE)
			continue;
		struct lod_slot_choice *choice = &m->slot_choices[s];
		choice->near_saved = 0;
		if (lod_prices_organs_off(m, plant))
			break;
		double plants = (double)m->counts[s], open = choice->open,
			weight_px = plants * choice->weight_px[0];
		bands[count++] =
			(struct bands){ plants,
			weight_px - plants * lagrangian(m, &choice->cost[1], open)
			- lagrangian(m, &choice->cells, open),
			weight_px - plants * lagrangian(m, &choice->cost[0], open), 0 };
		bands[count - 1].cost = weight_px - bands[count - 1].near;
		choice->near_saved = bands[count - 1].near - bands[count - 1].far;
		count = pool_bands(bands, count);
	}
	for (uint32_t i = 0; i < count; i++)
		sum += bands[i].plants * fine_share(m, bands[i].near - bands[i].far,
			LOD_TIE_SHARE * bands[i].cost);
	return sum;
}

/* The gate with `near` plants before it, the nearest bands first. */
static uint32_t gate_of(const struct lod_allocation *m, uint32_t plant, double near)
{
	uint32_t gate = 0;
	for (uint32_t band = 0; band < m->gates_counted[plant] && near > 0; band++) {
		uint32_t s = lod_allocation_slot(m, plant, (uint8_t)band);
		if (s == ECO_NONE)
			continue;
		double plants = (double)m->counts[s], share = near < plants ? near / plants : 1;
		gate = eco_gate_place((uint8_t)band, (uint32_t)(share * ECO_SHARE_ONE));
		near -= plants;
	}
	return gate;
}

/* Sums the cells of each band, then sets each plant's gate. */
static void relax_gates(struct lod_allocation *m)
{
	struct lod_planner *p = m->p;
	lod_uses_sum_cells(m);
	for (uint32_t plant = 0; plant < p->scene->plant_count; plant++) {
		double near = m->lambda <= 0 ? INFINITY : count_near(m, plant);
		p->gates[plant] = gate_of(m, plant, near);
	}
	lod_uses_set_each(m);
}

/* Open share of a tile, given what its plants and children save, and what its summary saves. */
static double open_share(const struct lod_allocation *m, const struct lod_tile_choice *choice, double plants,
	double summary)
{
	if (!choice->has_summary || m->lambda <= 0)
		return 1;
	double share = fine_share(m, plants - summary, LOD_TIE_SHARE * (choice->weight_px - plants)),
		least = m->few_plants ? 0 : 1 - choice->closed_most;
	return !(plants > 0) ? 0 : share < least ? least : share;
}

/* Share of a summary's points that are drawn. Points stand for the plants that are not drawn yet, but nothing
 * says which point stands for which plant: all points stay until half of the plants are drawn. */
static double points_share(double share) { return share < 0.5 ? 1 : 2 * (1 - share); }

static struct lod_cost blended(const struct lod_tile_choice *choice, const struct lod_cost *fine)
{
	const struct lod_cost *coarse = &choice->cost;
	double s = choice->share, points = choice->has_summary ? points_share(s) : 0;
	struct lod_cost cost = *coarse;
	cost.alike = s * fine->alike + (1 - s) * coarse->alike;
	cost.open = s * fine->open + (1 - s) * coarse->open;
	cost.vertices = s * fine->vertices + points * coarse->vertices;
	cost.bytes = (s > 0 ? fine->bytes : 0) + (points > 0 ? coarse->bytes : 0);
	return cost;
}

/* Bytes do not blend: a tile pays all for its summary and all for what stands in it, however little of either
 * is drawn. So it draws one alone where that saves more, its summary only from where it may. */
static void blend(struct lod_allocation *m, struct lod_tile_choice *choice, const struct lod_cost *fine)
{
	const struct lod_cost both = blended(choice, fine), coarse = choice->cost;
	double least = lagrangian(m, &both, 1);
	bool pays = choice->share > 0 && choice->share < 1 && both.bytes > 0;
	choice->cost = both;
	if (pays && coarse.bytes > 0 && lagrangian(m, fine, 1) < least) {
		least = lagrangian(m, fine, 1);
		choice->share = 1;
		choice->cost = *fine;
	}
	if (pays && fine->bytes > 0 && choice->closed_most >= 1 && lagrangian(m, &coarse, 1) < least) {
		choice->share = 0;
		choice->cost = coarse;
	}
}

/* Adds what a tile's summary comes to at a position on its hull. */
static void add_summary(const struct lod_tile_choice *choice, double position, struct lod_cost *cost)
{
	add_at(cost, &choice->summary.hull, choice->weight_px, position);
	cost->open *= choice->summary.hull.open;
}

static double position_of(const struct lod_hull *hull, double vertices)
{
	uint32_t i = 0;
	while (i + 1 < hull->count && (double)hull->points[i + 1].vertices <= vertices)
		i++;
	return i + 1 < hull->count ? i + (vertices - (double)hull->points[i].vertices)
		/ (double)(hull->points[i + 1].vertices - hull->points[i].vertices) : i;
}

/* Chooses the summary where bytes have a price: whole chunks, none, or lambda's choice if the client holds it. */
static void price_summary(struct lod_allocation *m, uint32_t n)
{
	struct lod_tile_choice *choice = &m->tile_choices[n];
	const struct lod_hull *hull = &choice->summary.hull;
	uint32_t whole = (uint32_t)choice->position;
	double part = choice->position - whole, most = (double)hull->points[whole].vertices, points = most,
		least = INFINITY;
	if (part > 0)
		points += part * ((double)hull->points[whole + 1].vertices - most);
	const struct lod_summary_price up = lod_prices_summary(m, n, points),
		tries[] = { { .points = 0 }, up, lod_prices_summary(m, n, up.before) };
	for (int i = 0; i < 3; i++) {
		struct lod_cost cost = { .bytes = tries[i].bytes };
		double position = position_of(hull, tries[i].points);
		add_summary(choice, position, &cost);
		double l = lagrangian(m, &cost, 1);
		if (!(l < least))
			continue;
		least = l;
		choice->cost = cost;
		choice->position = position;
		choice->points = tries[i].points;
	}
}

/* Adds what the summary comes to at lambda to the choice's cost. */
static void relax_summary(struct lod_allocation *m, uint32_t n)
{
	struct lod_tile_choice *choice = &m->tile_choices[n];
	const struct lod_hull *hull = &choice->summary.hull;
	double each = m->price > 0 ? m->price * m->prices->points[n] : 0;
	m->p->looks++;
	choice->position = lod_hull_position(hull, (m->lambda + each) / choice->weight_px, choice->position);
	if (m->price > 0)
		price_summary(m, n);
	else
		add_summary(choice, choice->position, &choice->cost);
}

static struct lod_cost fine_cost(const struct lod_allocation *m, uint32_t n)
{
	const struct lod_node *node = &m->p->visible.nodes[n];
	struct lod_cost fine = lod_uses_cost(m, n);
	for (uint32_t c = 0; c < node->child_count; c++)
		lod_cost_add(&fine, &m->tile_choices[node->child_first + c].cost, 1, 1, 1);
	if (m->price > 0)
		fine.bytes += m->prices->instances[n];
	return fine;
}

static void relax_tile(struct lod_allocation *m, uint32_t n)
{
	struct lod_tile_choice *choice = &m->tile_choices[n];
	struct lod_cost fine = choice->open ? fine_cost(m, n) : (struct lod_cost){ .alike = choice->weight_px };
	double plants = choice->weight_px - lagrangian(m, &fine, 1);
	choice->cost = (struct lod_cost){ 0 };
	if (choice->has_summary)
		relax_summary(m, n);
	else
		choice->cost.alike = choice->weight_px;
	choice->share = choice->open;
	if (choice->has_summary && choice->open)
		choice->share = open_share(m, choice, plants,
			choice->weight_px - lagrangian(m, &choice->cost, 1));
	if (m->price > 0 && !choice->has_summary && choice->open)
		choice->share = plants > 0;      /* else not even its plants' places are sent */
	if (choice->open)
		blend(m, choice, &fine);
	choice->opened = choice->share >= 0.5;
}

/* Do its own plants or its children cost something else? */
static bool is_moved(const struct lod_allocation *m, uint32_t n)
{
	const struct lod_node *node = &m->p->visible.nodes[n];
	bool moved = m->uses.stale[n];
	for (uint32_t c = 0; c < node->child_count && !moved && m->tile_choices[n].open; c++)
		moved = m->tile_choices[node->child_first + c].moved;
	return moved;
}

/* From the last node to the first: children follow their parents. At the same lambda and price a tile chooses
 * the same again, unless limits have changed what stands in it. */
static void relax_tiles(struct lod_allocation *m)
{
	bool again = m->tiles.lambda == m->lambda && m->tiles.price == m->price;
	for (uint32_t n = m->p->visible.node_count; n-- > 0;) {
		struct lod_tile_choice *choice = &m->tile_choices[n];
		const struct lod_cost before = choice->cost;
		choice->moved = !again || (choice->open && is_moved(m, n));
		if (!choice->moved)
			continue;
		relax_tile(m, n);
		choice->moved = !again || memcmp(&before, &choice->cost, sizeof before) != 0;
	}
	m->tiles.lambda = m->lambda;
	m->tiles.price = m->price;
}

void lod_allocation_compare(const struct lod_allocation *m, uint32_t n, double *plants, double *summary)
{
	const struct lod_tile_choice *choice = &m->tile_choices[n];
	struct lod_cost fine = fine_cost(m, n), coarse = { 0 };
	add_summary(choice, lod_hull_position(&choice->summary.hull, m->lambda / choice->weight_px, 0), &coarse);
	*plants = choice->weight_px - lagrangian(m, &fine, 1);
	*summary = choice->weight_px - lagrangian(m, &coarse, 1);
}

static void relax_all(struct lod_allocation *m)
{
	uint64_t looks = relax_slots(m);
	relax_gates(m);
	relax_tiles(m);
	m->p->looks += looks;
	lod_planner_work(m->p, LOD_WORK_CHOICE * looks
		+ (m->price > 0 ? 3 : 1) * LOD_WORK_NODE
		* (uint64_t)m->p->visible.node_count);
}

void lod_allocation_relax_plants(struct lod_allocation *m, double lambda)
{
	m->lambda = lambda;
	m->relaxed.lambda = NAN;
	uint64_t looks = relax_slots(m);
	relax_gates(m);
	lod_planner_work(m->p, LOD_WORK_CHOICE * looks);
}

void lod_allocation_relax(struct lod_allocation *m, double lambda)
{
	bool limits = m->price > 0 && !m->limited;
	if (m->relaxed.lambda == lambda && m->relaxed.price == m->price && (m->limited || m->relaxed.limits == m->price))
		return;
	m->lambda = lambda;
	if (limits)
		lod_prices_lift(m);
	relax_all(m);
	for (int round = 0; limits && round < LOD_PRICE_ROUNDS; round++) {
		lod_prices_limit(m, round == 0, round + 1 == LOD_PRICE_ROUNDS);
		relax_all(m);
	}
	if (m->price > 0)
		lod_prices_tighten(m);
	m->cost = m->tile_choices[0].cost;
	m->relaxed.lambda = lambda;
	m->relaxed.price = m->price;
	m->relaxed.limits = m->limited ? m->relaxed.limits : m->price;
}

/* ---- The picture ---- */

/* The tile's summary, for all plants in it. */
static struct lod_splats summary_splats(const struct lod_tile_choice *choice)
{
	struct lod_cost cost = { 0 };
	add_at(&cost, &choice->summary.hull, 1, choice->position);
	double points = choice->summary.part * cost.vertices;
	const double scale = lod_summary_hull_scale(&choice->summary, (uint64_t)ceil(cost.vertices));
	return (struct lod_splats){ points, points > 0 ? sqrt(choice->summary.view.area * scale / points) : 0 };
}

/* Sets what tiles draw, and how much of their splats each visibility has. */
static void set_drawn(struct lod_allocation *m)
{
	const struct lod_screen *screen = &m->p->screen;
	uint64_t summaries = 0;
	for (uint32_t n = 0; n < m->p->visible.node_count; n++) {
		struct lod_tile_choice *choice = &m->tile_choices[n];
		bool summary = choice->has_summary && m->drawn_by[n] == n && choice->position > 0;
		m->drawn_here[n] = m->drawn_by[n] == n && choice->opened;
		choice->leaves = 0;
		choice->splats = summary ? summary_splats(choice) : (struct lod_splats){ 0, 0 };
		summaries += summary;
	}
	for (uint32_t i = 0; i < screen->count; i++)
		m->tile_choices[m->drawn_by[screen->visibilities[i].node]].leaves +=
			(double)screen->visibilities[i].leaves;
	lod_planner_work(m->p, LOD_WORK_SUMMARY / 4 * summaries
		+ (summaries > 0) * LOD_WORK_CELL * (uint64_t)screen->columns * screen->rows);
}

/* Adds to one of [2] what a choice leaves at its position. */
static void add_wrong(struct lod_slot_wrong *sum, int near, const struct lod_ladder_choice *choice, double share)
{
	const uint32_t whole = (uint32_t)choice->position;
	const double part = choice->position - whole, px = share * choice->weight_px;
	const struct lod_hull_point *a = &choice->hull.points[whole], *b = part > 0 ? a + 1 : a;
	sum->at[near].fp += px * (a->fp + part * (b->fp - a->fp));
	sum->at[near].fn += px * (a->fn + part * (b->fn - a->fn));
	sum->above[near].fp += px * (a->above_fp + part * (b->above_fp - a->above_fp));
	sum->above[near].fn += px * (a->above_fn + part * (b->above_fn - a->above_fn));
}

static void sum_slot_wrong(struct lod_allocation *m, uint32_t s)
{
	const struct lod_slot_choice *slot_choice = &m->slot_choices[s];
	struct lod_slot_wrong *sum = &m->slot_wrong[s];
	const double organs = slot_choice->whole_count ? 1 - slot_choice->whole_share : 1;
	*sum = (struct lod_slot_wrong){ .px = { slot_choice->weight_px[0], slot_choice->weight_px[1] } };
	for (uint32_t i = 0; i < slot_choice->ladder_choice_count; i++) {
		const struct lod_ladder_choice *choice = &m->ladder_choices[slot_choice->ladder_choice_first + i];
		if (choice->when < LOD_NEAR)
			add_wrong(sum, 0, choice, organs);
		if (choice->when == LOD_ALWAYS || choice->when == LOD_NEAR)
			add_wrong(sum, 1, choice, 1);
	}
	if (organs < 1)
		add_wrong(sum, 0, &m->ladder_choices[slot_choice->whole], 1 - organs);
}

static void add_cells_wrong(struct lod_allocation *m, const struct lod_use *use)
{
	const struct lod_slot_wrong *cell = &m->slot_wrong[use->slot];
	struct lod_slot_wrong *whole = &m->slot_wrong[use->whole];
	const double each = m->counts[use->whole] ? use->count / (double)m->counts[use->whole] : 0;
	whole->px[1] += each * cell->px[1];
	whole->at[1].fp += each * cell->at[1].fp;
	whole->at[1].fn += each * cell->at[1].fn;
	whole->above[1].fp += each * cell->above[1].fp;
	whole->above[1].fn += each * cell->above[1].fn;
}

static void set_slot_wrong(struct lod_allocation *m, uint32_t s)
{
	const struct lod_slot *slot = &m->p->visible.slots[s];
	struct lod_slot_wrong *wrong = &m->slot_wrong[s];
	wrong->near_end = lod_near_end(m->p->gates[slot->plant], slot->band);
	for (int near = 0; near < 2; near++) {
		const double each = wrong->px[near] > 0 ? 1 / wrong->px[near] : 0;
		const struct lod_wrong at = wrong->at[near], above = wrong->above[near];
		wrong->at[near] = (struct lod_wrong){ each * at.fp, each * at.fn };
		wrong->above[near] = (struct lod_wrong){ each * above.fp, each * above.fn };
	}
}

static struct lod_drawn drawn_of(void *ctx, const struct lod_visibility *visibility)
{
	const struct lod_allocation *m = ctx;
	if (visibility->slot == ECO_NONE || !m->drawn_here[visibility->node]) {
		const struct lod_tile_choice *tile = &m->tile_choices[m->drawn_by[visibility->node]];
		double part = tile->leaves > 0 ? (double)visibility->leaves / tile->leaves : 0;
		return part * tile->splats.count > 0
			? (struct lod_drawn){ .splats = { part * tile->splats.count, tile->splats.side } }
			: (struct lod_drawn){ .wrong.fn = 1 };
	}
	const struct lod_slot_wrong *slot = &m->slot_wrong[visibility->slot];
	bool near = visibility->hash < slot->near_end;
	struct lod_wrong wrong = slot->at[near];
	wrong.fp += (double)visibility->above * (slot->above[near].fp - wrong.fp);
	wrong.fn += (double)visibility->above * (slot->above[near].fn - wrong.fn);
	wrong.fn = wrong.fn < 1 ? wrong.fn : 1;
	return (struct lod_drawn){ .wrong = wrong };
}

/* Sets for each tile the tile whose choice draws it: itself where all tiles above it are open. */
static void find_drawn_by(struct lod_allocation *m)
{
	const struct lod_visible_tree *visible = &m->p->visible;
	m->drawn_by[0] = 0;
	for (uint32_t n = 0; n < visible->node_count; n++)
		for (uint32_t c = 0; visible->nodes[n].expanded && c < visible->nodes[n].child_count; c++)
			m->drawn_by[visible->nodes[n].child_first + c] = m->drawn_by[n] == n
				&& m->tile_choices[n].opened
				? visible->nodes[n].child_first + c : m->drawn_by[n];
}

enum eco_code lod_allocation_predict(struct lod_allocation *m, struct eco_prediction *prediction,
	struct eco_error *error)
{
	find_drawn_by(m);
	for (uint32_t s = 0; s < m->p->visible.slot_count; s++)
		sum_slot_wrong(m, s);
	for (uint32_t i = 0; i < m->uses.cell_count; i++)
		add_cells_wrong(m, &m->uses.cells[i]);
	for (uint32_t s = 0; s < m->p->visible.slot_count; s++)
		if (!m->p->visible.slots[s].cell)
			set_slot_wrong(m, s);
	set_drawn(m);
	lod_planner_work(m->p, LOD_WORK_CHOICE * (uint64_t)m->ladder_choice_count
		+ LOD_WORK_VISIBILITY / 4 * (uint64_t)m->p->screen.count
		+ LOD_WORK_CELL * m->cells / 8);
	return lod_screen_expect(&m->p->screen, drawn_of, m, prediction, error);
}

/* A summary beside plants keeps the points of the last lambda, less those whose plants are drawn; the size of
 * each stays. */
static void fix_summary(struct lod_tile_choice *choice, double points)
{
	struct lod_cost cost = { 0 };
	add_at(&cost, &choice->summary.hull, 1, choice->position);
	choice->all_points = (uint64_t)cost.vertices;
	choice->partial = (struct lod_hull_point){ .vertices = (uint64_t)(points * floor(cost.vertices)),
		.alike = cost.alike, .open = cost.open };
	choice->partial_hull = (struct lod_hull){ &choice->partial, 1, choice->summary.hull.open, 0, ECO_NONE };
}

/* A summary's hull up to the points that were chosen. */
static void limit_summary(struct lod_allocation *m, uint32_t n)
{
	struct lod_tile_choice *choice = &m->tile_choices[n];
	const struct lod_hull *hull = &choice->summary.hull;
	double position = position_of(hull, choice->points), part = position - floor(position);
	uint32_t whole = (uint32_t)position;
	struct lod_hull_point *points = choice->limited.points;
	memcpy(points, hull->points, (whole + 1) * sizeof *points);
	if (part > 0) {
		const struct lod_hull_point *a = &hull->points[whole], *b = a + 1;
		points[whole + 1] = *b;
		points[whole + 1].vertices = (uint64_t)choice->points;
		points[whole + 1].alike = a->alike + part * (b->alike - a->alike);
		points[whole + 1].open = a->open + part * (b->open - a->open);
	}
	choice->limited = (struct lod_hull){ points, whole + 1 + (part > 0), hull->open, 0, ECO_NONE };
}

/* Beyond the gate, the plants of the greatest hashes draw a ladder that shows the whole plant. */
static void fix_whole(struct lod_allocation *m)
{
	struct lod_visible_tree *visible = &m->p->visible;
	for (uint32_t s = 0; m->has_whole && s < visible->slot_count; s++) {
		struct lod_slot *slot = &visible->slots[s];
		uint32_t near = lod_near_end(m->p->gates[slot->plant], slot->band);
		double organs = 1 - m->slot_choices[s].whole_share;
		slot->whole_from = organs > 0 ? near + (uint32_t)(organs * (ECO_SHARE_ONE - near)) : 0;
	}
}

void lod_allocation_fix(struct lod_allocation *m)
{
	struct lod_visible_tree *visible = &m->p->visible;
	find_drawn_by(m);
	fix_whole(m);
	for (uint32_t n = 0; n < visible->node_count; n++)
		m->tile_choices[n].weight = n == 0;
	for (uint32_t n = 0; n < visible->node_count; n++) {
		struct lod_node *node = &visible->nodes[n];
		struct lod_tile_choice *choice = &m->tile_choices[n];
		double plants = choice->open ? choice->weight * choice->share : 0;
		node->points = choice->has_summary ? choice->weight * points_share(choice->share) : 0;
		node->left = (uint32_t)((1 - plants) * ECO_SHARE_ONE);
		node->state = choice->open && node->left < ECO_SHARE_ONE ? LOD_OPEN : node->points > 0
			? LOD_SUMMARY : LOD_CLOSED;
		if (node->state != LOD_OPEN)
			node->left = 0;
		if (m->price > 0 && node->points >= 1 && node->state == LOD_SUMMARY)
			limit_summary(m, n);
		if (node->points > 0 && (node->points < 1 || node->state == LOD_OPEN))
			fix_summary(choice, node->points);
		for (uint32_t c = 0; node->expanded && c < node->child_count; c++)
			m->tile_choices[node->child_first + c].weight = plants;
	}
	lod_visible_tree_recount(visible, m->p->gates);
	lod_planner_work(m->p, LOD_WORK_TALLY * m->tallies + LOD_WORK_NODE * (uint64_t)visible->node_count);
}
