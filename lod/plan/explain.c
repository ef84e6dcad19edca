/* Explanations are read off the planner's decisions; nothing is decided here. See lod/plan/explain.h. */
#include "lod/plan/fill_budget.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/array_grow.h"

#define ROUNDING 1e-9            /* slopes within this share are equal */

void lod_explanation_free(struct lod_explanation *explanation)
{
	free(explanation->rows);
	*explanation = (struct lod_explanation){ 0 };
}

/* ---- Reasons ---- */

static double more_by(double saved, double other) { return other > 0 ? saved / other - 1 : INFINITY; }

/* Compares a summary that is drawn with the tile's plants and children. */
static void explain_summary(const struct lod_fill *fill, uint32_t n, struct lod_reason *reason)
{
	const struct lod_tile_choice *choice = &fill->allocation->tile_choices[n];
	double plants, summary;
	if (!choice->open) {
		reason->why = LOD_WHY_FAR;
	} else if (fill->allocation->p->visible.nodes[n].state == LOD_OPEN) {
		reason->why = LOD_WHY_GIVES_WAY;
		reason->margin = choice->share;
	} else {
		lod_allocation_compare(fill->allocation, n, &plants, &summary);
		reason->why = LOD_WHY_SUMMARY;
		reason->margin = fmax(0, more_by(summary, plants));
	}
}

/* Compares a ladder that shows the whole plant with the plant's organs, as they were at lambda. */
static void explain_whole(const struct lod_fill *fill, uint32_t s, struct lod_reason *reason)
{
	const struct lod_slot *slot = &fill->allocation->p->visible.slots[s];
	const struct lod_slot_choice *choice = &fill->allocation->slot_choices[s];
	reason->why = LOD_WHY_WHOLE;
	reason->margin = fmax(0, more_by(choice->whole_saved, choice->whole_saved + choice->organs_saved));
	reason->share = (double)slot->whole / (double)(slot->count - slot->near);
}

/* Do plants draw a number of vertices between hull points, or a step that saves less than lambda? */
static bool beyond_lambda(const struct lod_fill *fill, const struct lod_candidate *candidate)
{
	const struct lod_hull_point *at = lod_candidate_point(candidate);
	double last = candidate->step
		? lod_hull_slope(candidate->hull, candidate->step) * candidate->weight_px : INFINITY;
	return candidate->low != at->vertices
		|| (candidate->ahead && candidate->high != at[1].vertices)
		|| last * LOD_HULL_BLUR < fill->lambda * (1 - ROUNDING);
}

static const struct lod_ladder_choice *choice_of(const struct lod_fill *fill,
	const struct lod_candidate *candidate)
{
	return &fill->allocation->ladder_choices[candidate->ladder_choice];
}

/* Work since `before` was to explain. */
static void count_explaining(struct lod_planner *p, uint64_t before)
{
	p->beside += p->work - before;
	p->work = before;
}

void lod_explain_begin(struct lod_explanation *explanation, uint64_t work_max)
{
	uint64_t most = work_max ? work_max / LOD_ROW_WORK : LOD_EXPLAINED_MAX;
	most = most < LOD_EXPLAINED_LEAST ? LOD_EXPLAINED_LEAST : most;
	lod_explanation_free(explanation);
	explanation->most = most < LOD_EXPLAINED_MAX ? (uint32_t)most : LOD_EXPLAINED_MAX;
}

static struct lod_reason reason_of(const struct lod_fill *fill, const struct lod_candidate *candidate)
{
	struct lod_reason reason = { .next = lod_candidate_next(candidate), .ahead = candidate->ahead };
	reason.expected_px = candidate->ladder_choice == ECO_NONE
		? fill->allocation->tile_choices[candidate->node].pixels
		: fill->allocation->slot_choices[choice_of(fill, candidate)->slot].seen;
	reason.gain = candidate->seen * lod_hull_error(candidate->hull, candidate->hull->points)
		- lod_fill_wrong_of(fill, candidate);
	if (candidate->ladder_choice == ECO_NONE)
		explain_summary(fill, candidate->node, &reason);
	else if (choice_of(fill, candidate)->when == LOD_WHOLE)
		explain_whole(fill, choice_of(fill, candidate)->slot, &reason);
	else if (lod_candidate_ended(candidate))
		reason.why = LOD_WHY_ALL;
	else if (beyond_lambda(fill, candidate))
		reason.why = LOD_WHY_LEFT_OVER;
	else if (candidate->ahead)
		reason.why = LOD_WHY_PART;
	else if (reason.next > fill->lambda * (1 + ROUNDING))
		reason.why = fill->allocation->price > 0 ? LOD_WHY_BYTES : LOD_WHY_ROOM;
	else
		reason.why = LOD_WHY_STEP;
	if (reason.why == LOD_WHY_PART)
		reason.margin = (double)candidate->ahead / (double)candidate->count;
	return reason;
}

