#include "lod/build/summary.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/memory.h"
#include "ecofiles/base/order.h"
#include "ecofiles/base/random.h"
#include "lod/build/palette.h"
#include "lod/eye.h"
#include "lod/sort.h"
#include "lod/tint.h"

#define GOLDEN 0.61803398874989484820    /* multiples of it, modulo 1, fill [0, 1) evenly for any number of
                                          * them */

double lod_power_below(double v)
{
	int exponent;
	assert(v > 0 && isfinite(v));
	frexp(v, &exponent);
	return ldexp(1, exponent - 1);
}

void lod_grid_place(struct eco_list *list, const double low[3], const double high[3], double step)
{
	for (int i = 0; i < 3; i++) {
		double extent = high[i] - low[i], unit = extent > 8 * step ? lod_power_below(extent / 8) : step;
		list->grid_step[i] = step;
		list->grid_origin[i] = floor(low[i] / unit) * unit + 0.0;
	}
}

/* ---- Summaries ---- */

struct visit { uint32_t tile, count; struct eco_placement placement; };

struct drawing {
	const struct lod_summary_input *input;
	struct lod_summary *out;
	struct visit *stack;         uint32_t depth, capacity;
	double *reach;               uint32_t reach_capacity; /* summed areas of the places of a leaf */
	uint64_t levels, leveled;    /* of points whose plants have a level: sum of codes, and number */
};

uint32_t lod_summary_count(const struct eco_tile *tile)
{
	uint64_t wanted = tile->instance_count > LOD_SUMMARY_MOST ? LOD_SUMMARY_MOST
		: 4 * tile->instance_count;
	return wanted < LOD_SUMMARY_LEAST ? LOD_SUMMARY_LEAST : wanted > LOD_SUMMARY_MOST ? LOD_SUMMARY_MOST
		: (uint32_t)wanted;
}

static void push(struct drawing *d, const struct visit *visit)
{
	eco_grow(&d->stack, &d->capacity, d->depth, sizeof *d->stack);
	d->stack[d->depth++] = *visit;
}

/* A seed from a tile's contents, not from its index in the table: other tiles may come and go. */
static uint64_t name_of(const struct eco_tile *tile)
{
	uint64_t bits;
	memcpy(&bits, &tile->area, sizeof bits);
	return eco_random(bits, tile->instance_count);
}

/* Areas of the tile's own plants, summed: d->reach[i] ends the share of place i. Returns their number. */
static uint32_t own_places(struct drawing *d, const struct eco_tile *tile)
{
	const struct eco_scene *scene = d->input->scene;
	uint32_t count = 0;
	double sum = 0;
	for (uint32_t g = 0; g < tile->group_count; g++) {
		const struct eco_group *group = &scene->groups[tile->group_first + g];
		uint32_t places = group->count;
		if (count + places > d->reach_capacity) {
			d->reach_capacity += count + places;
			d->reach = eco_realloc(d->reach, d->reach_capacity, sizeof *d->reach);
		}
		for (uint32_t i = 0; i < places; i++) {
			struct eco_place place = eco_place_read(scene, group->place_first + i);
			d->reach[count++] = sum += scene->plants[group->plant].area * eco_place_area(&place);
		}
	}
	return count;
}

static uint32_t find_place(const double *reach, uint32_t count, double target)
{
	uint32_t low = 0, high = count - 1;
	ECO_LEAST(low, high, i, reach[i] > target)
	return low;
}

static void count_level(struct drawing *d, uint8_t code)
{
	d->levels += code;
	d->leveled += code > 0;
}

static uint16_t color_of(const struct drawing *d, uint32_t color)
{
	return d->input->color_of ? d->input->color_of[color] : (uint16_t)color;
}

/* A point of a pool in a place with a tint: see lod_summary_input. */
static uint32_t tinted_color(uint32_t color_count, const struct lod_pool *pool, uint32_t pick, uint32_t tint)
{
	return pool->color[pick] + (pool->keeps[pick] ? 0 : color_count * tint);
}

