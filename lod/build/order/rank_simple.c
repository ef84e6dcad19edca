/* Candidates are halves of boxes turned step by step, of the leaf's own area, and subsets of its own corners.
 * The best is improved corner by corner, with smaller and smaller moves in the leaf's plane and out of it.
 * Pictures of 40 pixels decide, so cut-outs and bent leaves need no case of their own.
 *
 * A quad is nearer to a leaf of three triangles or more and costs twice as much; triangles save more
 * (lod/EXPERIMENTS.md, Simple leaves: quads or triangles). */
#include "lod/build/order/rank_state.h"

#include <string.h>

#include "lod/lanes.h"

#define PIXELS 40u
#define VIEWS 5u
#define AWAY 64.0                        /* radii: views that are nearly parallel */
#define REACH 1.5                        /* radii: half a picture, and the reach of corners */
#define TURNS 8u
#define MOVES 3u                         /* sizes of moves */

struct fit {
	struct lod_v3 center, u, v, n;
	double radius;
	struct lod_eye eyes[VIEWS];
	struct lod_footprint print;
	uint64_t leaf[VIEWS][PIXELS];
	uint32_t wrong;              /* of the best so far */
	float best[3][3];
};

/* ---- Views ---- */

static void set_frame(struct fit *fit, const struct lod_fan *leaf)
{
	struct lod_v3 first = lod_v3_of(leaf->corner[0]), normal = { 0, 0, 0 }, sum = { 0, 0, 0 };
	for (uint32_t i = 0; i < leaf->corners; i++)
		sum = lod_v3_add(sum, lod_v3_of(leaf->corner[i]));
	fit->center = lod_v3_scale(sum, 1.0 / leaf->corners);
	double far = 0;
	for (uint32_t i = 0; i < leaf->corners; i++) {
		struct lod_v3 p = lod_v3_of(leaf->corner[i]), from = lod_v3_sub(p, fit->center);
		if (i + 1 < leaf->corners)
			normal =
				lod_v3_add(normal,
				lod_v3_cross(lod_v3_sub(p, first),
				lod_v3_sub(lod_v3_of(leaf->corner[i + 1]), first)));
		if (lod_v3_length(from) > far) {
			far = lod_v3_length(from);
			fit->u = from;
		}
	}
	fit->radius = far;
	fit->u = lod_v3_unit(fit->u);
	fit->n = lod_v3_unit(lod_v3_sub(normal, lod_v3_scale(fit->u, lod_v3_dot(normal, fit->u))));
	if (!(lod_v3_length(fit->n) > 0.5)) {
		struct lod_v3 other = fabs(fit->u.z) < 0.9 ? (struct lod_v3){ 0, 0, 1 }
			: (struct lod_v3){ 1, 0, 0 };
		fit->n = lod_v3_unit(lod_v3_cross(fit->u, other));
	}
	fit->v = lod_v3_cross(fit->n, fit->u);
}

static struct lod_v3 in_frame(const struct fit *fit, double u, double v, double n)
{
	return lod_v3_add(lod_v3_scale(fit->u, u),
		lod_v3_add(lod_v3_scale(fit->v, v), lod_v3_scale(fit->n, n)));
}

static void place_eye(const struct fit *fit, struct lod_eye *eye, struct lod_v3 from)
{
	struct lod_v3 back = lod_v3_unit(from), right = lod_v3_unit(lod_v3_cross(fit->v, back)),
		up = lod_v3_cross(back, right);
	struct lod_v3 at = lod_v3_add(fit->center, lod_v3_scale(back, AWAY * fit->radius));
	*eye = (struct lod_eye){ .at = { at.x, at.y, at.z }, .right = { right.x, right.y, right.z },
		.up = { up.x, up.y, up.z },
		.forward = { -back.x, -back.y, -back.z }, .tan_x = REACH / AWAY, .tan_y = REACH / AWAY };
}

static void cover(struct fit *fit, const struct lod_fan *fan, uint32_t view, uint64_t rows[PIXELS])
{
	struct lod_fan_seen seen;
	memset(rows, 0, PIXELS * sizeof *rows);
	lod_fan_see(&seen, fan, &fit->eyes[view]);
	if (lod_fan_cover(&fit->print, &seen, 1, PIXELS))
		memcpy(rows + fit->print.y, fit->print.bits, fit->print.rows * sizeof *rows);
}

/* Pixels that only one of the two covers; stops early at the best's count. */
LOD_CLONES static uint32_t count_wrong(struct fit *fit, const float (*corner)[3])
{
	const struct lod_fan fan = { corner, NULL, 3, NULL };
	uint64_t rows[PIXELS];
	uint32_t wrong = 0;
	for (uint32_t view = 0; view < VIEWS && wrong < fit->wrong; view++) {
		cover(fit, &fan, view, rows);
		for (uint32_t y = 0; y < PIXELS; y++)
			wrong += lod_bits_of(rows[y] ^ fit->leaf[view][y]);
	}
	return wrong;
}

static bool try_corners(struct fit *fit, const float (*corner)[3])
{
	uint32_t wrong = count_wrong(fit, corner);
	if (wrong >= fit->wrong)
		return false;
	fit->wrong = wrong;
	memcpy(fit->best, corner, sizeof fit->best);
	return true;
}

/* ---- Starts ---- */

static void put(float to[3], const struct fit *fit, double u, double v)
{
	struct lod_v3 p = lod_v3_add(fit->center, in_frame(fit, u, v, 0));
	to[0] = (float)p.x, to[1] = (float)p.y, to[2] = (float)p.z;
}

