/* Deussen 2002 as printed, but for its misprints: his lists, his numbers of points and lines, his blend, his
 * splats; no curve that was measured. Occlusion is ignored, tiles far away are points (6.2), and plants in
 * whose list of points there are not enough show cells, each at its own distance (6.1). */
#include <math.h>
#include <stdlib.h>

#include "tests/bench/baseline/paper_rules.h"

#define SPLAT_FACTOR 1.3

/* The rule at one sample distance. */
struct rule {
	struct paper *p;
	double d, splat_factor;
	double *mean_m; /* per plant: the distance at which all its cells are drawn; NULL: each at its own */
};

double paper_deussen_points(double area, double r, double d, double splat_factor)
{
	return splat_factor * area / (2 * r * r) / (d * d);
}

double paper_deussen_lines(double width, double r, double d)
{
	return width / (r * d);
}

struct paper_blend paper_deussen_blend(double p, uint32_t k)
{
	uint64_t asked = !(p > 0) ? 0 : p < 3.0 * k ? (uint64_t)p : 3 * (uint64_t)k;
	if (asked < 2 * (uint64_t)k)
		return (struct paper_blend){ 0, 0, (uint32_t)asked };
	uint32_t triangles = (uint32_t)(asked - 2 * (uint64_t)k);
	return (struct paper_blend){ triangles, 2 * triangles, 2 * k };
}

double paper_deussen_scale(double p, double k, double splat_factor)
{
	return splat_factor * 2 * k / p;
}

/* ---- One ladder ---- */

struct region {
	double r, area, total, before;
}; /* total, before: triangles or lines */

/* Its own list holds `count` triangles after the `before` ones of the region that the whole plant's holds. */
static void add_points(const struct rule *rule, const struct lod_slot *slot, uint32_t ladder,
	const struct region *of)
{
	struct paper *p = rule->p;
	uint32_t list = p->s->scene->ladders[ladder].triangles,
		 count = p->s->scene->lists[list].primitive_count;
	uint32_t points = p->s->points[ladder];
	double asked = paper_deussen_points(of->area, of->r, rule->d, rule->splat_factor);
	double own = asked - 2 * of->before;
	struct paper_blend blend = { .end = (uint32_t)fmin(fmax(0, own), 2.0 * count) };
	/* triangles of the region as a whole are blended, not those of a part */
	if (asked >= 2 * of->total)
		blend = paper_deussen_blend(2.0 * count + fmax(0, asked - 2 * of->total - of->before), count);
	double k = of->total > 0 ? of->total : 1;
	paper_cut(p, slot, &(struct eco_cut){ .list = list, .end = blend.triangles, .scale = 1 });
	paper_cut(p, slot,
		&(struct eco_cut){ .list = points,
			.first = blend.first,
			.end = blend.end,
			.scale = (float)paper_deussen_scale(asked, k, rule->splat_factor) });
}

static uint32_t last_level(const struct eco_ladder *ladder, uint32_t *end, uint32_t all)
{
	uint8_t n = ladder->level_count;
	*end = n ? ladder->level_end[n - 1] : all;
	return n > 1 ? ladder->level_end[n - 2] : 0;
}

/* The lists of lines nearest to d' in width; NULL without lines. */
static const struct paper_lines *lines_at(const struct paper *p, uint32_t ladder, double width)
{
	const struct paper_lines *lines = p->s->lines + (size_t)ladder * PAPER_WIDTHS;
	if (!(lines->width > 0))
		return NULL;
	double step = floor(2 * log2(width / lines->width) + 0.5);
	return lines + (int)fmin(fmax(0, step), PAPER_WIDTHS - 1);
}

static void add_lines(const struct rule *rule, const struct lod_slot *slot, uint32_t ladder,
	const struct region *of)
{
	struct paper *p = rule->p;
	double d = rule->d;
	const struct eco_ladder *l = &p->s->scene->ladders[ladder];
	const struct paper_lines *lines = lines_at(p, ladder, d * of->r);
	double q = lines ? paper_deussen_lines(lines->thin, of->r, d) : 2;
	uint32_t end;
	if (lines && (l->triangles == ECO_NONE || (q <= 1 && (double)l->epsilon / of->r < d))) {
		/* the first list of wood holds the thickest lines and stands for these; that of blades holds
		 * some at random and stands for all */
		uint32_t count = p->s->scene->lists[l->lines].primitive_count;
		bool wood = l->organ == ECO_ORGAN_WOOD;
		double total = wood ? count : of->total, before = wood ? 0 : of->before;
		double own = lines->thick + fmin(q, 1) * fmax(0, total - lines->thick) - before;
		paper_cut(p, slot, &(struct eco_cut){ .list = lines->list,
			.end = (uint32_t)fmin(fmax(0, own), count),
			.scale = (float)fmax(1, d * of->r / lines->width) });
		return;
	}
	if (l->triangles == ECO_NONE)
		return;
	uint32_t first = last_level(l, &end, (uint32_t)lod_planner_count(p->s->scene, l->triangles));
	paper_cut(p, slot, &(struct eco_cut){ .list = l->triangles, .first = first, .end = end, .scale = 1 });
}

