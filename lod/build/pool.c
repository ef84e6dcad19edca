#include "lod/build/pool.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/memory.h"
#include "ecofiles/base/random.h"
#include "lod/geometry.h"
#include "lod/build/tone.h"
#include "lod/sort.h"

#define SEED 0x5EEDu

/* ---- Primitives ---- */

struct patch { double weight; uint32_t color; uint8_t organ; };

struct part {                    /* primitives of one list, consecutive in `patches` */
	const struct eco_list *list;
	uint32_t corners;            /* 1: points, 2: lines, 3: triangles */
	uint32_t first, count;
	struct lod_geometry geometry;
};

struct patches {
	struct patch *items;         uint32_t count;
	struct part *parts;          uint32_t part_count;
};

static bool organ_has(const struct lod_plant *plant, uint32_t organ, uint8_t flag)
{
	for (uint32_t i = 0; i < plant->ladder_count; i++)
		if (plant->ladders[i].organ == organ && (plant->ladders[i].flags & flag))
			return true;
	return false;
}

/* The list that stands for a whole ladder and its primitives, or ECO_NONE if another ladder does. Wood at its
 * finest level. */
static uint32_t list_of(const struct lod_plant *plant, const struct eco_ladder *l, uint32_t *first,
	uint32_t *end)
{
	uint32_t list = l->points != ECO_NONE ? l->points : l->triangles != ECO_NONE ? l->triangles
		: l->lines;
	if (list == ECO_NONE || l->flags & ECO_LADDER_WHOLE
			|| ((l->flags & ECO_LADDER_FAR) && organ_has(plant, l->organ, ECO_LADDER_NEAR)))
		return ECO_NONE;
	uint32_t all = plant->lists[list].elements.primitive_count;
	*first = list == l->triangles && l->level_count > 1 ? l->level_end[l->level_count - 2] : 0;
	*end = list == l->triangles && l->level_count > 0 && l->level_end[l->level_count - 1] < all
		? l->level_end[l->level_count - 1] : all;
	return *first < *end ? list : ECO_NONE;
}

static double area_of(const struct part *part, uint32_t i)
{
	const float *p = part->geometry.position + 3 * (size_t)part->corners * i;
	double a[3], b[3];
	if (part->corners == 1)
		return part->list->unit_area * eco_list_opacity(part->list)
			* (part->geometry.size ? (double)part->geometry.size[i] : 1);
	for (int k = 0; k < 3; k++) {
		a[k] = p[3 + k] - p[k];
		b[k] = part->corners == 3 ? p[6 + k] - p[k] : 0;
	}
	if (part->corners == 2)
		return sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]) * part->geometry.width[i];
	double x = a[1] * b[2] - a[2] * b[1], y = a[2] * b[0] - a[0] * b[2], z = a[0] * b[1] - a[1] * b[0];
	return 0.5 * sqrt(x * x + y * y + z * z);
}

static void add_part(struct patches *patches, const struct lod_list_draft *draft, uint8_t organ,
	uint32_t palette_first, uint32_t first, uint32_t end)
{
	struct part *part = &patches->parts[patches->part_count];
	const struct eco_list *list = &draft->list;
	uint32_t count = end - first;
	patches->items = eco_realloc(patches->items, (size_t)patches->count + count, sizeof *patches->items);
	*part = (struct part){ .list = list, .corners = eco_list_vertices(list), .first = patches->count,
		.count = count };
	if (!lod_geometry_make(&part->geometry, list, count, false))
		eco_end("no memory");
	patches->part_count++;
	lod_list_geometry(list, &draft->elements, first, end, 1, &part->geometry);
	for (uint32_t i = 0; i < count; i++) {
		int32_t color = part->geometry.color[i];
		patches->items[patches->count++] = (struct patch){ area_of(part, i),
			palette_first + list->palette_first + (color > 0 ? (uint32_t)color : 0), organ };
	}
}

static void collect(struct patches *patches, const struct lod_plant *plant, uint32_t palette_first)
{
	patches->parts = eco_alloc(plant->ladder_count + 1u, sizeof *patches->parts);
	for (uint32_t i = 0; i < plant->ladder_count; i++) {
		const struct eco_ladder *l = &plant->ladders[i];
		uint32_t first, end, list = list_of(plant, l, &first, &end);
		if (list != ECO_NONE)
			add_part(patches, &plant->lists[list], l->organ, palette_first, first, end);
	}
}

static void free_patches(struct patches *patches)
{
	for (uint32_t i = 0; i < patches->part_count; i++)
		lod_geometry_free(&patches->parts[i].geometry);
	free(patches->parts);
	free(patches->items);
}

/* ---- Weights ---- */

/* Turns areas of primitives into weights: an organ gets its share of the plant's area, in whatever form it
 * is. */
static double balance(struct patches *patches, const struct lod_plant *plant)
{
	double sum[ECO_ORGAN_COUNT] = { 0 }, total = 0;
	for (uint32_t i = 0; i < patches->count; i++)
		sum[patches->items[i].organ] += patches->items[i].weight;
	for (uint32_t i = 0; i < patches->count; i++) {
		struct patch *p = &patches->items[i];
		p->weight = sum[p->organ] > 0 ? p->weight / sum[p->organ] * plant->organ[p->organ].area : 0;
		total += p->weight;
	}
	return total;
}

