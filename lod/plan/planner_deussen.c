/* Deussen's rule, solved for a budget. One sample distance d' (radians: the mean distance of neighbouring
 * samples on the image plane at distance 1) decides for every tile whether its summary suffices, and for
 * every organ at every distance how many points or lines it gets. Smaller d' means more vertices; the rule
 * takes the smallest d' whose plan fits.
 *
 * Deussen 2002, section 5, with corrections:
 *   points  p = c_p A / (2 r^2) / d'^2. The paper multiplies by n_p as well and compares the result with
 *           n_p: a misprint. p < 2k: the first p points; then the blend of 5.3; from 3k on all triangles.
 *   lines   q = A/(2 r^2) / (l d'/(2 r)) = A / (l r d'). q <= 1 and epsilon / r < d': q n_l lines; else
 *           polygons.
 *           The paper's lines are long; ours may be shorter than the distance of two samples and are then
 *           no more use than points: never more lines than samples.
 *   importance multiplies an organ's share of the budget (4.3).
 *
 * As in the paper, plants out of view are left out and occlusion is ignored. One thing is better than there, so that
 * measurements compare rules and not primitives: scales are those measured for each list.
 *
 * V(d') is a step function and not quite monotone: a tile that opens may cost a little less than its summary
 * did. So d' is searched on a fixed exact grid and the plan's vertices are always counted. */
#include "lod/plan/planner_state.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/array_grow.h"
#include "lod/ladder.h"

struct eco_curve lod_planner_curve(const struct lod_planner *p, const struct lod_entry *entry,
	uint64_t vertices)
{
	const struct eco_ladder *ladder = &p->scene->ladders[entry->ladder];
	if (entry->slot == ECO_NONE) { /* summaries are not measured: random points over random plants */
		double share = entry->full ? (double)vertices / (double)entry->full : 1;
		return (struct eco_curve){ .share = (float)share, .fp = (float)((1 - LOD_DEUSSEN_HIT) * share),
			.fn = (float)(1 - LOD_DEUSSEN_HIT * share) };
	}
	return lod_ladder_curve(p->scene, ladder, lod_way_share(lod_planner_way(p, entry->ladder), vertices));
}

#define STEP_LAST (LOD_DEUSSEN_STEPS * 60)

/* ---- One level of detail ---- */

/* Exact at every step: 2, then halved every LOD_DEUSSEN_STEPS steps, linear between. */
static double distance_at(int step)
{
	if (step >= STEP_LAST)
		return 0;
	int octave = step / LOD_DEUSSEN_STEPS, part = step % LOD_DEUSSEN_STEPS;
	return ldexp(2.0 - (double)part / LOD_DEUSSEN_STEPS, -octave);
}

static uint64_t to_count(double x)
{
	return !(x > 0) ? 0 : x >= 9e15 ? (uint64_t)9e15 : (uint64_t)x;
}

/* Vertices that d' asks of a ladder at distance r, before rounding to what it can draw; *wanted: points or
 * lines of the region. */
static uint64_t ladder_wants(const struct eco_scene *scene, const struct eco_ladder *ladder, double r,
	double d, double *wanted)
{
	double importance = ladder->importance > 0 ? ladder->importance : 1;
	uint64_t full = lod_ladder_full(scene, ladder), points = lod_planner_count(scene, ladder->points);
	uint64_t lines = lod_planner_count(scene, ladder->lines);
	if (!(d > 0)) {
		*wanted = ladder->total;
		return full;
	}
	double samples = LOD_SPLAT_FACTOR * importance * ladder->area / (2.0 * r * r * d * d);
	if (points) {
		*wanted = samples;
		if (samples >= ladder->total)
			return to_count(samples / ladder->total * (double)points);
		uint64_t own = to_count(samples - ladder->before);
		return own < points ? own : points;
	}
	if (lines) {
		double q = ladder->length > 0 ? importance * ladder->area / (ladder->length * r * d) : 2;
		*wanted = q * ladder->total < samples ? q * ladder->total : samples;
		if ((q <= 1 && ladder->epsilon / r < d) || samples < ladder->total) {
			uint64_t own = to_count(*wanted - ladder->before);
			return 2 * (own < lines ? own : lines);
		}
		/* polygons: as many as there are samples, but not none */
		*wanted = ladder->total;
		return samples > 2.0 * (double)lines ? to_count(samples) : 2 * lines + 1;
	}
	*wanted = samples / 3;
	return to_count(samples);
}

