/* From a rule's cuts to a plan. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/array_grow.h"
#include "ecofiles/format/wire.h"
#include "tests/bench/baseline/paper_scene.h"

#define HALVINGS 26

enum eco_code paper_begin(struct paper *p, const struct paper_scene *s, const struct eco_request *request,
	struct eco_error *error)
{
	*p = (struct paper){ .s = s, .request = *request };
	p->request.texel_px = ECO_TEXEL_PX_MIN;
	p->input =
		(struct lod_planner_input){ .scene = s->scene, .tables = s->tables, .request = &p->request };
	return lod_planner_begin(&p->p, &p->input, error);
}

void paper_end(struct paper *p)
{
	lod_planner_end(&p->p);
	free(p->cuts);
}

void paper_clear(struct paper *p)
{
	p->cut_count = 0;
	p->p.entry_count = 0;
	p->p.vertices = 0;
}

static enum eco_code add_summaries(struct paper *p, double d, struct eco_error *error)
{
	enum eco_code code = ECO_OK;
	for (uint32_t i = 0; i < p->p.visible.node_count && !code; i++) {
		const struct lod_node *node = &p->p.visible.nodes[i];
		if (node->state != LOD_SUMMARY)
			continue;
		uint64_t full = lod_planner_count(p->s->scene, p->s->scene->tiles[node->tile].summary);
		struct lod_entry entry = { .slot = ECO_NONE,
			.ladder = i,
			.count = 1,
			.full = full,
			.wanted = lod_summary_points(node, d) };
		entry.vertices = entry.wanted < (double)full ? (uint64_t)entry.wanted : full;
		code = lod_planner_add(&p->p, &entry, error);
		p->p.vertices += entry.vertices;
	}
	return code;
}

enum eco_code paper_open(struct paper *p, double d, struct eco_error *error)
{
	enum eco_code code = lod_visible_tree_count(&p->p.visible, d, p->p.gates, error);
	return code ? code : add_summaries(p, d, error);
}

bool paper_applies(const struct paper *p, const struct eco_ladder *ladder, const struct lod_slot *slot)
{
	return !(ladder->flags & ECO_LADDER_FAR) || eco_gate_place(slot->band, 0) >= p->p.gates[slot->plant];
}

void paper_cut(struct paper *p, const struct lod_slot *slot, const struct eco_cut *cut)
{
	if (cut->end <= cut->first)
		return;
	if (!eco_array_grow(&p->cuts, &p->cut_room, p->cut_count, sizeof *p->cuts)) {
		p->no_memory = true;
		return;
	}
	struct eco_cut *out = &p->cuts[p->cut_count++];
	*out = *cut;
	out->scale = eco_wire_scale_round(out->scale);
	out->anchor = slot->anchor;
	out->band_first = slot->band;
	out->band_end = (uint8_t)(slot->band + 1);
	if (!cut->share_end)
		out->share_end = ECO_SHARE_ONE;
}

/* ---- Counting ---- */

static int by_plants(const void *a, const void *b)
{
	const struct eco_cut *x = a, *y = b;
	uint32_t kx[7] = { x->anchor, x->band_first, x->share_first, x->share_end, x->list, x->first,
		y->end },
		 ky[7] = { y->anchor, y->band_first, y->share_first, y->share_end, y->list, y->first,
			 x->end };
	for (int i = 0; i < 7; i++)
		if (kx[i] != ky[i])
			return kx[i] < ky[i] ? -1 : 1;
	return 0;
}

static uint32_t first_cut(const struct paper *p, const struct lod_anchor_band *at)
{
	uint32_t low = 0, high = p->cut_count;
	while (low < high) {
		uint32_t middle = low + (high - low) / 2;
		const struct eco_cut *cut = &p->cuts[middle];
		if (cut->anchor < at->anchor || (cut->anchor == at->anchor && cut->band_first < at->band))
			low = middle + 1;
		else
			high = middle;
	}
	return low;
}

/* Cuts of one anchor and band come by share: those that begin beyond the hash end the walk. */
static void count_plant(void *ctx, const struct lod_anchor_band *anchors, uint32_t count, uint32_t plant,
	uint32_t hash)
{
	struct paper *p = ctx;
	(void)plant;
	for (uint32_t a = 0; a < count; a++)
		for (uint32_t i = first_cut(p, &anchors[a]); i < p->cut_count; i++) {
			const struct eco_cut *cut = &p->cuts[i];
			if (cut->anchor != anchors[a].anchor || cut->band_first != anchors[a].band ||
				cut->share_first > hash)
				break;
			if (hash >= cut->share_end)
				continue;
			const struct eco_list *list = &view_store_list(p->s->store, cut->list)->list;
			p->p.vertices += (uint64_t)(cut->end - cut->first) * eco_list_vertices(list);
		}
}

