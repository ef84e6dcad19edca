#include "client-min/view_ground.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define ANCHOR_MAX ((1 << 28) - 1)

static enum eco_code same_grid(const struct view_ground *g, uint32_t i, struct eco_error *error)
{
	const struct eco_list *a = &g->tiles[0].list->list, *b = &g->tiles[i].list->list;
	if (memcmp(a->grid_origin, b->grid_origin, sizeof a->grid_origin) == 0
			&& memcmp(a->grid_step, b->grid_step, sizeof a->grid_step) == 0)
		return ECO_OK;
	return eco_fail(error, ECO_DAMAGED, "lists %u and %u are ground on different grids",
		g->tiles[0].list->id, g->tiles[i].list->id);
}

static void find_anchor(struct view_ground *g, const struct lod_eye *eye)
{
	const struct eco_list *list = &g->tiles[0].list->list;
	for (int i = 0; i < 3; i++) {
		double step = list->grid_step[i],
			at = step > 0 ? floor((eye->at[i] - list->grid_origin[i]) / step + 0.5) : 0;
		at = at > ANCHOR_MAX ? ANCHOR_MAX : at < -ANCHOR_MAX ? -ANCHOR_MAX : at;
		g->anchor[i] = (int32_t)at;
		g->at[i] = list->grid_origin[i] + at * step;
		g->step[i] = (float)step;
		g->origin[i] = list->grid_origin[i];
	}
}

enum eco_code view_ground_make(struct view_ground *g, const struct view_store *store,
	const struct lod_eye *eye, struct eco_error *error)
{
	const struct eco_plan *plan = view_store_plan(store);
	uint32_t columns, rows, most = 0;
	enum eco_code code = ECO_OK;
	*g = (struct view_ground){ 0 };
	view_store_ground(store, &columns, &rows);
	for (uint32_t i = 0; plan && columns && i < plan->cut_count; i++)
		most += view_store_list(store, plan->cuts[i].list)->list.kind == ECO_LIST_GROUND;
	if (!most)
		return ECO_OK;
	struct eco_ground_tile *tiles = malloc(most * sizeof *tiles);
	struct lod_ground_seam *seams = malloc(most * sizeof *seams);
	g->tiles = malloc(most * sizeof *g->tiles);
	for (uint32_t i = 0; tiles && g->tiles && i < plan->cut_count && !code; i++) {
		const struct view_list *list = view_store_list(store, plan->cuts[i].list);
		if (list->list.kind != ECO_LIST_GROUND)
			continue;
		struct view_ground_tile *tile = &g->tiles[g->count];
		tile->list = list;
		tiles[g->count] = list->tile;
		eco_ground_spans(&tile->x, &tile->y, &list->tile, columns, rows);
		code = same_grid(g, g->count++, error);
	}
	if (!tiles || !seams || !g->tiles || (!code && !lod_ground_seams(seams, tiles, g->count)))
		code = eco_no_memory(error, "the ground in view");
	for (uint32_t i = 0; !code && i < g->count; i++)
		g->tiles[i].seam = seams[i];
	if (!code)
		find_anchor(g, eye);
	else
		view_ground_free(g);
	free(tiles);
	free(seams);
	return code;
}

void view_ground_free(struct view_ground *g)
{
	free(g->tiles);
	*g = (struct view_ground){ 0 };
}

uint32_t view_ground_sample(const struct view_ground_tile *tile, uint32_t column, uint32_t row)
{
	lod_ground_corner(&column, &row, &tile->seam, &tile->x, &tile->y);
	return (row + tile->y.before) * tile->x.count + column + tile->x.before;
}

/* Rise from sample a to sample b, a metre along `axis`; 0 where they are one. */
static double slope(const struct view_list *list, const int32_t *a, const int32_t *b, int axis)
{
	double along = ((double)b[axis] - a[axis]) * list->list.grid_step[axis];
	return along > 0 ? ((double)b[2] - a[2]) * list->list.grid_step[2] / along : 0;
}

void view_ground_normal(const struct view_list *list, uint32_t sample, float normal[3])
{
	uint32_t columns = list->list.columns, rows = list->elements.element_count / columns,
		c = sample % columns, r = sample / columns;
	const int32_t *p = list->elements.position + 3 * (size_t)sample;
	size_t row = 3 * (size_t)columns;
	double x = -slope(list, c > 0 ? p - 3 : p, c + 1 < columns ? p + 3 : p, 0);
	double y = -slope(list, r > 0 ? p - row : p, r + 1 < rows ? p + row : p, 1);
	double length = sqrt(x * x + y * y + 1);
	normal[0] = (float)(x / length);
	normal[1] = (float)(y / length);
	normal[2] = (float)(1 / length);
}

void view_ground_place(const struct view_ground *ground, const struct view_ground_tile *tile, uint32_t sample,
	float out[3])
{
	const int32_t *at = tile->list->elements.position + 3 * (size_t)sample;
	for (int k = 0; k < 3; k++)
		out[k] = (float)(at[k] - ground->anchor[k]) * ground->step[k];
}

const uint32_t view_ground_corners[6][2] = { { 0, 0 }, { 1, 0 }, { 1, 1 }, { 0, 0 }, { 1, 1 }, { 0, 1 } };

uint32_t view_ground_triangles(const struct view_ground *ground, const struct view_ground_tile *tile,
	float *out)
{
	for (uint32_t y = 0; y + 1 < tile->y.inner && out; y++)
		for (uint32_t x = 0; x + 1 < tile->x.inner; x++)
			for (int c = 0; c < 6; c++, out += 3)
				view_ground_place(ground, tile, view_ground_sample(tile,
					x + view_ground_corners[c][0], y + view_ground_corners[c][1]), out);
	return 2 * (tile->x.inner - 1) * (tile->y.inner - 1);
}

/* The sample of the span's inner ones at or before `at`, but for the last, and how far `at` is on the way to
 * the next; false outside. Places of samples are `stride` apart. */
static bool find_cell(const struct eco_ground_span *span, const int32_t *places, size_t stride, double at,
	uint32_t *sample, double *share)
{
	uint32_t i = span->before, last = span->before + span->inner - 1;
	if (!(at >= places[stride * i] && at <= places[stride * last]))
		return false;
	while (i + 1 < last && at >= places[stride * (i + 1)])
		i++;
	double low = places[stride * i], high = places[stride * (i + 1)];
	*sample = i;
	*share = (at - low) / (high - low);
	return true;
}

bool view_ground_height(const struct view_ground *g, double x, double y, double *height_m)
{
	for (uint32_t i = 0; i < g->count; i++) {
		const struct view_ground_tile *tile = &g->tiles[i];
		const struct eco_list *list = &tile->list->list;
		uint32_t column, row;
		double u, v;
		const int32_t *at = tile->list->elements.position;
		if (!find_cell(&tile->x, at, 3, (x - list->grid_origin[0]) / list->grid_step[0], &column, &u)
			|| !find_cell(&tile->y, at + 1, 3 * (size_t)tile->x.count,
			(y - list->grid_origin[1]) / list->grid_step[1], &row, &v))
			continue;
		const int32_t *south = at + 3 * ((size_t)row * tile->x.count + column) + 2;
		const int32_t *north = south + 3 * (size_t)tile->x.count;
		double z = u >= v ? south[0] + u * (south[3] - (double)south[0])
			+ v * (north[3] - (double)south[3])
			: south[0] + v * (north[0] - (double)south[0]) + u * (north[3] - (double)north[0]);
		*height_m = list->grid_origin[2] + z * list->grid_step[2];
		return true;
	}
	return false;
}