static bool sphere_of(const struct patches *patches, double center[3], double *radius)
{
	double low[3] = { INFINITY, INFINITY, INFINITY }, high[3] = { -INFINITY, -INFINITY, -INFINITY },
		square = 0;
	for (uint32_t i = 0; i < patches->part_count; i++)
		for (size_t c = 0; c < 3 * (size_t)patches->parts[i].corners * patches->parts[i].count; c++) {
			low[c % 3] = fmin(low[c % 3], patches->parts[i].geometry.position[c]);
			high[c % 3] = fmax(high[c % 3], patches->parts[i].geometry.position[c]);
		}
	for (int k = 0; k < 3; k++) {
		center[k] = 0.5 * (low[k] + high[k]);
		square += (high[k] - center[k]) * (high[k] - center[k]);
	}
	*radius = sqrt(square);
	return *radius > 0 && isfinite(*radius);
}

static void draw_parts(const void *ctx, struct lod_raster *raster)
{
	const struct patches *patches = ctx;
	for (uint32_t i = 0; i < patches->part_count; i++) {
		const struct part *part = &patches->parts[i];
		lod_raster_list(raster, part->list, &part->geometry, &(struct lod_raster_batch){
			.count = part->count, .area = part->list->unit_area, .item = part->first, .owner = 1 });
	}
}

/* Total of the weights: pixels if primitives are visible, else area. */
static double weigh(struct patches *patches, const struct lod_plant *plant)
{
	double total = balance(patches, plant), pixels = 0;
	struct lod_tone_views views = { .draw = draw_parts, .ctx = patches };
	uint32_t *seen = eco_alloc((size_t)patches->count + 1, sizeof *seen);
	if (total > 0 && sphere_of(patches, views.center, &views.radius))
		lod_tone_count(seen, &views);
	for (uint32_t i = 0; i < patches->count; i++)
		pixels += seen[i];
	for (uint32_t i = 0; i < patches->count && pixels > 0; i++)
		patches->items[i].weight = seen[i];
	free(seen);
	return pixels > 0 ? pixels : total;
}

/* ---- Points ---- */

struct pooled { float at[3]; uint32_t color; bool keeps; };

static void point_on(const struct patches *patches, uint32_t patch, uint32_t number, float out[3])
{
	double u = eco_random_unit(eco_random(SEED + 1, number)), v = eco_random_unit(eco_random(SEED + 2, number)),
		root = sqrt(u);
	double w[3] = { 1, 0, 0 };
	const struct part *part = patches->parts;
	while (patch >= part->first + part->count)
		part++;
	const float *corner = part->geometry.position + 3 * (size_t)part->corners * (patch - part->first);
	if (part->corners == 2) {
		w[0] = 1 - v;
		w[1] = v;
	} else if (part->corners == 3) {
		w[0] = 1 - root;
		w[1] = root * (1 - v);
		w[2] = root * v;
	}
	for (int i = 0; i < 3; i++) {
		double sum = 0;
		for (uint32_t c = 0; c < part->corners; c++)
			sum += w[c] * corner[3 * c + (uint32_t)i];
		out[i] = (float)sum;
	}
}

/* One point in each of `count` equal parts of the summed weights. */
static void sample(const struct patches *patches, double total, bool leafy, struct pooled *out, uint32_t count)
{
	double before = 0;
	uint32_t at = 0;
	for (uint32_t i = 0; i < count; i++) {
		double target = (i + eco_random_unit(eco_random(SEED, i))) / count * total;
		while (at + 1 < patches->count && before + patches->items[at].weight <= target)
			before += patches->items[at++].weight;
		point_on(patches, at, i, out[i].at);
		out[i].color = patches->items[at].color;
		out[i].keeps = leafy && patches->items[at].organ == ECO_ORGAN_WOOD;
	}
	lod_shuffle(out, count, sizeof *out, SEED);
}

static uint8_t level_of(const struct lod_plant *plant)
{
	double sum = 0, area = 0;
	for (uint32_t i = 0; i < plant->ladder_count; i++) {
		const struct eco_ladder *l = &plant->ladders[i];
		uint32_t first, end, list = list_of(plant, l, &first, &end);
		uint8_t code = list != ECO_NONE ? plant->lists[list].list.level : 0;
		sum += code ? (double)l->area * code : 0;
		area += code ? (double)l->area : 0;
	}
	return area > 0 ? (uint8_t)(sum / area + 0.5) : 0;
}

void lod_pool_make(struct lod_pool *pool, const struct lod_plant *plant, uint32_t palette_first, uint32_t count)
{
	struct patches patches = { 0 };
	assert(count >= 1);
	*pool = (struct lod_pool){ .position = eco_alloc(count, sizeof *pool->position),
		.color = eco_alloc(count, sizeof *pool->color), .keeps = eco_alloc(count, sizeof *pool->keeps) };
	struct pooled *points = eco_alloc(count, sizeof *points);
	collect(&patches, plant, palette_first);
	double total = weigh(&patches, plant);
	pool->count = total > 0 ? count : 1;
	pool->level = level_of(plant);
	if (total > 0)
		sample(&patches, total, plant->plant.leaf_width, points, count);
	else                     /* nothing to take points from: the plant's middle */
		points[0] = (struct pooled){ { plant->anchors[0].center[0], plant->anchors[0].center[1],
			plant->anchors[0].center[2] }, palette_first, false };
	for (uint32_t i = 0; i < pool->count; i++) {
		memcpy(pool->position[i], points[i].at, sizeof points[i].at);
		pool->color[i] = points[i].color;
		pool->keeps[i] = points[i].keeps;
	}
	free(points);
	free_patches(&patches);
}

void lod_pool_free(struct lod_pool *pool)
{
	eco_free(pool->position, pool->color, pool->keeps);
	*pool = (struct lod_pool){ 0 };
}
