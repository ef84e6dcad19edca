/* Deussen's rule, solved for a budget: one sample distance d' (radians; the mean distance of neighbouring samples on the image plane
 * at distance 1) decides for every tile whether its summary suffices, and for every organ at every distance how many points or lines
 * it gets. Smaller d' means more vertices; the planner finds the smallest d' whose plan fits, then spends what remains where the
 * measured curves promise most.
 *
 * From Deussen 2002, section 5, with corrections:
 *   points  p = c_p A / (2 r^2) / d'^2. The paper multiplies by n_p as well and compares the result with n_p: a misprint.
 *           p < 2k the first p points, then the blend of 5.3, all triangles from 3k on.
 *   lines   q = A/(2 r^2) / (l d'/(2 r)) = A / (l r d'); q <= 1 and epsilon / r < d': q n_l lines; else polygons.
 *   importance multiplies an organ's share of the budget (4.3).
 *
 * V(d') is a step function and not quite monotone (a tile that opens may cost a little less than its summary did). So d' is
 * searched on a fixed exact grid, the plan's vertices are always counted, never inferred, and the structure (which tiles are open,
 * which plants show cells) may be taken from a finer d' than the amounts, where that uses the budget better. */
#include "lod/planner.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "lod/ladder.h"
#include "lod/visible.h"

#define SPLAT_FACTOR 1.3         /* c_p */
#define STEPS_PER_OCTAVE 32
#define STEP_LAST (STEPS_PER_OCTAVE * 60)
#define STRUCTURE_TRIES 12       /* finer structures looked at when budget is left over */

struct entry {                   /* one ladder for all plants of one slot, or a tile's summary */
	uint32_t slot;               /* ECO_NONE: a summary */
	uint32_t ladder;             /* summary: the node */
	uint64_t count;              /* plants */
	uint64_t vertices, full;     /* per plant */
	uint64_t more;               /* per plant whose hash is below `share`: this many instead */
	uint32_t share;
	double wanted;               /* points or lines of the whole region that d' asked for */
	double pixels;               /* expected covered pixels of one plant's organ */
};

struct planning {
	const struct lod_planner_input *input;
	const struct eco_scene *scene;
	struct lod_visible visible;
	uint8_t *gates;              /* per plant */
	uint32_t *ladder_first;      /* per anchor, into ladder_order; anchor_count + 1 */
	uint32_t *ladder_order;
	struct entry *entries;
	uint32_t entry_count, entry_capacity;
	uint64_t vertices;
	bool ended;                  /* every curve has ended: nothing could be added */
};

/* ---- One level of detail ---- */

/* Exact at every step: 2, then halved every STEPS_PER_OCTAVE steps, linear between. */
static double distance_at(int step)
{
	if (step >= STEP_LAST)
		return 0;
	int octave = step / STEPS_PER_OCTAVE, part = step % STEPS_PER_OCTAVE;
	return ldexp(2.0 - (double)part / STEPS_PER_OCTAVE, -octave);
}

static uint64_t list_count(const struct eco_scene *scene, uint32_t list)
{
	return list == ECO_NONE ? 0 : scene->lists[list].primitive_count;
}

static uint64_t to_count(double x)
{
	return !(x > 0) ? 0 : x >= 9e15 ? (uint64_t)9e15 : (uint64_t)x;
}

