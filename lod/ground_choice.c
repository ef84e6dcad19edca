/* Choosing tiles, and the seams between those chosen. */
#include "lod/ground_choice.h"

#include <math.h>
#include <stdlib.h>

#include "ecofiles/base/order.h"
#include "lod/heap.h"

/* ---- Neighbours ---- */

enum { SIDES = 4 };              /* as LOD_GROUND_WEST and the others */

struct placed { uint64_t key; uint32_t tile; };

static uint64_t key_of(uint32_t level, uint32_t column, uint32_t row)
{
	return (uint64_t)level << 48 | (uint64_t)column << 24 | row;
}

ECO_ORDER(by_key, struct placed, ->key)

/* The coarser tile, of `all` in order, that touches this side of a tile; NULL: none is coarser. */
static const struct placed *coarser_beyond(const struct placed *all, uint32_t count,
	const struct eco_ground_tile *tile, int side)
{
	static const int8_t beyond[SIDES][2] = { { -1, 0 }, { 1, 0 }, { 0, -1 }, { 0, 1 } };
	int64_t column = (int64_t)tile->column + beyond[side][0], row = (int64_t)tile->row + beyond[side][1];
	if (column < 0 || row < 0)
		return NULL;
	for (uint8_t up = 1; tile->level + up < ECO_GROUND_LEVELS; up++) {
		struct placed key = { .key = key_of(tile->level + up, (uint32_t)column >> up, (uint32_t)row >> up) };
		const struct placed *found = bsearch(&key, all, count, sizeof key, by_key);
		if (found)
			return found;
	}
	return NULL;
}

/* ---- Choosing ---- */

struct search {
	const struct eco_scene *scene;
	const struct lod_eye *eye;
	double origin[2], step[2];       /* of the grid of samples */
	struct lod_heap_item *heap;          /* the entry with the largest error on the screen on top */
	uint32_t count, most;
	uint32_t *done, done_count;      /* tiles that cannot be refined */
	double error_px;
};

static double place(const struct eco_scene *scene, const struct eco_ground_span *span, uint32_t sample)
{
	return eco_ground_place(sample, span->last + 1, scene->ground_margin);
}

static void bounds(const struct eco_scene *scene, const struct eco_ground_tile *tile, double low[3],
	double high[3])
{
	const struct eco_list *list = &scene->lists[scene->ground[0].list];
	const double *o = list->grid_origin, *step = list->grid_step;
	struct eco_ground_span x, y;
	eco_ground_spans(&x, &y, tile, scene->ground_columns, scene->ground_rows);
	low[0] = o[0] + place(scene, &x, x.low) * step[0];
	high[0] = o[0] + place(scene, &x, x.high) * step[0];
	low[1] = o[1] + place(scene, &y, y.low) * step[1];
	high[1] = o[1] + place(scene, &y, y.high) * step[1];
	/* the drawn ground may be off by the error */
	low[2] = (double)tile->low_m - (double)tile->error_m;
	high[2] = (double)tile->high_m + (double)tile->error_m;
}

/* The largest and, below, the smallest value of dot(axis, p - eye) over the box. */
static double farthest(const struct lod_eye *eye, const double axis[3], const double low[3],
	const double high[3])
{
	double sum = 0;
	for (int i = 0; i < 3; i++)
		sum += axis[i] * ((axis[i] > 0 ? high[i] : low[i]) - eye->at[i]);
	return sum;
}

static double nearest(const struct lod_eye *eye, const double axis[3], const double low[3],
	const double high[3])
{
	double sum = 0;
	for (int i = 0; i < 3; i++)
		sum += axis[i] * ((axis[i] > 0 ? low[i] : high[i]) - eye->at[i]);
	return sum;
}

bool lod_box_seen(const struct lod_eye *eye, const double low[3], const double high[3])
{
	for (int i = 0; i < 4; i++)
		if (farthest(eye, eye->side[i], low, high) < 0)
			return false;
	return farthest(eye, eye->forward, low, high) > 0;
}

