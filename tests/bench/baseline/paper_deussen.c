/* Deussen 2002 as printed, but for its misprints: his lists, his numbers of points and lines, his blend, his
 * splats; no curve that was measured. Occlusion is ignored, tiles far away are points (6.2), and plants in
 * whose list of points there are not enough show cells, each at its own distance (6.1). */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/memory.h"
#include "ecofiles/format/chunk/chunk.h"
#include "lod/geometry.h"
#include "tests/bench/baseline/paper_rules.h"

#define SPLAT_FACTOR 1.3

/* ---- His lists (4.1) ---- */

static double dice(uint64_t *state)
{
	*state = *state * 6364136223846793005u + 1442695040888963407u;
	return (double)(*state >> 11) / 9007199254740992.0;
}

/* Uniform on the triangle: a point of the parallelogram, turned back where it lies outside. On the list's
 * grid. */
static void take_point(const float corners[9], uint64_t *state, const struct eco_list *list, int32_t out[3])
{
	double a = dice(state), b = dice(state);
	if (a + b > 1) {
		a = 1 - a;
		b = 1 - b;
	}
	for (int k = 0; k < 3; k++) {
		double o = (double)corners[k], at = o + a * ((double)corners[3 + k] - o)
			+ b * ((double)corners[6 + k] - o);
		out[k] = (int32_t)floor((at - list->grid_origin[k]) / list->grid_step[k] + 0.5);
	}
}

/* `count` elements of one primitive with `corners` corners each. */
static struct eco_elements take_elements(uint32_t count, uint8_t corners, uint32_t extra)
{
	struct eco_elements out = { .element_count = count, .corner_count = corners * count,
		.primitive_count = count, .extra_count = extra, .corners = eco_alloc(count, 1),
		.position = eco_alloc(3u * corners * (size_t)count, sizeof *out.position),
		.extra = eco_alloc((size_t)extra * count, sizeof *out.extra) };
	memset(out.corners, corners, count);
	return out;
}

/* Two points on each triangle, one behind the other, in the colours of the points that the pack has. */
static struct eco_elements make_points(const struct view_list *from, const struct view_list *forms,
	const struct eco_list *list)
{
	uint32_t count = from->list.primitive_count, t = 0, colour = eco_list_extra_at(&forms->list,
		ECO_ATTR_COLOR);
	bool coloured = forms->list.attributes & ECO_ATTR_COLOR;
	struct lod_geometry corners = { 0 };
	uint64_t state = 1 + from->id;
	struct eco_elements out = take_elements(2 * count, 1, coloured);
	if (!lod_geometry_make(&corners, &from->list, count, false))
		eco_end("no memory for points");
	lod_list_geometry(&from->list, &from->elements, 0, count, 1, &corners);
	for (uint32_t e = 0; e < from->elements.element_count; e++)
		for (uint32_t last = t + from->elements.corners[e] - 2u; t < last; t++)
			for (uint32_t i = 2 * t; i < 2 * t + 2; i++) {
				take_point(corners.position + 9 * (size_t)t, &state, list, out.position + 3
					* (size_t)i);
				if (coloured)
					out.extra[i] = forms->elements.extra[(size_t)e
						* forms->elements.extra_count + colour];
			}
	lod_geometry_free(&corners);
	return out;
}

/* Gives the store a list of its own, and frees `made`. Chunks reorder their elements, but points must stay
 * beside those of their triangle: the store's copy is put back into the order in which they were made. */
static void feed_made(struct paper_scene *s, uint32_t id, const struct eco_list *list,
	struct eco_elements *made, const struct view_list *like)
{
	struct eco_chunk_input input = { .list = list, .elements = made, .end = made->element_count };
	struct eco_chunk chunk = { .primitive_count = made->primitive_count,
		.element_count = made->element_count };
	uint8_t *bytes;
	size_t size;
	paper_must(eco_chunk_encode(&input, &bytes, &size, paper_error));
	chunk.size_bytes = (uint32_t)size;
	chunk.id = eco_chunk_hash(bytes, size);
	paper_must(view_store_events.list(s->store, id, list, (const uint8_t (*)[3])like->palette, NULL,
		paper_error));
	paper_must(view_store_events.chunk(s->store, id, 0, &chunk, bytes, paper_error));
	const struct eco_elements *held = &view_store_list(s->store, id)->elements;
	memcpy(held->position, made->position, 3 * (size_t)made->corner_count * sizeof *made->position);
	if (made->extra_count)
		memcpy(held->extra, made->extra, (size_t)made->extra_count * made->element_count
			* sizeof *made->extra);
	free(bytes);
	eco_elements_free(made);
}