/* Vertices that d' asks of a ladder at distance r, before rounding to what it can draw; *wanted: points or lines of the region. */
static uint64_t ladder_wants(const struct eco_scene *scene, const struct eco_ladder *ladder, double r, double d, double *wanted)
{
	double importance = ladder->importance > 0 ? ladder->importance : 1;
	uint64_t full = lod_ladder_full(scene, ladder), points = list_count(scene, ladder->points);
	uint64_t lines = list_count(scene, ladder->lines);
	if (!(d > 0)) {
		*wanted = ladder->total;
		return full;
	}
	double samples = SPLAT_FACTOR * importance * ladder->area / (2.0 * r * r * d * d);
	if (points) {
		*wanted = samples;
		if (samples >= ladder->total)
			return to_count(samples / ladder->total * (double)points);
		uint64_t own = to_count(samples - ladder->before);
		return own < points ? own : points;
	}
	if (lines) {
		double q = ladder->length > 0 ? importance * ladder->area / (ladder->length * r * d) : 2;
		*wanted = q * ladder->total;
		if (q <= 1 && ladder->epsilon / r < d) {
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

/* The plant's cells are drawn in bands where its whole-plant lists do not suffice. */
static uint8_t gate_at(const struct planning *p, uint32_t plant, double d)
{
	const struct eco_scene *scene = p->scene;
	const struct eco_plant *pl = &scene->plants[plant];
	if (pl->anchor_count < 2)
		return 0;
	for (int band = ECO_BANDS - 1; band >= 0; band--) {
		double r = lod_band_distance_m((uint8_t)band), wanted;
		for (uint32_t i = 0; i < pl->ladder_count; i++) {
			const struct eco_ladder *ladder = &scene->ladders[pl->ladder_first + i];
			if (ladder->anchor != pl->anchor_first)
				continue;
			uint64_t points = list_count(scene, ladder->points), limit = points ? points : 2 * list_count(scene, ladder->lines);
			if (ladder_wants(scene, ladder, r, d, &wanted) > limit || (points && wanted > (double)points) || !(d > 0))
				return (uint8_t)(band + 1);
		}
	}
	return 0;
}

static enum eco_code open_structure(struct planning *p, int step, struct eco_error *error)
{
	double d = distance_at(step);
	for (uint32_t i = 0; i < p->scene->plant_count; i++)
		p->gates[i] = gate_at(p, i, d);
	return lod_visible_count(&p->visible, d, p->gates, error);
}

/* Share of pixels of the whole picture that one plant's organ is expected to cover: half its area, but not more than most of its
 * bounding disc. */
static double organ_pixels(const struct planning *p, const struct eco_ladder *ladder, double r)
{
	const struct eco_anchor *anchor = &p->scene->anchors[ladder->anchor];
	double disc = 2.0 * anchor->radius * anchor->radius, area = 0.5 * ladder->area;
	double pixel = r * p->visible.eye.pixel_rad;
	return (area < disc ? area : disc) / (pixel * pixel);
}

static enum eco_code add_entry(struct planning *p, const struct entry *entry, struct eco_error *error)
{
	if (p->entry_count == p->entry_capacity) {
		uint32_t wanted = p->entry_capacity ? 2 * p->entry_capacity : 256;
		struct entry *bigger = realloc(p->entries, wanted * sizeof *bigger);
		if (!bigger)
			return eco_fail(error, ECO_NO_MEMORY, "planning: no memory for %u cuts", wanted);
		p->entries = bigger;
		p->entry_capacity = wanted;
	}
	p->entries[p->entry_count++] = *entry;
	return ECO_OK;
}

static bool ladder_applies(const struct planning *p, const struct eco_ladder *ladder, const struct lod_slot *slot)
{
	return !(ladder->flags & ECO_LADDER_FAR) || slot->band >= p->gates[slot->plant];
}

static bool add_vertices(struct planning *p, uint64_t count, uint64_t vertices)
{
	uint64_t product;
	if (__builtin_mul_overflow(count, vertices, &product) || __builtin_add_overflow(p->vertices, product, &p->vertices))
		p->vertices = UINT64_MAX;
	return p->vertices != UINT64_MAX;
}

static enum eco_code add_summaries(struct planning *p, double d, struct eco_error *error)
{
	for (uint32_t i = 0; i < p->visible.node_count; i++) {
		const struct lod_node *node = &p->visible.nodes[i];
		if (node->state != LOD_SUMMARY)
			continue;
		uint64_t full = list_count(p->scene, p->scene->tiles[node->tile].summary);
		double wanted = d > 0 ? lod_summary_points(node, d) : INFINITY, pixel = node->distance * p->visible.eye.pixel_rad;
		struct entry entry = { .slot = ECO_NONE, .ladder = i, .count = 1, .full = full, .wanted = wanted };
		entry.vertices = to_count(wanted) < full ? to_count(wanted) : full;
		entry.pixels = pixel > 0 ? 0.5 * node->area / (pixel * pixel) : 0;
		if (add_entry(p, &entry, error))
			return ECO_NO_MEMORY;
		add_vertices(p, 1, entry.vertices);
		p->ended = false;        /* a summary is never everything */
	}
	return ECO_OK;
}

/* Fills entries and vertices for the open structure at the amounts of `step`. */
static enum eco_code amounts(struct planning *p, int step, struct eco_error *error)
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
		for (uint32_t i = p->ladder_first[slot->anchor]; i < p->ladder_first[slot->anchor + 1]; i++) {
			const struct eco_ladder *ladder = &p->scene->ladders[p->ladder_order[i]];
			if (!ladder_applies(p, ladder, slot))
				continue;
			struct entry entry = { .slot = s, .ladder = p->ladder_order[i], .count = slot->count,
				.full = lod_ladder_full(p->scene, ladder), .pixels = organ_pixels(p, ladder, r) };
			entry.vertices = lod_ladder_floor(p->scene, ladder, ladder_wants(p->scene, ladder, r, d, &entry.wanted));
			p->ended = p->ended && entry.vertices == entry.full && (!(ladder->flags & ECO_LADDER_FAR) || !(d > 0));
			if (add_entry(p, &entry, error))
				return ECO_NO_MEMORY;
			add_vertices(p, slot->count, entry.vertices);
		}
	}
	return add_summaries(p, d, error);
}

/* ---- The budget ---- */

static enum eco_code try_level(struct planning *p, int step, bool *fits, struct eco_error *error)
{
	struct eco_error local = { 0 };
	enum eco_code code = open_structure(p, step, &local);
	if (code == ECO_TOO_LARGE && step > 0) {
		p->ended = false;
		*fits = false;
		return ECO_OK;
	}
	if (code)
		return eco_fail(error, code, "%s", local.text);
	code = amounts(p, step, error);
	*fits = p->vertices <= p->input->request->vertices;
	return code;
}

/* Greatest step whose plan fits, -1 if none. */
static enum eco_code solve(struct planning *p, int *solution, struct eco_error *error)
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
		if (high == STEP_LAST)
			break;
		high = p->ended || high + STEPS_PER_OCTAVE > STEP_LAST ? STEP_LAST : high + STEPS_PER_OCTAVE;
	}
	while (high - low > 1) {
		int middle = low + (high - low) / 2;
		enum eco_code code = try_level(p, middle, &fits, error);
		if (code)
			return code;
		*(fits ? &low : &high) = middle;
	}
	*solution = low;
	return ECO_OK;
}

