/* From entries to a plan: cuts, runs, gates, placements and the prediction; and which chunks a plan needs. */
#include "lod/plan/fill_budget.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/format/wire.h"
#include "lod/ground_choice.h"
#include "lod/ladder.h"
#include "lod/plan/planner_state.h"
#include "lod/plan/texture_levels.h"
#include "lod/scattered.h"

/* ---- Points of summaries in parts ---- */

/* Points of summaries are scattered (lod/scattered.h) into as few parts as make them narrow, and as many as the
 * vertices that the plan has left allow. */

#define PART_STEP 1.41421356237309504880
#define PART_PX_MAX 1e6          /* wider points are not scattered */

/* Area factor of the points of a summary's entry, which has vertices. */
static float summary_scale(const struct lod_entry *entry)
{
	return eco_wire_scale_round((float)((double)entry->full / fmax(entry->wanted,
		(double)entry->vertices)));
}

static double width_px(const struct lod_planner *p, const struct lod_entry *entry)
{
	const struct lod_node *node = &p->visible.nodes[entry->ladder];
	const struct eco_list *list = &p->scene->lists[p->scene->tiles[node->tile].summary];
	return 2 * lod_ball_radius(list, summary_scale(entry)) * p->visible.placements[node->placement].scale
		/ (node->distance * p->visible.eye.pixel_rad);
}

/* Halvings until points of the entry, where its tile is nearest, are no wider. */
static uint8_t halvings_of(const struct lod_planner *p, const struct lod_entry *entry, double part_px)
{
	bool seen = entry->vertices && isfinite(part_px) && p->visible.nodes[entry->ladder].distance > 0;
	double width = seen ? width_px(p, entry) : 0;
	uint8_t halvings = 0;
	for (; width > part_px && halvings < ECO_HALVINGS_MAX; width *= M_SQRT1_2)
		halvings++;
	return halvings;
}

static uint64_t added(const struct lod_planner *p, double part_px)
{
	uint64_t sum = 0;
	for (uint32_t i = 0; i < p->entry_count; i++)
		if (p->entries[i].slot == ECO_NONE)
			sum += (p->entries[i].vertices << halvings_of(p, &p->entries[i], part_px))
				- p->entries[i].vertices;
	return sum;
}

/* The least width of a part, pixels, at which all fit in the vertices left; infinite: no point is scattered. */
static double part_px_of(const struct lod_planner *p)
{
	uint64_t left = p->input->request->vertices - p->vertices;
	double part_px = LOD_PART_PX;
	while (part_px < PART_PX_MAX && added(p, part_px) > left)
		part_px *= PART_STEP;
	return part_px < PART_PX_MAX ? part_px : INFINITY;
}

static double entry_density(const struct lod_planner *p, const struct lod_entry *entry, uint64_t vertices)
{
	const struct eco_ladder *ladder = &p->scene->ladders[entry->ladder];
	const struct lod_slot *slot = &p->visible.slots[entry->slot];
	double density = lod_way_density(lod_planner_way(p, entry->ladder), vertices);
	/* where cells add to the coarse list, the plant as a whole is as dense as `wanted` says */
	if (!slot->cell && eco_gate_place(slot->band, 0) < p->gates[slot->plant] && ladder->total
			&& entry->wanted / ladder->total > density)
		density = entry->wanted / ladder->total;
	return density < 1 ? density : 1;
}

/* The factor of leaves' areas. Measured scales serve a plant that stands alone, where a false positive is as
 * wrong as a false negative. Among other plants it seldom is: there leaves grow, and the more of the plant
 * they miss the more they do (lod/EXPERIMENTS.md, Larger leaves among other plants). */
static double grown(const struct lod_planner *p, const struct lod_entry *entry, uint64_t vertices)
{
	const struct eco_ladder *ladder = &p->scene->ladders[entry->ladder];
	double among = entry->among > 0 && ladder->organ != ECO_ORGAN_WOOD
		&& !(ladder->flags & ECO_LADDER_WHOLE) ? entry->among * entry->among : 0;
	double missed = among > 0 ? lod_planner_curve(p, entry, vertices).fn / LOD_LEAF_MISSED : 0;
	return 1 + LOD_LEAF_GROWTH * among * among * fmin(1, missed);
}

/* Mean degree of the view from above onto the slot's plants, rounded. */
static double above_of(const struct lod_slot *slot)
{
	return slot->above_count > 0 ? floor(LOD_SCALE_STEPS * slot->above / slot->above_count + 0.5)
		/ LOD_SCALE_STEPS : 0;
}

/* Plants of an entry whose hash lies in [first, end), `count` of them, draw `vertices` each. */
struct part { uint64_t vertices, count; uint32_t first, end; };

