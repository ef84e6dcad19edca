/* Packs for the rules of papers, and plans of cuts. */
#include <stdlib.h>
#include <string.h>

#include "client-min/view_measure.h"
#include "ecofiles/base/memory.h"
#include "lod/ladder.h"
#include "tests/bench/baseline/paper_rules.h"

static struct eco_error failure;
struct eco_error *const paper_error = &failure;

void paper_must(enum eco_code code)
{
	if (code)
		eco_end(failure.text);
}

/* ---- Lists of the pack ---- */

static bool is_held(const struct eco_list *list)
{
	return list->kind != ECO_LIST_IMPOSTOR && list->kind != ECO_LIST_INVENTORY
		&& !(list->attributes & ECO_ATTR_SPLAT);
}

/* A paper scales all leaves alike. */
static void grow_plainly(const struct view_list *list)
{
	if (!(list->list.attributes & ECO_ATTR_GROWTH))
		return;
	uint32_t at = eco_list_extra_at(&list->list, ECO_ATTR_GROWTH), each = list->elements.extra_count;
	for (uint32_t i = 0; i < list->elements.element_count; i++)
		list->elements.extra[(size_t)i * each + at] = ECO_GROWTH_PLAIN;
}

static void feed_list(struct paper_scene *s, uint32_t id)
{
	const struct eco_list *list = &s->scene->lists[id];
	paper_must(view_store_events.list(s->store, id, list, s->scene->palette + list->palette_first,
		list->group_count ? eco_list_groups(s->scene, id) : NULL, paper_error));
	for (uint32_t i = 0; i < list->chunk_count; i++) {
		const uint8_t *bytes;
		size_t size;
		paper_must(eco_pack_payload(s->pack, list->chunk_first + i, &bytes, &size, paper_error));
		paper_must(view_store_events.chunk(s->store, id, i, &s->scene->chunks[list->chunk_first + i],
			bytes, paper_error));
	}
	grow_plainly(view_store_list(s->store, id));
}

static void feed_pack(struct paper_scene *s)
{
	const struct eco_scene *scene = s->scene;
	paper_must(view_store_events.scene(s->store, scene, &s->pack->id, paper_error));
	for (uint32_t i = 0; i < scene->plant_count; i++)
		paper_must(view_store_events.plant(s->store, i, &scene->plants[i],
			scene->anchors + scene->plants[i].anchor_first,
			scene->plants[i].anchor_count, paper_error));
	/* forms come after what they are forms of */
	for (int forms = 0; forms < 2; forms++)
		for (uint32_t i = 0; i < scene->list_count; i++)
			if (is_held(&scene->lists[i]) && (scene->lists[i].partner != ECO_NONE) == forms)
				feed_list(s, i);
}

bool paper_is_leaves(const struct eco_ladder *ladder)
{
	return ladder->organ != ECO_ORGAN_WOOD && !(ladder->flags & ECO_LADDER_WHOLE)
		&& ladder->triangles != ECO_NONE;
}

/* ---- Tables ---- */

static void count_triangles(struct paper_scene *s, uint32_t list)
{
	const struct eco_elements *e = &view_store_list(s->store, list)->elements;
	uint32_t *sums = s->triangles[list];
	if (!sums)
		sums = s->triangles[list] = eco_alloc(e->element_count + 1u, sizeof *sums);
	for (uint32_t i = 0; i < e->element_count; i++)
		sums[i + 1] = sums[i] + e->corners[i] - 2;
}

static void make_tables(struct paper_scene *s)
{
	const struct eco_scene *scene = s->scene;
	s->triangles = eco_alloc(scene->list_count, sizeof *s->triangles);
	s->wood_full = eco_alloc(scene->plant_count, sizeof *s->wood_full);
	for (uint32_t i = 0; i < scene->ladder_count; i++) {
		const struct eco_ladder *l = &scene->ladders[i];
		if (l->organ == ECO_ORGAN_WOOD && !(l->flags & (ECO_LADDER_FAR | ECO_LADDER_WHOLE)))
			s->wood_full[l->plant] += (double)lod_ladder_full(scene, l);
		if (paper_is_leaves(l))
			count_triangles(s, l->triangles);
	}
}

uint32_t paper_triangles(const struct paper_scene *s, uint32_t list, uint32_t elements)
{
	uint32_t most = s->scene->lists[list].element_count;
	return s->triangles[list][elements < most ? elements : most];
}

enum eco_code paper_scene_open(struct paper_scene **scene, const char *pack, struct eco_error *error)
{
	struct view_store_options options = { .images = true, .memory_max = 16ull << 30 };
	struct paper_scene *s = eco_alloc(1, sizeof *s);
	enum eco_code code = eco_pack_open(&s->pack, pack, error);
	*scene = s;
	if (code)
		return code;
	s->scene = &s->pack->scene;
	paper_must(lod_plan_tables_make(&s->tables, s->scene, paper_error));
	paper_must(view_store_new(&s->store, &options, paper_error));
	feed_pack(s);
	make_tables(s);
	paper_deussen_lists(s);
	return ECO_OK;
}

void paper_scene_close(struct paper_scene *s)
{
	if (!s)
		return;
	for (uint32_t i = 0; s->triangles && i < s->scene->list_count; i++)
		free(s->triangles[i]);
	eco_free(s->triangles, s->points, s->lines, s->wood_full);
	view_store_free(s->store);
	lod_plan_tables_free(s->tables);
	if (s->pack)
		eco_pack_close(s->pack);
	free(s);
}

/* ---- Drawing ---- */

