/* Plants of blades: grass, turf, reeds. A splat is right where it lies on one blade, and mostly wrong where it
 * covers two, and no descent leads from there to one. So one level has a splat for each blade; coarser ones begin
 * with all points of their blades (lod/EXPERIMENTS.md, Splats, Blades). */
#include <math.h>
#include <string.h>

#include "lod/build/grid.h"
#include "lod/build/splat/splat_state.h"
#include "lod/build/weld.h"

#define BLADES_LEAST 48u         /* fewer are found by the usual start */
#define BLADES_MOST 1024u
#define LONG2 16                 /* square of a blade's length over its width */
#define LONG_SHARE 0.9           /* of all points: lie on such blades */

struct blade { struct splat_part part; double mean[3], length; };

struct blades {
	const struct splat_points *points;
	struct lod_arena *arena;
	struct blade *items;
	uint32_t count;
};

static uint32_t size_of(const struct splat_part *part) { return part->end - part->first; }

/* Sorts the points by the model's components; each that shows is a blade. False if they are too many. */
static bool gather(struct blades *b, const struct eco_model *model)
{
	const struct splat_points *points = b->points;
	struct lod_mesh mesh;
	lod_weld(&mesh, model, lod_grid_bits_least(model), b->arena);
	uint32_t *component = lod_arena_take(b->arena, model->triangle_count, sizeof *component);
	for (uint32_t t = 0; t < mesh.triangle_count; t++)
		component[mesh.source[t]] = 1 + mesh.component[t];
	struct lod_keyed *keyed = lod_arena_take(b->arena, points->count, sizeof *keyed);
	float (*copy)[3] = lod_arena_take(b->arena, points->count, sizeof *copy);
	for (uint32_t p = 0; p < points->count; p++)
		keyed[p] = (struct lod_keyed){ component[points->triangle[p]], p };
	lod_sort(b->arena, keyed, points->count);
	memcpy(copy, points->at, points->count * sizeof *copy);
	for (uint32_t p = 0; p < points->count; p++) {
		memcpy(points->at[p], copy[keyed[p].value], sizeof *copy);
		if (!p || keyed[p].key != keyed[p - 1].key) {
			if (b->count == BLADES_MOST)
				return false;
			b->items[b->count++].part.first = p;
		}
		b->items[b->count - 1].part.end = p + 1;
	}
	return true;
}

/* Finds the blade's moments. Whether it is much longer than wide. */
static bool measure(const struct blades *b, struct blade *blade)
{
	double value[3], vector[3][3];
	splat_moments((const float (*)[3])(b->points->at + blade->part.first), size_of(&blade->part),
		blade->mean, value, vector);
	blade->length = value[0] * size_of(&blade->part);
	return value[0] > LONG2 * value[1];
}

static bool are_blades(struct blades *b)
{
	uint64_t on = 0;
	for (uint32_t i = 0; i < b->count; i++)
		if (measure(b, &b->items[i]))
			on += size_of(&b->items[i].part);
	return b->count >= BLADES_LEAST && (double)on >= LONG_SHARE * b->points->count;
}

/* Levels about four times apart, one of them with at least as many splats as there are blades, and one with
 * half as many before it, since the gain is great there. */
static void choose_sizes(struct splat_blades *blades, uint32_t count)
{
	uint32_t most = 0, l = 0;
	for (uint32_t base = 1; base <= 3; base++) {
		uint32_t n = base;
		while (n < count)
			n *= 4;
		most = most && most < n ? most : n;
	}
	uint32_t base = most;
	while (base % 4 == 0)
		base /= 4;
	if (base > 1)
		blades->size[l++] = 1;
	for (uint32_t n = base; n < most; n *= 4)
		blades->size[l++] = n;
	blades->size[l++] = most / 2;
	blades->level = l;
	blades->size[l++] = most;
	blades->size[l++] = 4 * most;
	blades->levels = l;
}

/* Cuts the longest blades in two, until they are `count`. */
static void split(struct blades *b, uint32_t count)
{
	while (b->count < count) {
		uint32_t longest = 0;
		for (uint32_t i = 1; i < b->count; i++)
			if (b->items[i].length > b->items[longest].length)
				longest = i;
		struct blade *one = &b->items[longest], *two = &b->items[b->count++];
		splat_sort_along(b->points->at + one->part.first, size_of(&one->part), b->arena);
		two->part = one->part;
		one->part.end = two->part.first = one->part.first + size_of(&one->part) / 2;
		measure(b, one);
		measure(b, two);
	}
}

