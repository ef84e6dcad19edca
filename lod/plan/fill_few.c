/* Few plants in view: what all of them draw at once, as a multiple-choice knapsack. A lambda may be far from the
 * best choice for one of few plants: a dear step is worth some cheap ones, and a ladder for the whole plant may be
 * better than organs though no lambda that fits chooses it. See lod/plan/fill_budget.h. */
#include "lod/plan/fill_budget.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/array_grow.h"
#include "lod/plan/knapsack.h"

/* The plants of a candidate may draw this: `each`, but `ahead` of them the next hull point; cells what `lambda`
 * says. */
struct option { double wrong; uint64_t vertices, each, ahead; double lambda; };

/* A class of the knapsack: one candidate; `whole`: a slot's plants beyond the gate in place of those from `from` on. */
struct class { struct lod_candidate candidate; uint32_t first, end, from; bool whole; };

struct few {
	struct lod_fill *fill;
	uint64_t budget;
	double lambda;
	struct option *options;      uint32_t count, capacity;
	struct class *classes;       uint32_t class_count;
	uint64_t bins, unit;         /* of vertices */
	bool failed;
};

static void push(struct few *f, const struct option *option)
{
	f->failed |= !eco_array_grow(&f->options, &f->capacity, f->count, sizeof *f->options);
	if (!f->failed)
		f->options[f->count++] = *option;
}

static void add_option(struct few *f, const struct lod_candidate *c, uint64_t each, uint64_t ahead, uint64_t next)
{
	double error = lod_fill_error(f->fill, c, each), part = (double)ahead / (double)c->count;
	if (ahead)
		error += part * (lod_fill_error(f->fill, c, next) - error);
	push(f, &(struct option){ c->seen * error, c->count * each + ahead * (next - each), each, ahead, 0 });
}

/* Between two hull points that are far apart: some plants are ahead, or all of them on the way, where a curve may be
 * better than both points. */
static void add_between(struct few *f, const struct lod_candidate *c, uint64_t at, uint64_t next)
{
	uint64_t bin = f->budget / LOD_FEW_BINS, part = bin / c->count > (next - at) / LOD_FEW_PARTS ? bin / c->count
		: (next - at) / LOD_FEW_PARTS, plants = bin / (next - at) + (c->count + LOD_FEW_PARTS - 1) / LOD_FEW_PARTS;
	for (uint64_t ahead = plants; c->count > 1 && ahead < c->count; ahead += plants)
		add_option(f, c, at, ahead, next);
	for (uint64_t on = at; (on = lod_fill_next(f->fill, c, on, on + part)) < next && c->count * on <= f->budget;)
		add_option(f, c, on, 0, 0);
}

static void add_options(struct few *f, const struct lod_candidate *c)
{
	const struct lod_hull *hull = c->hull;
	for (uint32_t k = 0; k < hull->count && c->count * hull->points[k].vertices <= f->budget; k++) {
		add_option(f, c, hull->points[k].vertices, 0, 0);
		if (k + 1 < hull->count)
			add_between(f, c, hull->points[k].vertices, hull->points[k + 1].vertices);
	}
}

static void add_class(struct few *f, const struct lod_candidate *candidate, uint32_t from, bool whole)
{
	struct class *class = &f->classes[f->class_count++];
	*class = (struct class){ *candidate, f->count, 0, from, whole };
	add_options(f, candidate);
	class->end = f->count;
}

static const struct lod_ladder_choice *choice_of(const struct few *f, const struct lod_candidate *c)
{
	return c->ladder_choice == ECO_NONE ? NULL : &f->fill->allocation->ladder_choices[c->ladder_choice];
}

/* Candidates of a slot in the order of classes: organs of plants beyond the gate, what shows these as a whole. */
static void add_slot(struct few *f, uint32_t from, uint32_t to)
{
	const struct lod_allocation *m = f->fill->allocation;
	const struct lod_candidate *organ = NULL;
	uint32_t first = f->class_count, slot = choice_of(f, &f->fill->candidates[from])->slot;
	const struct lod_slot_choice *s = &m->slot_choices[slot];
	for (uint32_t i = from; i < to; i++)
		if (choice_of(f, &f->fill->candidates[i])->when < LOD_NEAR) {
			organ = &f->fill->candidates[i];
			add_class(f, organ, 0, false);
		}
	for (uint32_t k = 0, id = s->ladder_choice_first + s->ladder_choice_count; organ && k < s->whole_count; k++) {
		struct lod_candidate whole = *organ;
		whole.ladder_choice = --id;
		whole.hull = &m->ladder_choices[id].hull;
		whole.seen = (double)organ->count * m->ladder_choices[id].weight_px * m->uses.seen[slot]
			/ (double)m->p->visible.slots[slot].count;
		add_class(f, &whole, first, true);
	}
	for (uint32_t i = from; i < to; i++)
		if (choice_of(f, &f->fill->candidates[i])->when == LOD_NEAR)
			add_class(f, &f->fill->candidates[i], 0, false);
}

static bool is_cell(const struct few *f, const struct lod_candidate *c)
{
	const struct lod_ladder_choice *choice = choice_of(f, c);
	return choice && f->fill->allocation->p->visible.slots[choice->slot].cell;
}