/* The first `count` points of a tile's own sequence. */
static void draw_points(struct drawing *d, const struct visit *visit, const struct eco_tile *tile,
	uint32_t places, uint32_t count)
{
	const struct eco_scene *scene = d->input->scene;
	uint64_t seed = eco_random(d->input->seed, name_of(tile));
	double start = eco_random_unit(seed), total = d->reach[places - 1];
	for (uint32_t k = 0; k < count; k++) {
		double turn = start + k * GOLDEN;
		uint32_t place = find_place(d->reach, places, (turn - floor(turn)) * total),
			g = tile->group_first;
		while (place >= scene->groups[g].count)
			place -= scene->groups[g++].count;
		const struct eco_group *group = &scene->groups[g];
		const struct lod_pool *pool = &d->input->pools[group->plant];
		uint32_t pick = (uint32_t)(eco_random(seed, k) % pool->count);
		struct eco_place stored = eco_place_read(scene, group->place_first + place);
		struct lod_place stands;
		struct lod_summary_point *point = &d->out->points[d->out->count++];
		lod_place_instance(&stands, &visit->placement, &scene->lists[group->list], &stored);
		lod_place_point(&stands, pool->position[pick], point->at);
		point->plant = group->plant;
		point->key = (uint16_t)(eco_owner_leaf(visit->tile - d->input->tile) + visit->placement.path);
		point->color = color_of(d, tinted_color(d->input->color_count, pool, pick, stored.tint));
		count_level(d, pool->level);
	}
}

static struct eco_placement placed_child(const struct eco_placement *outer, const struct eco_scene *scene,
	uint32_t tile, uint32_t child)
{
	const struct eco_child *c = &scene->children[child];
	/* an eco file's coordinates in its parent's: the arithmetic of an instance with a grid in metres */
	struct lod_place place = { 0 };
	const struct eco_list metres = { .grid_origin = { c->at[0], c->at[1], c->at[2] } };
	const struct eco_place here = { .scale = 65536 };
	lod_place_instance(&place, outer, &metres, &here);
	return (struct eco_placement){ .at = { place.at[0], place.at[1], place.at[2] },
		.turn = (uint16_t)(outer->turn + c->turn),
		.scale = outer->scale * c->scale, .path = outer->path + eco_owner_step(scene, tile, child) };
}

/* The first `count` points of a nested eco file's summary, or all of them. */
static void take_points(struct drawing *d, const struct visit *visit, const struct lod_summary_root *root)
{
	const struct eco_list *list = &root->list, whole = { .grid_origin = { 0 } };
	const struct eco_place here = { .scale = 65536 };
	uint32_t count = visit->count < root->elements.element_count ? visit->count
		: root->elements.element_count;
	struct lod_place stands;
	lod_place_instance(&stands, &visit->placement, &whole, &here);
	for (uint32_t k = 0; k < count; k++) {
		const int32_t *at = root->elements.position + 3 * (size_t)k,
			*extra = root->elements.extra + (size_t)root->elements.extra_count * k;
		struct lod_summary_point *point = &d->out->points[d->out->count++];
		float inside[3];
		for (int i = 0; i < 3; i++)
			inside[i] = (float)(list->grid_origin[i] + list->grid_step[i] * at[i]);
		lod_place_point(&stands, inside, point->at);
		point->color = color_of(d, (uint32_t)extra[0] + list->palette_first);
		point->plant = (uint32_t)extra[1];
		point->key = (uint16_t)((uint32_t)extra[2] + eco_owner_leaf(visit->tile - d->input->tile)
			+ visit->placement.path);
		count_level(d, list->level);
	}
}

static uint32_t given_until(double sum, double total, uint32_t count, double start)
{
	double until = floor(sum / total * count + start);
	return until >= count ? count : (uint32_t)until;
}

/* Divides the visit's points by area among the tile's own plants and its children, rounding the running sum
 * so that the shares add up. */