/* A list like another, of one chunk. */
static struct eco_list list_like(const struct view_list *like)
{
	struct eco_list list = like->list;
	list.coder = ECO_CODER_ELEMENTS;
	list.partner = ECO_NONE;
	list.chunk_count = 1;
	list.chunk_first = 0;
	return list;
}

static void add_points(struct paper_scene *s, const struct eco_ladder *l, uint32_t id)
{
	const struct view_list *from = view_store_list(s->store, l->triangles),
		*forms = view_store_list(s->store, l->points);
	struct eco_list list = list_like(forms);
	double region = (double)from->list.primitive_count * l->total / from->list.element_count;
	list.attributes &= ECO_ATTR_COLOR;
	list.primitive_count = list.element_count = 2 * from->list.primitive_count;
	list.unit_area = (float)((double)l->area / 2 / (2 * region));
	memcpy(list.grid_origin, from->list.grid_origin, sizeof list.grid_origin);
	memcpy(list.grid_step, from->list.grid_step, sizeof list.grid_step);
	struct eco_elements points = make_points(from, forms, &list);
	feed_made(s, id, &list, &points, forms);
}

struct line { double width, length; uint32_t at; };

/* In random order. */
static struct line *read_lines(const struct view_list *from)
{
	const struct eco_elements *e = &from->elements;
	uint32_t n = e->element_count, width = eco_list_extra_at(&from->list, ECO_ATTR_WIDTH);
	struct line *lines = eco_alloc(n, sizeof *lines);
	uint64_t state = 1 + from->id;
	for (uint32_t i = 0; i < n; i++) {
		uint32_t other = (uint32_t)(dice(&state) * (i + 1));
		const int32_t *at = e->position + 6 * (size_t)i;
		double square = 0;
		for (int k = 0; k < 3; k++) {
			double d = from->list.grid_step[k] * ((double)at[3 + k] - at[k]);
			square += d * d;
		}
		lines[i] = lines[other];
		lines[other] = (struct line){ from->list.grid_step[0] * e->extra[(size_t)e->extra_count * i
			+ width], sqrt(square), i };
	}
	return lines;
}

/* Mean width of lines up to `most` wide. */
static double mean_width(const struct line *lines, uint32_t count, double most)
{
	double area = 0, length = 0;
	for (uint32_t i = 0; i < count; i++)
		if (lines[i].width <= most) {
			area += lines[i].width * lines[i].length;
			length += lines[i].length;
		}
	return length > 0 ? area / length : 0;
}

/* Fills all of `made` but the list. */
static struct eco_elements make_lines(const struct view_list *from, const struct line *lines, double width,
	struct paper_lines *made)
{
	const struct eco_elements *e = &from->elements;
	uint32_t n = e->element_count, each = e->extra_count, next = 0,
		extra = eco_list_extra_at(&from->list, ECO_ATTR_WIDTH);
	struct eco_elements out = take_elements(n, 2, each);
	for (int thick = 1; thick >= 0; thick--)
		for (uint32_t i = 0; i < n; i++) {
			if ((lines[i].width > width) != thick)
				continue;
			memcpy(out.position + 6 * (size_t)next, e->position + 6 * (size_t)lines[i].at,
				6 * sizeof *out.position);
			memcpy(out.extra + (size_t)each * next, e->extra + (size_t)each * lines[i].at,
				each * sizeof *out.extra);
			if (!thick)
				out.extra[(size_t)each * next + extra] = (int32_t)fmin(fmax(1, width
					/ from->list.grid_step[0]), 1 << 26);
			made->thick += (uint32_t)thick;
			next++;
		}
	made->width = width;
	made->thin = mean_width(lines, n, width);
	return out;
}

