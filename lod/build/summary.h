/* Point summaries of tiles (Deussen 2002, 6.2): points drawn at random from the points of a tile's plants, in proportion to the plants'
 * areas, so that a few thousand of them stand for a hillside.
 *
 *   lod_pool_make(&pool, &plant, palette_first, count, &error);     once per plant (lod/build/pool.h)
 *   lod_summary_make(&summary, &input, &error);                     once per tile
 *   lod_summary_list(&summary, &scene, tile, &list, &elements, ...) as a list to be packed
 *
 * Every leaf tile owns an endless seeded sequence of points. Its summary is the beginning of it; a parent's summary is made of longer
 * or shorter beginnings, as many of each child as its share of the area: so parents merge their children's points, and no tile
 * is over-represented because its children had few. The same tile reached through two placements gives the same points.
 *
 * Of an eco file that is nested, whatever is in it, a parent takes the beginning of the summary as it is stored: so a summary costs as
 * much where a million hectares lie below it as where one does, and packs that were built apart can be summed up without their plants. */
#ifndef LOD_SUMMARY_H
#define LOD_SUMMARY_H

#include "lod/build/pool.h"

#define LOD_SUMMARY_LEAST 64u
#define LOD_SUMMARY_MOST 4096u

struct lod_summary_point { double at[3]; uint32_t plant; uint16_t key, color; };       /* in the tile's coordinates; key: see ecofiles/format/plan.h */
struct lod_summary { struct lod_summary_point *points; uint32_t count; uint8_t level; };

/* The summary of a nested eco file, decoded. */
struct lod_summary_root { struct eco_list list; struct eco_elements elements; };

struct lod_summary_input {
	const struct eco_scene *scene;       /* plants, tiles with area, groups, children, places and the groups' lists */
	const struct lod_pool *pools;        /* per plant; NULL: all plants are in nested eco files, and those without a root are left out */
	uint32_t tile, count;                /* points wanted */
	uint64_t seed;
	const struct lod_summary_root *const *roots;         /* per tile, NULL for those that are to be gone into; may be NULL itself */
};
/* About four points a plant, within bounds. */
uint32_t lod_summary_count(const struct eco_tile *tile);
/* Exactly `count` points in random order, fewer where nested summaries have fewer, or none where the tile's area is 0. Owned by the caller
 * (free points). */
enum eco_code lod_summary_make(struct lod_summary *summary, const struct lod_summary_input *input, struct eco_error *error);

/* The summary as a list with a grid fine enough for 1/4096 of the tile; counts and chunks are left to the writer. `palette_count`: of the
 * scene. */
enum eco_code lod_summary_list(const struct lod_summary *summary, const struct eco_scene *scene, uint32_t tile,
	uint32_t palette_count, struct eco_list *list, struct eco_elements *elements, struct eco_error *error);

/* Largest power of two that is not above v > 0. Exact. */
double lod_power_below(double v);

#endif