static void share_out(struct drawing *d, const struct visit *visit)
{
	const struct eco_scene *scene = d->input->scene;
	const struct eco_tile *tile = &scene->tiles[visit->tile];
	uint32_t places = own_places(d, tile), given = 0;
	double own = places ? d->reach[places - 1] : 0, total = own, sum;
	for (uint32_t i = 0; i < tile->child_count; i++) {
		const struct eco_child *child = &scene->children[tile->child_first + i];
		total += scene->tiles[child->tile].area * (child->placed ? (double)child->scale * child->scale
			: 1);
	}
	if (!(total > 0))
		return;
	/* the sums are added in one order, so the last is exactly `total`; a random start within a step
	 * favours no child */
	double start = tile->child_count ? eco_random_unit(eco_random(d->input->seed + 1, name_of(tile))) : 0;
	given = given_until(own, total, visit->count, start);
	if (given)
		draw_points(d, visit, tile, places, given);
	sum = own;
	for (uint32_t i = 0; i < tile->child_count; i++) {
		const struct eco_child *child = &scene->children[tile->child_first + i];
		sum += scene->tiles[child->tile].area * (child->placed ? (double)child->scale * child->scale
			: 1);
		uint32_t until = given_until(sum, total, visit->count, start);
		struct visit next = { .tile = child->tile, .count = until - given,
			.placement = visit->placement };
		if (!next.count)
			continue;
		given = until;
		if (child->placed)
			next.placement = placed_child(&visit->placement, scene, visit->tile,
				tile->child_first + i);
		if (child->placed && d->input->roots && d->input->roots[child->tile])
			take_points(d, &next, d->input->roots[child->tile]);
		else if (child->placed && !d->input->pools)
			continue;                /* a nested eco file without a summary */
		else
			push(d, &next);
	}
}

void lod_summary_make(struct lod_summary *summary, const struct lod_summary_input *input)
{
	*summary = (struct lod_summary){ .points = eco_alloc((size_t)input->count + 1, sizeof *summary->points) };
	struct drawing d = { .input = input, .out = summary };
	struct visit visit = { .tile = input->tile, .count = input->count, .placement = { .scale = 1 } };
	push(&d, &visit);
	while (d.depth) {
		visit = d.stack[--d.depth];
		share_out(&d, &visit);
	}
	free(d.stack);
	free(d.reach);
	summary->level = (uint8_t)(d.leveled ? (d.levels + d.leveled / 2) / d.leveled : 0);
	lod_shuffle(summary->points, summary->count, sizeof *summary->points,
		eco_random(input->seed + 2, name_of(&input->scene->tiles[input->tile])));
}

/* ---- Colours ---- */

#define WHOLE 1099511627776.0            /* 2^40: weight of a plant with the file's whole area */
#define LEAST 9.5367431640625e-7         /* 2^-20 */

struct nested { uint32_t tile; double area; };

struct shares {
	const struct lod_summary_input *input;
	struct lod_arena arena;
	double *plant;               /* per plant of the scene, without a tint, then with each: summed area */
	struct nested *nested;       uint32_t nested_count;  /* placed children, in the order of tiles */
	double total;
	uint64_t *weight;            /* per colour, as lod_summary_input has it */
	const uint8_t (*tints)[3];   uint32_t tint_count;    /* of the file's instance lists */
};

static void add_group(struct shares *s, const struct eco_group *group)
{
	const struct eco_scene *scene = s->input->scene;
	double area = (double)scene->plants[group->plant].area;
	if (!(scene->lists[group->list].attributes & ECO_ATTR_COLOR)) {
		s->plant[group->plant] += (double)group->count * area;
		return;
	}
	for (uint32_t i = 0; i < group->count; i++) {
		uint32_t tint = eco_place_read(scene, group->place_first + i).tint;
		assert(tint <= s->tint_count);
		s->plant[tint * scene->plant_count + group->plant] += area;
	}
}

/* An eco file's instance lists have one palette. */
static void find_tints(struct shares *s, uint32_t first, uint32_t end)
{
	const struct eco_scene *scene = s->input->scene;
	for (uint32_t t = first; t < end; t++)
		for (uint32_t g = 0; g < scene->tiles[t].group_count; g++) {
			const struct eco_list *list = &scene->lists[scene->groups[scene->tiles[t].group_first + g].list];
			if (list->palette_count) {
				s->tints = scene->palette + list->palette_first;
				s->tint_count = list->palette_count;
			}
		}
}

