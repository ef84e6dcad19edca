#include "tests/bench/collapse/bench_collapse_plant.h"

#include <string.h>

#include "lod/sort.h"

#define LEAF_RGB { 76, 110, 40 }

static uint32_t element_of(const struct bench_collapse_plant *plant, uint32_t sector, uint32_t node)
{
	const struct lod_collapse *forest = &plant->sectors.forest[sector];
	return node < forest->leaves ? forest->leaf[node] : plant->base[sector] + node - forest->leaves;
}

/* The element whose area is the median: the shape of the leaves in all textures. */
static uint32_t median_leaf(const struct lod_foliage *f, struct lod_arena *arena)
{
	struct lod_arena_piece *mark = arena->last;
	struct lod_keyed *items = lod_arena_take(arena, f->count, sizeof *items);
	for (uint32_t i = 0; i < f->count; i++)
		items[i] = (struct lod_keyed){ lod_sort_key(f->area[i]), i };
	lod_sort(arena, items, f->count);
	uint32_t median = items[f->count / 2].value;
	lod_arena_release(arena, mark);
	return median;
}

/* Vertices of every level: two runs; the first only grows. */
static void count_vertices(struct bench_collapse_plant *plant, uint32_t sector, const struct lod_foliage *f,
	struct lod_arena *arena)
{
	const struct lod_collapse *forest = &plant->sectors.forest[sector];
	uint64_t *vertices = lod_arena_take(arena, (size_t)forest->made + 1, sizeof *vertices), sum = 0;
	uint32_t done = 0;
	for (uint32_t row = 0; row <= forest->made; row++) {
		for (; done < forest->level[row].a; done++) {
			uint32_t leaf = element_of(plant, sector, forest->place[done]);
			sum += 3 * (f->first[leaf + 1] - f->first[leaf] - 2);
		}
		vertices[row] = sum + 6 * (uint64_t)forest->level[row].c;
	}
	plant->vertices[sector] = vertices;
}

void bench_collapse_make(struct bench_collapse_plant *plant, const struct lod_foliage *f,
	const struct bench_collapse_options *options, struct lod_arena *arena)
{
	uint32_t sectors = options->sectors ? options->sectors : 1;
	*plant = (struct bench_collapse_plant){ .leaves = f->count, .solid = options->solid,
		.base = lod_arena_take(arena, sectors, sizeof *plant->base),
		.vertices = lod_arena_take(arena, sectors, sizeof *plant->vertices) };
	lod_collapse_sectors_make(&plant->sectors, sectors, f, NULL, arena);
	for (uint32_t s = 0; s < sectors; s++) {
		plant->base[s] = f->count + plant->quads;
		plant->quads += plant->sectors.forest[s].made;
		count_vertices(plant, s, f, arena);
	}
	uint32_t leaf = median_leaf(f, arena);
	const struct lod_fan shape = lod_foliage_fan(f, leaf, f->mask ? f->mask[leaf] : NULL);
	lod_collapse_atlas_make(&plant->atlas, plant->sectors.forest, sectors, &shape,
		(const uint8_t[3])LEAF_RGB, arena);
}

/* ---- Elements ---- */

static void *grown(struct lod_arena *arena, const void *old, size_t count, size_t room, size_t size)
{
	void *array = lod_arena_take(arena, room, size);
	memcpy(array, old, count * size);
	return array;
}

static void fill_quad(const struct bench_collapse_plant *plant, uint32_t sector, uint32_t quad,
	struct lod_foliage *f)
{
	const struct lod_collapse *forest = &plant->sectors.forest[sector];
	const struct lod_collapse_node *node = &forest->node[forest->leaves + quad];
	uint32_t i = plant->base[sector] + quad, at = f->first[i], tile = plant->atlas.of[sector][quad];
	struct lod_v3 corner[ECO_CORNERS_MAX];
	f->first[i + 1] = at + lod_collapse_corners(forest, NULL, forest->leaves + quad, corner);
	f->triangle_first[i + 1] = f->triangle_first[i] + 2;
	for (uint32_t k = 0; k < 4; k++) {
		float *to = f->corner[at + k];
		to[0] = (float)corner[k].x, to[1] = (float)corner[k].y, to[2] = (float)corner[k].z;
	}
	lod_collapse_atlas_uv(&plant->atlas, tile, f->uv + at);
	f->cutout[i] = plant->solid ? NULL : &plant->atlas.image;
	f->center[i] = node->center;
	f->normal[i] = lod_v3_scale(node->normal, node->area);
	f->area[i] = node->opaque_area;
}

void bench_collapse_extend(const struct bench_collapse_plant *plant, struct lod_foliage *f,
	struct lod_arena *arena)
{
	size_t n = plant->leaves, all = n + plant->quads, corners = f->first[n],
		room = corners + 4 * (size_t)plant->quads;
	f->first = grown(arena, f->first, n + 1, all + 1, sizeof *f->first);
	f->triangle_first = grown(arena, f->triangle_first, n + 1, all + 1, sizeof *f->triangle_first);
	f->corner = grown(arena, f->corner, corners, room, sizeof *f->corner);
	f->uv = grown(arena, f->uv, corners, room, sizeof *f->uv);
	f->cutout = grown(arena, f->cutout, n, all, sizeof *f->cutout);
	if (f->mask)                             /* quads have none: their images are looked up */
		f->mask = grown(arena, f->mask, n, all, sizeof *f->mask);
	f->center = grown(arena, f->center, n, all, sizeof *f->center);
	f->normal = grown(arena, f->normal, n, all, sizeof *f->normal);
	f->area = grown(arena, f->area, n, all, sizeof *f->area);
	for (uint32_t s = 0; s < plant->sectors.count; s++)
		for (uint32_t k = 0; k < plant->sectors.forest[s].made; k++)
			fill_quad(plant, s, k, f);
}

/* ---- Levels ---- */

uint32_t bench_collapse_row(const struct bench_collapse_plant *plant, uint32_t sector, double vertices)
{
	uint32_t low = 0, high = plant->sectors.forest[sector].made;
	while (low < high) {
		uint32_t middle = (low + high + 1) / 2;
		if ((double)plant->vertices[sector][middle] <= vertices)
			low = middle;
		else
			high = middle - 1;
	}
	return low;
}

uint32_t bench_collapse_order(const struct bench_collapse_plant *plant, uint32_t sector, uint32_t row,
	uint32_t *order)
{
	const struct lod_collapse *forest = &plant->sectors.forest[sector];
	const struct lod_collapse_level *level = &forest->level[row];
	for (uint32_t i = 0; i < level->a; i++)
		order[i] = element_of(plant, sector, forest->place[i]);
	for (uint32_t i = 0; i < level->c; i++)
		order[level->a + i] = element_of(plant, sector, forest->place[level->b + i]);
	return level->a + level->c;
}

void bench_collapse_shown(const struct bench_collapse_plant *plant, uint32_t sector, uint32_t row,
	uint32_t *shown, struct lod_arena *arena)
{
	const struct lod_collapse *forest = &plant->sectors.forest[sector];
	struct lod_arena_piece *mark = arena->last;
	uint32_t *node = lod_arena_take(arena, forest->leaves, sizeof *node);
	lod_collapse_shown(forest, &forest->level[row], node, arena);
	for (uint32_t i = 0; i < forest->leaves; i++)
		shown[element_of(plant, sector, i)] = element_of(plant, sector, node[i]);
	lod_arena_release(arena, mark);
}
