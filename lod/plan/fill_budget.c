/* The search for lambda and the greedy fill of the rest: see lod/plan/fill_budget.h. Longer than 600
 * lines: search, fill and entries work on the same candidates. */
#include "lod/plan/fill_budget.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "lod/heap.h"
#include "lod/ladder.h"

/* ---- Candidates ---- */

static double drawn_share(const struct lod_node *node) { return 1 - (double)node->left / ECO_SHARE_ONE; }

/* Plants of a tally that are drawn: cells only of plants before the gate. */
static double shown(const struct lod_planner *p, const struct lod_tally *t)
{
	const struct lod_slot *slot = &p->visible.slots[t->slot];
	return t->count * (slot->cell ? lod_planner_near(p, slot->plant, t->whole_band) : 1);
}

/* A summary with no plants beside it is a candidate along its whole hull. */
static bool summary_alone(const struct lod_node *node)
{
	return node->state == LOD_SUMMARY && node->points >= 1;
}

/* By hash, near plants are the first of the slot, and those that draw a ladder for the whole plant the
 * last. */
static uint64_t plants_of(const struct lod_allocation *m, uint32_t ladder_choice)
{
	const struct lod_ladder_choice *choice = &m->ladder_choices[ladder_choice];
	const struct lod_slot *slot = &m->p->visible.slots[choice->slot];
	uint64_t others = slot->count - slot->whole;
	switch (choice->when) {
	case LOD_NEAR:
		return slot->near;
	case LOD_FAR:
		return others - slot->near;
	case LOD_WHOLE:
		return m->slot_choices[choice->slot].whole == ladder_choice ? slot->whole : 0;
	default:
		return others;
	}
}

enum eco_code lod_fill_make(struct lod_fill *fill, struct lod_allocation *m, struct eco_error *error)
{
	const struct lod_planner *p = m->p;
	*fill = (struct lod_fill){ .allocation = m,
		.candidates =
		malloc(((size_t)m->ladder_choice_count + p->visible.node_count + 1)
		* sizeof *fill->candidates) };
	if (!fill->candidates)
		return eco_fail(error, ECO_NO_MEMORY, "planning: no memory for %u ladder choices",
			m->ladder_choice_count);
	lod_uses_sum_drawn(m);
	for (uint32_t i = 0; i < m->ladder_choice_count; i++) {
		const struct lod_ladder_choice *o = &m->ladder_choices[i];
		uint64_t count = plants_of(m, i);
		if (!count)
			continue;
		double seen = o->weight_px * m->uses.seen[o->slot] / (double)p->visible.slots[o->slot].count;
		fill->candidates[fill->candidate_count++] = (struct lod_candidate){ .ladder_choice = i,
			.node = ECO_NONE, .hull = &o->hull, .count = count,
			.weight_px = m->few_plants ? seen : o->weight_px, .seen = seen * (double)count };
	}
	for (uint32_t n = 0; n < p->visible.node_count; n++) {
		const struct lod_node *node = &p->visible.nodes[n];
		const struct lod_tile_choice *choice = &m->tile_choices[n];
		if (node->points > 0)
			fill->candidates[fill->candidate_count++] =
				(struct lod_candidate){ .ladder_choice = ECO_NONE, .node = n,
				.hull = !summary_alone(node) ? &choice->partial_hull
				: m->price > 0 ? &choice->limited : &choice->summary.hull,
				.count = 1, .weight_px = choice->weight_px,
				.seen = choice->weight * (1 - choice->share) * choice->weight_px };
	}
	return ECO_OK;
}

void lod_fill_free(struct lod_fill *fill)
{
	free(fill->candidates);
	free(fill->hash_first);
	free(fill->hashes);
	free(fill->sorted);
	*fill = (struct lod_fill){ 0 };
}

/* ---- At a lambda ---- */

