/* Deussen 2002 as printed, but for its misprints: his lists, his numbers of points and lines, his blend, his
 * splats; no curve that was measured. Occlusion is ignored, tiles far away are points (6.2), and plants in
 * whose list of points there are not enough show cells, each at its own distance (6.1). */
#include <math.h>

#include "tests/bench/baseline/paper_rules.h"

double paper_deussen_points(double area, double r, double d)
{
	return PAPER_SPLAT_FACTOR * area / (2 * r * r) / (d * d);
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

double paper_deussen_scale(double p, double k)
{
	return PAPER_SPLAT_FACTOR * 2 * k / p;
}

/* ---- One ladder ---- */

struct region {
	double r, area, total, before;
}; /* total, before: triangles or lines */

/* Its own list holds `count` triangles after the `before` ones of the region that the whole plant's holds. */
static void add_points(struct paper *p, const struct lod_slot *slot, uint32_t ladder, const struct region *of,
	double d)
{
	uint32_t list = p->s->scene->ladders[ladder].triangles,
		 count = p->s->scene->lists[list].primitive_count;
	uint32_t points = p->s->points[ladder];
	double asked = paper_deussen_points(of->area, of->r, d), own = asked - 2 * of->before;
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
			.scale = (float)paper_deussen_scale(asked, k) });
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

static void add_lines(struct paper *p, const struct lod_slot *slot, uint32_t ladder, const struct region *of,
	double d)
{
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

static void add_ladder(struct paper *p, const struct lod_slot *slot, uint32_t ladder, double d)
{
	const struct eco_ladder *l = &p->s->scene->ladders[ladder];
	double r = lod_band_distance_m(slot->band);
	bool points = p->s->points[ladder] != ECO_NONE;
	struct region of = region_of(p, l, r, points);
	if (points)
		add_points(p, slot, ladder, &of, d);
	else
		add_lines(p, slot, ladder, &of, d);
}

/* ---- Cells ---- */

/* Whether the whole plant's lists do not suffice at this distance. */
static bool wants_cells(const struct paper *p, const struct eco_ladder *l, double r, double d)
{
	if (l->flags & ECO_LADDER_WHOLE)
		return false;
	if (p->s->points[l - p->s->scene->ladders] != ECO_NONE)
		return paper_deussen_points((double)l->area, r, d) >
			2.0 * p->s->scene->lists[l->triangles].primitive_count;
	/* all lines of the region, of which the whole plant's list may hold a few */
	double area = (double)l->area * (l->organ == ECO_ORGAN_WOOD ? 0.5 : 1);
	double q = l->length > 0 ? paper_deussen_lines(area / (double)l->length, r, d) : 2;
	return q * l->total > (double)lod_planner_count(p->s->scene, l->lines) || (double)l->epsilon / r >= d;
}

static uint32_t gate_of(const struct paper *p, uint32_t plant, double d)
{
	const struct eco_scene *scene = p->s->scene;
	const struct eco_plant *of = &scene->plants[plant];
	for (int band = ECO_BANDS - 1; band >= 0 && of->anchor_count > 1; band--)
		for (uint32_t i = of->ladder_first; i < of->ladder_first + of->ladder_count; i++)
			if (scene->ladders[i].anchor == of->anchor_first &&
				wants_cells(p, &scene->ladders[i], lod_band_distance_m((uint8_t)band), d))
				return (uint32_t)(band + 1) * ECO_SHARE_ONE;
	return 0;
}

enum eco_code paper_deussen(struct paper *p, double d, void *unused, struct eco_error *error)
{
	(void)unused;
	for (uint32_t i = 0; i < p->s->scene->plant_count; i++)
		p->p.gates[i] = gate_of(p, i, d);
	enum eco_code code = paper_open(p, d, error);
	for (uint32_t i = 0; i < p->p.visible.slot_count && !code; i++) {
		const struct lod_slot *slot = &p->p.visible.slots[i];
		uint32_t count;
		const uint32_t *ladders =
			slot->count ? lod_plan_tables_anchor(p->s->tables, slot->anchor, &count) : NULL;
		for (uint32_t k = 0; ladders && k < count; k++)
			if (paper_applies(p, &p->s->scene->ladders[ladders[k]], slot))
				add_ladder(p, slot, ladders[k], d);
	}
	return code;
}