double lod_box_depth(const struct lod_eye *eye, const double low[3], const double high[3])
{
	/* of the angle between the view's axis and its corners */
	double border_cosine = 1 / sqrt(1 + eye->tan_x * eye->tan_x + eye->tan_y * eye->tan_y);
	double square = 0, depth, along;
	for (int i = 0; i < 3; i++) {
		double off = eye->at[i] < low[i] ? low[i] - eye->at[i] : eye->at[i] > high[i]
			? eye->at[i] - high[i] : 0;
		square += off * off;
	}
	depth = sqrt(square) * border_cosine;
	along = nearest(eye, eye->forward, low, high);
	return along > depth ? along : depth;
}

/* The height of the error in pixels, at the least depth that a visible point of the box can have. */
static double shown_px(const struct search *s, const struct eco_ground_tile *tile, const double low[3],
	const double high[3])
{
	double depth = lod_box_depth(s->eye, low, high);
	if (tile->error_m <= 0)
		return 0;
	return depth > 0 ? (double)tile->error_m / (depth * s->eye->pixel_rad) : INFINITY;
}

static struct lod_heap_item pop(struct search *s)
{
	struct lod_heap_item top = s->heap[0];
	s->heap[0] = s->heap[--s->count];
	lod_heap_sift(s->heap, s->count, 0);
	return top;
}

void lod_ground_heights(const struct eco_scene *scene, double low[3], double high[3])
{
	const struct eco_ground_tile *tile = &scene->ground[0];
	for (bool inside = true; inside && tile->child_count > 0;) {
		inside = false;
		for (uint32_t i = 0; i < tile->child_count && !inside; i++) {
			double from[3], to[3];
			bounds(scene, &scene->ground[tile->child_first + i], from, to);
			inside = low[0] >= from[0] && low[1] >= from[1] && high[0] <= to[0] &&
				high[1] <= to[1];
			if (inside)
				tile = &scene->ground[tile->child_first + i];
		}
	}
	low[2] = (double)tile->low_m;
	high[2] = (double)tile->high_m;
}

static bool is_seen(const struct search *s, uint32_t tile)
{
	double low[3], high[3];
	bounds(s->scene, &s->scene->ground[tile], low, high);
	return lod_box_seen(s->eye, low, high);
}

static void look_at(struct search *s, uint32_t tile)
{
	const struct eco_ground_tile *t = &s->scene->ground[tile];
	double low[3], high[3];
	bounds(s->scene, t, low, high);
	if (!lod_box_seen(s->eye, low, high))
		return;
	if (t->child_count > 0)
		lod_heap_push(s->heap, s->count++, (struct lod_heap_item){ shown_px(s, t, low, high), tile });
	else
		s->done[s->done_count++] = tile;
}

static void refine(struct search *s, double tolerance_px)
{
	/* refining adds at most three */
	while (s->count > 0 && s->heap[0].key > tolerance_px && s->count + s->done_count + 3 <= s->most) {
		const struct eco_ground_tile *t = &s->scene->ground[pop(s).id];
		for (uint32_t i = 0; i < t->child_count; i++)
			look_at(s, t->child_first + i);
	}
	s->error_px = s->count > 0 ? s->heap[0].key : 0;
	for (uint32_t i = 0; i < s->count; i++)
		s->done[s->done_count++] = s->heap[i].id;
}

/* Which of the chosen tiles touch one that is too much finer, and have children. */
static void mark_far_apart(const struct search *s, struct placed *all, bool *marked)
{
	const struct eco_ground_tile *tiles = s->scene->ground;
	for (uint32_t i = 0; i < s->done_count; i++) {
		const struct eco_ground_tile *t = &tiles[s->done[i]];
		all[i] = (struct placed){ key_of(t->level, t->column, t->row), i };
	}
	qsort(all, s->done_count, sizeof *all, by_key);
	for (uint32_t i = 0; i < s->done_count; i++)
		for (int side = 0; side < SIDES; side++) {
			const struct eco_ground_tile *t = &tiles[s->done[i]];
			const struct placed *other = coarser_beyond(all, s->done_count, t, side);
			const struct eco_ground_tile *coarse = other ? &tiles[s->done[other->tile]] : t;
			if (coarse->level - t->level > (int)ECO_GROUND_APART_MAX && coarse->child_count)
				marked[other->tile] = true;
		}
}

