/* The rest of a budget once d' is found: see lod/plan/planner_state.h. Greedy by wrong pixels saved per
 * vertex, first on whole slots, then on shares of them, so that the last vertices go to as many plants as
 * possible. It ends early where the work is done that the plan may take. */
#include "lod/plan/planner_state.h"

#include <stdlib.h>
#include <string.h>

#include "lod/heap.h"
#include "lod/ladder.h"

struct eco_curve lod_planner_curve(const struct lod_planner *p, const struct lod_entry *entry,
	uint64_t vertices)
{
	const struct eco_ladder *ladder = &p->scene->ladders[entry->ladder];
	if (entry->slot == ECO_NONE) { /* summaries are not measured: random points over random plants */
		double share = entry->full ? (double)vertices / (double)entry->full : 1;
		return (struct eco_curve){ .share = (float)share, .fp = (float)(0.3 * share),
			.fn = (float)(1 - 0.7 * share) };
	}
	return lod_ladder_curve(p->scene, ladder, lod_way_share(lod_planner_way(p, entry->ladder), vertices));
}

static uint64_t entry_floor(const struct lod_planner *p, const struct lod_entry *entry, uint64_t vertices)
{
	vertices = vertices < entry->full ? vertices : entry->full;
	return entry->slot == ECO_NONE ? vertices : lod_way_floor(lod_planner_way(p, entry->ladder),
		vertices);
}

static uint64_t entry_next(const struct lod_planner *p, const struct lod_entry *entry, uint64_t vertices)
{
	if (vertices >= entry->full)
		return UINT64_MAX;
	return entry->slot == ECO_NONE ? vertices + 1 : lod_way_next(lod_planner_way(p, entry->ladder),
		vertices);
}

/* The next number of vertices to try: about an eighth more, so that a fill takes few steps. */
static uint64_t entry_target(const struct lod_planner *p, const struct lod_entry *entry)
{
	uint64_t next = entry_next(p, entry, entry->vertices);
	if (next == UINT64_MAX)
		return next;
	uint64_t further = entry_floor(p, entry, entry->vertices + entry->vertices / 8 + 1);
	return further > next ? further : next;
}

/* Wrong pixels saved per vertex by going to `target`. Never negative: a curve may rise by noise. */
static double entry_gain(const struct lod_planner *p, const struct lod_entry *entry, uint64_t target)
{
	struct eco_curve now = lod_planner_curve(p, entry, entry->vertices),
		then = lod_planner_curve(p, entry, target);
	double saved = ((double)now.fp + now.fn - then.fp - then.fn) * entry->pixels;
	return (saved > 0 ? saved : 0) / (double)(target - entry->vertices);
}

#define STEP_WORK (5 * LOD_WORK_CURVE)
#define SHARE_WORK 8000u         /* beside the plants that are gone through */

/* Plants of one slot by hash. */
struct hashes { uint32_t anchor; uint8_t band; uint32_t count[ECO_SHARE_ONE]; };

static void collect_hash(void *ctx, const struct lod_anchor_band *anchors, uint32_t anchor_count,
	uint32_t plant, uint32_t hash)
{
	struct hashes *h = ctx;
	(void)plant;
	for (uint32_t i = 0; i < anchor_count; i++)
		if (anchors[i].anchor == h->anchor && anchors[i].band == h->band)
			h->count[hash]++;
}

/* Gives the next number of vertices to as many plants of the slot as fit: those with the smallest hashes. */
static uint64_t fill_share(struct lod_planner *p, struct lod_entry *entry, uint64_t left,
	struct hashes *hashes)
{
	const struct lod_slot *slot = &p->visible.slots[entry->slot];
	uint64_t next = entry_next(p, entry, entry->vertices);
	if (next == UINT64_MAX || next - entry->vertices > left)
		return 0;
	uint64_t most = left / (next - entry->vertices), plants = 0;
	memset(hashes, 0, sizeof *hashes);
	hashes->anchor = slot->anchor;
	hashes->band = slot->band;
	lod_planner_work(p, SHARE_WORK + LOD_WORK_TALLY * p->visible.plants);
	lod_visible_tree_each(&p->visible, slot->plant, p->gates, collect_hash, hashes);
	uint32_t share = 0;
	while (share < ECO_SHARE_ONE && plants + hashes->count[share] <= most)
		plants += hashes->count[share++];
	if (plants == 0)
		return 0;
	entry->more = next;
	entry->share = share;
	entry->reason = (struct lod_reason){ .why = LOD_WHY_LEFT_OVER, .ahead = plants };
	return plants * (next - entry->vertices);
}

/* Nothing has to be chosen if all that is open fits. False: it does not. */
static bool fill_all(struct lod_planner *p)
{
	uint64_t left = p->input->request->vertices - p->vertices, sum = 0, more;
	for (uint32_t i = 0; i < p->entry_count; i++) {
		const struct lod_entry *entry = &p->entries[i];
		if (__builtin_mul_overflow(entry_floor(p, entry, entry->full) - entry->vertices, entry->count, &more)
				|| __builtin_add_overflow(sum, more, &sum) || sum > left)
			return false;
	}
	for (uint32_t i = 0; i < p->entry_count; i++) {
		struct lod_entry *entry = &p->entries[i];
		uint64_t most = entry_floor(p, entry, entry->full);
		if (most > entry->vertices)
			entry->reason.why = LOD_WHY_LEFT_OVER;
		entry->vertices = most;
	}
	p->vertices += sum;
	return true;
}

enum eco_code lod_planner_fill(struct lod_planner *p, struct eco_error *error)
{
	if (fill_all(p))
		return ECO_OK;
	uint64_t left = p->input->request->vertices - p->vertices;
	struct lod_heap_item *heap = malloc((p->entry_count + 1) * sizeof *heap);
	struct hashes *hashes = malloc(sizeof *hashes);
	uint32_t count = 0;
	if (!heap || !hashes) {
		free(heap);
		free(hashes);
		return eco_fail(error, ECO_NO_MEMORY, "planning: no memory for %u candidates",
			p->entry_count);
	}
	for (uint32_t i = 0; i < p->entry_count; i++) {
		uint64_t target = entry_target(p, &p->entries[i]);
		if (target != UINT64_MAX)
			heap[count++] = (struct lod_heap_item){ entry_gain(p, &p->entries[i], target), i };
	}
	lod_heap_make(heap, count);
	lod_planner_work(p, STEP_WORK * (uint64_t)count);
	while (count && left && !lod_planner_over(p, 4)) {
		lod_planner_work(p, STEP_WORK);
		struct lod_entry *entry = &p->entries[heap[0].id];
		uint64_t target = entry_target(p, entry), affordable = entry->vertices + left / entry->count;
		if (target > affordable)
			target = entry_floor(p, entry, affordable);
		bool whole = target != UINT64_MAX && target > entry->vertices;
		if (whole) {
			left -= (target - entry->vertices) * entry->count;
			entry->vertices = target;
			entry->reason.why = LOD_WHY_LEFT_OVER;
			target = entry_target(p, entry);
			heap[0].key = target == UINT64_MAX ? -1 : entry_gain(p, entry, target);
		} else if (entry->count > 1) {
			left -= fill_share(p, entry, left, hashes);
		}
		if (!whole || target == UINT64_MAX)
			heap[0] = heap[--count];
		lod_heap_sift(heap, count, 0);
	}
	p->vertices = p->input->request->vertices - left;
	free(heap);
	free(hashes);
	return ECO_OK;
}