/* The bands in which the whole plant's lists do not suffice, so that its cells are drawn. */
static uint32_t gate_at(const struct lod_planner *p, uint32_t plant, double d)
{
	const struct eco_scene *scene = p->scene;
	const struct eco_plant *pl = &scene->plants[plant];
	if (pl->anchor_count < 2)
		return 0;
	for (int band = ECO_BANDS - 1; band >= 0; band--) {
		double r = lod_band_distance_m((uint8_t)band), wanted;
		for (uint32_t i = 0; i < pl->ladder_count; i++) {
			const struct eco_ladder *ladder = &scene->ladders[pl->ladder_first + i];
			if (ladder->anchor != pl->anchor_first || ladder->flags & ECO_LADDER_WHOLE)
				continue;
			uint64_t points = lod_planner_count(scene, ladder->points), limit = points ? points
				: 2 * lod_planner_count(scene, ladder->lines);
			if (ladder_wants(scene, ladder, r, d, &wanted) > limit
					|| (points && wanted > (double)points) || !(d > 0))
				return (uint32_t)(band + 1) * ECO_SHARE_ONE;
		}
	}
	return 0;
}

enum eco_code lod_planner_open(struct lod_planner *p, double d, double d_cells, struct eco_error *error)
{
	const uint64_t before = p->visible.places, plants = p->scene->plant_count;
	uint32_t *gates = malloc((plants + 1) * sizeof *gates);
	if (!gates)
		return eco_fail(error, ECO_NO_MEMORY, "planning: no memory for %u plants", p->scene->plant_count);
	for (uint32_t i = 0; i < plants; i++)
		gates[i] = gate_at(p, i, d_cells);
	enum eco_code code = lod_visible_tree_count(&p->visible, d, gates, error);
	if (!code)
		memcpy(p->gates, gates, plants * sizeof *gates);
	free(gates);
	lod_planner_work(p, LOD_WORK_PLACE * (p->visible.places - before)
		+ LOD_WORK_NODE * (uint64_t)p->visible.node_count);
	return code;
}

/* Pixels that one plant's organ is expected to cover: half its area, at most its bounding disc. */
static double organ_pixels(const struct lod_planner *p, const struct eco_ladder *ladder, double r)
{
	const struct eco_anchor *anchor = &p->scene->anchors[ladder->anchor];
	double disc = 2.0 * anchor->radius * anchor->radius, area = 0.5 * ladder->area;
	double pixel = r * p->visible.eye.pixel_rad;
	return (area < disc ? area : disc) / (pixel * pixel);
}

enum eco_code lod_planner_add(struct lod_planner *p, const struct lod_entry *entry, struct eco_error *error)
{
	if (!eco_array_grow(&p->entries, &p->entry_capacity, p->entry_count, sizeof *p->entries))
		return eco_fail(error, ECO_NO_MEMORY, "planning: no memory for more than %u cuts",
			p->entry_count);
	p->entries[p->entry_count++] = *entry;
	return ECO_OK;
}

static bool ladder_applies(const struct lod_planner *p, const struct eco_ladder *ladder,
	const struct lod_slot *slot)
{
	return !(ladder->flags & ECO_LADDER_FAR) || eco_gate_place(slot->band, 0) >= p->gates[slot->plant];
}