static void add_cuts(const struct lod_planner *p, struct lod_explanation *why, const struct lod_entry *entry,
	const struct part *part, struct eco_plan *plan)
{
	const struct lod_slot *slot = &p->visible.slots[entry->slot];
	struct eco_cut cuts[LOD_LADDER_CUTS_MAX];
	if (part->vertices == 0 || part->first == part->end)
		return;
	uint32_t count = lod_way_cuts(lod_planner_way(p, entry->ladder), part->vertices,
		entry_density(p, entry, part->vertices), above_of(slot), cuts);
	uint32_t impostor = p->scene->ladders[entry->ladder].impostor;
	if (part->vertices == 1 && impostor != ECO_NONE && entry->impostor != ECO_NONE)
		cuts[0] = (struct eco_cut){ .list = impostor,
			.first = entry->impostor, .end = entry->impostor + 1, .scale = 1 };
	double growth = grown(p, entry, part->vertices);
	for (uint32_t i = 0; i < count; i++) {
		cuts[i].scale = eco_wire_scale_round((float)(growth * (double)cuts[i].scale));
		cuts[i].anchor = slot->anchor;
		cuts[i].band_first = slot->band;
		cuts[i].band_end = (uint8_t)(slot->band + 1);
		cuts[i].share_first = part->first;
		cuts[i].share_end = part->end;
		lod_explain_cut(p, why, entry, &cuts[i], part->count);
		plan->cuts[plan->cut_count++] = cuts[i];
	}
}

static void add_summary_cut(const struct lod_planner *p, struct lod_explanation *why, const struct lod_entry *entry,
	const uint32_t *placement_in_plan, double part_px, struct eco_plan *plan)
{
	const struct lod_node *node = &p->visible.nodes[entry->ladder];
	if (entry->vertices == 0)
		return;
	struct eco_cut *cut = &plan->cuts[plan->cut_count++];
	*cut = (struct eco_cut){
		.list = p->scene->tiles[node->tile].summary, .end = (uint32_t)entry->vertices,
		.scale = summary_scale(entry), .halvings = halvings_of(p, entry, part_px),
		.placement = placement_in_plan[node->placement], .anchor = ECO_NONE,
		.share_end = ECO_SHARE_ONE };
	plan->vertices += eco_cut_primitives(cut) - entry->vertices;
	lod_explain_cut(p, why, entry, cut, 1);
}

/* Cuts that differ only in their bands are neighbours. */
static int by_anchor(const void *a, const void *b)
{
	const struct eco_cut *x = a, *y = b;
	uint32_t kx[8] = { x->anchor + 1, x->placement, x->list, x->first, x->end, x->share_first,
		x->share_end, x->band_first };
	uint32_t ky[8] = { y->anchor + 1, y->placement, y->list, y->first, y->end, y->share_first,
		y->share_end, y->band_first };
	for (int i = 0; i < 8; i++)
		if (kx[i] != ky[i])
			return kx[i] < ky[i] ? -1 : 1;
	return 0;
}

/* From the end of one cut to the next, which differs only in its bands, no plant is drawn. */
static bool nothing_between(const struct lod_planner *p, const struct eco_cut *cut,
	const struct eco_cut *next)
{
	for (uint32_t band = cut->band_end; band < next->band_first; band++) {
		uint32_t slot = lod_visible_tree_slot(&p->visible, cut->anchor, (uint8_t)band);
		if (slot != ECO_NONE && p->visible.slots[slot].count)
			return false;
	}
	return true;
}

static bool like(const struct eco_cut *cut, const struct eco_cut *next)
{
	return cut->anchor == next->anchor && cut->list == next->list && cut->first == next->first
		&& cut->end == next->end && cut->share_first == next->share_first
		&& cut->share_end == next->share_end
		&& fabsf(cut->scale - next->scale) <= LOD_SCALE_NEARLY * fminf(cut->scale, next->scale);
}

/* Cuts that differ in their bands, and next to nothing in their scale, become one where no plant stands
 * between these: a plan says less, and draws the same. */