void lod_candidate_reach(struct lod_candidate *candidate, uint64_t vertices)
{
	candidate->ahead = 0;
	while (!lod_candidate_ended(candidate) && lod_candidate_point(candidate)[1].vertices <= vertices)
		candidate->step++;
	candidate->low = vertices;
	candidate->high = lod_candidate_ended(candidate) ? vertices : lod_candidate_point(candidate)[1].vertices;
}

void lod_fill_at(struct lod_fill *fill, double lambda)
{
	fill->vertices = 0;
	fill->allocation->p->looks += fill->candidate_count;
	lod_planner_work(fill->allocation->p, LOD_WORK_CANDIDATE * (uint64_t)fill->candidate_count);
	for (uint32_t i = 0; i < fill->candidate_count; i++) {
		struct lod_candidate *candidate = &fill->candidates[i];
		double position = candidate->weight_px > 0
			? lod_hull_position(candidate->hull, lambda / candidate->weight_px, candidate->step)
			: lambda > 0 ? 0 : candidate->hull->count - 1;
		candidate->step = (uint32_t)position;
		lod_candidate_reach(candidate, lod_candidate_point(candidate)->vertices);
		double part = position - candidate->step;
		if (candidate->ladder_choice == ECO_NONE) /* a summary can have any number of points */
			candidate->low += (uint64_t)(part * (double)(candidate->high - candidate->low));
		else
			candidate->ahead = (uint64_t)(part * (double)candidate->count);
		lod_vertices_add(&fill->vertices, candidate->count, candidate->low);
		lod_vertices_add(&fill->vertices, candidate->ahead, candidate->high - candidate->low);
	}
}

/* Part of the way to the next hull point, the mean over its plants. */
static double part_of(const struct lod_candidate *c)
{
	const struct lod_hull_point *a = lod_candidate_point(c);
	double more = (double)c->ahead / (double)c->count * (double)(c->high - c->low);
	return lod_candidate_ended(c) ? 0 : ((double)(c->low - a->vertices) + more) / (double)(a[1].vertices - a->vertices);
}

static double candidate_wrong(const struct lod_candidate *candidate)
{
	const struct lod_hull_point *a = lod_candidate_point(candidate);
	double now = lod_hull_error(candidate->hull, a), part = part_of(candidate);
	if (part > 0)
		now += part * (lod_hull_error(candidate->hull, a + 1) - now);
	return candidate->seen * now;
}

/* A tile that draws nothing, or only its plants, is no candidate: the caller adds what it leaves wrong. */
static void sum_wrong(struct lod_fill *fill)
{
	fill->wrong = 0;
	for (uint32_t i = 0; i < fill->candidate_count; i++)
		fill->wrong += candidate_wrong(&fill->candidates[i]);
}

void lod_fill_search(struct lod_fill *fill, double lambda, uint64_t budget)
{
	lod_fill_at(fill, 0);
	fill->lambda = 0;
	if (fill->vertices > budget)
		lod_fill_at(fill, fill->lambda = lambda);
	for (double more = LOD_LAMBDA_STEP; fill->vertices > budget && fill->lambda < LOD_LAMBDA_MOST; more *= 2)
		lod_fill_at(fill, fill->lambda *= 1 + more);
	fill->converged = fill->lambda < LOD_LAMBDA_MOST;
	sum_wrong(fill);
}

/* ---- Hashes: which plants are ahead ---- */

static void collect_cell_hashes(void *ctx, const struct lod_anchor_band *anchors, uint32_t anchor_count,
	uint32_t plant, uint32_t hash)
{
	struct lod_fill *fill = ctx;
	(void)plant;
	for (uint32_t i = 1; i < anchor_count; i++) {
		uint32_t slot = lod_visible_tree_slot(&fill->allocation->p->visible, anchors[i].anchor,
			anchors[i].band);
		if (slot != ECO_NONE)
			fill->hashes[fill->hash_first[slot]++] = (uint16_t)hash;
	}
}