static enum eco_code add_summaries(struct lod_planner *p, double d, struct eco_error *error)
{
	for (uint32_t i = 0; i < p->visible.node_count; i++) {
		const struct lod_node *node = &p->visible.nodes[i];
		if (node->state != LOD_SUMMARY)
			continue;
		uint64_t full = lod_planner_count(p->scene, p->scene->tiles[node->tile].summary);
		double wanted = d > 0 ? lod_summary_points(node, d) : INFINITY,
			pixel = node->distance * p->visible.eye.pixel_rad;
		struct lod_entry entry = { .slot = ECO_NONE, .ladder = i, .count = 1, .full = full,
			.wanted = wanted };
		entry.vertices = to_count(wanted) < full ? to_count(wanted) : full;
		entry.pixels = pixel > 0 ? 0.5 * node->area / (pixel * pixel) : 0;
		if (lod_planner_add(p, &entry, error))
			return ECO_NO_MEMORY;
		lod_vertices_add(&p->vertices, 1, entry.vertices);
		p->ended = false;        /* a summary is never everything */
	}
	return ECO_OK;
}

/* Fills entries and vertices for the open structure at the hull points of `step`. */
static enum eco_code count_vertices(struct lod_planner *p, int step, struct eco_error *error)
{
	double d = distance_at(step);
	p->entry_count = 0;
	p->vertices = 0;
	p->ended = true;
	for (uint32_t s = 0; s < p->visible.slot_count; s++) {
		const struct lod_slot *slot = &p->visible.slots[s];
		double r = lod_band_distance_m(slot->band);
		if (slot->count == 0)
			continue;
		uint32_t count;
		const uint32_t *ladders = lod_plan_tables_anchor(p->tables, slot->anchor, &count);
		for (uint32_t i = 0; i < count; i++) {
			const struct eco_ladder *ladder = &p->scene->ladders[ladders[i]];
			if (!ladder_applies(p, ladder, slot))
				continue;
			const struct lod_plan_tables_ladder *table = lod_plan_tables_ladder(p->tables,
				ladders[i]);
			if (!table)
				return eco_fail(error, ECO_NO_MEMORY, "planning: no memory for ladder %u",
					ladders[i]);
			struct lod_entry entry = { .slot = s, .ladder = ladders[i], .count = slot->count,
				.end = ECO_SHARE_ONE,
				.full = table->way.full, .pixels = organ_pixels(p, ladder, r) };
			entry.vertices = ladder_wants(p->scene, ladder, r, d, &entry.wanted);
			/* a whole-plant list alone, or beside cells that do not show all their points yet,
			 * stands for more than itself */
			bool coarse = !slot->cell && p->scene->plants[slot->plant].anchor_count > 1
				&& (eco_gate_place(slot->band, 0) >= p->gates[slot->plant]
				|| entry.wanted < ladder->total);
			if (coarse)
				entry.full = lod_way_stage_end(&table->way);
			entry.vertices = lod_way_floor(&table->way, entry.vertices < entry.full
				? entry.vertices : entry.full);
			p->ended = p->ended && entry.vertices == entry.full && !coarse;
			if (lod_planner_add(p, &entry, error))
				return ECO_NO_MEMORY;
			lod_vertices_add(&p->vertices, slot->count, entry.vertices);
		}
	}
	enum eco_code code = add_summaries(p, d, error);
	lod_planner_work(p, LOD_WORK_NODE * (uint64_t)p->visible.node_count
		+ 2 * LOD_WORK_CURVE * (uint64_t)p->entry_count);
	return code;
}

/* ---- The budget ---- */

/* After a step that is too large the tree is empty, so that a coarser step has all the room. At the coarsest
 * step tiles beyond the bounds show their summaries: a million plants may stand around the eye. */
