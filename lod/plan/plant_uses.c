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
	uses->first = lod_arena_try(a, nodes + 1u, sizeof *uses->first);
	uses->near = lod_arena_try(a, slots, sizeof *uses->near);
	uses->each = lod_arena_try(a, slots, sizeof *uses->each);
	uses->drawn = lod_arena_try(a, slots, sizeof *uses->drawn);
	uses->seen = lod_arena_try(a, slots, sizeof *uses->seen);
	uses->moved = lod_arena_try(a, slots, sizeof *uses->moved);
	uses->own = lod_arena_try(a, nodes, sizeof *uses->own);
	uses->stale = lod_arena_try(a, nodes, sizeof *uses->stale);
	uses->reach = lod_arena_try(a, nodes, sizeof *uses->reach);
	bool good = first && next && !a->failed;
	if (good) {
		fill(m, first, next);
		memset(uses->stale, true, nodes * sizeof *uses->stale);
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
	}
}

static bool is_same(const struct lod_cost *a, const struct lod_cost *b)
{
	return a->alike == b->alike && a->open == b->open && a->vertices == b->vertices;
}

/* One pass over all uses. */
static void count_pass(const struct lod_allocation *m)
{
	lod_planner_work(m->p, LOD_WORK_TALLY * (uint64_t)m->uses.first[m->p->visible.node_count] / LOD_PASS_TALLIES);
}

void lod_uses_set_each(struct lod_allocation *m)
{
	struct lod_uses *uses = &m->uses;
	bool any = false;
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
		uses->moved[s] = uses->near[s] != near || !is_same(&uses->each[s], &cost);
		any |= uses->moved[s];
		uses->near[s] = near;
		uses->each[s] = cost;
	}
	for (uint32_t n = 0; any && n < m->p->visible.node_count; n++)
		for (uint32_t i = uses->first[n]; i < uses->first[n + 1] && !uses->stale[n]; i++)
			uses->stale[n] = uses->moved[uses->items[i].slot];
	if (any)
		count_pass(m);
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

void lod_uses_sum_drawn(struct lod_allocation *m)
{
	const struct lod_visible_tree *visible = &m->p->visible;
	struct lod_uses *uses = &m->uses;
	memset(uses->drawn, 0, visible->slot_count * sizeof *uses->drawn);
	memset(uses->seen, 0, visible->slot_count * sizeof *uses->seen);
	uses->reach[0] = 1;
	for (uint32_t n = 0; n < visible->node_count; n++) {
		const struct lod_node *node = &visible->nodes[n];
		const struct lod_tile_choice *choice = &m->tile_choices[n];
		double weight = choice->open ? uses->reach[n] * choice->share : 0;
		for (uint32_t c = 0; node->expanded && c < node->child_count; c++)
			uses->reach[node->child_first + c] = weight;
		for (uint32_t i = uses->first[n]; i < uses->first[n + 1] && weight > 0; i++) {
			const struct lod_use *use = &uses->items[i];
			double count = weight * use->count * (use->whole == use->slot ? 1 : uses->near[use->whole]);
			uses->drawn[use->slot] += count;
			uses->seen[use->slot] += count * choice->factor;
		}
	}
	count_pass(m);
}
