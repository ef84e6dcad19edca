/* Leaves and flowers: one order, and several forms of each element: a point at the middle of its opaque part,
 * with that part's area; in a group of blades also a line; one triangle, for elements of more; and the fan
 * itself. Coarse forms are replaced by finer ones from the front of the order on (struct eco_ladder). One
 * point a leaf with a size of its own shows eight times as many leaves as Deussen's two points a triangle.
 * Blades have points as well as lines (lod/EXPERIMENTS.md, Points and lines for blades). */
#include <string.h>

#include "lod/light.h"
#include "lod/build/order/order.h"
#include "lod/build/plant_state.h"
#include "lod/build/order/rank.h"
#include "lod/raster/texel.h"
#include "lod/vector.h"
#include "lod/sort.h"
#include "lod/build/tone.h"

#define BLADE_RATIO 6.0          /* length over mean width from which on an element is a blade */
#define BLADE_SHARE 0.6          /* of a group's area, from which on it is a group of blades */
#define COARSE_LEAST 256u        /* elements of the whole-plant list of a plant with cells */
#define COARSE_DIVISOR 8u
#define COMPACT 0.8              /* of an ellipse as long and as wide: cut-outs that cover more are as opaque points */
#define COVER_LEAST 4            /* sixteenths that a point covers of its disc */
#define LATTICE 24               /* steps a side of the lattice that searches opaque texels */
/* Simple triangles get a list if elements have at least so many triangles on average. */
#define SIMPLE_GAIN 1.3

static struct lod_v3 corner(const struct lod_build *b, const struct lod_element *e, uint32_t i)
{
	return lod_v3_of(b->mesh.place + 3 * (size_t)e->vertex[i]);
}

void lod_leaves_measure(struct lod_build *b)
{
	b->center = lod_arena_take(&b->arena, b->elements.count, sizeof *b->center);
	b->area = lod_arena_take(&b->arena, b->elements.count, sizeof *b->area);
	for (uint32_t i = 0; i < b->elements.count; i++) {
		const struct lod_element *e = &b->elements.items[i];
		b->center[i] = lod_element_center(e, &b->mesh);
		for (uint32_t k = 0; k + 2 < e->corners; k++)
			b->area[i] += b->organs.area[e->triangle[k]];
	}
}

static uint64_t group_key(const struct lod_build *b, uint32_t element)
{
	const struct lod_component *c =
		&b->organs.components[b->mesh.component[b->elements.items[element].triangle[0]]];
	const struct eco_image *image = lod_mesh_image(b->model, c->material);
	return (uint64_t)c->organ << 40 | (uint64_t)c->importance << 32
		| (image ? (uint32_t)(image - b->model->images) + 1 : 0);
}

static void sort_by(struct lod_build *b, const double *survival)
{
	uint32_t n = b->elements.count;
	struct lod_keyed *by = lod_arena_take(&b->arena, n, sizeof *by);
	for (uint32_t i = 0; i < n; i++)
		by[i] = (struct lod_keyed){ ~lod_sort_key(survival[i]), i };
	lod_sort(&b->arena, by, n);
	for (uint32_t i = 0; i < n; i++)
		b->order[i] = by[i].value;
}

/* The static orders use the field of all leaves and flowers of the plant. */
static void order_by_survival(struct lod_build *b, enum lod_order_method method)
{
	uint32_t n = b->elements.count;
	struct lod_arena_piece *mark = b->arena.last;
	struct lod_v3 *normal = lod_arena_take(&b->arena, n, sizeof *normal);
	double *survival = lod_arena_take(&b->arena, n, sizeof *survival);
	for (uint32_t i = 0; i < n; i++)
		normal[i] = lod_element_normal(&b->elements.items[i], &b->mesh);
	lod_order_survival_by(survival, method,
		&(struct lod_order_input){ .count = n, .center = b->center, .normal = normal,
		.height = (double)b->mesh.high[2] - b->mesh.low[2], .seed = b->options->seed }, &b->arena);
	sort_by(b, survival);
	lod_arena_release(&b->arena, mark);
}

static bool rank_goes_on(void *ctx, double share)
{
	struct lod_build *b = ctx;
	return lod_plant_goes_on(b->options, 0.1 + 0.8 * share);
}

