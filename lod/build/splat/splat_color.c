/* Colours of splats. */
#include <string.h>

#include "lod/build/splat/splat_state.h"

static void sort_by_depth(const struct splat_view *view, const struct splat_params *splats, uint32_t count,
	struct lod_arena *arena, struct lod_keyed *order)
{
	for (uint32_t i = 0; i < count; i++) {
		double depth = 0;
		for (int k = 0; k < 3; k++)
			depth += view->forward[k] * (double)splats[i].v[k];
		order[i] = (struct lod_keyed){ lod_sort_key(depth), i };
	}
	lod_sort(arena, order, count);
}

void splat_color_level(const struct splat_views *views, const struct splat_params *splats, uint32_t count,
	const struct lod_splat *parents, uint32_t children, struct lod_arena *arena, struct lod_splat *out)
{
	static const uint8_t grey[3] = { 128, 128, 128 };
	const struct lod_arena_piece *mark = arena->last;
	size_t pixels = (size_t)views->pixels * views->stride;
	struct lod_keyed *order = lod_arena_take(arena, count, sizeof *order);
	struct lod_light *light = lod_arena_take(arena, count, sizeof *light);
	struct splat_picture picture = { lod_arena_take(arena, pixels, sizeof(float)), NULL, NULL };
	for (uint32_t view = 0; view < views->count; view++) {
		sort_by_depth(&views->items[view], splats, count, arena, order);
		splat_view_light(views, view, splats, order, count, &picture, light);
	}
	for (uint32_t i = 0; i < count; i++) {
		memcpy(out[i].rgb, parents ? parents[i / children].rgb : grey, 3);
		if (light[i].weight > 0.25)
			lod_light_mean(&light[i], out[i].rgb);
	}
	lod_arena_release(arena, mark);
}