uint64_t paper_vertices(struct paper *p)
{
	uint32_t kept = 0;
	if (p->cut_count)
		qsort(p->cuts, p->cut_count, sizeof *p->cuts, by_plants);
	for (uint32_t i = 0; i < p->cut_count; i++) {
		const struct eco_cut *last = kept ? &p->cuts[kept - 1] : NULL, *cut = &p->cuts[i];
		bool again = last && last->anchor == cut->anchor && last->band_first == cut->band_first &&
			last->share_first == cut->share_first && last->share_end == cut->share_end &&
			last->list == cut->list && last->first == cut->first;
		if (!again)
			p->cuts[kept++] = *cut;
	}
	p->cut_count = kept;
	p->p.vertices = 0;
	for (uint32_t i = 0; i < p->p.entry_count; i++)
		p->p.vertices += p->p.entries[i].vertices;
	for (uint32_t i = 0; i < p->s->scene->plant_count; i++)
		lod_visible_tree_each(&p->p.visible, i, p->p.gates, count_plant, p);
	return p->p.vertices;
}

/* ---- Plans ---- */

static bool has_cut(const struct eco_plan *plan, uint32_t list)
{
	for (uint32_t i = 0; i < plan->cut_count; i++)
		if (plan->cuts[i].list == list)
			return true;
	return false;
}

/* All textures, whole; `plan` has room. */
static void add_textures(const struct eco_scene *scene, struct eco_plan *plan)
{
	for (uint32_t i = 0; i < scene->list_count; i++)
		if ((scene->lists[i].kind == ECO_LIST_IMAGE || scene->lists[i].kind == ECO_LIST_OUTLINE)
				&& !has_cut(plan, i))
			plan->cuts[plan->cut_count++] = (struct eco_cut){ .list = i,
				.end = scene->lists[i].chunk_count, .scale = 1, .anchor = ECO_NONE,
				.share_end = ECO_SHARE_ONE };
}

enum eco_code paper_finish(struct paper *p, struct eco_plan *plan, struct eco_error *error)
{
	*plan = (struct eco_plan){ 0 };
	paper_vertices(p);
	enum eco_code code = p->no_memory
		? eco_fail(error, ECO_NO_MEMORY, "no memory for %u cuts", p->cut_count)
		: lod_planner_emit(&p->p, plan, error);
	/* ground first: it looks cuts up in the pack, which has not all of the rule's lists */
	if (!code)
		code = lod_plan_ground(plan, p->s->scene, &p->request.view, p->request.ground_px, error);
	struct eco_cut *cuts = code
		? NULL
		: realloc(plan->cuts, ((size_t)plan->cut_count + p->cut_count + p->s->scene->list_count + 1)
		* sizeof *cuts);
	if (!code && !cuts)
		code = eco_fail(error, ECO_NO_MEMORY, "no memory for %u cuts", p->cut_count);
	if (cuts) {
		plan->cuts = cuts;
		if (p->cut_count)
			memcpy(cuts + plan->cut_count, p->cuts, p->cut_count * sizeof *cuts);
		plan->cut_count += p->cut_count;
		add_textures(p->s->scene, plan);
	}
	if (code)
		eco_plan_free(plan);
	else
		eco_plan_sort(plan);
	return code;
}

static enum eco_code try_rule(struct paper *p, paper_rule *rule, void *ctx, double x, bool *fits,
	struct eco_error *error)
{
	struct eco_error local = { 0 };
	paper_clear(p);
	enum eco_code code = rule(p, x, ctx, &local);
	if (code == ECO_TOO_LARGE) {
		*fits = false;
		return lod_visible_tree_restart(&p->p.visible, error);
	}
	*fits = !code && paper_vertices(p) <= p->request.vertices;
	return code ? eco_fail(error, code, "%s", local.text) : ECO_OK;
}

enum eco_code paper_solve(struct paper *p, paper_rule *rule, void *ctx, double few, double many, double *x,
	struct eco_plan *plan, struct eco_error *error)
{
	bool fits;
	enum eco_code code = try_rule(p, rule, ctx, many, &fits, error);
	*x = many;
	if (!code && !fits) {
		for (int i = 0; i < HALVINGS && !code; i++) {
			double middle = sqrt(few * many);
			code = try_rule(p, rule, ctx, middle, &fits, error);
			*(fits ? &few : &many) = middle;
		}
		*x = few;
		if (!code)
			code = try_rule(p, rule, ctx, few, &fits, error);
		if (!code && !fits)
			paper_clear(p);
	}
	return code ? code : paper_finish(p, plan, error);
}