/* Amounts for the structure of `structure`, at the finest step not finer than it that fits; vertices 0 if none does. */
static enum eco_code amounts_that_fit(struct planning *p, int structure, struct eco_error *error)
{
	int low = -1, high = structure + 1;
	while (high - low > 1) {
		int middle = low + (high - low) / 2;
		enum eco_code code = amounts(p, middle, error);
		if (code)
			return code;
		*(p->vertices <= p->input->request->vertices ? &low : &high) = middle;
	}
	enum eco_code code = amounts(p, low < 0 ? 0 : low, error);
	if (low < 0 && !code) {
		p->vertices = 0;
		for (uint32_t i = 0; i < p->entry_count; i++)
			p->entries[i].vertices = 0;
	}
	return code;
}

/* ---- What remains ---- */

static struct eco_curve entry_curve(const struct planning *p, const struct entry *entry, uint64_t vertices)
{
	double share = entry->full ? (double)vertices / (double)entry->full : 1;
	if (entry->slot == ECO_NONE) /* summaries are not measured: random points over random plants */
		return (struct eco_curve){ .share = (float)share, .fp = (float)(0.3 * share), .fn = (float)(1 - 0.7 * share) };
	return lod_ladder_curve(p->scene, &p->scene->ladders[entry->ladder], share);
}

static uint64_t entry_floor(const struct planning *p, const struct entry *entry, uint64_t vertices)
{
	if (entry->slot == ECO_NONE)
		return vertices < entry->full ? vertices : entry->full;
	return lod_ladder_floor(p->scene, &p->scene->ladders[entry->ladder], vertices);
}