static void add_lines(struct paper_scene *s, uint32_t ladder, uint32_t id)
{
	const struct view_list *from = view_store_list(s->store, s->scene->ladders[ladder].lines);
	const struct eco_list list = list_like(from);
	struct line *lines = read_lines(from);
	double mean = mean_width(lines, from->elements.element_count, INFINITY);
	for (uint32_t i = 0; i < PAPER_WIDTHS && mean > 0; i++) {
		struct paper_lines *made = &s->lines[(size_t)ladder * PAPER_WIDTHS + i];
		made->list = id + i;
		struct eco_elements elements = make_lines(from, lines, mean * pow(2, i / 2.0), made);
		feed_made(s, id + i, &list, &elements, from);
	}
	free(lines);
}

void paper_deussen_lists(struct paper_scene *s)
{
	const struct eco_scene *scene = s->scene;
	s->points = eco_alloc(scene->ladder_count, sizeof *s->points);
	s->lines = eco_alloc(scene->ladder_count * (size_t)PAPER_WIDTHS, sizeof *s->lines);
	for (uint32_t i = 0, id = scene->list_count; i < scene->ladder_count; i++) {
		const struct eco_ladder *l = &scene->ladders[i];
		s->points[i] = ECO_NONE;
		if (l->lines != ECO_NONE && scene->lists[l->lines].primitive_count) {
			add_lines(s, i, id);
			id += PAPER_WIDTHS;
		}
		if (paper_is_leaves(l) && l->points != ECO_NONE && l->lines == ECO_NONE
				&& scene->lists[l->triangles].element_count) {
			s->points[i] = id++;
			add_points(s, l, s->points[i]);
		}
	}
}

/* ---- His numbers (5) ---- */

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

/* The rule at one sample distance. */
struct rule {
	struct paper *p;
	double d, splat_factor;
};

/* A ladder's own lists hold `count` triangles or lines after the `before` ones of the region, `total` in all,
 * that the whole plant's lists hold. */
static void cut_points(const struct rule *rule, const struct lod_slot *slot, uint32_t ladder, double r)
{
	struct paper *p = rule->p;
	const struct eco_ladder *l = &p->s->scene->ladders[ladder];
	const struct eco_list *list = &p->s->scene->lists[l->triangles];
	uint32_t count = list->primitive_count;
	double each = list->element_count ? (double)count / list->element_count : 1, total = each * l->total,
		before = each * l->before,
		asked = paper_deussen_points((double)l->area, r, rule->d, rule->splat_factor);
	struct paper_blend blend = { .end = (uint32_t)fmin(fmax(0, asked - 2 * before), 2.0 * count) };
	/* triangles of the region as a whole are blended, not those of a part */
	if (asked >= 2 * total)
		blend = paper_deussen_blend(2.0 * count + fmax(0, asked - 2 * total - before), count);
	paper_cut(p, slot, &(struct eco_cut){ .list = l->triangles, .end = blend.triangles, .scale = 1 });
	paper_cut(p, slot, &(struct eco_cut){ .list = p->s->points[ladder], .first = blend.first,
		.end = blend.end,
		.scale = (float)paper_deussen_scale(asked, total > 0 ? total : 1, rule->splat_factor) });
}

static void cut_lines(const struct rule *rule, const struct lod_slot *slot, uint32_t ladder, double r)
{
	struct paper *p = rule->p;
	double d = rule->d;
	const struct eco_ladder *l = &p->s->scene->ladders[ladder];
	const struct paper_lines *lines = p->s->lines + (size_t)ladder * PAPER_WIDTHS;
	bool has_lines = lines->width > 0;
	if (has_lines)                       /* those nearest to d' in width */
		lines += (int)fmin(fmax(0, floor(2 * log2(d * r / lines->width) + 0.5)), PAPER_WIDTHS - 1);
	double q = has_lines ? paper_deussen_lines(lines->thin, r, d) : 2;
	if (has_lines && (l->triangles == ECO_NONE || (q <= 1 && (double)l->epsilon / r < d))) {
		/* the first list of wood holds the thickest lines and stands for these; that of blades holds
		 * some at random and stands for all */
		uint32_t count = p->s->scene->lists[l->lines].primitive_count;
		bool wood = l->organ == ECO_ORGAN_WOOD;
		double total = wood ? count : l->total, before = wood ? 0 : l->before;
		double own = lines->thick + fmin(q, 1) * fmax(0, total - lines->thick) - before;
		paper_cut(p, slot, &(struct eco_cut){ .list = lines->list,
			.end = (uint32_t)fmin(fmax(0, own), count), .scale = (float)fmax(1, d * r
				/ lines->width) });
	} else if (l->triangles != ECO_NONE) {       /* polygons of the last level */
		uint8_t n = l->level_count;
		paper_cut(p, slot, &(struct eco_cut){ .list = l->triangles,
			.first = n > 1 ? l->level_end[n - 2] : 0, .end = n ? l->level_end[n - 1]
			: (uint32_t)lod_planner_count(p->s->scene, l->triangles), .scale = 1 });
	}
}