static void add_up(struct shares *s, uint32_t first, uint32_t end)
{
	const struct eco_scene *scene = s->input->scene;
	for (uint32_t t = first; t < end; t++) {
		const struct eco_tile *tile = &scene->tiles[t];
		for (uint32_t g = 0; g < tile->group_count; g++) {
			const struct eco_group *group = &scene->groups[tile->group_first + g];
			double area = (double)group->count
				* (double)scene->plants[group->plant].area;
			add_group(s, group);
			s->total += area;
		}
		for (uint32_t c = 0; c < tile->child_count; c++) {
			const struct eco_child *child = &scene->children[tile->child_first + c];
			if (!child->placed || !s->input->roots || !s->input->roots[child->tile])
				continue;
			double area = scene->tiles[child->tile].area * (double)child->scale
				* (double)child->scale;
			s->nested[s->nested_count++] = (struct nested){ child->tile, area };
			s->total += area;
		}
	}
}

/* The weight of each of `points` points of what has this area. */
static uint64_t weight_of(const struct shares *s, double area, uint32_t points)
{
	double share = fmin(fmax(area / s->total, LEAST), 1);
	return (uint64_t)(lod_power_below(share) * WHOLE / points);
}

static void weigh_plants(struct shares *s)
{
	const struct eco_scene *scene = s->input->scene;
	for (uint32_t k = 0; s->input->pools && k < scene->plant_count * (s->tint_count + 1); k++) {
		const struct lod_pool *pool = &s->input->pools[k % scene->plant_count];
		if (!(s->plant[k] > 0))
			continue;
		uint64_t weight = weight_of(s, s->plant[k], pool->count);
		for (uint32_t i = 0; i < pool->count; i++)
			s->weight[tinted_color(scene->palette_count, pool, i, k / scene->plant_count)] += weight;
	}
}

/* Places of one nested file count as one. */
static void weigh_nested(struct shares *s)
{
	struct lod_keyed *order = lod_arena_take(&s->arena, s->nested_count, sizeof *order);
	for (uint32_t i = 0; i < s->nested_count; i++)
		order[i] = (struct lod_keyed){ s->nested[i].tile, i };
	lod_sort(&s->arena, order, s->nested_count);
	for (uint32_t i = 0, end; i < s->nested_count; i = end) {
		double area = 0;
		for (end = i; end < s->nested_count && order[end].key == order[i].key; end++)
			area += s->nested[order[end].value].area;
		const struct lod_summary_root *root = s->input->roots[order[i].key];
		const struct eco_elements *e = &root->elements;
		if (!(area > 0) || e->element_count == 0)
			continue;
		uint64_t weight = weight_of(s, area, e->element_count);
		for (uint32_t k = 0; k < e->element_count; k++)
			s->weight[(uint32_t)e->extra[(size_t)k * e->extra_count] + root->list.palette_first]
				+= weight;
	}
}

static uint32_t count_placed(const struct eco_scene *scene, uint32_t first, uint32_t end)
{
	uint32_t count = 0;
	for (uint32_t t = first; t < end; t++)
		for (uint32_t c = 0; c < scene->tiles[t].child_count; c++)
			count += scene->children[scene->tiles[t].child_first + c].placed;
	return count;
}

/* The colour that an index of lod_summary_input.color_of stands for. */
static void color_at(const struct shares *s, uint32_t i, uint8_t rgb[3])
{
	const struct eco_scene *scene = s->input->scene;
	uint32_t tint = i / scene->palette_count;
	memcpy(rgb, scene->palette[i % scene->palette_count], 3);
	if (tint)
		lod_tint_apply(lod_tint_word(s->tints[tint - 1]), NULL, rgb, rgb);
}

static void make_palette(struct shares *s, struct lod_palette *palette)
{
	const struct eco_scene *scene = s->input->scene;
	uint32_t all = scene->palette_count * (s->tint_count + 1), count = 0;
	uint8_t (*rgb)[3] = lod_arena_take(&s->arena, all, sizeof *rgb);
	uint32_t *weights = lod_arena_take(&s->arena, all, sizeof *weights);
	for (uint32_t i = 0; i < all; i++)
		if (s->weight[i]) {
			color_at(s, i, rgb[count]);
			weights[count++] = (uint32_t)(s->weight[i] >> 12);
		}
	lod_palette_make(palette, LOD_SUMMARY_COLORS, (const uint8_t (*)[3])rgb, weights, count, &s->arena);
}

/* Entries stand in the order of the scene's colours, which follow the plants. So a point's colour tells much
 * of its plant, and its code is short. */
