/* See lod/plan/allocation.h. */
#include "lod/plan/allocation.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Adds a use of a cell to those of all open tiles. `first`, per slot, and `next`: lists of a cell's uses;
 * index + 1. */
static void add_cell(struct lod_uses *uses, const struct lod_use *use, uint32_t *first, uint32_t *next)
{
	uint32_t i = first[use->slot];
	while (i && uses->cells[i - 1].whole != use->whole)
		i = next[i - 1];
	if (i) {
		uses->cells[i - 1].count += use->count;
		return;
	}
	uses->cells[uses->cell_count] = *use;
	next[uses->cell_count++] = first[use->slot];
	first[use->slot] = uses->cell_count;
}

static void fill(struct lod_allocation *m, uint32_t *first, uint32_t *next)
{
	const struct lod_visible_tree *visible = &m->p->visible;
	uint32_t count = 0;
	for (uint32_t n = 0; n < visible->node_count; n++) {
		m->uses.first[n] = count;
		for (uint32_t i = 0; m->tile_choices[n].open && i < visible->nodes[n].tally_count; i++) {
			const struct lod_tally *t = &visible->nodes[n].tallies[i];
			const struct lod_slot *slot = &visible->slots[t->slot];
			struct lod_use *use = &m->uses.items[count++];
			*use = (struct lod_use){ t->slot, t->slot, t->count };
			if (!slot->cell)
				continue;
			use->whole = lod_allocation_slot(m, slot->plant, t->whole_band);
			add_cell(&m->uses, use, first, next);
		}
	}
	m->uses.first[visible->node_count] = count;
}

/* The same uses by slot, of each slot by node. */
static void fill_by_slot(struct lod_uses *uses, uint32_t nodes, uint32_t slots)
{
	uint32_t *to = uses->slot_first + 1;     /* where a slot's next use goes; afterwards where it ends */
	for (uint32_t i = 0; i < uses->first[nodes]; i++)
		if (uses->items[i].slot + 1 < slots)
			to[uses->items[i].slot + 1]++;
	for (uint32_t s = 1; s < slots; s++)
		to[s] += to[s - 1];
	for (uint32_t n = 0; n < nodes; n++)
		for (uint32_t i = uses->first[n]; i < uses->first[n + 1]; i++)
			uses->by_slot[to[uses->items[i].slot]++] = (struct lod_slot_use){ n,
				uses->items[i].whole, uses->items[i].count };
}

/* Nothing is summed yet. */
static void forget_sums(struct lod_uses *uses, uint32_t nodes, uint32_t slots)
{
	memset(uses->stale, true, nodes * sizeof *uses->stale);
	memset(uses->moved, true, slots * sizeof *uses->moved);
	for (uint32_t n = 0; n < nodes; n++)
		uses->weight[n] = NAN;
}

enum eco_code lod_uses_make(struct lod_allocation *m, struct eco_error *error)
{
	const struct lod_visible_tree *visible = &m->p->visible;
	struct lod_uses *uses = &m->uses;
	uint32_t count = 0, slots = visible->slot_count, nodes = visible->node_count;
	for (uint32_t n = 0; n < nodes; n++)
		count += m->tile_choices[n].open ? visible->nodes[n].tally_count : 0;
	uint32_t *first = calloc(slots + 1u, sizeof *first), *next = malloc((count + 1u) * sizeof *next);
	struct lod_arena *a = &m->memory;
	uses->items = lod_arena_try(a, count, sizeof *uses->items);
	uses->cells = lod_arena_try(a, count, sizeof *uses->cells);
	uses->by_slot = lod_arena_try(a, count, sizeof *uses->by_slot);
	uses->first = lod_arena_try(a, nodes + 1u, sizeof *uses->first);
	uses->slot_first = lod_arena_try(a, slots + 1u, sizeof *uses->slot_first);
	uses->near = lod_arena_try(a, slots, sizeof *uses->near);
	uses->each = lod_arena_try(a, slots, sizeof *uses->each);
	uses->drawn = lod_arena_try(a, slots, sizeof *uses->drawn);
	uses->seen = lod_arena_try(a, slots, sizeof *uses->seen);
	uses->moved = lod_arena_try(a, slots, sizeof *uses->moved);
	uses->redrawn = lod_arena_try(a, slots, sizeof *uses->redrawn);
	uses->own = lod_arena_try(a, nodes, sizeof *uses->own);
	uses->stale = lod_arena_try(a, nodes, sizeof *uses->stale);
	uses->reach = lod_arena_try(a, nodes, sizeof *uses->reach);
	uses->weight = lod_arena_try(a, nodes, sizeof *uses->weight);
	bool good = first && next && !a->failed;
	if (good) {
		fill(m, first, next);
		fill_by_slot(uses, nodes, slots);
		forget_sums(uses, nodes, slots);
	}
	free(first);
	free(next);
	return good ? ECO_OK : eco_fail(error, ECO_NO_MEMORY, "planning: no memory for the plants of %u "
		"tiles", nodes);
}

void lod_uses_sum_cells(struct lod_allocation *m)
{
	for (uint32_t i = 0; i < m->uses.cell_count; i++) {
		const struct lod_use *use = &m->uses.cells[i];
		const struct lod_slot_choice *cell = &m->slot_choices[use->slot];
		struct lod_slot_choice *whole = &m->slot_choices[use->whole];
		lod_cost_add(&whole->cells, &cell->cost[1], 1, use->count, use->count);
		whole->cells_weight_px += use->count * cell->weight_px[1];
	}
}