struct lod_reason lod_explain_candidate(const struct lod_fill *fill, const struct lod_candidate *candidate)
{
	struct lod_planner *p = fill->allocation->p;
	uint64_t before = p->work;
	lod_planner_work(p, LOD_WORK_CURVE);
	struct lod_reason reason = reason_of(fill, candidate);
	count_explaining(p, before);
	return reason;
}

/* ---- Rows ---- */

/* Without memory, or beyond the bound, a row is omitted: a plan does not fail for its explanation. */
static void add_row(struct lod_explanation *explanation, const struct lod_explained *row)
{
	if (explanation->count >= explanation->most
			|| !eco_array_grow(&explanation->rows, &explanation->capacity, explanation->count,
			sizeof *explanation->rows))
		explanation->omitted++;
	else
		explanation->rows[explanation->count++] = *row;
}

static void sum_expected(const struct lod_allocation *m, double expected_px[LOD_DISTANCES])
{
	memset(expected_px, 0, LOD_DISTANCES * sizeof *expected_px);
	for (uint32_t i = 0; i < m->p->screen.count; i++) {
		const struct lod_visibility *visibility = &m->p->screen.visibilities[i];
		if (visibility->slot == ECO_NONE || m->tile_choices[visibility->node].open)
			expected_px[lod_distance_of((double)visibility->distance)] +=
				(double)visibility->share * (double)visibility->pixels;
	}
}

void lod_explain_tiles(const struct lod_fill *fill)
{
	const struct lod_allocation *m = fill->allocation;
	struct lod_explanation *explanation = m->p->input->explanation;
	if (!explanation)
		return;
	uint64_t before = m->p->work;
	lod_planner_work(m->p, LOD_WORK_NODE * (uint64_t)m->p->visible.node_count);
	sum_expected(m, explanation->expected_px);
	explanation->lambda = fill->lambda;
	explanation->count = 0;
	explanation->omitted = 0;
	for (uint32_t n = 0; n < m->p->visible.node_count; n++) {
		const struct lod_node *node = &m->p->visible.nodes[n];
		struct lod_explained row = { .cut = { .list = ECO_NONE, .anchor = ECO_NONE },
			.tile = node->tile, .plant = ECO_NONE };
		double plants, summary;
		if (node->state != LOD_OPEN || node->points > 0 || !m->tile_choices[n].has_summary)
			continue;
		lod_allocation_compare(m, n, &plants, &summary);
		row.plants = node->plants;
		row.expected_px = m->tile_choices[n].pixels;
		row.reason = (struct lod_reason){ .why = LOD_WHY_PLANTS, .gain = plants,
			.margin = fmax(0, more_by(plants, summary)) };
		add_row(explanation, &row);
	}
	count_explaining(m->p, before);
}

void lod_explain_cut(const struct lod_planner *p, struct lod_explanation *why, const struct lod_entry *entry,
	const struct eco_cut *cut, uint64_t plants)
{
	struct lod_explained row = { .cut = *cut, .tile = ECO_NONE, .plant = ECO_NONE, .plants = plants,
		.reason = entry->reason };
	if (!why)
		return;
	if (entry->slot == ECO_NONE)
		row.tile = p->visible.nodes[entry->ladder].tile;
	else
		row.plant = p->visible.slots[entry->slot].plant;
	row.vertices = eco_cut_vertices(cut, &p->scene->lists[cut->list]) * plants;
	row.expected_px = (double)plants * entry->reason.expected_px;
	add_row(why, &row);
}

void lod_explain_ground(const struct lod_planner *p, const struct eco_plan *plan)
{
	for (uint32_t i = 0; p->input->explanation && i < plan->cut_count; i++) {
		struct lod_explained row = { .cut = plan->cuts[i], .tile = ECO_NONE, .plant = ECO_NONE,
			.reason = { .why = LOD_WHY_GROUND, .margin = p->ground_px } };
		if (p->scene->lists[row.cut.list].kind == ECO_LIST_GROUND)
			add_row(p->input->explanation, &row);
	}
}

/* ---- In words ---- */

/* Words of people who look at plants, not of the planner: its figures stand in brackets, or beside it. `unit`: what
 * follows the reason's number; NULL: the text is all, or the reason has words of its own. */