static void rank_each(void *ctx, uint32_t count, void (*piece)(void *pieces, uint32_t i), void *pieces)
{
	const struct lod_build *b = ctx;
	lod_each_run(b->options->each, b->options->ctx, count, piece, pieces);
}

/* Fills b->order, growth and simple, which outlive the scratch memory. */
static void order_greedily(struct lod_build *b)
{
	uint32_t n = b->elements.count;
	struct lod_foliage foliage;
	struct lod_rank rank;
	b->growth = lod_arena_take(&b->arena, n, sizeof *b->growth);
	b->simple = lod_arena_take(&b->arena, n, sizeof *b->simple);
	struct lod_arena_piece *mark = b->arena.last;
	lod_foliage_from(&foliage,
		&(struct lod_foliage_parts){ b->model, &b->mesh, &b->organs, &b->elements }, &b->arena);
	b->code = lod_rank_make(&rank, &foliage,
		&(struct lod_rank_options){ .seed = b->options->seed, .progress = rank_goes_on,
		.each = rank_each, .ctx = b }, &b->arena, b->error);
	if (b->code)
		longjmp(b->stopped, 1);
	memcpy(b->order, rank.order, n * sizeof *b->order);
	memcpy(b->growth, rank.growth, n * sizeof *b->growth);
	memcpy(b->simple, rank.simple, n * sizeof *b->simple);
	lod_arena_release(&b->arena, mark);
}

/* Sorts elements by group, stable. */
static void sort_groups(struct lod_build *b)
{
	uint32_t n = b->elements.count;
	struct lod_arena_piece *mark = b->arena.last;
	struct lod_keyed *by = lod_arena_take(&b->arena, n, sizeof *by);
	for (uint32_t i = 0; i < n; i++)
		by[i] = (struct lod_keyed){ group_key(b, b->order[i]), b->order[i] };
	lod_sort(&b->arena, by, n);
	for (uint32_t i = 0; i < n; i++)
		b->order[i] = by[i].value;
	lod_arena_release(&b->arena, mark);
}

void lod_leaves_order(struct lod_build *b)
{
	b->order = lod_arena_take(&b->arena, b->elements.count, sizeof *b->order);
	if (b->options->order != LOD_ORDER_GREEDY)
		order_by_survival(b, b->options->order);
	else if (!b->options->grid_bits || b->elements.count == 0)
		order_by_survival(b, LOD_ORDER_COMBINED);
	else
		order_greedily(b);
	sort_groups(b);
}

/* ---- Blades ---- */

/* The line that stands for an element: along its longest extent through its centre, as wide as its area
 * demands. */
static void make_blade(const struct lod_build *b, uint32_t number, struct lod_line *line, double *error)
{
	const struct lod_element *e = &b->elements.items[number];
	uint32_t ends[2];
	lod_element_axis(e, &b->mesh, ends);
	struct lod_v3 axis = lod_v3_unit(lod_v3_sub(corner(b, e, ends[1]), corner(b, e, ends[0])));
	double low = 0, high = 0;
	*error = 0;
	for (uint32_t i = 0; i < e->corners; i++) {
		double at = lod_v3_dot(axis, lod_v3_sub(corner(b, e, i), b->center[number]));
		low = fmin(low, at);
		high = fmax(high, at);
		*error =
			fmax(*error,
			lod_v3_distance(corner(b, e, i),
			lod_v3_add(b->center[number], lod_v3_scale(axis, at))));
	}
	line->end[0] = lod_v3_add(b->center[number], lod_v3_scale(axis, low));
	line->end[1] = lod_v3_add(b->center[number], lod_v3_scale(axis, high));
	line->width = high > low ? b->area[number] / (high - low) : 0;
	*error = fmax(0, *error - line->width / 2);
	lod_organs_mean(&b->organs, e->triangle, e->corners - 2u, line->rgb);
}

