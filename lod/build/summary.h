/* Point summaries of tiles (Deussen 2002, 6.2): points drawn at random from the points of a tile's plants, in
 * proportion to the plants' areas.
 *
 *   lod_pool_make(&pool, &plant, palette_first, count);             once per plant (lod/build/pool.h)
 *   lod_summary_palette_make(&palette, &input, first, count);  once per eco file
 *   lod_summary_make(&summary, &input);                             once per tile
 *   lod_summary_list(&summary, &scene, tile, &list, &elements, ...) as a list to be packed
 *
 * Every leaf tile has an endless seeded sequence of points, and its summary is the beginning of it; a
 * parent's is made of beginnings, each as long as the child's share of the area. From a nested eco file a
 * parent takes the beginning of its stored summary. */
#pragma once

#include "lod/build/pool.h"

#define LOD_SUMMARY_LEAST 64u
#define LOD_SUMMARY_MOST 4096u

/* In the tile's coordinates; key: ecofiles/format/plan.h; color: index into the list's palette. */
struct lod_summary_point { double at[3]; uint32_t plant; uint16_t key, color; };
struct lod_summary { struct lod_summary_point *points; uint32_t count; uint8_t level; };

/* The summary of a nested eco file, decoded. */
struct lod_summary_root { struct eco_list list; struct eco_elements elements; };

struct lod_summary_input {
	/* Plants, tiles with area, groups, children, places and the groups' lists. */
	const struct eco_scene *scene;
	/* Per plant; NULL: all plants are in nested eco files, and nested files without a root are left
	 * out. */
	const struct lod_pool *pools;
	uint32_t tile, count;                /* points wanted */
	uint64_t seed;
	/* Per tile, NULL for a tile to descend into; may itself be NULL. */
	const struct lod_summary_root *const *roots;
	/* Per colour of the scene, as pools and roots name it, without a tint, then with each of the lists'
	 * tints: that of a point (lod_summary_palette). NULL: the same, of at most 65536. */
	const uint16_t *color_of;
	uint32_t color_count;                /* of the scene, when color_of was made */
};
/* About four points a plant, within bounds. */
uint32_t lod_summary_count(const struct eco_tile *tile);
/* Exactly `count` points in random order; fewer if nested summaries have fewer, none if the tile's area is 0.
 * The caller frees points. */
void lod_summary_make(struct lod_summary *summary, const struct lod_summary_input *input);

/* The colours of the summaries of one eco file: exactly those of the points if they are few, else a palette
 * in which a plant counts with its area, rounded down to a power of two of the file's. So colours stay while
 * a few plants come, go or move. Nested files give the colours of their stored summaries.
 *
 *   lod_summary_palette_make(&palette, &input, tile_first, tile_count);
 *   input.color_of = palette.color_of; input.color_count = palette.color_count;    lod_summary_make(&summary, &input)
 *   free(palette.color_of); */
#define LOD_SUMMARY_COLORS 32u

struct lod_summary_palette {
	uint8_t rgb[LOD_SUMMARY_COLORS][3];      uint32_t count; /* 0: the tiles show nothing */
	/* per colour, as lod_summary_input has it: its entry, 0 if no point has it; owned */
	uint16_t *color_of;          uint32_t color_count;
};

/* Colours of points in tiles [tile_first, tile_first + tile_count), which are all of one eco file. The tile,
 * its count and color_of of `input` are not read. */
void lod_summary_palette_make(struct lod_summary_palette *palette, const struct lod_summary_input *input,
	uint32_t tile_first, uint32_t tile_count);

/* The summary as a list with a grid step of at most 1/4096 of the tile; the writer sets counts and chunks.
 * `palette_count`: colours that points name; the caller sets the list's palette_first. */
void lod_summary_list(const struct lod_summary *summary, const struct eco_scene *scene, uint32_t tile,
	uint32_t palette_count, struct eco_list *list, struct eco_elements *elements);

/* The largest power of two not above v > 0. Exact. */
double lod_power_below(double v);
/* Gives a list a grid of this step, a power of two, for what lies in [low, high]. The origin has few bits: it
 * is within an eighth of the extent of `low` on each axis, and a point of the scene's grid of that step, so
 * that [0, 0, 0] is on it. */
void lod_grid_place(struct eco_list *list, const double low[3], const double high[3], double step);
