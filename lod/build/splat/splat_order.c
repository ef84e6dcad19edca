/* The gain of a splat that gives way to its children: the mean of the gain among parents and the gain among
 * children, as it is the less the more its neighbours cover. */
#include <string.h>

#include "lod/build/splat/splat_state.h"

#define VIEW_STEP 4u             /* every fourth view decides */

struct gains {
	const struct splat_views *views;
	const struct splat_params *parents, *level;
	uint32_t count, children;
	struct splat_softness soft;
	float *coarse, *fine, *trial;
	struct splat_row *rows[2];       /* of `fine`, of `coarse` */
	double *gain;
};

static double trial_score(const struct gains *g, uint32_t view, uint32_t parent, bool finer)
{
	const struct splat_params *one = &g->parents[parent], *many = &g->level[(size_t)parent * g->children];
	struct splat_exchange what = finer ? (struct splat_exchange){ one, many, 1, g->children }
		: (struct splat_exchange){ many, one, g->children, 1 };
	return splat_view_replace(g->views, view, &what, &g->soft, finer ? g->coarse : g->fine,
		g->rows[finer], g->trial);
}

static void add_view(const struct gains *g, uint32_t view)
{
	splat_view_draw(g->views, view, g->parents, g->count, &g->soft, g->coarse);
	splat_view_draw(g->views, view, g->level, g->count * g->children, &g->soft, g->fine);
	double coarse = splat_view_score(g->views, view, g->coarse, g->soft.chance, g->rows[1]),
		fine = splat_view_score(g->views, view, g->fine, g->soft.chance, g->rows[0]);
	for (uint32_t i = 0; i < g->count; i++)
		g->gain[i] += coarse - trial_score(g, view, i, true) + trial_score(g, view, i, false) - fine;
}

void splat_gains(const struct splat_views *views, const struct splat_params *parents, uint32_t count,
	const struct splat_params *level, uint32_t children, struct lod_arena *arena, double *gain)
{
	const struct lod_arena_piece *mark = arena->last;
	size_t pixels = (size_t)views->pixels * views->stride;
	struct gains g = { .views = views, .parents = parents, .level = level, .count = count,
		.children = children, .soft = { .edge_px = 0.6f, .blur_px2 = 0.2f, .chance = 0.6f },
		.gain = gain };
	g.coarse = lod_arena_take(arena, pixels, sizeof *g.coarse);
	g.fine = lod_arena_take(arena, pixels, sizeof *g.fine);
	g.trial = lod_arena_take(arena, pixels, sizeof *g.trial);
	for (int i = 0; i < 2; i++)
		g.rows[i] = lod_arena_take(arena, views->pixels, sizeof *g.rows[i]);
	memset(gain, 0, count * sizeof *gain);
	for (uint32_t view = 0; view < views->count; view += VIEW_STEP)
		add_view(&g, view);
	lod_arena_release(arena, mark);
}
