/* Walls in one plane: of two buildings that share a stretch of wall, the higher one draws it, as both would flicker, and one of a
 * party wall is never seen. A building that stands on the footprint of another, as high, is the same building. */
#include "ecofiles/generate/buildings.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/memory.h"
#include "ecofiles/base/order.h"

#define NEAR_M 0.002           /* of the other's line, both ends of a wall lie */
#define LEAST_M 0.01           /* shorter stretches stay as they are */
#define BELOW_M 0.05           /* a flat roof in the plane of another is moved down */
#define PITCH_MOST 2.0         /* a pitched roof at most doubles the height of the eaves (buildings.c) */
#define LOOKS_MAX 1000000000u  /* pairs of walls, or of corners, that are looked at: what is left flickers */
#define COVERS_MAX 1024u       /* of a building; the other walls flicker */

struct wall { double a[2], b[2], low[2], high[2]; uint32_t building; bool first; };
struct sweep { struct eco_building *const *buildings; struct wall *walls; uint32_t count; uint64_t looks; };

ECO_ORDER_TWO(by_west, struct wall, ->low[0], ->building)

static double least_top(const struct eco_building *b)
{
	return b->base_m + b->height_m / (b->roof == ECO_ROOF_FLAT || b->to_eaves ? 1 : PITCH_MOST);
}

static double most_top(const struct eco_building *b)
{
	return b->base_m + b->height_m * (b->roof == ECO_ROOF_FLAT || !b->to_eaves ? 1 : PITCH_MOST);
}

/* By the even-odd rule. */
static bool holds(const struct eco_building *b, const double at[2])
{
	bool in = false;
	for (uint32_t i = 0; i < b->edge_count; i++) {
		const struct eco_edge *e = &b->edges[i];
		if ((e->a[1] > at[1]) != (e->b[1] > at[1]) &&
			at[0] < e->a[0] + (at[1] - e->a[1]) / (e->b[1] - e->a[1]) * (e->b[0] - e->a[0]))
			in = !in;
	}
	return in;
}

/* Ends of wall w along wall `on`, whose length is returned, in metres from its beginning; 0: not in its line. */
static double along(const struct wall *on, const struct wall *w, double at[2])
{
	double x = on->b[0] - on->a[0], y = on->b[1] - on->a[1], length = sqrt(x * x + y * y);
	if (!(length > LEAST_M))
		return 0;
	for (int k = 0; k < 2; k++) {
		const double *p = k ? w->b : w->a;
		double dx = p[0] - on->a[0], dy = p[1] - on->a[1];
		at[k] = (dx * x + dy * y) / length;
		if (fabs(dy * x - dx * y) > NEAR_M * length)
			return 0;
	}
	return length;
}

/* Building `of` draws no wall from `from` to `to` along w. */
static void add_cover(struct eco_building *of, const struct wall *w, double length, double from, double to)
{
	of->covers = eco_realloc(of->covers, of->cover_count + 1u, sizeof *of->covers);
	struct eco_edge *cover = &of->covers[of->cover_count++];
	for (int k = 0; k < 2; k++) {
		cover->a[k] = w->a[k] + (w->b[k] - w->a[k]) * from / length;
		cover->b[k] = w->a[k] + (w->b[k] - w->a[k]) * to / length;
	}
}

/* Whether both buildings lie on one side of a place on their walls. */
static bool one_side(const struct eco_building *const of[2], const struct wall *w, double length, double at)
{
	bool in[2][2];
	for (int side = 0; side < 2; side++) {
		double off = (side ? LEAST_M : -LEAST_M) / length, place[2] = { w->a[0] + (w->b[0] - w->a[0]) * at / length -
			off * (w->b[1] - w->a[1]), w->a[1] + (w->b[1] - w->a[1]) * at / length + off * (w->b[0] - w->a[0]) };
		for (int i = 0; i < 2; i++)
			in[i][side] = holds(of[i], place);
	}
	return in[0][0] == in[1][0] && in[0][1] == in[1][1];
}