static bool is_drawn(const struct lod_node *node, uint32_t hash)
{
	return node->state == LOD_OPEN && lod_open_hash(hash) >= node->left;
}

/* Collects the hashes of all drawn plants and cells, slot by slot. */
static bool collect_hashes(struct lod_fill *fill)
{
	struct lod_planner *p = fill->allocation->p;
	uint32_t slots = p->visible.slot_count, sum = 0;
	fill->hash_first = malloc(((size_t)slots + 2) * sizeof *fill->hash_first);
	fill->sorted = calloc((size_t)slots + 1, 1);
	if (!fill->hash_first || !fill->sorted)
		return false;
	for (uint32_t s = 0; s < slots; s++) {
		fill->hash_first[s] = sum;
		sum += (uint32_t)p->visible.slots[s].count;
	}
	fill->hash_first[slots] = sum;
	fill->hashes = malloc(((size_t)sum + 1) * sizeof *fill->hashes);
	if (!fill->hashes)
		return false;
	for (uint32_t i = 0; i < p->screen.count; i++) {
		const struct lod_visibility *visibility = &p->screen.visibilities[i];
		if (visibility->slot != ECO_NONE
				&& is_drawn(&p->visible.nodes[visibility->node], visibility->hash))
			fill->hashes[fill->hash_first[visibility->slot]++] = visibility->hash;
	}
	for (uint32_t plant = 0; plant < p->scene->plant_count; plant++)
		if (p->gates[plant])
			lod_visible_tree_each(&p->visible, plant, p->gates, collect_cell_hashes, fill);
	for (uint32_t s = 0, end = 0; s < slots; s++) /* as many as were counted */
		assert(fill->hash_first[s] == (end += (uint32_t)p->visible.slots[s].count));
	memmove(fill->hash_first + 1, fill->hash_first, (size_t)slots * sizeof *fill->hash_first);
	fill->hash_first[0] = 0;
	return true;
}

static int ascending(const void *a, const void *b)
{
	return *(const uint16_t *)a - *(const uint16_t *)b;
}

static const uint16_t *hashes_of(struct lod_fill *fill, const struct lod_candidate *candidate)
{
	const struct lod_ladder_choice *choice = &fill->allocation->ladder_choices[candidate->ladder_choice];
	const struct lod_slot *slot = &fill->allocation->p->visible.slots[choice->slot];
	uint16_t *hashes = fill->hashes + fill->hash_first[choice->slot];
	if (!fill->sorted[choice->slot])
		qsort(hashes, slot->count, sizeof *hashes, ascending);
	fill->sorted[choice->slot] = 1;
	return choice->when == LOD_FAR ? hashes + slot->near : choice->when == LOD_WHOLE
		? hashes + (slot->count - slot->whole) : hashes;
}

/* Plants of one hash are treated alike: the greatest number of plants up to `wanted` that a range of hashes
 * can hold. */
static uint64_t share_floor(struct lod_fill *fill, const struct lod_candidate *candidate, uint64_t wanted)
{
	if (wanted == 0 || wanted >= candidate->count)
		return wanted < candidate->count ? wanted : candidate->count;
	const uint16_t *hashes = hashes_of(fill, candidate);
	while (wanted > 0 && hashes[wanted - 1] == hashes[wanted])
		wanted--;
	return wanted;
}

/* The least number of plants above `plants` that a range of hashes can hold; `plants` < count. */
static uint64_t share_next(struct lod_fill *fill, const struct lod_candidate *candidate, uint64_t plants)
{
	const uint16_t *hashes = hashes_of(fill, candidate);
	while (++plants < candidate->count && hashes[plants - 1] == hashes[plants])
		;
	return plants;
}

/* The end of a share that holds this many plants, fewer than all. Several ends may hold them: the result is
 * the one with the fewest bits on the wire. */