/* Boxes around the opaque part, face on, shrunk to twice its area: half of a box is a triangle that points to
 * one of the sides. */
static void try_boxes(struct fit *fit)
{
	static const double cosine[TURNS] = { 1, 0.92387953, 0.70710678, 0.38268343, 0, -0.38268343,
		-0.70710678, -0.92387953 };
	double pixel = 2 * REACH * fit->radius / PIXELS;
	for (uint32_t turn = 0; turn < TURNS; turn++) {
		double c = cosine[turn], s = cosine[(turn + TURNS / 2) % TURNS] * (turn < TURNS / 2 ? -1 : 1),
			low[2] = { 9, 9 }, high[2] = { -9, -9 };
		uint32_t area = 0;
		s = -s;
		low[0] = low[1] = 1e9, high[0] = high[1] = -1e9;
		for (uint32_t y = 0; y < PIXELS; y++)
			for (uint32_t x = 0; x < PIXELS; x++) {
				if (!(fit->leaf[0][y] >> x & 1))
					continue;
				double right = x + 0.5 - PIXELS / 2.0, up = PIXELS / 2.0 - y - 0.5,
					at[2] = { right * c + up * s, up * c - right * s };
				for (int k = 0; k < 2; k++) {
					low[k] = fmin(low[k], at[k] - 0.5);
					high[k] = fmax(high[k], at[k] + 0.5);
				}
				area++;
			}
		if (!area)
			return;
		double middle[2] = { (low[0] + high[0]) / 2, (low[1] + high[1]) / 2 },
			wide = high[0] - low[0], tall = high[1] - low[1];
		double in = sqrt(2 * area / (wide * tall));
		for (uint32_t way = 0; way < 4; way++) {
			static const double wedge[4][3][2] = { { { -1, -1 }, { 1, -1 }, { 0, 1 } },
				{ { -1, -1 }, { 1, 0 }, { -1, 1 } },
				{ { 0, -1 }, { 1, 1 }, { -1, 1 } }, { { -1, 0 }, { 1, -1 }, { 1, 1 } } };
			float corner[3][3];
			for (uint32_t k = 0; k < 3; k++) {
				double a = middle[0] + wedge[way][k][0] * wide / 2 * in,
					b = middle[1] + wedge[way][k][1] * tall / 2 * in;
				put(corner[k], fit, (a * c - b * s) * pixel, (a * s + b * c) * pixel);
			}
			try_corners(fit, (const float (*)[3])corner);
		}
	}
}

/* Triangles of the leaf's own corners. */
static void try_own(struct fit *fit, const struct lod_fan *leaf)
{
	for (uint32_t set = 0; set < 1u << leaf->corners; set++) {
		float corner[3][3];
		uint32_t count = 0;
		if (__builtin_popcount(set) != 3)
			continue;
		for (uint32_t i = 0; i < leaf->corners; i++)
			if (set >> i & 1)
				memcpy(corner[count++], leaf->corner[i], sizeof corner[0]);
		try_corners(fit, (const float (*)[3])corner);
	}
}

/* ---- Improvement ---- */

static bool move_corner(struct fit *fit, uint32_t k, struct lod_v3 by)
{
	float corner[3][3];
	memcpy(corner, fit->best, sizeof corner);
	struct lod_v3 to = lod_v3_add(lod_v3_of(corner[k]), by);
	if (lod_v3_distance(to, fit->center) > REACH * fit->radius)
		return false;
	corner[k][0] = (float)to.x, corner[k][1] = (float)to.y, corner[k][2] = (float)to.z;
	return try_corners(fit, (const float (*)[3])corner);
}

static void improve(struct fit *fit)
{
	static const double share[MOVES] = { 0.25, 0.12, 0.06 };
	for (uint32_t size = 0; size < MOVES; size++) {
		double step = share[size] * fit->radius;
		bool moved = true;
		for (uint32_t round = 0; round < 4 && moved; round++) {
			moved = false;
			for (uint32_t k = 0; k < 3; k++)
				for (int way = 0; way < 6; way++) {
					const double by = way % 2 ? -step : step;
					moved |=
						move_corner(fit, k,
						in_frame(fit, way / 2 == 0 ? by : 0, way / 2 == 1 ? by : 0,
						way / 2 == 2 ? by : 0));
				}
		}
	}
}

void lod_simple_fit(struct lod_simple *simple, const struct lod_fan *leaf)
{
	static const double aslant[VIEWS][2] = { { 0, 0 }, { 1, 0.4 }, { -0.4, 1 }, { -1, -0.4 },
		{ 0.4, -1 } };
	struct fit fit;
	*simple = (struct lod_simple){ .corners = 3 };
	memcpy(simple->corner, leaf->corner, sizeof simple->corner);
	fit.wrong = UINT32_MAX;
	memset(fit.best, 0, sizeof fit.best);
	set_frame(&fit, leaf);
	if (leaf->corners == 3 || !(fit.radius > 0))
		return;
	for (uint32_t view = 0; view < VIEWS; view++) {
		place_eye(&fit, &fit.eyes[view], in_frame(&fit, aslant[view][0], aslant[view][1], 1));
		cover(&fit, leaf, view, fit.leaf[view]);
	}
	try_own(&fit, leaf);
	try_boxes(&fit);
	improve(&fit);
	memcpy(simple->corner, fit.best, sizeof simple->corner);
}