static uint64_t entry_next(const struct planning *p, const struct entry *entry, uint64_t vertices)
{
	if (entry->slot == ECO_NONE)
		return vertices < entry->full ? vertices + 1 : UINT64_MAX;
	return lod_ladder_next(p->scene, &p->scene->ladders[entry->ladder], vertices);
}

/* Next amount worth considering: about an eighth more, so that a fill takes few steps, and at least the next one possible. */
static uint64_t entry_target(const struct planning *p, const struct entry *entry)
{
	uint64_t next = entry_next(p, entry, entry->vertices);
	if (next == UINT64_MAX)
		return next;
	uint64_t further = entry_floor(p, entry, entry->vertices + entry->vertices / 8 + 1);
	return further > next ? further : next;
}

/* Wrong pixels saved per vertex by going to `target`. Never negative: a curve may rise by noise. */
static double entry_gain(const struct planning *p, const struct entry *entry, uint64_t target)
{
	struct eco_curve now = entry_curve(p, entry, entry->vertices), then = entry_curve(p, entry, target);
	double saved = ((double)now.fp + now.fn - then.fp - then.fn) * entry->pixels;
	return (saved > 0 ? saved : 0) / (double)(target - entry->vertices);
}

struct candidate { double gain; uint32_t entry; };

static bool before(const struct candidate *a, const struct candidate *b)
{
	return a->gain > b->gain || (a->gain == b->gain && a->entry < b->entry);
}

static void sift_down(struct candidate *heap, uint32_t count, uint32_t at)
{
	for (;;) {
		uint32_t best = at;
		for (uint32_t child = 2 * at + 1; child <= 2 * at + 2 && child < count; child++)
			if (before(&heap[child], &heap[best]))
				best = child;
		if (best == at)
			return;
		struct candidate swap = heap[at];
		heap[at] = heap[best];
		heap[best] = swap;
		at = best;
	}
}

/* Hashes of all plants in one slot. */
struct hashes { uint32_t anchor; uint8_t band; uint32_t count[ECO_SHARE_ONE]; };

static void collect_hash(void *ctx, const struct lod_anchor_band *anchors, uint32_t anchor_count, uint32_t plant, uint32_t hash)
{
	struct hashes *h = ctx;
	(void)plant;
	for (uint32_t i = 0; i < anchor_count; i++)
		if (anchors[i].anchor == h->anchor && anchors[i].band == h->band)
			h->count[hash]++;
}

/* Gives the next amount to as many plants of the slot as the budget allows: those with the smallest hashes. */
static uint64_t fill_share(struct planning *p, struct entry *entry, uint64_t left, struct hashes *hashes)
{
	const struct lod_slot *slot = &p->visible.slots[entry->slot];
	uint64_t next = entry_next(p, entry, entry->vertices);
	if (next == UINT64_MAX || next - entry->vertices > left)
		return 0;
	uint64_t most = left / (next - entry->vertices), plants = 0;
	memset(hashes, 0, sizeof *hashes);
	hashes->anchor = slot->anchor;
	hashes->band = slot->band;
	lod_visible_each(&p->visible, slot->plant, p->gates, collect_hash, hashes);
	uint32_t share = 0;
	while (share < ECO_SHARE_ONE && plants + hashes->count[share] <= most)
		plants += hashes->count[share++];
	if (plants == 0)
		return 0;
	entry->more = next;
	entry->share = share;
	return plants * (next - entry->vertices);
}