static bool is_blade(const struct lod_build *b, uint32_t number)
{
	const struct lod_element *e = &b->elements.items[number];
	uint32_t ends[2];
	lod_element_axis(e, &b->mesh, ends);
	double length = lod_v3_distance(corner(b, e, ends[0]), corner(b, e, ends[1])), area = 0;
	for (uint32_t i = 0; i + 2 < e->corners; i++) {
		struct lod_v3 u = lod_v3_sub(corner(b, e, i + 1), corner(b, e, 0)),
			v = lod_v3_sub(corner(b, e, i + 2), corner(b, e, 0));
		area += lod_v3_length(lod_v3_cross(u, v)) / 2;
	}
	return length * length > BLADE_RATIO * area;     /* width is area / length */
}

/* ---- Points ---- */

static uint8_t size_code(double ratio)
{
	uint8_t code = 0;
	/* Up to half of a step above the code's size. */
	while (code + 1u < ECO_SIZES && ratio > (double)eco_size(code) * 1.0905077326652577)
		code++;
	return code;
}

/* A triangle's part of the point of its leaf: middle, area (grid steps^2) and colour of what is opaque.
 * Without an opaque texel it has its own middle, no area, and the image's mean colour. */
struct sample { double at[3], square[3][3], area; uint8_t rgb[3]; };    /* square: mean products of coordinates */

/* Mean barycentric coordinates of opaque points on an even lattice, and their mean products; returns their
 * share, and their last texel in *seen. */
static double opaque_middle(const struct eco_image *image, const int32_t *uv, double middle[3],
	double products[3][3], const uint8_t **seen)
{
	uint32_t hits = 0, all = 0;
	double sum[3] = { 0, 0, 0 }, pairs[3][3] = { { 0 } };
	for (int i = 0; i < LATTICE; i++)
		for (int j = 0; i + j < LATTICE; j++, all++) {
			double w[3] = { (i + 1 / 3.0) / LATTICE, (j + 1 / 3.0) / LATTICE, 0 }, p[2];
			w[2] = 1 - w[0] - w[1];
			for (int a = 0; a < 2; a++)
				p[a] = (w[0] * uv[a] + w[1] * uv[2 + a] + w[2] * uv[4 + a]) / ECO_UV_ONE;
			const uint8_t *texel = lod_texel_at(image, p[0], p[1]);
			if (texel[3] < 128)
				continue;
			hits++;
			*seen = texel;
			for (int k = 0; k < 9; k++)
				pairs[k / 3][k % 3] += w[k / 3] * w[k % 3];
			for (int k = 0; k < 3; k++)
				sum[k] += w[k];
		}
	for (int k = 0; k < 9 && hits; k++)
		products[k / 3][k % 3] = pairs[k / 3][k % 3] / hits;
	for (int k = 0; k < 3 && hits; k++)
		middle[k] = sum[k] / hits;
	return (double)hits / all;
}

static void sample_triangle(const struct lod_mesh *mesh, uint32_t t, struct lod_texels *texels,
	const uint8_t *tint, struct sample *sample)
{
	double middle[3] = { 1 / 3.0, 1 / 3.0, 1 / 3.0 }, found = 1,
	       products[3][3] = { { 1 / 6.0, 1 / 12.0, 1 / 12.0 }, { 1 / 12.0, 1 / 6.0, 1 / 12.0 }, { 1 / 12.0, 1 / 12.0, 1 / 6.0 } };
	const uint8_t *seen = NULL;
	const int32_t *p[3], *uv = mesh->uv + 6 * (size_t)t;
	struct lod_v3 corner[3];
	for (uint32_t k = 0; k < 3; k++) {
		p[k] = mesh->grid + 3 * (size_t)mesh->index[3 * (size_t)t + k];
		corner[k] = (struct lod_v3){ p[k][0], p[k][1], p[k][2] };
	}
	sample->area = lod_v3_length(lod_v3_cross(lod_v3_sub(corner[1], corner[0]),
		lod_v3_sub(corner[2], corner[0]))) / 2;
	memcpy(sample->rgb, tint, 3);
	if (texels) {
		double share = lod_texels_mean(texels, tint, uv, sample->rgb);
		if (texels->cutout)
			found = opaque_middle(texels->image, uv, middle, products, &seen);
		if (share <= 0 && seen)      /* thinner than the rows that the mean samples */
			lod_texel_tint(seen, tint, sample->rgb);
		sample->area *= share > 0 ? share : found;
	}
	for (int k = 0; k < 3; k++)
		sample->at[k] = middle[0] * p[0][k] + middle[1] * p[1][k] + middle[2] * p[2][k];
	memset(sample->square, 0, sizeof sample->square);
	for (int k = 0; k < 9; k++)
		for (int i = 0; i < 9; i++)
			sample->square[i / 3][i % 3] += products[k / 3][k % 3] * p[k / 3][i / 3] * p[k % 3][i % 3];
}