static void choose(struct shares *s, struct lod_summary_palette *out)
{
	const struct eco_scene *scene = s->input->scene;
	struct lod_palette *palette = lod_arena_take(&s->arena, 1, sizeof *palette);
	uint16_t entry[LOD_SUMMARY_COLORS];
	memset(entry, 0xff, sizeof entry);
	make_palette(s, palette);
	uint32_t all = scene->palette_count * (s->tint_count + 1);
	out->color_of = eco_alloc(all, sizeof *out->color_of);
	for (uint32_t i = 0; i < all; i++) {
		uint8_t rgb[3];
		if (!s->weight[i])
			continue;
		color_at(s, i, rgb);
		uint32_t k = lod_palette_index(palette, rgb);
		if (entry[k] == LOD_PALETTE_NONE) {
			entry[k] = (uint16_t)out->count;
			memcpy(out->rgb[out->count++], palette->rgb[k], sizeof *out->rgb);
		}
		out->color_of[i] = entry[k];
	}
}

void lod_summary_palette_make(struct lod_summary_palette *palette, const struct lod_summary_input *input,
	uint32_t tile_first, uint32_t tile_count)
{
	const struct eco_scene *scene = input->scene;
	struct shares s = { .input = input };
	*palette = (struct lod_summary_palette){ .color_count = scene->palette_count };
	find_tints(&s, tile_first, tile_first + tile_count);
	s.plant = lod_arena_take(&s.arena, (size_t)scene->plant_count * (s.tint_count + 1), sizeof *s.plant);
	s.nested = lod_arena_take(&s.arena, count_placed(scene, tile_first, tile_first + tile_count),
		sizeof *s.nested);
	s.weight = lod_arena_take(&s.arena, (size_t)scene->palette_count * (s.tint_count + 1), sizeof *s.weight);
	add_up(&s, tile_first, tile_first + tile_count);
	weigh_plants(&s);
	weigh_nested(&s);
	choose(&s, palette);
	lod_arena_free(&s.arena);
}

/* ---- As a list ---- */

#define SUMMARY_STEPS 1024.0     /* lod/EXPERIMENTS.md, Coarser grids */

static void choose_grid(struct eco_list *list, const struct lod_summary *summary)
{
	double low[3], high[3], extent = 0;
	for (int i = 0; i < 3; i++) {
		low[i] = high[i] = summary->points[0].at[i];
		for (uint32_t k = 1; k < summary->count; k++) {
			low[i] = fmin(low[i], summary->points[k].at[i]);
			high[i] = fmax(high[i], summary->points[k].at[i]);
		}
		extent = fmax(extent, high[i] - low[i]);
	}
	lod_grid_place(list, low, high, lod_power_below(fmax(extent / SUMMARY_STEPS, 1e-6)));
}

void lod_summary_list(const struct lod_summary *summary, const struct eco_scene *scene, uint32_t tile,
	uint32_t palette_count, struct eco_list *list, struct eco_elements *elements)
{
	uint32_t n = summary->count;
	assert(n > 0);
	*list = (struct eco_list){ .kind = ECO_LIST_POINTS, .coder = ECO_CODER_KD,
		.attributes = ECO_ATTR_COLOR | ECO_ATTR_PLANT,
		.level = summary->level, .owner = tile, .image = ECO_NONE,
		.partner = ECO_NONE, .palette_count = palette_count,
		.unit_area = eco_few_bits((float)(scene->tiles[tile].area / 2 / n)) };
	choose_grid(list, summary);
	*elements = (struct eco_elements){ .element_count = n, .corner_count = n, .primitive_count = n,
		.extra_count = 3,
		.corners = eco_alloc(n, 1), .position = eco_alloc(n, 3 * sizeof(int32_t)),
		.extra = eco_alloc(n, 3 * sizeof(int32_t)) };
	for (uint32_t k = 0; k < n; k++) {
		const struct lod_summary_point *p = &summary->points[k];
		elements->corners[k] = 1;
		for (int i = 0; i < 3; i++)
			elements->position[3 * k + (uint32_t)i] =
				(int32_t)floor((p->at[i] - list->grid_origin[i]) / list->grid_step[i] + 0.5);
		elements->extra[3 * k] = p->color;
		elements->extra[3 * k + 1] = (int32_t)p->plant;
		elements->extra[3 * k + 2] = p->key;
	}
}
