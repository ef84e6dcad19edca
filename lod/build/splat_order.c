/* The order in which splats give way to their children. */
#include <string.h>

#include "lod/build/splat_state.h"

#define VIEW_STEP 2u             /* every second view decides */

struct order {
	const struct splat_views *views;
	const struct splat_params *parents, *level;
	uint32_t children;
	struct splat_softness soft;
	float **left, *trial;            /* pictures of what has been chosen, one a view */
};

static double loss_with(const struct order *o, uint32_t parent)
{
	double loss = 0;
	size_t bytes = (size_t)o->views->pixels * o->views->stride * sizeof *o->trial;
	for (uint32_t view = 0; view < o->views->count; view += VIEW_STEP) {
		memcpy(o->trial, o->left[view], bytes);
		splat_view_replace(o->views, view, &o->parents[parent], &o->level[parent * o->children],
			o->children, &o->soft, o->trial);
		loss += splat_view_score(o->views, view, o->trial, o->soft.chance);
	}
	return loss;
}

static void choose(const struct order *o, uint32_t parent)
{
	for (uint32_t view = 0; view < o->views->count; view += VIEW_STEP)
		splat_view_replace(o->views, view, &o->parents[parent], &o->level[parent * o->children],
			o->children, &o->soft, o->left[view]);
}

static void order_group(const struct order *o, uint32_t *group, uint32_t siblings)
{
	for (uint32_t i = 0; i < siblings; i++) {
		uint32_t best = i;
		double least = i + 1 < siblings ? loss_with(o, group[i]) : 0;
		for (uint32_t j = i + 1; j < siblings; j++) {
			double loss = loss_with(o, group[j]);
			if (loss < least) {
				least = loss;
				best = j;
			}
		}
		uint32_t chosen = group[best];
		group[best] = group[i];
		group[i] = chosen;
		choose(o, chosen);
	}
}

void splat_order_find(const struct splat_views *views, const struct splat_params *parents, uint32_t count,
	uint32_t siblings, const struct splat_params *level, uint32_t children, struct lod_arena *arena,
	uint32_t *order)
{
	const struct lod_arena_piece *mark = arena->last;
	size_t pixels = (size_t)views->pixels * views->stride;
	struct order o = { .views = views, .parents = parents, .level = level, .children = children,
		.soft = { .edge_px = 0.6f, .blur_px2 = 0.2f, .chance = 0.25f } };
	o.left = lod_arena_take(arena, views->count, sizeof *o.left);
	o.trial = lod_arena_take(arena, pixels, sizeof *o.trial);
	for (uint32_t view = 0; view < views->count; view += VIEW_STEP) {
		o.left[view] = lod_arena_take(arena, pixels, sizeof(float));
		splat_view_draw(views, view, parents, count, &o.soft, o.left[view]);
	}
	for (uint32_t i = 0; i < count; i++)
		order[i] = i;
	for (uint32_t i = 0; i < count; i += siblings)
		order_group(&o, order + i, siblings);
	lod_arena_release(arena, mark);
}
