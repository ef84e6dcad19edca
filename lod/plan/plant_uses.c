/* See lod/plan/plant_uses.h. */
#include "lod/plan/plant_uses.h"

#include <stdlib.h>

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
	uint32_t count = 0, slots = visible->slot_count;
	for (uint32_t n = 0; n < visible->node_count; n++)
		count += m->tile_choices[n].open ? visible->nodes[n].tally_count : 0;
	uses->items = malloc((count + 1u) * sizeof *uses->items);
	uses->cells = malloc((count + 1u) * sizeof *uses->cells);
	uses->first = malloc((visible->node_count + 1u) * sizeof *uses->first);
	uses->near = calloc(slots + 1u, sizeof *uses->near);
	uses->each = calloc(slots + 1u, sizeof *uses->each);
	uint32_t *first = calloc(slots + 1u, sizeof *first), *next = malloc((count + 1u) * sizeof *next);
	bool good = uses->items && uses->cells && uses->first && uses->near && uses->each && first && next;
	if (good)
		fill(m, first, next);
	free(first);
	free(next);
	return good ? ECO_OK : eco_fail(error, ECO_NO_MEMORY, "planning: no memory for the plants of %u "
		"tiles", visible->node_count);
}

void lod_uses_free(struct lod_uses *uses)
{
	free(uses->items);
	free(uses->first);
	free(uses->cells);
	free(uses->near);
	free(uses->each);
	*uses = (struct lod_uses){ 0 };
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

void lod_uses_set_each(struct lod_allocation *m)
{
	for (uint32_t s = 0; s < m->p->visible.slot_count; s++) {
		const struct lod_slot *slot = &m->p->visible.slots[s];
		const struct lod_slot_choice *choice = &m->slot_choices[s];
		double near = slot->cell ? 1 : lod_planner_near(m->p, slot->plant, slot->band),
			far = 1 - near;
		m->uses.near[s] = near;
		m->uses.each[s] = (struct lod_cost){ 0 };
		if (near > 0)
			lod_cost_add(&m->uses.each[s], &choice->cost[1], choice->fp_weight, near, near);
		if (far > 0)
			lod_cost_add(&m->uses.each[s], &choice->cost[0], choice->fp_weight, far, far);
	}
}

struct lod_cost lod_uses_cost(const struct lod_allocation *m, uint32_t n)
{
	double factor = m->tile_choices[n].factor;
	struct lod_cost sum = { 0 };
	for (uint32_t i = m->uses.first[n]; i < m->uses.first[n + 1]; i++) {
		const struct lod_use *use = &m->uses.items[i];
		double count = use->whole == use->slot ? use->count : use->count * m->uses.near[use->whole];
		const struct lod_cost *each = &m->uses.each[use->slot];
		sum.fp += count * each->fp;
		sum.fn += count * each->fn;
		sum.detail += count * each->detail;
		sum.vertices += count * each->vertices;
	}
	sum.fp *= factor;
	sum.fn *= factor;
	sum.detail *= factor;
	return sum;
}