/* The building that draws what both walls have: 0, 1, or 2: none hides the other. */
static int upper(const struct eco_building *const of[2], bool first)
{
	for (int k = 0; k < 2; k++) {
		int i = first ? k : 1 - k;
		if (least_top(of[i]) >= most_top(of[1 - i]) && of[i]->base_m - ECO_BUILDING_SINK_M <= of[1 - i]->base_m)
			return i;
	}
	return 2;
}

static bool same_corners(const struct eco_building *a, const struct eco_building *b)
{
	uint32_t same = 0;
	for (uint32_t i = 0; i < a->edge_count && a->edge_count == b->edge_count && same == i; i++)
		for (uint32_t k = 0; k < b->edge_count && same == i; k++)
			same += fabs(a->edges[i].a[0] - b->edges[k].a[0]) < NEAR_M && fabs(a->edges[i].a[1] - b->edges[k].a[1]) < NEAR_M;
	return same == b->edge_count;
}

static void meet(struct sweep *s, const struct wall *p, const struct wall *q)
{
	double at[2] = { 0, 0 }, length = along(p, q, at), from = fmax(fmin(at[0], at[1]), 0), to = fmin(fmax(at[0], at[1]), length);
	struct eco_building *pair[2] = { s->buildings[p->building], s->buildings[q->building] };
	const struct eco_building *const seen[2] = { pair[0], pair[1] };
	if (!(length > 0) || !(to - from > LEAST_M) || pair[0] == pair[1])
		return;
	int above = upper(seen, p->building < q->building);
	if (above == 2)
		return;
	struct eco_building *under = pair[1 - above];
	if (under->twin)
		return;
	if (under->cover_count < COVERS_MAX)
		add_cover(under, p, length, from, to);
	bool level = least_top(pair[above]) == most_top(under), corner = (above ? p : q)->first;
	s->looks += level ? 4 * ((uint64_t)pair[0]->edge_count + pair[1]->edge_count) : 0;
	if (level && one_side(seen, p, length, (from + to) / 2)) {
		s->looks += corner ? (uint64_t)pair[0]->edge_count * pair[1]->edge_count : 0;
		under->level = true;
		under->twin = corner && same_corners(seen[0], seen[1]);
	}
}

void eco_buildings_cover(struct eco_building *const *buildings, uint32_t count)
{
	struct sweep s = { .buildings = buildings };
	uint64_t walls = 0;
	for (uint32_t i = 0; i < count; i++)
		walls += buildings[i]->edge_count;
	s.walls = eco_alloc(walls + 1, sizeof *s.walls);
	for (uint32_t i = 0; i < count; i++)
		for (uint32_t e = 0; e < buildings[i]->edge_count; e++) {
			struct wall *w = &s.walls[s.count++];
			memcpy(w->a, buildings[i]->edges[e].a, sizeof w->a);
			memcpy(w->b, buildings[i]->edges[e].b, sizeof w->b);
			w->building = i;
			w->first = e == 0;
			for (int k = 0; k < 2; k++) {
				w->low[k] = fmin(w->a[k], w->b[k]) - NEAR_M;
				w->high[k] = fmax(w->a[k], w->b[k]) + NEAR_M;
			}
		}
	qsort(s.walls, s.count, sizeof *s.walls, by_west);
	for (uint32_t i = 0; i < s.count; i++)
		for (uint32_t k = i + 1; k < s.count && s.walls[k].low[0] <= s.walls[i].high[0] && s.looks < LOOKS_MAX; k++, s.looks++)
			if (s.walls[k].low[1] <= s.walls[i].high[1] && s.walls[i].low[1] <= s.walls[k].high[1])
				meet(&s, &s.walls[i], &s.walls[k]);
	for (uint32_t i = 0; i < count; i++) {
		struct eco_building *b = buildings[i];
		b->height_m -= b->level && b->roof == ECO_ROOF_FLAT && b->height_m > 2 * BELOW_M ? BELOW_M : 0;
	}
	free(s.walls);
}