static void merge_bands(const struct lod_planner *p, struct eco_plan *plan)
{
	uint32_t kept = 0;
	qsort(plan->cuts, plan->cut_count, sizeof *plan->cuts, by_anchor);
	for (uint32_t i = 0; i < plan->cut_count; i++) {
		struct eco_cut *last = kept ? &plan->cuts[kept - 1] : NULL, *cut = &plan->cuts[i];
		if (last && cut->anchor != ECO_NONE && like(last, cut) && nothing_between(p, last, cut))
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

static void add_runs(const struct lod_planner *p, const uint32_t *placement_in_plan, struct eco_plan *plan)
{
	for (uint32_t n = 0; n < p->visible.node_count; n++) {
		const struct lod_node *node = &p->visible.nodes[n];
		const struct eco_tile *tile = &p->scene->tiles[node->tile];
		if (node->state != LOD_OPEN || node->plants == 0)
			continue;
		for (uint32_t g = 0; g < tile->group_count; g++) {
			uint32_t list = p->scene->groups[tile->group_first + g].list;
			if (p->scene->groups[tile->group_first + g].first)
				continue;        /* the list's first group was there */
			plan->runs[plan->run_count++] = (struct eco_run){ placement_in_plan[node->placement],
				list, list + 1, node->left };
		}
	}
	qsort(plan->runs, plan->run_count, sizeof *plan->runs, by_list);
	uint32_t kept = 0;
	for (uint32_t i = 0; i < plan->run_count; i++) {
		struct eco_run *last = kept ? &plan->runs[kept - 1] : NULL;
		if (last && last->placement == plan->runs[i].placement
				&& last->list_end == plan->runs[i].list_first
				&& last->left == plan->runs[i].left)
			last->list_end = plan->runs[i].list_end;
		else
			plan->runs[kept++] = plan->runs[i];
	}
	plan->run_count = kept;
}

/* Adds only placements in which something is drawn; the scene itself is always [0]. */
static void add_placements(const struct lod_planner *p, uint32_t *placement_in_plan, struct eco_plan *plan)
{
	for (uint32_t i = 0; i < p->visible.placement_count; i++)
		placement_in_plan[i] = ECO_NONE;
	placement_in_plan[0] = 0;
	plan->placements[plan->placement_count++] = p->visible.placements[0];
	for (uint32_t n = 0; n < p->visible.node_count; n++) {
		const struct lod_node *node = &p->visible.nodes[n];
		bool drawn = node->state == LOD_SUMMARY
			|| (node->state == LOD_OPEN && (node->plants || node->points > 0));
		if (!drawn || placement_in_plan[node->placement] != ECO_NONE)
			continue;
		placement_in_plan[node->placement] = plan->placement_count;
		plan->placements[plan->placement_count++] = p->visible.placements[node->placement];
	}
}

static enum eco_code add_image(const struct lod_planner *p, struct eco_plan *plan, struct eco_error *error)
{
	if (!p->image.count)
		return ECO_OK;
	struct eco_cut *cuts = realloc(plan->cuts, ((size_t)plan->cut_count + p->image.count) * sizeof *cuts);
	if (!cuts)
		return eco_fail(error, ECO_NO_MEMORY, "planning: no memory for the image of the ground");
	plan->cuts = cuts;
	plan->cut_count += lod_image_cuts(&p->image, p->scene, p->input->holdings, p->image_price,
		cuts + plan->cut_count);
	return ECO_OK;
}

/* As it travels. With more vertices fewer pixels are wrong in all, also once these are rounded. */
static struct eco_prediction rounded(const struct eco_prediction *exact)
{
	double fp = eco_wire_pixels_round(exact->fp), wrong = eco_wire_pixels_round(exact->fp + exact->fn);
	return (struct eco_prediction){ eco_wire_pixels_round(exact->tp), fp, wrong - fp };
}

/* The part of the objective that differences of colors are: all but those of contrast and of owners. */
static double color_of(const struct lod_planner *p)
{
	double sum = p->wrong;
	for (uint32_t i = 0; i < p->entry_count; i++) {
		const struct lod_entry *entry = &p->entries[i];
		if (entry->slot == ECO_NONE)
			sum -= entry->owners;
		if (entry->slot == ECO_NONE || !(entry->wrong > 0))
			continue;
		struct eco_seen seen = lod_planner_curve(p, entry, entry->vertices).seen;
		double all = lod_seen_worth(&seen, entry->size),
			color = ECO_SEEN_UNIT * LOD_SEEN_COLOR * seen.color[entry->size][1];
		all *= entry->vertices == 1 && entry->impostor != ECO_NONE ? LOD_IMPOSTOR_WRONG : 1;
		sum -= all > 0 ? entry->wrong * (1 - color / all) : 0;
	}
	return fmax(0, sum);
}

enum eco_code lod_planner_emit(const struct lod_planner *p, struct lod_explanation *why, struct eco_plan *plan,
	struct eco_error *error)
{
	const struct eco_view *view = &p->input->request->view;
	uint32_t groups = 0;
	size_t cuts = 1;
	for (uint32_t n = 0; n < p->visible.node_count; n++)
		if (p->visible.nodes[n].state == LOD_OPEN)
			groups += p->scene->tiles[p->visible.nodes[n].tile].group_count;
	for (uint32_t i = 0; i < p->entry_count; i++)
		cuts += p->entries[i].slot == ECO_NONE ? 1 : 2 * lod_way_cuts_bound(lod_planner_way(p, p->entries[i].ladder));
	plan->cuts = malloc(cuts * sizeof *plan->cuts);
	plan->runs = malloc((groups + 1) * sizeof *plan->runs);
	plan->gates = malloc((p->scene->plant_count + 1) * sizeof *plan->gates);
	plan->placements = malloc(p->visible.placement_count * sizeof *plan->placements);
	uint32_t *placement_in_plan = malloc(p->visible.placement_count * sizeof *placement_in_plan);
	if (!plan->cuts || !plan->runs || !plan->gates || !plan->placements || !placement_in_plan) {
		free(placement_in_plan);
		return eco_fail(error, ECO_NO_MEMORY, "planning: no memory for a plan of %u cuts",
			p->entry_count);
	}
	add_placements(p, placement_in_plan, plan);
	add_runs(p, placement_in_plan, plan);
	double part_px = part_px_of(p);
	plan->vertices = p->vertices;
	for (uint32_t i = 0; i < p->entry_count; i++) {
		const struct lod_entry *entry = &p->entries[i];
		if (entry->slot == ECO_NONE) {
			add_summary_cut(p, why, entry, placement_in_plan, part_px, plan);
			continue;
		}
		uint32_t from = entry->share ? entry->share : entry->first;
		uint64_t ahead = entry->reason.ahead;
		add_cuts(p, why, entry, &(struct part){ entry->more, ahead, entry->first, from }, plan);
		add_cuts(p, why, entry, &(struct part){ entry->vertices, entry->count - ahead, from, entry->end }, plan);
	}
	free(placement_in_plan);
	for (uint32_t i = 0; i < p->scene->plant_count; i++)
		if (p->gates[i])
			plan->gates[plan->gate_count++] = (struct eco_gate){ i, p->gates[i] };
	enum eco_code code = lod_plan_textures(plan, p, error);
	if (!code)
		code = add_image(p, plan, error);
	if (code)
		return code;
	merge_bands(p, plan);
	plan->prediction = rounded(&p->prediction);
	plan->m16 = eco_wire_m16_round(color_of(p) / (LOD_SEEN_COLOR * view->width * view->height));
	plan->visible_plants = p->visible.plants;
	plan->sample_distance = p->sample_distance;
	return ECO_OK;
}

/* ---- Ground ---- */

/* Ground precedes the other cuts, with the summaries, sorted by list. */
static void insert_ground(struct eco_plan *plan, const struct eco_scene *scene,
	const struct lod_ground_choice *choice)
{
	memmove(plan->cuts + choice->count, plan->cuts, plan->cut_count * sizeof *plan->cuts);
	plan->cut_count += choice->count;
	for (uint32_t i = 0; i < choice->count; i++) {
		uint32_t list = scene->ground[choice->tiles[i]].list;
		plan->cuts[i] = (struct eco_cut){ .list = list, .end = scene->lists[list].primitive_count,
			.scale = 1, .anchor = ECO_NONE,
			.share_end = ECO_SHARE_ONE };
	}
	qsort(plan->cuts, plan->cut_count, sizeof *plan->cuts, by_anchor);
}

enum eco_code lod_plan_ground(struct eco_plan *plan, const struct eco_scene *scene,
	const struct eco_view *view, double ground_px, struct eco_error *error)
{
	struct lod_ground_limits limits = { .tolerance_px = ground_px > 0 ? ground_px : ECO_GROUND_PX };
	struct lod_ground_choice choice;
	struct lod_eye eye;
	uint32_t kept = 0;
	plan->ground_px = limits.tolerance_px;
	if (scene->ground_count == 0)
		return ECO_OK;
	lod_eye_make(&eye, view);
	enum eco_code code = lod_ground_select(&choice, scene, &eye, &limits, error);
	if (code)
		return code;
	for (uint32_t i = 0; i < plan->cut_count; i++)
		if (scene->lists[plan->cuts[i].list].kind != ECO_LIST_GROUND)
			plan->cuts[kept++] = plan->cuts[i];
	plan->cut_count = kept;
	struct eco_cut *cuts = realloc(plan->cuts, ((size_t)kept + choice.count + 1) * sizeof *cuts);
	if (cuts) {
		plan->cuts = cuts;
		insert_ground(plan, scene, &choice);
	} else {
		code = eco_fail(error, ECO_NO_MEMORY, "planning: no memory for %u tiles of ground",
			choice.count);
	}
	free(choice.tiles);
	return code;
}