/* Those that show most first. */
static void sort_blades(struct blades *b)
{
	struct lod_keyed *keyed = lod_arena_take(b->arena, b->count, sizeof *keyed);
	struct blade *copy = lod_arena_take(b->arena, b->count, sizeof *copy);
	memcpy(copy, b->items, b->count * sizeof *copy);
	for (uint32_t i = 0; i < b->count; i++)
		keyed[i] = (struct lod_keyed){ UINT32_MAX - size_of(&copy[i].part), i };
	lod_sort(b->arena, keyed, b->count);
	for (uint32_t i = 0; i < b->count; i++)
		b->items[i] = copy[keyed[i].value];
}

static double distance2(const struct blade *a, const struct blade *b)
{
	double sum = 0;
	for (int k = 0; k < 3; k++)
		sum += (a->mean[k] - b->mean[k]) * (a->mean[k] - b->mean[k]);
	return sum;
}

/* The first `heads` of `heads` * `each` blades head groups; the others go to the nearest head with room.
 * child[each h .. each (h + 1)): group h, its head first. */
static void group(const struct blades *b, uint32_t heads, uint32_t each, uint32_t *child)
{
	uint32_t *taken = lod_arena_take(b->arena, heads, sizeof *taken);
	for (uint32_t i = 0; i < heads * each; i++) {
		double least = INFINITY;
		uint32_t to = i;
		for (uint32_t h = 0; i >= heads && h < heads; h++) {
			double d = distance2(&b->items[i], &b->items[h]);
			if (taken[h] < each && d < least) {
				least = d;
				to = h;
			}
		}
		child[each * to + taken[to]++] = i;
	}
}

/* The blades in the order of the finest groups: those of a group follow each other, in every level. */
static void nest(const struct blades *b, const struct splat_blades *blades, uint32_t *order)
{
	for (uint32_t i = 0; i < blades->size[0]; i++)
		order[i] = i;
	for (uint32_t level = 1; level <= blades->level; level++) {
		uint32_t heads = blades->size[level - 1], each = blades->size[level] / heads;
		uint32_t *child = lod_arena_take(b->arena, blades->size[level], sizeof *child);
		group(b, heads, each, child);
		for (uint32_t i = heads; i-- > 0;)
			memmove(order + (size_t)i * each, child + (size_t)order[i] * each,
				each * sizeof *order);
	}
}

bool splat_blades_find(struct splat_blades *blades, const struct splat_points *points,
	const struct eco_model *model, struct lod_arena *arena)
{
	struct blades b = { .points = points, .arena = arena };
	memset(blades, 0, sizeof *blades);
	b.items = lod_arena_take(arena, BLADES_MOST, sizeof *b.items);
	if (!gather(&b, model) || !are_blades(&b))
		return false;
	choose_sizes(blades, b.count);
	uint32_t count = blades->size[blades->level];
	split(&b, count);
	sort_blades(&b);
	uint32_t *order = lod_arena_take(arena, count, sizeof *order);
	float (*copy)[3] = lod_arena_take(arena, points->count, sizeof *copy);
	blades->parts = lod_arena_take(arena, count, sizeof *blades->parts);
	nest(&b, blades, order);
	memcpy(copy, points->at, points->count * sizeof *copy);
	for (uint32_t i = 0, first = 0; i < count; i++) {
		const struct splat_part *from = &b.items[order[i]].part;
		blades->parts[i] = (struct splat_part){ first, first + size_of(from) };
		memcpy(points->at + first, copy + from->first, size_of(from) * sizeof *copy);
		first = blades->parts[i].end;
	}
	return true;
}

struct splat_part splat_blades_part(const struct splat_blades *blades, uint32_t level, uint32_t i)
{
	uint32_t each = blades->size[blades->level] / blades->size[level];
	const struct splat_part *parts = blades->parts + (size_t)i * each;
	return (struct splat_part){ parts->first, parts[each - 1].end };
}