static void draw(struct paper_scene *s, struct eco_plan *plan, const struct eco_view *view, uint32_t samples,
	struct paper_frame *frame)
{
	struct lod_eye eye;
	*frame = (struct paper_frame){ 0 };
	lod_eye_make(&eye, view);
	view_store_begin(s->store);
	paper_must(view_store_events.plan(s->store, plan, paper_error));
	paper_must(view_select_make(&frame->selection, s->store, &eye, paper_error));
	frame->selection.sky = s->sky;
	struct view_draw_job job = { .store = s->store, .selection = &frame->selection, .eye = &eye,
		.near_m = view_store_near_m(s->store), .samples = samples };
	paper_must(view_picture_init(&frame->picture, view->width, view->height, paper_error));
	paper_must(view_reference_draw(&job, &frame->picture, paper_error));
	if (samples)
		paper_must(view_measure_soft(&job, &frame->picture, paper_error));
}

void paper_frame_free(struct paper_frame *frame)
{
	view_picture_free(&frame->picture);
	view_select_free(&frame->selection);
}

/* ---- Rules ---- */

#define HALVINGS 26

static void clear(struct paper *p)
{
	p->cut_count = 0;
	p->p.entry_count = 0;
	p->p.vertices = 0;
}

bool paper_open(struct paper *p, double d)
{
	struct eco_error error = { 0 };
	enum eco_code code = lod_visible_tree_count(&p->p.visible, d, p->p.gates, &error);
	if (code == ECO_TOO_LARGE)
		return false;
	if (code)
		eco_end(error.text);
	for (uint32_t i = 0; i < p->p.visible.node_count; i++) {
		const struct lod_node *node = &p->p.visible.nodes[i];
		if (node->state != LOD_SUMMARY)
			continue;
		uint64_t full = lod_planner_count(p->s->scene, p->s->scene->tiles[node->tile].summary);
		struct lod_entry entry = { .slot = ECO_NONE, .ladder = i, .count = 1, .full = full,
			.wanted = lod_summary_points(node, d) };
		entry.vertices = entry.wanted < (double)full ? (uint64_t)entry.wanted : full;
		paper_must(lod_planner_add(&p->p, &entry, paper_error));
		p->p.vertices += entry.vertices;
	}
	return true;
}

bool paper_applies(const struct paper *p, const struct eco_ladder *ladder, const struct lod_slot *slot)
{
	return !(ladder->flags & ECO_LADDER_FAR) || eco_gate_place(slot->band, 0) >= p->p.gates[slot->plant];
}

void paper_cut(struct paper *p, const struct lod_slot *slot, const struct eco_cut *cut)
{
	if (cut->end <= cut->first)
		return;
	eco_grow(&p->cuts, &p->cut_room, p->cut_count, sizeof *p->cuts);
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
		ky[7] = { y->anchor, y->band_first, y->share_first, y->share_end, y->list, y->first, x->end };
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

/* Vertices of all cuts and summaries, by a walk over the plants. Sorts the cuts; of two of the same list,
 * band and plants the longer one stays. */
static uint64_t count_vertices(struct paper *p)
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
				.end = scene->lists[i].primitive_count, .scale = 1, .anchor = ECO_NONE,
				.share_end = ECO_SHARE_ONE };
}

static void make_plan(struct paper *p, struct eco_plan *plan)
{
	count_vertices(p);
	paper_must(lod_planner_emit(&p->p, NULL, plan, paper_error));
	/* ground first: it looks cuts up in the pack, which has not all of the rule's lists */
	paper_must(lod_plan_ground(plan, p->s->scene, &p->request.view, p->request.ground_px, paper_error));
	plan->cuts = eco_realloc(plan->cuts, (size_t)plan->cut_count + p->cut_count + p->s->scene->list_count,
		sizeof *plan->cuts);
	if (p->cut_count)
		memcpy(plan->cuts + plan->cut_count, p->cuts, p->cut_count * sizeof *p->cuts);
	plan->cut_count += p->cut_count;
	add_textures(p->s->scene, plan);
	eco_plan_sort(plan);
}

/* Whether the cuts of the rule at x are within the budget. */
static bool fits(struct paper *p, paper_rule *rule, void *ctx, double x)
{
	clear(p);
	if (rule(p, x, ctx))
		return count_vertices(p) <= p->request.vertices;
	paper_must(lod_visible_tree_restart(&p->p.visible, paper_error));
	return false;
}

/* Between a value of few vertices and one of many. */
static double solve(struct paper *p, paper_rule *rule, void *ctx, double few, double many)
{
	if (fits(p, rule, ctx, many))
		return many;
	for (int i = 0; i < HALVINGS; i++) {
		double middle = sqrt(few * many);
		*(fits(p, rule, ctx, middle) ? &few : &many) = middle;
	}
	if (!fits(p, rule, ctx, few))
		clear(p);
	return few;
}

void paper_shoot(struct paper_scene *s, const struct eco_request *request, paper_rule *rule, void *ctx,
	double *x, uint32_t samples, struct paper_frame *frame)
{
	struct paper p = { .s = s, .request = *request };
	struct eco_plan plan = { 0 };
	bool deussen = rule == paper_deussen;        /* d' in radians; the others have a distance in metres */
	p.request.texel_px = ECO_TEXEL_PX_MIN;
	p.input = (struct lod_planner_input){ .scene = s->scene, .tables = s->tables, .request = &p.request };
	paper_must(lod_planner_begin(&p.p, &p.input, paper_error));
	if (!(*x > 0))
		*x = solve(&p, rule, ctx, deussen ? 2 : 1e-3, deussen ? 1e-6 : 1e5);
	else if (!rule(&p, *x, ctx))
		eco_end("a view holds more than a walk may look at");
	make_plan(&p, &plan);
	lod_planner_end(&p.p);
	free(p.cuts);
	draw(s, &plan, &request->view, samples, frame);
}