/* Cells are many and small: what all of them draw at one of some lambdas. */
static void add_cells(struct few *f)
{
	double lambda = INFINITY;
	f->classes[f->class_count++] = (struct class){ { .ladder_choice = ECO_NONE, .node = ECO_NONE }, f->count, 0, 0,
		false };
	for (uint64_t i = 0; i < LOD_CELL_LAMBDAS; i++) {
		struct option option = { .lambda = lambda };
		lod_fill_at(f->fill, lambda);
		for (uint32_t k = 0; k < f->fill->candidate_count; k++) {
			const struct lod_candidate *c = &f->fill->candidates[k];
			option.vertices += is_cell(f, c) ? lod_candidate_vertices(c) : 0;
			option.wrong += is_cell(f, c) ? lod_fill_wrong_of(f->fill, c) : 0;
		}
		push(f, &option);
		lambda = i ? lambda * LOD_CELL_STEP : f->lambda * LOD_CELL_HIGHEST;
	}
	f->classes[f->class_count - 1].end = f->count;
}

static void make_classes(struct few *f)
{
	const struct lod_fill *fill = f->fill;
	add_cells(f);
	for (uint32_t i = 0, end; i < fill->candidate_count; i = end) {
		const struct lod_ladder_choice *choice = choice_of(f, &fill->candidates[i]), *other;
		for (end = i + 1; choice && end < fill->candidate_count
				&& (other = choice_of(f, &fill->candidates[end])) && other->slot == choice->slot; end++)
			;
		if (choice && is_cell(f, &fill->candidates[i]))
			continue;
		if (choice)
			add_slot(f, i, end);
		else
			add_class(f, &fill->candidates[i], 0, false);
	}
}

static void make_bins(struct few *f)
{
	uint64_t left = f->budget, most = LOD_FEW_TRIES / (f->count + 1u);
	for (uint32_t c = 0; c < f->class_count; c++)
		left -= f->classes[c].whole ? 0 : f->options[f->classes[c].first].vertices;
	f->unit = left / (most < LOD_FEW_BINS ? most + 1 : LOD_FEW_BINS) + 1;
	f->bins = left / f->unit;
}

/* Sets each class's option; ECO_NONE: another class draws in its place. */
static void choose(struct few *f, uint32_t *chosen)
{
	struct lod_knapsack_option *options = malloc((f->count + 1u) * sizeof *options);
	struct lod_knapsack_class *classes = malloc((f->class_count + 1u) * sizeof *classes);
	for (uint32_t c = 0; options && classes && c < f->class_count; c++) {
		const struct class *class = &f->classes[c];
		classes[c] = (struct lod_knapsack_class){ class->first, class->end, class->from, class->whole };
		for (uint32_t o = class->first; o < class->end; o++)
			options[o] = (struct lod_knapsack_option){ f->options[o].wrong, (f->options[o].vertices
				- f->options[class->first].vertices + f->unit - 1) / f->unit };
	}
	f->failed |= !options || !classes || !lod_knapsack_solve(f->fill->allocation->p, options, classes,
		f->class_count, f->bins, chosen);
	free(options);
	free(classes);
}

/* No plants are drawn as a whole, so that all candidates are there to choose from. */
static enum eco_code begin(struct few *f, struct eco_error *error)
{
	struct lod_allocation *m = f->fill->allocation;
	for (uint32_t s = 0; s < m->p->visible.slot_count; s++) {
		m->slot_choices[s].whole_share = 0;
		lod_allocation_unsettle(m, s);
	}
	lod_fill_free(f->fill);
	lod_allocation_fix(m);
	enum eco_code code = lod_fill_make(f->fill, m, error);
	f->classes = malloc((m->ladder_choice_count + m->p->visible.node_count + 2u) * sizeof *f->classes);
	f->failed = !f->classes;
	return code;
}

/* Makes the structure of what was chosen, and takes it. */
static enum eco_code take(struct few *f, const uint32_t *chosen, struct eco_error *error)
{
	struct lod_fill *fill = f->fill;
	struct lod_allocation *m = fill->allocation;
	for (uint32_t c = 0; c < f->class_count; c++)
		if (f->classes[c].whole && chosen[c] != ECO_NONE) {
			struct lod_slot_choice *slot = &m->slot_choices[choice_of(f, &f->classes[c].candidate)->slot];
			slot->whole = f->classes[c].candidate.ladder_choice;
			slot->whole_share = 1;
		}
	lod_fill_free(fill);
	lod_allocation_fix(m);
	enum eco_code code = lod_fill_make(fill, m, error);
	if (!code)
		lod_fill_at(fill, f->options[chosen[0]].lambda);
	for (uint32_t i = 0, c = 0; !code && i < fill->candidate_count; i++) {
		struct lod_candidate *to = &fill->candidates[i];
		for (c = 1; c < f->class_count && (f->classes[c].candidate.ladder_choice != to->ladder_choice
				|| f->classes[c].candidate.node != to->node); c++)
			;
		if (c == f->class_count || chosen[c] == ECO_NONE)
			continue;
		fill->vertices -= lod_candidate_vertices(to);
		to->step = 0;
		lod_candidate_reach(to, f->options[chosen[c]].each);
		to->ahead = f->options[chosen[c]].ahead;
		fill->vertices += f->options[chosen[c]].vertices;
	}
	return code;
}

enum eco_code lod_fill_few(struct lod_fill *fill, uint64_t budget, struct eco_error *error)
{
	struct few f = { .fill = fill, .budget = budget, .lambda = fill->lambda };
	enum eco_code code = begin(&f, error);
	uint32_t *chosen = NULL;
	if (!code && !f.failed) {
		make_classes(&f);
		f.failed |= !(chosen = malloc((f.class_count + 1u) * sizeof *chosen));
	}
	if (!code && !f.failed) {
		make_bins(&f);
		choose(&f, chosen);
	}
	if (f.failed && !code)
		code = eco_fail(error, ECO_NO_MEMORY, "planning: no memory for steps of %u candidates",
			fill->candidate_count);
	if (!code)
		code = take(&f, chosen, error);
	fill->lambda = f.lambda;
	fill->converged = true;
	free(f.options);
	free(f.classes);
	free(chosen);
	return code;
}