static uint32_t share_end(struct lod_fill *fill, const struct lod_candidate *candidate, uint64_t plants)
{
	const uint16_t *hashes = hashes_of(fill, candidate);
	uint32_t end = hashes[plants];
	while (plants && (end & (end - 1)) > hashes[plants - 1])
		end &= end - 1;
	return end;
}

/* ---- The rest of the budget ---- */

static const struct lod_way *way_of(const struct lod_fill *fill, const struct lod_candidate *candidate)
{
	return lod_planner_way(fill->allocation->p,
		fill->allocation->ladder_choices[candidate->ladder_choice].ladder);
}

/* A summary can have any number of points. */
static double summary_error(const struct lod_hull *hull, uint64_t vertices)
{
	const struct lod_hull_point *b = hull->points;
	while (b->vertices < vertices)
		b++;
	const struct lod_hull_point *a = b - 1;
	double part = (double)(vertices - a->vertices) / (double)(b->vertices - a->vertices);
	return lod_hull_error(hull, a) + part * (lod_hull_error(hull, b) - lod_hull_error(hull, a));
}

uint64_t lod_fill_next(const struct lod_fill *fill, const struct lod_candidate *candidate, uint64_t vertices,
	uint64_t to)
{
	if (candidate->ladder_choice == ECO_NONE)
		return to > vertices ? to : vertices + 1;
	const struct lod_way *way = way_of(fill, candidate);
	uint64_t next = lod_way_next(way, vertices), further = lod_way_floor(way, to);
	return next > further ? next : further;
}

/* From the curve, which is no straight line between hull points. Fewer splats than the first level of several
 * has were not measured: they show their share of it. */
double lod_fill_error(const struct lod_fill *fill, const struct lod_candidate *candidate, uint64_t vertices)
{
	const struct lod_hull *hull = candidate->hull;
	double none = lod_hull_error(hull, hull->points);
	if (vertices == hull->points->vertices)
		return none;
	if (candidate->ladder_choice == ECO_NONE)
		return summary_error(hull, vertices);
	const struct lod_way *way = way_of(fill, candidate);
	uint64_t measured = way->has_splats ? lod_way_level_above(way, lod_hull_impostor_levels(way) > 0) : 0;
	bool part = vertices < measured && !(vertices == 1 && hull->impostor != ECO_NONE);
	lod_planner_work(fill->allocation->p, LOD_WORK_CURVE);
	struct lod_hull_point point = lod_hull_point_at(way, part ? measured : vertices, hull->size,
		hull->impostor);
	double found = lod_hull_error(hull, &point);
	return part ? none + (found - none) * (double)vertices / (double)measured : found;
}

/* As many plants as `left` allows take the whole step. */
static uint64_t fill_plants(struct lod_fill *fill, struct lod_candidate *candidate, uint64_t left)
{
	uint64_t each = candidate->high - candidate->low, most = left / each,
		behind = candidate->count - candidate->ahead;
	uint64_t plants = share_floor(fill, candidate, candidate->ahead + (most < behind ? most : behind));
	uint64_t spent = plants > candidate->ahead ? (plants - candidate->ahead) * each : 0;
	if (spent)
		candidate->ahead = plants;
	if (candidate->ahead == candidate->count)
		lod_candidate_reach(candidate, candidate->high);
	return spent;
}

/* A plant by itself that `left` is too little for goes part of its step. */
static uint64_t fill_part(struct lod_fill *fill, struct lod_candidate *candidate, uint64_t left)
{
	uint64_t low = candidate->low,
		to = candidate->count == 1 ? lod_way_floor(way_of(fill, candidate), low + left) : 0;
	if (to <= low || lod_fill_error(fill, candidate, to) > lod_fill_error(fill, candidate, low))
		return 0;
	lod_candidate_reach(candidate, to);
	return to - low;
}

static uint64_t fill_summary(struct lod_candidate *candidate, uint64_t left)
{
	uint64_t points = left < candidate->high - candidate->low ? left : candidate->high - candidate->low;
	lod_candidate_reach(candidate, candidate->low + points);
	return points;
}

