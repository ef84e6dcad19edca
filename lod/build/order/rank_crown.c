#include "lod/build/order/rank_state.h"

#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/order.h"
#include "lod/lanes.h"
#include "lod/sort.h"

#define PIXELS_LEAST 128u
#define PIXELS_MOST 512u
#define PIXELS_FEWEST 48u
/* Pixels of a picture for each element, which then is a few pixels wide. */
#define PER_ELEMENT 200.0
#define STEP 1.03                        /* of edges; a finer one brings nothing */
#define HALF_STEP 1.015
#define WIDE 2.0 /* pixels: width of a leaf of the usual size in the largest pictures */

ECO_ORDER(by_area, double, [0])

/* The size of pictures in which half of the leaves are at least WIDE pixels wide. */
static uint32_t choose_pixels(const struct lod_foliage *foliage, struct lod_arena *arena)
{
	const struct lod_arena_piece *mark = arena->last;
	uint32_t n = foliage->count;
	double *area = lod_arena_take(arena, n, sizeof *area);
	memcpy(area, foliage->area, n * sizeof *area);
	qsort(area, n, sizeof *area, by_area);
	double leaf = sqrt(area[n / 2]), crown = lod_v3_distance(foliage->low, foliage->high);
	lod_arena_release(arena, mark);
	double pixels = leaf > 0 ? WIDE * crown / leaf : PIXELS_MOST;
	return pixels < PIXELS_LEAST ? PIXELS_LEAST : pixels > PIXELS_MOST ? PIXELS_MOST
		: (uint32_t)(pixels / 64) * 64;
}

static void open_level(struct lod_crown *crown, const double (*directions)[3], uint32_t pixels,
	struct lod_arena *arena)
{
	struct lod_crown_level *level = &crown->levels[crown->level_count++];
	lod_sights_make(&level->sights, crown->foliage, directions, crown->views, pixels, arena);
	level->canvas = lod_arena_take(arena, crown->views, sizeof *level->canvas);
	for (uint32_t v = 0; v < crown->views; v++)
		level->canvas[v] = (struct lod_canvas){ .row_words = level->sights.words / pixels,
			.reference = level->sights.reference[v],
			.times = lod_arena_take(arena, level->sights.words, sizeof *level->canvas[v].times) };
}

void lod_crown_open(struct lod_crown *crown, const struct lod_foliage *foliage,
	const struct lod_rank_options *options, struct lod_arena *arena)
{
	uint32_t views = options->views, pixels = options->pixels ? options->pixels
		: choose_pixels(foliage, arena);
	double (*directions)[3] = lod_arena_take(arena, views, sizeof *directions);
	*crown = (struct lod_crown){ .foliage = foliage, .views = views };
	lod_directions_spread(directions, views, options->seed);
	for (uint32_t k = 0; k < LOD_CROWN_LEVELS; k++)
		if (pixels >> (LOD_CROWN_LEVELS - 1 - k) >= PIXELS_FEWEST || k + 1 == LOD_CROWN_LEVELS)
			open_level(crown, (const double (*)[3])directions,
				pixels >> (LOD_CROWN_LEVELS - 1 - k), arena);
	crown->level = &crown->levels[crown->level_count - 1];
}

void lod_crown_set_level(struct lod_crown *crown, uint32_t count)
{
	uint32_t k = 0;
	while (k + 1 < crown->level_count
			&& (double)crown->levels[k].sights.pixels * crown->levels[k].sights.pixels
			< PER_ELEMENT * count)
		k++;
	crown->level = &crown->levels[k];
}

void lod_crown_set_scale(struct lod_crown_edges *edges, double scale, bool points)
{
	for (uint32_t c = 0; c < ECO_GROWTHS; c++) {
		double wanted = sqrt(eco_growth(points ? ECO_GROWTH_PLAIN : c, (float)scale)), edge = 1;
		uint32_t step = 0;
		for (; step + 1 < LOD_CROWN_EDGES && edge * HALF_STEP < wanted; step++)
			edge *= STEP;
		edges->step[c] = (uint16_t)step;
		edges->edge[c] = edge;
	}
}

void lod_crown_see(const struct lod_crown *crown, struct lod_fan_seen *seen, uint32_t element, uint32_t view,
	bool points)
{
	const struct lod_eye *eye = &crown->level->sights.eyes[view];
	struct lod_fan fan = lod_foliage_fan(crown->foliage, element);
	if (points)
		lod_fan_see_point(seen, &fan, crown->foliage->area[element] / 2, eye);
	else
		lod_fan_see(seen, &fan, eye);
}

void lod_crown_clear(struct lod_crown *crown, struct lod_crown_views views)
{
	const struct lod_sights *sights = &crown->level->sights;
	for (uint32_t v = views.first; v < sights->count; v += views.stride)
		for (uint32_t i = 0; i < sights->words; i++)
			for (int k = 0; k < 2; k++)
				crown->level->canvas[v].times[i][k] = sights->wood[v][i];
}

void lod_crown_gain(const struct lod_crown *crown, uint32_t element, const double *edge, uint32_t count,
	struct lod_crown_views views, struct lod_gain *gain)
{
	struct lod_fan_seen seen;
	memset(gain, 0, count * sizeof *gain);
	for (uint32_t v = views.first; v < crown->level->sights.count; v += views.stride) {
		lod_crown_see(crown, &seen, element, v, crown->points);
		for (uint32_t i = 0; i < count; i++)
			lod_fan_gain(&seen, edge[i], crown->level->sights.pixels, &crown->level->canvas[v],
				&gain[i]);
	}
}

void lod_crown_add(struct lod_crown *crown, uint32_t element, double edge, struct lod_crown_views views)
{
	struct lod_fan_seen seen;
	for (uint32_t v = views.first; v < crown->level->sights.count; v += views.stride) {
		lod_crown_see(crown, &seen, element, v, crown->points);
		lod_fan_add(&seen, edge, crown->level->sights.pixels, &crown->level->canvas[v]);
	}
}

LOD_CLONES struct lod_crown_sum lod_crown_sum(const struct lod_crown *crown, struct lod_crown_views views)
{
	const struct lod_sights *sights = &crown->level->sights;
	struct lod_crown_sum sum = { 0 };
	for (uint32_t v = views.first; v < sights->count; v += views.stride) {
		for (uint32_t i = 0; i < sights->words; i++) {
			const uint64_t *times = crown->level->canvas[v].times[i], covered = times[0];
			sum.right += lod_bits_of(covered & sights->reference[v][i]);
			sum.wrong += lod_bits_of(covered & ~sights->reference[v][i]);
		}
		sum.wanted += sights->reference_pixels[v];
	}
	return sum;
}