/* Puts children in the place of marked tiles; returns how many were marked. */
static uint32_t split_marked(struct search *s, const bool *marked, uint32_t *next)
{
	uint32_t count = 0, split = 0;
	for (uint32_t i = 0; i < s->done_count; i++) {
		const struct eco_ground_tile *t = &s->scene->ground[s->done[i]];
		if (!marked[i])
			next[count++] = s->done[i];
		for (uint32_t child = 0; marked[i] && child < t->child_count; child++)
			if (is_seen(s, t->child_first + child))
				next[count++] = t->child_first + child;
		split += marked[i];
	}
	free(s->done);
	s->done = next;
	s->done_count = count;
	return split;
}

/* Splits tiles until none touches one that is too much finer: the two would share no samples between a
 * tile's corners, and there would be gaps. Small grids never get there. False without memory. */
static bool bring_together(struct search *s)
{
	bool good = true, again = s->scene->ground[0].level > ECO_GROUND_APART_MAX + 1;
	while (good && again) {
		size_t count = (size_t)s->done_count + 1;
		struct placed *all = malloc(count * sizeof *all);
		bool *marked = calloc(count, sizeof *marked);
		uint32_t *next = malloc(4 * count * sizeof *next);
		good = all && marked && next;
		if (good) {
			mark_far_apart(s, all, marked);
			again = split_marked(s, marked, next) > 0;
		} else {
			free(next);
		}
		free(all);
		free(marked);
	}
	return good;
}

ECO_ORDER(by_number, uint32_t, [0])

enum eco_code lod_ground_select(struct lod_ground_choice *choice, const struct eco_scene *scene,
	const struct lod_eye *eye, const struct lod_ground_limits *limits, struct eco_error *error)
{
	struct search s = { .scene = scene, .eye = eye, .most = limits->tiles_max > 0 ? limits->tiles_max
		: LOD_GROUND_TILES_MAX };
	*choice = (struct lod_ground_choice){ .tiles = NULL };
	if (scene->ground_count == 0)
		return ECO_OK;
	s.most = s.most < scene->ground_count + 3 ? s.most : scene->ground_count + 3;
	s.heap = malloc((s.most + 4) * sizeof *s.heap);
	s.done = malloc((s.most + 4) * sizeof *s.done);
	bool good = s.heap && s.done;
	if (good) {
		look_at(&s, 0);
		refine(&s, limits->tolerance_px);
		good = bring_together(&s);
	}
	free(s.heap);
	if (!good) {
		free(s.done);
		return eco_fail(error, ECO_NO_MEMORY, "planning: no memory for %u tiles of ground", s.most);
	}
	qsort(s.done, s.done_count, sizeof *s.done, by_number);
	*choice = (struct lod_ground_choice){ s.done, s.done_count, s.error_px };
	return ECO_OK;
}

/* ---- Seams ---- */

bool lod_ground_seams(struct lod_ground_seam *seams, const struct eco_ground_tile *tiles, uint32_t count)
{
	struct placed *all = malloc((count + (size_t)1) * sizeof *all);
	if (!all)
		return false;
	for (uint32_t i = 0; i < count; i++)
		all[i] = (struct placed){ key_of(tiles[i].level, tiles[i].column, tiles[i].row), i };
	qsort(all, count, sizeof *all, by_key);
	for (uint32_t i = 0; i < count; i++)
		for (int side = 0; side < SIDES; side++) {
			const struct placed *other = coarser_beyond(all, count, &tiles[i], side);
			seams[i].coarser[side] = other ? tiles[other->tile].level - tiles[i].level : 0;
		}
	free(all);
	return true;
}

/* The nearest multiple of 2^levels, of two the upper; all tiles share the last sample. */
static uint32_t snapped(uint32_t i, uint8_t levels, uint32_t inner)
{
	uint32_t at = (i + (1u << levels) / 2) >> levels << levels;
	return at < inner ? at : inner - 1;
}

void lod_ground_corner(uint32_t *c, uint32_t *r, const struct lod_ground_seam *seam,
	const struct eco_ground_span *x, const struct eco_ground_span *y)
{
	uint32_t column = *c, row = *r;
	if (column == 0)
		*r = snapped(*r, seam->coarser[LOD_GROUND_WEST], y->inner);
	if (column == x->inner - 1)
		*r = snapped(*r, seam->coarser[LOD_GROUND_EAST], y->inner);
	if (row == 0)
		*c = snapped(*c, seam->coarser[LOD_GROUND_SOUTH], x->inner);
	if (row == y->inner - 1)
		*c = snapped(*c, seam->coarser[LOD_GROUND_NORTH], x->inner);
}