/* The area of the ellipse that a plane figure of that middle and those mean products is as wide and as long as. */
static double ellipse_of(const double at[3], double square[3][3])
{
	double minors = 0, c[3][3];
	for (int k = 0; k < 9; k++)
		c[k / 3][k % 3] = square[k / 3][k % 3] - at[k / 3] * at[k % 3];
	for (int k = 0, j = 1; k < 3; k++, j = (k + 1) % 3)
		minors += c[k][k] * c[j][j] - c[k][j] * c[k][j];
	return 4 * LOD_PI * sqrt(fmax(minors, 0));
}

/* `texels`: of the group's image, opaque and cut out, opened when first needed. `mean`: mean area of the
 * group's elements. Adds what is opaque of it, and its ellipse, to `spread`. */
static void make_point(struct lod_build *b, uint32_t number, struct lod_texels texels[2], double mean,
	struct lod_point *point, double spread[2])
{
	const struct lod_element *e = &b->elements.items[number];
	struct lod_light light = { { 0, 0, 0 }, 0 };
	double at[3] = { 0, 0, 0 }, square[3][3] = { { 0 } };
	for (uint32_t pass = 0; pass < 2 && light.weight <= 0; pass++) /* the second pass ignores opacity */
		for (uint32_t i = 0; i + 2 < e->corners; i++) {
			uint32_t t = e->triangle[i];
			const struct eco_material *material =
				lod_mesh_material(b->model, b->mesh.material[t]);
			const struct eco_image *image = lod_mesh_image(b->model, b->mesh.material[t]);
			if (image && !texels[material->cutout].image)
				lod_texels_open(&texels[material->cutout], image, material->cutout,
					&b->arena);
			struct sample sample;
			sample_triangle(&b->mesh, t, image ? &texels[material->cutout] : NULL,
				image ? material->rgb : b->organs.rgb[t], &sample);
			double weight = pass ? 1 : sample.area;
			lod_light_add(&light, sample.rgb, weight);
			for (int k = 0; k < 9; k++)
				square[k / 3][k % 3] += weight * sample.square[k / 3][k % 3];
			for (int k = 0; k < 3; k++)
				at[k] += weight * sample.at[k];
		}
	lod_light_mean(&light, point->rgb);
	for (int k = 0; k < 9; k++)
		square[k / 3][k % 3] /= light.weight;
	for (int k = 0; k < 3; k++)
		at[k] /= light.weight;
	for (int k = 0; k < 3; k++)
		point->position[k] = (int32_t)floor(at[k] + 0.5);
	spread[0] += light.weight;
	spread[1] += fmax(ellipse_of(at, square), light.weight);
	point->size = size_code(mean > 0 ? b->area[number] / mean : 1);
}

static void measure_group(struct lod_build *b, struct lod_group *group)
{
	double thin = 0;
	for (uint32_t i = group->first; i < group->end; i++) {
		thin += is_blade(b, b->order[i]) ? b->area[b->order[i]] : 0;
		group->area += b->area[b->order[i]];
	}
	group->blades = thin > BLADE_SHARE * group->area;
}

/* Colours of the group's points and blades such that their beginnings look like the visible whole. */
static void level_tones(struct lod_build *b, const struct lod_group *group, const uint32_t *seen_of)
{
	uint32_t n = group->end - group->first;
	struct lod_arena_piece *mark = b->arena.last;
	uint8_t (*rgb)[3] = lod_arena_take(&b->arena, n, sizeof *rgb);
	uint32_t *seen = lod_arena_take(&b->arena, n, sizeof *seen);
	double *area = lod_arena_take(&b->arena, n, sizeof *area);
	for (uint32_t i = 0; i < n; i++) {
		uint32_t number = b->order[group->first + i];
		memcpy(rgb[i], b->point[number].rgb, sizeof rgb[i]);
		seen[i] = seen_of[number];
		area[i] = b->area[number];
	}
	lod_tone_level(rgb, area, seen, n);
	for (uint32_t i = 0; i < n; i++) {
		uint32_t number = b->order[group->first + i];
		memcpy(b->point[number].rgb, rgb[i], sizeof rgb[i]);
		if (group->blades)
			memcpy(b->blade[number].rgb, rgb[i], sizeof rgb[i]);
	}
	lod_arena_release(&b->arena, mark);
}