/* Spends what is left by gain per vertex: first on whole slots, then on shares of them. */
static enum eco_code fill(struct planning *p, struct eco_error *error)
{
	uint64_t left = p->input->request->vertices - p->vertices;
	struct candidate *heap = malloc((p->entry_count + 1) * sizeof *heap);
	struct hashes *hashes = malloc(sizeof *hashes);
	uint32_t count = 0;
	if (!heap || !hashes) {
		free(heap);
		free(hashes);
		return eco_fail(error, ECO_NO_MEMORY, "planning: no memory for %u candidates", p->entry_count);
	}
	for (uint32_t i = 0; i < p->entry_count; i++) {
		uint64_t target = entry_target(p, &p->entries[i]);
		if (target != UINT64_MAX)
			heap[count++] = (struct candidate){ entry_gain(p, &p->entries[i], target), i };
	}
	for (uint32_t i = count; i-- > 0;)
		sift_down(heap, count, i);
	while (count && left) {
		struct entry *entry = &p->entries[heap[0].entry];
		uint64_t target = entry_target(p, entry), affordable = entry->vertices + left / entry->count;
		if (target > affordable)
			target = entry_floor(p, entry, affordable);
		bool whole = target != UINT64_MAX && target > entry->vertices;
		if (whole) {
			left -= (target - entry->vertices) * entry->count;
			entry->vertices = target;
			target = entry_target(p, entry);
			heap[0].gain = target == UINT64_MAX ? -1 : entry_gain(p, entry, target);
		} else if (entry->count > 1) {
			left -= fill_share(p, entry, left, hashes);
		}
		if (!whole || target == UINT64_MAX)
			heap[0] = heap[--count];
		sift_down(heap, count, 0);
	}
	p->vertices = p->input->request->vertices - left;
	free(heap);
	free(hashes);
	return ECO_OK;
}

/* ---- The plan ---- */

static double entry_density(const struct planning *p, const struct entry *entry, uint64_t vertices)
{
	const struct eco_ladder *ladder = &p->scene->ladders[entry->ladder];
	const struct lod_slot *slot = &p->visible.slots[entry->slot];
	uint64_t shown = list_count(p->scene, ladder->points) ? vertices : list_count(p->scene, ladder->lines) ? vertices / 2 : vertices / 3;
	double density = ladder->total ? ((double)shown + ladder->before) / ladder->total : 1;
	/* where cells add to the coarse list, the plant as a whole is as dense as d' asked for */
	if (!slot->cell && slot->band < p->gates[slot->plant] && ladder->total && entry->wanted / ladder->total > density)
		density = entry->wanted / ladder->total;
	return density < 1 ? density : 1;
}

static void add_cuts(const struct planning *p, const struct entry *entry, uint64_t vertices, uint32_t share_first,
	uint32_t share_end, struct eco_plan *plan)
{
	const struct eco_ladder *ladder = &p->scene->ladders[entry->ladder];
	const struct lod_slot *slot = &p->visible.slots[entry->slot];
	struct eco_cut cuts[LOD_LADDER_CUTS_MAX];
	if (vertices == 0 || share_first == share_end)
		return;
	uint32_t count = lod_ladder_cuts(p->scene, ladder, vertices, entry_density(p, entry, vertices), cuts);
	for (uint32_t i = 0; i < count; i++) {
		cuts[i].anchor = slot->anchor;
		cuts[i].band_first = slot->band;
		cuts[i].band_end = (uint8_t)(slot->band + 1);
		cuts[i].share_first = share_first;
		cuts[i].share_end = share_end;
		plan->cuts[plan->cut_count++] = cuts[i];
	}
}

static void add_summary_cut(const struct planning *p, const struct entry *entry, const uint32_t *placement_in_plan,
	struct eco_plan *plan)
{
	const struct lod_node *node = &p->visible.nodes[entry->ladder];
	if (entry->vertices == 0)
		return;
	plan->cuts[plan->cut_count++] = (struct eco_cut){
		.list = p->scene->tiles[node->tile].summary, .end = (uint32_t)entry->vertices,
		.scale = (float)((double)entry->full / (double)entry->vertices),
		.placement = placement_in_plan[node->placement], .anchor = ECO_NONE, .share_end = ECO_SHARE_ONE };
}

static int by_anchor(const void *a, const void *b)
{
	const struct eco_cut *x = a, *y = b;
	uint32_t kx[8] = { x->anchor + 1, x->placement, x->list, x->first, x->end, x->share_first, x->share_end, x->band_first };
	uint32_t ky[8] = { y->anchor + 1, y->placement, y->list, y->first, y->end, y->share_first, y->share_end, y->band_first };
	for (int i = 0; i < 8; i++)
		if (kx[i] != ky[i])
			return kx[i] < ky[i] ? -1 : 1;
	return 0;
}