static enum eco_code open_step(struct lod_planner *p, int step, struct eco_error *error)
{
	const uint64_t work = p->input->work_max, nodes = work ? work / LOD_DEUSSEN_NODE_WORK + 1 : 0,
		most = work / 4 / LOD_WORK_PLACE, places = (work && most < LOD_DEUSSEN_PLACES ? most : LOD_DEUSSEN_PLACES) + 1;
	const bool few = step == 0 && work;
	p->visible.bounds = step > 0 && (p->scene->needs & ECO_NEED_SUMMARIES)
		? (struct lod_walk_bounds){ .nodes = nodes, .places = places }
		: (struct lod_walk_bounds){ .places = work ? LOD_DEUSSEN_PLACES + ECO_OPEN_PLANTS_MAX : 0,
			.nodes_few = few ? nodes : 0, .places_few = few ? places : 0 };
	enum eco_code code = lod_planner_open(p, distance_at(step), distance_at(step), error);
	return code == ECO_TOO_LARGE && lod_visible_tree_restart(&p->visible, NULL) ? ECO_NO_MEMORY : code;
}

static enum eco_code try_level(struct lod_planner *p, int step, bool *fits, struct eco_error *error)
{
	struct eco_error local = { 0 };
	enum eco_code code = open_step(p, step, &local);
	if (code == ECO_TOO_LARGE && step > 0) {
		p->ended = false;
		*fits = false;
		return ECO_OK;
	}
	if (code)
		return eco_fail(error, code, "%s", local.text);
	code = count_vertices(p, step, error);
	*fits = p->vertices <= p->input->request->vertices;
	return code;
}

/* Greatest step whose plan fits, -1 if none. */
static enum eco_code solve(struct lod_planner *p, int *solution, struct eco_error *error)
{
	int low = -1, high = 0;
	bool fits;
	for (;;) {
		enum eco_code code = try_level(p, high, &fits, error);
		if (code)
			return code;
		if (!fits)
			break;
		low = high;
		if (high == STEP_LAST || lod_planner_over(p, 2))
			break;
		high = p->ended || high + LOD_DEUSSEN_STEPS > STEP_LAST ? STEP_LAST : high + LOD_DEUSSEN_STEPS;
	}
	while (high - low > 1 && !lod_planner_over(p, 2)) {
		int middle = low + (high - low) / 2;
		enum eco_code code = try_level(p, middle, &fits, error);
		if (code)
			return code;
		*(fits ? &low : &high) = middle;
	}
	*solution = low;
	return ECO_OK;
}

/* Wrong pixels summed over organs as if nothing overlapped, then shrunk to the picture. A picture that is
 * asked to hold t times its pixels is covered by the share t / (1 + t). */
static struct eco_prediction predict(const struct lod_planner *p)
{
	const struct eco_view *view = &p->input->request->view;
	double tp = 0, fp = 0, fn = 0, pixels = (double)view->width * view->height;
	for (uint32_t i = 0; i < p->entry_count; i++) {
		const struct lod_entry *entry = &p->entries[i];
		struct eco_curve curve = lod_planner_curve(p, entry, entry->vertices);
		double covered = entry->pixels * (double)entry->count;
		tp += covered * (1 - curve.fn);
		fp += covered * curve.fp;
		fn += covered * curve.fn;
	}
	double shrink = 1 / (1 + (tp + fn) / pixels);
	return (struct eco_prediction){ tp * shrink, fp * shrink, fn * shrink };
}

enum eco_code lod_rule_deussen(struct lod_planner *p, struct eco_error *error)
{
	int step;
	bool fits;
	enum eco_code code = solve(p, &step, error);
	if (!code)
		code = try_level(p, step < 0 ? 0 : step, &fits, error);
	if (code)
		return code;
	for (uint32_t i = 0; !fits && i < p->entry_count; i++)
		p->entries[i].vertices = 0;
	p->vertices = fits ? p->vertices : 0;
	p->converged = true;         /* by halving whole numbers of steps: there is one that fits, or none */
	p->sample_distance = distance_at(step < 0 ? 0 : step);
	p->prediction = predict(p);
	return ECO_OK;
}