void lod_leaves_represent(struct lod_build *b)
{
	b->blade = lod_arena_take(&b->arena, b->elements.count, sizeof *b->blade);
	b->blade_error = lod_arena_take(&b->arena, b->elements.count, sizeof *b->blade_error);
	b->point = lod_arena_take(&b->arena, b->elements.count, sizeof *b->point);
	uint32_t *seen = lod_arena_take(&b->arena, b->elements.count, sizeof *seen);
	lod_tone_seen(seen, &(struct lod_tone_input){ &b->mesh, &b->elements }, &b->arena);
	for (uint32_t g = 0; g < b->group_count; g++) {
		struct lod_group *group = &b->groups[g];
		struct lod_arena_piece *mark = b->arena.last;
		struct lod_texels texels[2] = { { 0 }, { 0 } };
		double spread[2] = { 0, 0 };
		measure_group(b, group);
		for (uint32_t i = group->first; i < group->end; i++) {
			uint32_t number = b->order[i];
			make_point(b, number, texels, group->area / (group->end - group->first),
				&b->point[number], spread);
			if (group->blades)
				make_blade(b, number, &b->blade[number], &b->blade_error[number]);
		}
		group->cover = texels[1].image && spread[0] < COMPACT * spread[1]
			? (uint32_t)fmax(ECO_COVER_ONE * spread[0] / spread[1] + 0.5, COVER_LEAST) : 0;
		lod_arena_release(&b->arena, mark);
		level_tones(b, group, seen);
	}
}

/* ---- Ladders ---- */

/* ECO_NONE if that draws hardly fewer vertices than the elements themselves. */
static uint32_t write_simple(struct lod_build *b, uint32_t triangles, const uint32_t *items, uint32_t count)
{
	uint64_t full = 0;
	for (uint32_t i = 0; i < count; i++)
		full += b->elements.items[items[i]].corners - 2u;
	if (SIMPLE_GAIN * count > (double)full)
		return ECO_NONE;
	struct lod_facet *facet = lod_arena_take(&b->arena, count, sizeof *facet);
	for (uint32_t i = 0; i < count; i++) {
		const struct lod_simple *simple = &b->simple[items[i]];
		for (int k = 0; k < 9; k++)
			facet[i].corner[k / 3][k % 3] =
				(int32_t)floor((simple->corner[k / 3][k % 3] - b->mesh.origin[k % 3])
				/ b->mesh.step + 0.5);
		memcpy(facet[i].rgb, b->point[items[i]].rgb, sizeof facet[i].rgb);
	}
	return lod_draft_facets(&b->draft, triangles, facet, b->growth, items);
}

static uint8_t level_of(const struct lod_build *b, const uint32_t *items, uint32_t count)
{
	double square = 0, area = 0;
	for (uint32_t i = 0; i < count; i++) {
		struct lod_v3 n = lod_element_normal(&b->elements.items[items[i]], &b->mesh);
		double length = lod_v3_length(n);
		square += length > 0 ? n.z * n.z / length : 0;
		area += length;
	}
	return area > 0 ? eco_level_code(square / area) : 0;
}

/* The lists of items[0..count) under `ladder`. */
static void write_lists(struct lod_build *b, const struct lod_group *group, struct eco_ladder *ladder,
	uint32_t *items, uint32_t count)
{
	struct lod_arena_piece *mark = b->arena.last;
	ladder->triangles = lod_draft_fans(&b->draft, b->elements.items, b->growth, items, count, group->image);
	if (b->simple)
		ladder->simple = write_simple(b, ladder->triangles, items, count);
	for (uint32_t i = 0; i < count && group->blades; i++)
		ladder->epsilon = fmaxf(ladder->epsilon, (float)b->blade_error[items[i]]);
	if (group->blades)
		ladder->lines = lod_draft_blades(&b->draft, ladder->triangles, b->blade, items);
	ladder->points = lod_draft_points(&b->draft, ladder->triangles, b->point, items,
		(float)(group->area / 2 / (group->end - group->first)), group->cover);
	if (ladder->points != ECO_NONE)
		b->draft.plant->lists[ladder->points].list.level = level_of(b, items, count);
	lod_arena_release(&b->arena, mark);
}