/* Cuts that differ only in their band, one after the other, become one. */
static void merge_bands(struct eco_plan *plan)
{
	uint32_t kept = 0;
	qsort(plan->cuts, plan->cut_count, sizeof *plan->cuts, by_anchor);
	for (uint32_t i = 0; i < plan->cut_count; i++) {
		struct eco_cut *last = kept ? &plan->cuts[kept - 1] : NULL, *cut = &plan->cuts[i];
		if (last && cut->anchor != ECO_NONE && last->anchor == cut->anchor && last->list == cut->list && last->first == cut->first
				&& last->end == cut->end && last->scale == cut->scale && last->share_first == cut->share_first
				&& last->share_end == cut->share_end && last->band_end == cut->band_first)
			last->band_end = cut->band_end;
		else
			plan->cuts[kept++] = *cut;
	}
	plan->cut_count = kept;
}

static int by_list(const void *a, const void *b)
{
	const struct eco_run *x = a, *y = b;
	if (x->placement != y->placement)
		return x->placement < y->placement ? -1 : 1;
	return x->list_first < y->list_first ? -1 : x->list_first > y->list_first;
}

static void add_runs(const struct planning *p, const uint32_t *placement_in_plan, struct eco_plan *plan)
{
	for (uint32_t n = 0; n < p->visible.node_count; n++) {
		const struct lod_node *node = &p->visible.nodes[n];
		const struct eco_tile *tile = &p->scene->tiles[node->tile];
		if (node->state != LOD_OPEN || node->plants == 0)
			continue;
		for (uint32_t g = 0; g < tile->group_count; g++) {
			uint32_t list = p->scene->groups[tile->group_first + g].list;
			plan->runs[plan->run_count++] = (struct eco_run){ placement_in_plan[node->placement], list, list + 1 };
		}
	}
	qsort(plan->runs, plan->run_count, sizeof *plan->runs, by_list);
	uint32_t kept = 0;
	for (uint32_t i = 0; i < plan->run_count; i++) {
		struct eco_run *last = kept ? &plan->runs[kept - 1] : NULL;
		if (last && last->placement == plan->runs[i].placement && last->list_end == plan->runs[i].list_first)
			last->list_end = plan->runs[i].list_end;
		else
			plan->runs[kept++] = plan->runs[i];
	}
	plan->run_count = kept;
}

/* Only placements that something is drawn in; the scene itself is always [0]. */
static void add_placements(const struct planning *p, uint32_t *placement_in_plan, struct eco_plan *plan)
{
	for (uint32_t i = 0; i < p->visible.placement_count; i++)
		placement_in_plan[i] = ECO_NONE;
	placement_in_plan[0] = 0;
	plan->placements[plan->placement_count++] = p->visible.placements[0];
	for (uint32_t n = 0; n < p->visible.node_count; n++) {
		const struct lod_node *node = &p->visible.nodes[n];
		bool drawn = node->state == LOD_SUMMARY || (node->state == LOD_OPEN && node->plants);
		if (!drawn || placement_in_plan[node->placement] != ECO_NONE)
			continue;
		placement_in_plan[node->placement] = plan->placement_count;
		plan->placements[plan->placement_count++] = p->visible.placements[node->placement];
	}
}

/* Wrong pixels summed over organs as if nothing overlapped, then shrunk to what a picture can hold: covered share c of a picture that
 * asks for t times its pixels is t / (1 + t). */
static void predict(const struct planning *p, struct eco_plan *plan)
{
	const struct eco_view *view = &p->input->request->view;
	double tp = 0, fp = 0, fn = 0, pixels = (double)view->width * view->height;
	for (uint32_t i = 0; i < p->entry_count; i++) {
		const struct entry *entry = &p->entries[i];
		struct eco_curve curve = entry_curve(p, entry, entry->vertices);
		double covered = entry->pixels * (double)entry->count;
		tp += covered * (1 - curve.fn);
		fp += covered * curve.fp;
		fn += covered * curve.fn;
	}
	double shrink = 1 / (1 + (tp + fn) / pixels);
	plan->prediction = (struct eco_prediction){ tp * shrink, fp * shrink, fn * shrink };
}