/* ---- Cells (6.1) ---- */

/* Whether the whole plant's lists do not suffice at this distance. */
static bool wants_cells(const struct rule *rule, const struct eco_ladder *l, double r)
{
	const struct paper *p = rule->p;
	if (l->flags & ECO_LADDER_WHOLE)
		return false;
	if (p->s->points[l - p->s->scene->ladders] != ECO_NONE)
		return paper_deussen_points((double)l->area, r, rule->d, rule->splat_factor)
			> 2.0 * p->s->scene->lists[l->triangles].primitive_count;
	/* all lines of the region; the whole plant's list may hold a few of them */
	double area = (double)l->area * (l->organ == ECO_ORGAN_WOOD ? 0.5 : 1);
	double q = l->length > 0 ? paper_deussen_lines(area / (double)l->length, r, rule->d) : 2;
	return q * l->total > (double)lod_planner_count(p->s->scene, l->lines)
		|| (double)l->epsilon / r >= rule->d;
}

static uint32_t gate_of(const struct rule *rule, uint32_t plant)
{
	const struct eco_scene *scene = rule->p->s->scene;
	const struct eco_plant *of = &scene->plants[plant];
	for (int band = ECO_BANDS - 1; band >= 0 && of->anchor_count > 1; band--)
		for (uint32_t i = of->ladder_first; i < of->ladder_first + of->ladder_count; i++)
			if (scene->ladders[i].anchor == of->anchor_first
					&& wants_cells(rule, &scene->ladders[i],
						lod_band_distance_m((uint8_t)band)))
				return (uint32_t)(band + 1) * ECO_SHARE_ONE;
	return 0;
}

/* Mean distance of each plant's instances and their cells: the plant's own if its model stands once. */
static double *find_means(const struct paper *p)
{
	uint32_t plants = p->s->scene->plant_count;
	double *count = eco_alloc(plants, sizeof *count), *mean_m = eco_alloc(plants, sizeof *mean_m);
	for (uint32_t i = 0; i < p->p.visible.slot_count; i++) {
		const struct lod_slot *slot = &p->p.visible.slots[i];
		mean_m[slot->plant] += (double)slot->count * lod_band_distance_m(slot->band);
		count[slot->plant] += (double)slot->count;
	}
	for (uint32_t i = 0; i < plants; i++)
		mean_m[i] /= fmax(1, count[i]);
	free(count);
	return mean_m;
}

bool paper_deussen(struct paper *p, double d, void *deussen)
{
	const struct paper_deussen *how = deussen;
	struct rule rule = { p, d, how && how->splat_factor > 0 ? how->splat_factor : SPLAT_FACTOR };
	for (uint32_t i = 0; i < p->s->scene->plant_count; i++)
		p->p.gates[i] = gate_of(&rule, i);
	if (!paper_open(p, d))
		return false;
	double *mean_m = how && how->whole ? find_means(p) : NULL;
	for (uint32_t i = 0; i < p->p.visible.slot_count; i++) {
		const struct lod_slot *slot = &p->p.visible.slots[i];
		double r = mean_m ? mean_m[slot->plant] : lod_band_distance_m(slot->band);
		uint32_t count;
		const uint32_t *ladders = lod_plan_tables_anchor(p->s->tables, slot->anchor, &count);
		for (uint32_t k = 0; k < count && slot->count; k++)
			if (paper_applies(p, &p->s->scene->ladders[ladders[k]], slot))
				(p->s->points[ladders[k]] != ECO_NONE ? cut_points : cut_lines)(&rule, slot,
					ladders[k], r);
	}
	free(mean_m);
	return true;
}