/* As much as `left` allows of the candidate's next step. Returns the vertices used. */
static uint64_t fill_candidate(struct lod_fill *fill, struct lod_candidate *candidate, uint64_t left)
{
	if (candidate->ladder_choice == ECO_NONE)
		return fill_summary(candidate, left);
	uint64_t spent = fill_plants(fill, candidate, left);
	return spent ? spent : fill_part(fill, candidate, left);
}

/* Greedy fill: gives the rest of the budget to candidates in falling order of slope. Sets vertices. False
 * without memory. */
static bool fill_rest(struct lod_fill *fill, uint64_t budget)
{
	struct lod_heap_item *heap = malloc(((size_t)fill->candidate_count + 1) * sizeof *heap);
	uint32_t count = 0;
	if (!heap)
		return false;
	fill->vertices = 0;
	for (uint32_t i = 0; i < fill->candidate_count; i++) {
		struct lod_candidate *candidate = &fill->candidates[i];
		candidate->ahead = candidate->ahead ? share_floor(fill, candidate, candidate->ahead) : 0;
		lod_vertices_add(&fill->vertices, candidate->count, candidate->low);
		lod_vertices_add(&fill->vertices, candidate->ahead, candidate->high - candidate->low);
		if (lod_candidate_next(candidate) > 0)
			heap[count++] = (struct lod_heap_item){ lod_candidate_next(candidate), i };
	}
	lod_heap_make(heap, count);
	uint64_t left = budget - fill->vertices, steps = 0;
	while (count && left) {
		struct lod_candidate *candidate = &fill->candidates[heap[0].id];
		uint32_t step = candidate->step;
		uint64_t spent = fill_candidate(fill, candidate, left);
		left -= spent;
		steps++;
		if (candidate->step != step && lod_candidate_next(candidate) > 0)
			heap[0].key = lod_candidate_next(candidate);
		else if (spent == 0 || candidate->step != step)
			heap[0] = heap[--count];
		lod_heap_sift(heap, count, 0);
	}
	lod_planner_work(fill->allocation->p, 2 * LOD_WORK_CANDIDATE * (fill->candidate_count + steps));
	fill->vertices = budget - left;
	free(heap);
	return true;
}