static enum eco_code emit(const struct planning *p, int step, struct eco_plan *plan, struct eco_error *error)
{
	uint32_t groups = 0;
	for (uint32_t n = 0; n < p->visible.node_count; n++)
		if (p->visible.nodes[n].state == LOD_OPEN)
			groups += p->scene->tiles[p->visible.nodes[n].tile].group_count;
	plan->cuts = malloc((2 * LOD_LADDER_CUTS_MAX * (size_t)p->entry_count + 1) * sizeof *plan->cuts);
	plan->runs = malloc((groups + 1) * sizeof *plan->runs);
	plan->gates = malloc((p->scene->plant_count + 1) * sizeof *plan->gates);
	plan->placements = malloc(p->visible.placement_count * sizeof *plan->placements);
	uint32_t *placement_in_plan = malloc(p->visible.placement_count * sizeof *placement_in_plan);
	if (!plan->cuts || !plan->runs || !plan->gates || !plan->placements || !placement_in_plan) {
		free(placement_in_plan);
		return eco_fail(error, ECO_NO_MEMORY, "planning: no memory for a plan of %u cuts", p->entry_count);
	}
	add_placements(p, placement_in_plan, plan);
	add_runs(p, placement_in_plan, plan);
	for (uint32_t i = 0; i < p->entry_count; i++) {
		const struct entry *entry = &p->entries[i];
		if (entry->slot == ECO_NONE) {
			add_summary_cut(p, entry, placement_in_plan, plan);
			continue;
		}
		add_cuts(p, entry, entry->more, 0, entry->share, plan);
		add_cuts(p, entry, entry->vertices, entry->share, ECO_SHARE_ONE, plan);
	}
	free(placement_in_plan);
	for (uint32_t i = 0; i < p->scene->plant_count; i++)
		if (p->gates[i])
			plan->gates[plan->gate_count++] = (struct eco_gate){ i, p->gates[i] };
	merge_bands(plan);
	predict(p, plan);
	plan->vertices = p->vertices;
	plan->visible_plants = p->visible.plants;
	plan->sample_distance = distance_at(step);
	plan->ground = p->scene->ground != ECO_NONE;
	return ECO_OK;
}

/* ---- Putting it together ---- */

static enum eco_code planning_init(struct planning *p, const struct lod_planner_input *input, struct eco_error *error)
{
	const struct eco_scene *scene = input->scene;
	*p = (struct planning){ .input = input, .scene = scene };
	p->gates = calloc(scene->plant_count + 1, 1);
	p->ladder_first = calloc(scene->anchor_count + 2, sizeof *p->ladder_first);
	p->ladder_order = calloc(scene->ladder_count + 1, sizeof *p->ladder_order);
	if (!p->gates || !p->ladder_first || !p->ladder_order)
		return eco_fail(error, ECO_NO_MEMORY, "planning: no memory for %u ladders", scene->ladder_count);
	for (uint32_t i = 0; i < scene->ladder_count; i++)
		p->ladder_first[scene->ladders[i].anchor + 2]++;
	for (uint32_t i = 2; i <= scene->anchor_count + 1; i++)
		p->ladder_first[i] += p->ladder_first[i - 1];
	for (uint32_t i = 0; i < scene->ladder_count; i++)
		p->ladder_order[p->ladder_first[scene->ladders[i].anchor + 1]++] = i;
	return lod_visible_init(&p->visible, scene, &input->request->view, input->tiles_max ? input->tiles_max : 1000000,
		input->placements_max ? input->placements_max : 100000, error);
}

static void planning_free(struct planning *p)
{
	free(p->gates);
	free(p->ladder_first);
	free(p->ladder_order);
	free(p->entries);
	if (p->visible.nodes)
		lod_visible_free(&p->visible);
}

static enum eco_code plan_structure(struct planning *p, int structure, struct eco_error *error)
{
	enum eco_code code = open_structure(p, structure, error);
	if (!code)
		code = amounts_that_fit(p, structure, error);
	if (!code)
		code = fill(p, error);
	return code;
}