static bool is_same(const struct lod_cost *a, const struct lod_cost *b)
{
	return a->alike == b->alike && a->open == b->open && a->vertices == b->vertices;
}

/* Another `near` draws more or fewer of a plant's cells, which stand in the plant's tiles. Returns uses passed. */
static uint64_t set_each(struct lod_uses *uses, uint32_t s, double near, const struct lod_cost *cost)
{
	if (uses->near[s] == near && is_same(&uses->each[s], cost))
		return 0;
	uses->moved[s] |= uses->near[s] != near;
	uses->near[s] = near;
	uses->each[s] = *cost;
	for (uint32_t i = uses->slot_first[s]; i < uses->slot_first[s + 1]; i++)
		uses->stale[uses->by_slot[i].node] = true;
	return uses->slot_first[s + 1] - uses->slot_first[s];
}

void lod_uses_set_each(struct lod_allocation *m)
{
	uint64_t looks = 0;
	for (uint32_t s = 0; s < m->p->visible.slot_count; s++) {
		const struct lod_slot *slot = &m->p->visible.slots[s];
		const struct lod_slot_choice *choice = &m->slot_choices[s];
		double near = slot->cell ? 1 : lod_planner_near(m->p, slot->plant, slot->band),
			far = 1 - near;
		struct lod_cost cost = { 0 };
		if (near > 0)
			lod_cost_add(&cost, &choice->cost[1], choice->open, near, near);
		if (far > 0)
			lod_cost_add(&cost, &choice->cost[0], choice->open, far, far);
		looks += set_each(&m->uses, s, near, &cost);
	}
	lod_planner_work(m->p, LOD_WORK_TALLY * looks);
}

static struct lod_cost sum_own(const struct lod_allocation *m, uint32_t n)
{
	double factor = m->tile_choices[n].factor;
	struct lod_cost sum = { 0 };
	for (uint32_t i = m->uses.first[n]; i < m->uses.first[n + 1]; i++) {
		const struct lod_use *use = &m->uses.items[i];
		double count = use->whole == use->slot ? use->count : use->count * m->uses.near[use->whole];
		const struct lod_cost *each = &m->uses.each[use->slot];
		sum.alike += count * each->alike;
		sum.open += count * each->open;
		sum.vertices += count * each->vertices;
	}
	sum.alike *= factor;
	sum.open *= factor;
	return sum;
}

struct lod_cost lod_uses_cost(const struct lod_allocation *m, uint32_t n)
{
	if (m->uses.stale[n]) {
		m->uses.own[n] = sum_own(m, n);
		m->uses.stale[n] = false;
		lod_planner_work(m->p, LOD_WORK_TALLY * (uint64_t)(m->uses.first[n + 1] - m->uses.first[n]));
	}
	return m->uses.own[n];
}

/* Sets the weights of tiles, and marks the slots of those that are others. Returns uses passed. */
static uint64_t weigh_tiles(struct lod_allocation *m)
{
	const struct lod_visible_tree *visible = &m->p->visible;
	struct lod_uses *uses = &m->uses;
	uint64_t looks = 0;
	uses->reach[0] = 1;
	for (uint32_t n = 0; n < visible->node_count; n++) {
		const struct lod_node *node = &visible->nodes[n];
		const struct lod_tile_choice *choice = &m->tile_choices[n];
		double weight = choice->open ? uses->reach[n] * choice->share : 0;
		for (uint32_t c = 0; node->expanded && c < node->child_count; c++)
			uses->reach[node->child_first + c] = weight;
		if (uses->weight[n] == weight)
			continue;
		uses->weight[n] = weight;
		for (uint32_t i = uses->first[n]; i < uses->first[n + 1]; i++)
			uses->redrawn[uses->items[i].slot] = true;
		looks += uses->first[n + 1] - uses->first[n];
	}
	return looks;
}

static void sum_slot(struct lod_allocation *m, uint32_t s)
{
	struct lod_uses *uses = &m->uses;
	uses->drawn[s] = uses->seen[s] = 0;
	for (uint32_t i = uses->slot_first[s]; i < uses->slot_first[s + 1]; i++) {
		const struct lod_slot_use *use = &uses->by_slot[i];
		if (!(uses->weight[use->node] > 0))
			continue;
		double count = uses->weight[use->node] * use->count
			* (use->whole == s ? 1 : uses->near[use->whole]);
		uses->drawn[s] += count;
		uses->seen[s] += count * m->tile_choices[use->node].factor;
	}
}

void lod_uses_sum_drawn(struct lod_allocation *m)
{
	struct lod_uses *uses = &m->uses;
	uint32_t slots = m->p->visible.slot_count;
	memset(uses->redrawn, false, slots * sizeof *uses->redrawn);
	uint64_t looks = weigh_tiles(m);
	for (uint32_t i = 0; i < uses->cell_count; i++)
		uses->redrawn[uses->cells[i].slot] |= uses->moved[uses->cells[i].whole];
	memset(uses->moved, false, slots * sizeof *uses->moved);
	for (uint32_t s = 0; s < slots; s++)
		if (uses->redrawn[s]) {
			sum_slot(m, s);
			looks += uses->slot_first[s + 1] - uses->slot_first[s];
		}
	lod_planner_work(m->p, LOD_WORK_TALLY * looks);
}