/* Vertices of the cheapest step of a hull that is left, of the fewest plants. */
static uint64_t cheapest_step(struct lod_fill *fill)
{
	uint64_t cheapest = UINT64_MAX;
	for (uint32_t i = 0; i < fill->candidate_count; i++) {
		const struct lod_candidate *c = &fill->candidates[i];
		if (!(lod_candidate_next(c) > 0))
			continue;
		uint64_t cost = 1;
		if (c->ladder_choice != ECO_NONE)
			cost = (share_next(fill, c, c->ahead) - c->ahead) * (c->high - c->low);
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

/* Share of its elements that a candidate shows, the mean over its plants. If there are many plants it is
 * that of lambda: cells are few, and a step of one cell would change all plants that it belongs to. Where
 * there are few, what is drawn may be far from lambda. */
static double mean_density(const struct lod_fill *fill, const struct lod_candidate *candidate)
{
	const struct lod_way *way = way_of(fill, candidate);
	if (fill->allocation->few_plants)
		return between_densities(way, candidate->low, candidate->high,
			(double)candidate->ahead / (double)candidate->count);
	double position = fill->allocation->ladder_choices[candidate->ladder_choice].position;
	const struct lod_hull_point *a = &candidate->hull->points[(uint32_t)position];
	bool last = (uint32_t)position + 1 == candidate->hull->count;
	return between_densities(way, a->vertices, last ? a->vertices : a[1].vertices,
		position - floor(position));
}

/* Sums how much of each organ the plants of a slot show together with their cells: the coarse list is scaled
 * to that. */
static void find_densities(const struct lod_fill *fill, double (*drawn)[ECO_ORGAN_COUNT],
	double (*all)[ECO_ORGAN_COUNT])
{
	const struct lod_allocation *m = fill->allocation;
	const struct lod_planner *p = m->p;
	for (uint32_t i = 0; i < fill->candidate_count; i++) {
		const struct lod_candidate *candidate = &fill->candidates[i];
		if (candidate->ladder_choice == ECO_NONE
				|| !p->visible.slots[m->ladder_choices[candidate->ladder_choice].slot].cell)
			continue;
		const struct eco_ladder *ladder =
			&p->scene->ladders[m->ladder_choices[candidate->ladder_choice].ladder];
		uint32_t slot = m->ladder_choices[candidate->ladder_choice].slot;
		drawn[slot][ladder->organ] += mean_density(fill, candidate) * ladder->area;
		all[slot][ladder->organ] += ladder->area;
	}
	for (uint32_t n = 0; n < p->visible.node_count; n++)
		for (uint32_t i = 0; p->visible.nodes[n].state == LOD_OPEN
				&& i < p->visible.nodes[n].tally_count; i++) {
			const struct lod_tally *t = &p->visible.nodes[n].tallies[i];
			const struct lod_slot *slot = &p->visible.slots[t->slot];
			if (!slot->cell || eco_gate_place(t->whole_band, 0) >= p->gates[slot->plant])
				continue;
			uint32_t whole = lod_allocation_slot(m, slot->plant, t->whole_band);
			double count = drawn_share(&p->visible.nodes[n]) * shown(p, t);
			for (int o = 0; o < ECO_ORGAN_COUNT; o++) {
				drawn[whole][o] += count * drawn[t->slot][o];
				all[whole][o] += count * all[t->slot][o];
			}
		}
}

/* In the band where the gate ends, the plants with the smallest hashes draw cells and the others do not. The
 * others with the greatest hashes may draw a ladder for the whole plant. */
static void find_hashes(const struct lod_planner *p, const struct lod_ladder_choice *choice,
	struct lod_entry *entry)
{
	const struct lod_slot *slot = &p->visible.slots[choice->slot];
	uint32_t near = lod_near_end(p->gates[slot->plant], slot->band),
		whole = slot->whole_from > near ? slot->whole_from : near;
	entry->first = choice->when == LOD_FAR ? near : choice->when == LOD_WHOLE ? whole : 0;
	entry->end = choice->when == LOD_NEAR ? near : choice->when == LOD_WHOLE ? ECO_SHARE_ONE : whole;
}

static enum eco_code add_entries(struct lod_fill *fill, struct eco_error *error)
{
	struct lod_allocation *m = fill->allocation;
	struct lod_planner *p = m->p;
	double (*drawn)[ECO_ORGAN_COUNT] = calloc(2 * (size_t)p->visible.slot_count + 1, sizeof *drawn);
	double (*all)[ECO_ORGAN_COUNT] = drawn ? drawn + p->visible.slot_count : NULL;
	enum eco_code code = drawn ? ECO_OK : eco_fail(error, ECO_NO_MEMORY, "planning: no memory for %u "
		"slots", p->visible.slot_count);
	if (drawn)
		find_densities(fill, drawn, all);
	p->vertices = fill->vertices;
	p->entry_count = 0;
	fill->wrong = 0;
	for (uint32_t i = 0; !code && i < fill->candidate_count; i++) {
		const struct lod_candidate *candidate = &fill->candidates[i];
		struct lod_entry entry = { .slot = ECO_NONE, .ladder = candidate->node,
			.count = candidate->count, .vertices = candidate->low, .impostor = ECO_NONE,
			.wrong = lod_fill_wrong_of(fill, candidate) };
		fill->wrong += entry.wrong;
		if (candidate->ladder_choice == ECO_NONE) {
			const struct lod_node *node = &p->visible.nodes[candidate->node];
			entry.full = lod_planner_count(p->scene, p->scene->tiles[node->tile].summary);
			const struct lod_tile_choice *choice = &m->tile_choices[candidate->node];
			uint64_t points = summary_alone(node) ? candidate->low : choice->all_points;
			entry.wanted = (double)points / lod_summary_hull_scale(&choice->summary, points);
			/* from the error before like plants, half (1 - fn) + fn: see summary_hull.h */
			double half = LOD_OWNER_WEIGHT * choice->summary.pixels;
			entry.owners = candidate->seen * half * (1 - lod_candidate_point(candidate)->alike) / (1 - half);
		} else {
			const struct lod_ladder_choice *o = &m->ladder_choices[candidate->ladder_choice];
			const struct eco_ladder *ladder = &p->scene->ladders[o->ladder];
			entry.slot = o->slot;
			entry.among =
				1 - (m->slot_choices[o->slot].seen > 0
				? m->slot_choices[o->slot].unoccluded / m->slot_choices[o->slot].seen : 1);
			entry.ladder = o->ladder;
			entry.impostor = o->hull.impostor;
			entry.size = (uint32_t)(o->hull.size + 0.5);
			entry.full = lod_planner_way(p, o->ladder)->full;
			double organ = o->when == LOD_NEAR ? all[o->slot][ladder->organ] : 0;
			find_hashes(p, o, &entry);
			entry.wanted = organ > 0 ? ladder->total * drawn[o->slot][ladder->organ] / organ : 0;
			if (candidate->ahead) { /* fewer than all */
				entry.more = candidate->high;
				entry.share = share_end(fill, candidate, candidate->ahead);
			}
		}
		if (p->input->explanation)
			entry.reason = lod_explain_candidate(fill, candidate);
		code = lod_planner_add(p, &entry, error);
	}
	free(drawn);
	return code;
}

double lod_fill_wrong_of(const struct lod_fill *fill, const struct lod_candidate *candidate)
{
	const struct lod_hull_point *a = lod_candidate_point(candidate);
	bool at_steps = lod_candidate_ended(candidate)
		|| (candidate->low == a->vertices && (!candidate->ahead || candidate->high == a[1].vertices));
	if (candidate->ladder_choice == ECO_NONE || at_steps)
		return candidate_wrong(candidate);
	double now = lod_fill_error(fill, candidate, candidate->low), wrong = now, each = 1 / (double)candidate->count;
	if (candidate->ahead)
		wrong += each * (double)candidate->ahead * (lod_fill_error(fill, candidate, candidate->high) - now);
	return candidate->seen * wrong;
}

enum eco_code lod_fill_finish(struct lod_fill *fill, uint64_t budget, struct eco_error *error)
{
	struct lod_planner *p = fill->allocation->p;
	lod_planner_work(p, p->screen.count + 2 * LOD_WORK_CHOICE * (uint64_t)fill->candidate_count
		+ LOD_WORK_TALLY * fill->allocation->tallies);
	if (!collect_hashes(fill) || !fill_rest(fill, budget))
		return eco_fail(error, ECO_NO_MEMORY, "planning: no memory for %u candidates",
			fill->candidate_count);
	fill->cheapest = cheapest_step(fill);
	return add_entries(fill, error);
}

enum eco_code lod_fill_predict(struct lod_fill *fill, struct eco_prediction *prediction, struct eco_error *error)
{
	struct lod_allocation *m = fill->allocation;
	for (uint32_t i = 0; i < fill->candidate_count; i++) {
		const struct lod_candidate *c = &fill->candidates[i];
		if (c->ladder_choice != ECO_NONE) {
			m->ladder_choices[c->ladder_choice].position = c->step + part_of(c);
			lod_allocation_unsettle(m, m->ladder_choices[c->ladder_choice].slot);
		} else if (c->hull == &m->tile_choices[c->node].summary.hull) {
			m->tile_choices[c->node].position = c->step + part_of(c);
		}
	}
	return lod_allocation_predict(m, prediction, error);
}