/* The structure that uses the budget best: the solved one, or, where its curves have all ended below the budget, a finer one. */
static enum eco_code best_structure(struct planning *p, int solved, int *best, struct eco_error *error)
{
	uint64_t most = 0, budget = p->input->request->vertices;
	*best = solved < 0 ? 0 : solved;
	int step = *best, stride = 1;
	for (int i = 0; i < STRUCTURE_TRIES; i++) {
		struct eco_error local = { 0 };
		enum eco_code code = plan_structure(p, step, &local);
		if (code && code != ECO_TOO_LARGE)
			return eco_fail(error, code, "%s", local.text);
		if (code && i == 0)
			return eco_fail(error, code, "%s", local.text);
		if (code)
			break;
		if (p->vertices > most || i == 0) {
			most = p->vertices;
			*best = step;
		}
		if (most == budget || step == STEP_LAST)
			break;
		step = step + stride < STEP_LAST ? step + stride : STEP_LAST;
		stride *= 2;
	}
	return ECO_OK;
}

enum eco_code lod_plan(struct eco_plan *plan, const struct lod_planner_input *input, struct eco_error *error)
{
	struct planning p;
	int solved, structure;
	assert(input->request->vertices <= ECO_VERTICES_MAX);
	*plan = (struct eco_plan){ 0 };
	enum eco_code code = planning_init(&p, input, error);
	if (!code)
		code = solve(&p, &solved, error);
	if (!code)
		code = best_structure(&p, solved, &structure, error);
	if (!code)
		code = plan_structure(&p, structure, error);
	if (!code)
		code = emit(&p, structure, plan, error);
	planning_free(&p);
	if (code)
		eco_plan_free(plan);
	return code;
}

/* ---- Needs ---- */

static uint32_t chunks_for(const struct eco_scene *scene, uint32_t list, uint32_t end)
{
	const struct eco_list *l = &scene->lists[list];
	uint64_t have = 0;
	uint32_t chunks = 0;
	while (have < end && chunks < l->chunk_count)
		have += scene->chunks[l->chunk_first + chunks++].primitive_count;
	return chunks;
}

static int by_holding(const void *a, const void *b)
{
	const struct eco_holding *x = a, *y = b;
	if (x->list != y->list)
		return x->list < y->list ? -1 : 1;
	return x->chunks < y->chunks ? -1 : x->chunks > y->chunks;
}

enum eco_code lod_plan_needs(const struct eco_scene *scene, const struct eco_plan *plan, struct eco_holdings *needs,
	struct eco_error *error)
{
	size_t most = 2 * (size_t)plan->cut_count + 1;
	for (uint32_t i = 0; i < plan->run_count; i++)
		most += plan->runs[i].list_end - plan->runs[i].list_first;
	*needs = (struct eco_holdings){ .items = malloc(most * sizeof *needs->items) };
	if (!needs->items)
		return eco_fail(error, ECO_NO_MEMORY, "planning: no memory for %zu lists", most);
	struct eco_holding *items = needs->items;
	uint32_t count = 0, kept = 0;
	if (plan->ground)
		items[count++] = (struct eco_holding){ scene->ground, scene->lists[scene->ground].chunk_count };
	for (uint32_t i = 0; i < plan->run_count; i++)
		for (uint32_t list = plan->runs[i].list_first; list < plan->runs[i].list_end; list++)
			items[count++] = (struct eco_holding){ list, scene->lists[list].chunk_count };
	for (uint32_t i = 0; i < plan->cut_count; i++) {
		uint32_t list = plan->cuts[i].list, image = scene->lists[list].image;
		items[count++] = (struct eco_holding){ list, chunks_for(scene, list, plan->cuts[i].end) };
		if (image != ECO_NONE)
			items[count++] = (struct eco_holding){ image, scene->lists[image].chunk_count };
	}
	qsort(items, count, sizeof *items, by_holding);
	for (uint32_t i = 0; i < count; i++)         /* of equal lists the last asks for most */
		if (i + 1 == count || items[i + 1].list != items[i].list)
			items[kept++] = items[i];
	needs->count = kept;
	return ECO_OK;
}