static const struct { const char *name, *text, *unit; } whys[LOD_WHY_COUNT] = {
	[LOD_WHY_STEP] = { "next step", NULL, NULL },
	[LOD_WHY_ROOM] = { "no room", "more detail would be worth it, but the budget of vertices has no room for it", NULL },
	[LOD_WHY_BYTES] = { "bytes", "more detail would be worth its vertices, but not the bytes that it takes to send", NULL },
	[LOD_WHY_PART] = { "within a step", "there are vertices for more detail in", "% of such plants" },
	[LOD_WHY_LEFT_OVER] = { "left over", "a little more detail than needed: some vertices were left over", NULL },
	[LOD_WHY_ALL] = { "all", "its full detail is drawn", NULL },
	[LOD_WHY_WHOLE] = { "whole plant", "drawn as a whole, without single leaves, it looks best from here", NULL },
	[LOD_WHY_DISTANCE] = { "sample distance", "Deussen's rule: one detail every", "rad of the view" },
	[LOD_WHY_SUMMARY] = { "summary", "points that stand for many plants look best from here", NULL },
	[LOD_WHY_FAR] = { "far", "points that stand for many plants are fine enough at this distance", NULL },
	[LOD_WHY_GIVES_WAY] = { "gives way", "points for many plants give way to single ones:", "% of these are drawn" },
	[LOD_WHY_PLANTS] = { "plants", "single plants look best from here", NULL },
	[LOD_WHY_GROUND] = { "ground", "the ground's heights may be off by", "pixels" },
};

const char *lod_why_name(enum lod_why why) { return whys[why].name; }

static void say_better(char *text, size_t size, const char *winner, const char *loser, double margin)
{
	if (margin < INFINITY)
		snprintf(text, size, "%s (%.3g %% more pixels right than by %s)", winner, 100 * margin,
			loser);
	else
		snprintf(text, size, "%s: %s would put no pixel right", winner, loser);
}

static void say_whole(char *text, size_t size, const struct lod_reason *reason)
{
	if (reason->share < 1)
		snprintf(text, size, "drawn as a whole, without single leaves, it looks nearly as good from here: "
			"%.3g %% of such plants are", 100 * reason->share);
	else if (reason->margin > 0)
		say_better(text, size, whys[LOD_WHY_WHOLE].text, "leaves", reason->margin);
	else
		snprintf(text, size, "drawn as a whole, without single leaves, it looks best for so few vertices");
}

/* costs: how many times as much a vertex mends elsewhere as in the next step; 0: that mends nothing. */
static void say_step(char *text, size_t size, double costs)
{
	if (!(costs > 0))
		snprintf(text, size, "more detail would not be seen from here");
	else if (costs < 1.5)
		snprintf(text, size, "more detail would gain nearly as much here as elsewhere");
	else
		snprintf(text, size, "more detail would hardly be seen here: elsewhere it improves the picture %.2g "
			"times as much", costs);
}

void lod_explain_text(char *text, size_t size, const struct lod_explanation *explanation,
	const struct lod_explained *row)
{
	const struct lod_reason *reason = &row->reason;
	const enum lod_why why = reason->why;
	if (why == LOD_WHY_STEP)
		say_step(text, size, reason->next > 0 ? explanation->lambda / reason->next : 0);
	else if (why == LOD_WHY_WHOLE)
		say_whole(text, size, reason);
	else if (why == LOD_WHY_SUMMARY || why == LOD_WHY_PLANTS)
		say_better(text, size, whys[why].text, why == LOD_WHY_SUMMARY ? "single plants" : "points for many of them",
			reason->margin);
	else if (whys[why].unit)
		snprintf(text, size, "%s %.3g %s", whys[why].text, why == LOD_WHY_DISTANCE ? explanation->sample_distance
			: why == LOD_WHY_GROUND ? reason->margin : 100 * reason->margin, whys[why].unit);
	else
		snprintf(text, size, "%s", whys[why].text);
}

void lod_explain_line(char *text, size_t size, const struct eco_scene *scene,
	const struct lod_explanation *explanation, const struct lod_explained *row)
{
	char who[80], why[128];
	lod_explain_text(why, sizeof why, explanation, row);
	if (row->plant != ECO_NONE)
		snprintf(who, sizeof who, "%.40s, band %u, %llu plants", scene->plants[row->plant].name,
			row->cut.band_first, (unsigned long long)row->plants);
	else if (row->tile != ECO_NONE)
		snprintf(who, sizeof who, "tile %u", row->tile);
	else
		snprintf(who, sizeof who, "ground");
	snprintf(text, size, "%s: %llu vertices save %.4g pixels: %s", who, (unsigned long long)row->vertices,
		row->reason.gain, why);
}