static void count_in(const struct lod_build *b, const struct lod_group *group, uint32_t number, double *area,
	double *length)
{
	*area += b->area[number];
	if (group->blades)
		*length += lod_v3_distance(b->blade[number].end[0], b->blade[number].end[1]);
}

/* The number of the group's first elements that are in the whole-plant list. */
static uint32_t coarse_count(const struct lod_build *b, const struct lod_group *group)
{
	uint32_t n = group->end - group->first, coarse = n / COARSE_DIVISOR;
	coarse = coarse > COARSE_LEAST ? coarse : COARSE_LEAST;
	return b->cells.count == 0 || n <= 2 * coarse ? n : coarse;
}

static void whole_ladder(struct lod_build *b, const struct lod_group *group)
{
	struct eco_ladder *ladder = lod_build_ladder(b, group, 0, 0);
	double area = 0, length = 0;
	for (uint32_t i = group->first; i < group->end; i++) {
		ladder->total++;
		count_in(b, group, b->order[i], &area, &length);
	}
	ladder->area = (float)area;
	ladder->length = (float)length;
	write_lists(b, group, ladder, b->order + group->first, coarse_count(b, group));
}

/* The group's elements by cell, each in order: items[first[cell] .. first[cell + 1]). One pass for any number
 * of cells. */
static uint32_t *sort_by_cell(struct lod_build *b, const struct lod_group *group, uint32_t **first)
{
	uint32_t n = group->end - group->first, cells = b->cells.count;
	uint32_t *cell = lod_arena_take(&b->arena, n, sizeof *cell),
		*items = lod_arena_take(&b->arena, n, sizeof *items);
	uint32_t *start = *first = lod_arena_take(&b->arena, (size_t)cells + 2, sizeof *start);
	memset(start, 0, ((size_t)cells + 2) * sizeof *start);
	for (uint32_t i = 0; i < n; i++) {
		uint32_t in = lod_build_cell(b, b->center[b->order[group->first + i]]);
		cell[i] = in < cells ? in : cells;
		start[cell[i] + 1]++;
	}
	for (uint32_t c = 0; c <= cells; c++)
		start[c + 1] += start[c];
	for (uint32_t i = 0; i < n; i++)
		items[start[cell[i]]++] = i;
	memmove(start + 1, start, ((size_t)cells + 1) * sizeof *start);
	start[0] = 0;
	return items;
}

/* The rest of the order, sharded by cell. */
static void cell_ladders(struct lod_build *b, const struct lod_group *group)
{
	uint32_t coarse = coarse_count(b, group), n = group->end - group->first, *first;
	if (coarse >= n)
		return;
	uint32_t *own = lod_arena_take(&b->arena, n, sizeof *own), *items = sort_by_cell(b, group, &first);
	for (uint32_t cell = 0; cell < b->cells.count; cell++) {
		uint32_t count = 0, before = 0, total = 0;
		double area = 0, length = 0;
		for (uint32_t k = first[cell]; k < first[cell + 1]; k++) {
			uint32_t number = b->order[group->first + items[k]];
			total++;
			count_in(b, group, number, &area, &length);
			if (items[k] < coarse)
				before++;
			else
				own[count++] = number;
		}
		if (count == 0)
			continue;
		struct eco_ladder *ladder = lod_build_ladder(b, group, 1 + cell, ECO_LADDER_NEAR);
		ladder->before = before;
		ladder->total = total;
		ladder->area = (float)area;
		ladder->length = (float)length;
		write_lists(b, group, ladder, own, count);
	}
}

void lod_leaves_ladders(struct lod_build *b, const struct lod_group *group, bool cells)
{
	if (cells)
		cell_ladders(b, group);
	else
		whole_ladder(b, group);
}