static struct region region_of(const struct paper *p, const struct eco_ladder *l, double r, bool triangles)
{
	double each = 1;
	if (triangles && p->s->scene->lists[l->triangles].element_count)
		each = (double)p->s->scene->lists[l->triangles].primitive_count /
			p->s->scene->lists[l->triangles].element_count;
	return (struct region){ r, (double)l->area, each * l->total, each * l->before };
}

static void add_ladder(const struct rule *rule, const struct lod_slot *slot, uint32_t ladder)
{
	const struct paper *p = rule->p;
	const struct eco_ladder *l = &p->s->scene->ladders[ladder];
	double r = rule->mean_m ? rule->mean_m[slot->plant] : lod_band_distance_m(slot->band);
	bool points = p->s->points[ladder] != ECO_NONE;
	struct region of = region_of(p, l, r, points);
	if (points)
		add_points(rule, slot, ladder, &of);
	else
		add_lines(rule, slot, ladder, &of);
}

/* ---- Cells ---- */

/* Whether the whole plant's lists do not suffice at this distance. */
static bool wants_cells(const struct rule *rule, const struct eco_ladder *l, double r)
{
	const struct paper *p = rule->p;
	double d = rule->d;
	if (l->flags & ECO_LADDER_WHOLE)
		return false;
	if (p->s->points[l - p->s->scene->ladders] != ECO_NONE)
		return paper_deussen_points((double)l->area, r, d, rule->splat_factor) >
			2.0 * p->s->scene->lists[l->triangles].primitive_count;
	/* all lines of the region, of which the whole plant's list may hold a few */
	double area = (double)l->area * (l->organ == ECO_ORGAN_WOOD ? 0.5 : 1);
	double q = l->length > 0 ? paper_deussen_lines(area / (double)l->length, r, d) : 2;
	return q * l->total > (double)lod_planner_count(p->s->scene, l->lines) || (double)l->epsilon / r >= d;
}

static uint32_t gate_of(const struct rule *rule, uint32_t plant)
{
	const struct eco_scene *scene = rule->p->s->scene;
	const struct eco_plant *of = &scene->plants[plant];
	for (int band = ECO_BANDS - 1; band >= 0 && of->anchor_count > 1; band--)
		for (uint32_t i = of->ladder_first; i < of->ladder_first + of->ladder_count; i++)
			if (scene->ladders[i].anchor == of->anchor_first &&
				wants_cells(rule, &scene->ladders[i], lod_band_distance_m((uint8_t)band)))
				return (uint32_t)(band + 1) * ECO_SHARE_ONE;
	return 0;
}

/* Of each plant's instances and their cells: that of the plant itself where its model stands once. */
static enum eco_code find_means(struct rule *rule, struct eco_error *error)
{
	const struct paper *p = rule->p;
	uint32_t plants = p->s->scene->plant_count;
	double *count = calloc(plants + 1u, sizeof *count);
	rule->mean_m = calloc(plants + 1u, sizeof *rule->mean_m);
	if (!count || !rule->mean_m) {
		free(count);
		return eco_fail(error, ECO_NO_MEMORY, "no memory for %u distances", plants);
	}
	for (uint32_t i = 0; i < p->p.visible.slot_count; i++) {
		const struct lod_slot *slot = &p->p.visible.slots[i];
		rule->mean_m[slot->plant] += (double)slot->count * lod_band_distance_m(slot->band);
		count[slot->plant] += (double)slot->count;
	}
	for (uint32_t i = 0; i < plants; i++)
		rule->mean_m[i] /= fmax(1, count[i]);
	free(count);
	return ECO_OK;
}

enum eco_code paper_deussen(struct paper *p, double d, void *deussen, struct eco_error *error)
{
	const struct paper_deussen *how = deussen;
	struct rule rule = { p, d, how && how->splat_factor > 0 ? how->splat_factor : SPLAT_FACTOR, NULL };
	for (uint32_t i = 0; i < p->s->scene->plant_count; i++)
		p->p.gates[i] = gate_of(&rule, i);
	enum eco_code code = paper_open(p, d, error);
	if (!code && how && how->whole)
		code = find_means(&rule, error);
	for (uint32_t i = 0; i < p->p.visible.slot_count && !code; i++) {
		const struct lod_slot *slot = &p->p.visible.slots[i];
		uint32_t count;
		const uint32_t *ladders =
			slot->count ? lod_plan_tables_anchor(p->s->tables, slot->anchor, &count) : NULL;
		for (uint32_t k = 0; ladders && k < count; k++)
			if (paper_applies(p, &p->s->scene->ladders[ladders[k]], slot))
				add_ladder(&rule, slot, ladders[k]);
	}
	free(rule.mean_m);
	return code;
}
