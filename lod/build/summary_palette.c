#include "lod/build/summary_palette.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "lod/build/palette.h"
#include "lod/sort.h"

#define WHOLE 1099511627776.0            /* 2^40: weight of a plant with the file's whole area */
#define LEAST 9.5367431640625e-7         /* 2^-20 */

struct nested { uint32_t tile; double area; };

struct shares {
	const struct lod_summary_input *input;
	struct lod_arena arena;
	double *plant;               /* per plant of the scene: summed area */
	struct nested *nested;       uint32_t nested_count;  /* placed children, in the order of tiles */
	double total;
	uint64_t *weight;            /* per colour of the scene */
};

static void add_up(struct shares *s, uint32_t first, uint32_t end)
{
	const struct eco_scene *scene = s->input->scene;
	for (uint32_t t = first; t < end; t++) {
		const struct eco_tile *tile = &scene->tiles[t];
		for (uint32_t g = 0; g < tile->group_count; g++) {
			const struct eco_group *group = &scene->groups[tile->group_first + g];
			double area = (double)group->count
				* (double)scene->plants[group->plant].area;
			s->plant[group->plant] += area;
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
	for (uint32_t p = 0; s->input->pools && p < s->input->scene->plant_count; p++) {
		const struct lod_pool *pool = &s->input->pools[p];
		if (!(s->plant[p] > 0))
			continue;
		uint64_t weight = weight_of(s, s->plant[p], pool->count);
		for (uint32_t i = 0; i < pool->count; i++)
			s->weight[pool->color[i]] += weight;
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

static void make_palette(struct shares *s, struct lod_palette *palette)
{
	const struct eco_scene *scene = s->input->scene;
	uint8_t (*rgb)[3] = lod_arena_take(&s->arena, scene->palette_count, sizeof *rgb);
	uint32_t *weights = lod_arena_take(&s->arena, scene->palette_count, sizeof *weights), count = 0;
	for (uint32_t i = 0; i < scene->palette_count; i++)
		if (s->weight[i]) {
			memcpy(rgb[count], scene->palette[i], sizeof rgb[count]);
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
	out->color_of = lod_arena_own(&s->arena, scene->palette_count, sizeof *out->color_of);
	for (uint32_t i = 0; i < scene->palette_count; i++) {
		if (!s->weight[i])
			continue;
		uint32_t k = lod_palette_index(palette, scene->palette[i]);
		if (entry[k] == LOD_PALETTE_NONE) {
			entry[k] = (uint16_t)out->count;
			memcpy(out->rgb[out->count++], palette->rgb[k], sizeof *out->rgb);
		}
		out->color_of[i] = entry[k];
	}
}

enum eco_code lod_summary_palette_make(struct lod_summary_palette *palette,
	const struct lod_summary_input *input, uint32_t tile_first, uint32_t tile_count,
	struct eco_error *error)
{
	const struct eco_scene *scene = input->scene;
	struct shares s = { .input = input };
	*palette = (struct lod_summary_palette){ .count = 0 };
	if (setjmp(s.arena.failed)) {
		lod_arena_free(&s.arena);
		return eco_fail(error, ECO_NO_MEMORY, "no memory for the colours of summaries");
	}
	s.plant = lod_arena_take(&s.arena, scene->plant_count, sizeof *s.plant);
	s.nested = lod_arena_take(&s.arena, count_placed(scene, tile_first, tile_first + tile_count),
		sizeof *s.nested);
	s.weight = lod_arena_take(&s.arena, scene->palette_count, sizeof *s.weight);
	add_up(&s, tile_first, tile_first + tile_count);
	weigh_plants(&s);
	weigh_nested(&s);
	choose(&s, palette);
	lod_arena_free(&s.arena);
	return ECO_OK;
}
