/* Rings of a footprint to convex pieces. A ring that crosses itself is cut in two at the crossing, until none does. Holes are
 * joined to the ring around them by a bridge, and what results is cut into triangles ear by ear (Meisters 1975; Eberly 2002). */
#include "ecofiles/generate/building_rings.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/memory.h"

static int64_t cross(struct gen_corner a, struct gen_corner b, struct gen_corner c)
{
	return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

static bool same(struct gen_corner a, struct gen_corner b)
{
	return a.x == b.x && a.y == b.y;
}

static int sign_of(int64_t v)
{
	return (v > 0) - (v < 0);
}

/* ---- Rings ---- */

/* Drops corners that repeat the one before, lie on the line between their neighbours, or end a spike. */
static void clean(struct gen_ring *r)
{
	for (uint32_t i = 0, good = 0; r->count > 2 && good < r->count;) {
		struct gen_corner before = r->corners[(i + r->count - 1) % r->count],
				  after = r->corners[(i + 1) % r->count];
		if (cross(before, r->corners[i], after) != 0) {
			i = (i + 1) % r->count;
			good++;
			continue;
		}
		memmove(&r->corners[i], &r->corners[i + 1], (r->count - i - 1) * sizeof *r->corners);
		r->count--;
		i = (i + r->count - 1) % r->count;
		good = 0;
	}
	r->count = r->count > 2 ? r->count : 0;
}

/* Whether the edges ab and cd cross or touch, and where. */
static bool meet(struct gen_corner a, struct gen_corner b, struct gen_corner c, struct gen_corner d,
	struct gen_corner *at)
{
	int64_t c_of = cross(a, b, c), d_of = cross(a, b, d), a_of = cross(c, d, a), b_of = cross(c, d, b);
	if (sign_of(c_of) * sign_of(d_of) > 0 || sign_of(a_of) * sign_of(b_of) > 0 ||
		(c_of == 0 && d_of == 0))
		return false;
	double t = (double)c_of / ((double)c_of - (double)d_of);
	*at = (struct gen_corner){ c.x + (int64_t)floor(t * (double)(d.x - c.x) + 0.5),
		c.y + (int64_t)floor(t * (double)(d.y - c.y) + 0.5) };
	return true;
}

static bool find_crossing(const struct gen_ring *r, uint32_t *first, uint32_t *second, struct gen_corner *at)
{
	for (uint32_t i = 0; i + 2 < r->count; i++)
		for (uint32_t j = i + 2; j < r->count; j++) {
			if (i == 0 && j + 1 == r->count)
				continue;
			*first = i;
			*second = j;
			if (meet(r->corners[i], r->corners[i + 1], r->corners[j],
				    r->corners[(j + 1) % r->count], at))
				return true;
		}
	return false;
}

/* Cuts the last ring where it crosses itself; the parts are the last rings then. False: too many. */
static bool cut_crossings(struct gen_rings *b)
{
	for (uint32_t k = b->count - 1; k < b->count; k++) {
		uint32_t i, j;
		struct gen_corner at;
		struct gen_ring *r = &b->items[k];
		clean(r);
		while (find_crossing(r, &i, &j, &at)) {
			if (b->count == GEN_RINGS_MAX)
				return false;
			struct gen_ring *loop = &b->items[b->count++];
			*loop = (struct gen_ring){ .corners = eco_alloc(j - i + 1u, sizeof at),
				.count = j - i + 1 };
			memcpy(loop->corners, &r->corners[i + 1], (j - i) * sizeof at);
			loop->corners[j - i] = at;
			r->corners[i + 1] = at;
			memmove(&r->corners[i + 2], &r->corners[j + 1], (r->count - j - 1) * sizeof at);
			r->count -= j - i - 1;
			b->crossed = true;
			clean(r);
		}
	}
	return true;
}

static int64_t twice_area(const struct gen_ring *r)
{
	int64_t sum = 0;
	for (uint32_t i = 1; i + 1 < r->count; i++)
		sum += cross(r->corners[0], r->corners[i], r->corners[i + 1]);
	return sum;
}

/* The side of a place: 1 inside a ring, -1 outside, 0 on it. Coordinates of the ring are doubled. */
static int side_of(const struct gen_ring *r, struct gen_corner p)
{
	int inside = -1;
	for (uint32_t i = 0; i < r->count; i++) {
		struct gen_corner a = r->corners[i], c = r->corners[(i + 1) % r->count];
		a = (struct gen_corner){ 2 * a.x, 2 * a.y };
		c = (struct gen_corner){ 2 * c.x, 2 * c.y };
		int64_t left = cross(a, c, p);
		if (left == 0 && (a.x - p.x) * (c.x - p.x) + (a.y - p.y) * (c.y - p.y) <= 0)
			return 0;
		if ((a.y > p.y) != (c.y > p.y) && (left > 0) == (c.y > a.y))
			inside = -inside;
	}
	return inside;
}

/* Whether the other ring is inside, by the first middle of its edges that is not on this one, as parts may share walls. */
static bool is_around(const struct gen_ring *r, const struct gen_ring *other)
{
	int side = 0;
	for (uint32_t i = 0; i < other->count && side == 0; i++) {
		struct gen_corner a = other->corners[i], b = other->corners[(i + 1) % other->count];
		side = side_of(r, (struct gen_corner){ a.x + b.x, a.y + b.y });
	}
	return side > 0;
}

/* A ring within an odd number of others is a hole of the smallest of them. Surfaces run counter-clockwise, holes
 * clockwise. */
static void nest(struct gen_rings *b)
{
	for (uint32_t i = 0; i < b->count; i++) {
		struct gen_ring *r = &b->items[i];
		uint32_t depth = 0;
		int64_t least = INT64_MAX;
		for (uint32_t k = 0; k < b->count; k++) {
			int64_t area = llabs(twice_area(&b->items[k]));
			if (k == i || !is_around(&b->items[k], r))
				continue;
			depth++;
			if (area < least) {
				least = area;
				r->outer = k;
			}
		}
		r->hole = depth % 2;
		if ((twice_area(r) > 0) == r->hole)
			for (uint32_t k = 0; k < r->count / 2; k++) {
				struct gen_corner swap = r->corners[k];
				r->corners[k] = r->corners[r->count - 1 - k];
				r->corners[r->count - 1 - k] = swap;
			}
	}
}

bool gen_rings_take(struct gen_rings *b, const struct eco_edge *e, uint32_t edge_count)
{
	*b = (struct gen_rings){ .count = 0 };
	if (edge_count > ECO_BUILDING_CORNERS_MAX)
		return false;
	for (uint32_t first = 0, end; first < edge_count; first = end) {
		const double *start = e[first].a;
		for (end = first + 1;
			end < edge_count && (e[end - 1].b[0] != start[0] || e[end - 1].b[1] != start[1]);
			end++)
			;
		if (b->count == GEN_RINGS_MAX)
			return false;
		struct gen_ring *r = &b->items[b->count++];
		*r = (struct gen_ring){ .corners = eco_alloc(end - first + 1u, sizeof *r->corners),
			.count = end - first };
		for (uint32_t i = 0; i < r->count; i++) {
			double x = e[first + i].a[0] - e[0].a[0], y = e[first + i].a[1] - e[0].a[1];
			if (fabs(x) > ECO_BUILDING_WIDE_M || fabs(y) > ECO_BUILDING_WIDE_M)
				return false;
			r->corners[i] = (struct gen_corner){ (int64_t)floor(x * 1000 + 0.5),
				(int64_t)floor(y * 1000 + 0.5) };
		}
		if (!cut_crossings(b))
			return false;
	}
	uint32_t kept = 0;
	for (uint32_t i = 0; i < b->count; i++) {
		struct gen_ring r = b->items[i];
		if (r.count > 0)
			b->items[kept++] = r;
		else
			free(r.corners);
	}
	b->count = kept;
	nest(b);
	return true;
}

void gen_rings_free(struct gen_rings *b)
{
	for (uint32_t i = 0; i < b->count; i++)
		free(b->items[i].corners);
	b->count = 0;
}

/* ---- Triangles of a surface ---- */

/* Whether the way from corner i of a ring to p begins inside of it. */
static bool begins_inside(const struct gen_corner *c, uint32_t count, uint32_t i, struct gen_corner p)
{
	struct gen_corner before = c[(i + count - 1) % count], after = c[(i + 1) % count];
	bool left = cross(c[i], after, p) > 0, right = cross(before, c[i], p) > 0;
	return cross(before, c[i], after) > 0 ? left && right : left || right;
}

static bool crosses_ring(const struct gen_corner *c, uint32_t count, struct gen_corner a, struct gen_corner b)
{
	struct gen_corner at;
	for (uint32_t i = 0; i < count; i++) {
		struct gen_corner p = c[i], q = c[(i + 1) % count];
		if (same(p, a) || same(p, b) || same(q, a) || same(q, b))
			continue;
		if (meet(a, b, p, q, &at))
			return true;
	}
	return false;
}

static uint32_t rightmost(const struct gen_ring *r)
{
	uint32_t best = 0;
	for (uint32_t i = 1; i < r->count; i++)
		if (r->corners[i].x > r->corners[best].x ||
			(r->corners[i].x == r->corners[best].x && r->corners[i].y > r->corners[best].y))
			best = i;
	return best;
}

/* The corner of the surface that a bridge from the hole's rightmost corner goes to: the nearest in sight. */
static uint32_t bridge_to(const struct gen_rings *b, const struct gen_corner *c, uint32_t count,
	uint32_t outer, struct gen_corner from)
{
	double least = INFINITY;
	uint32_t best = 0;
	for (uint32_t i = 0; i < count; i++) {
		double x = (double)(c[i].x - from.x), y = (double)(c[i].y - from.y);
		if (x * x + y * y >= least || !begins_inside(c, count, i, from) ||
			crosses_ring(c, count, c[i], from))
			continue;
		bool clear = true;
		for (uint32_t k = 0; k < b->count && clear; k++)
			clear = !b->items[k].hole || b->items[k].outer != outer ||
				!crosses_ring(b->items[k].corners, b->items[k].count, c[i], from);
		if (clear) {
			least = x * x + y * y;
			best = i;
		}
	}
	return best;
}

struct gen_ring gen_rings_join(const struct gen_rings *b, uint32_t outer)
{
	struct gen_ring joined = { .count = b->items[outer].count };
	size_t all = 0;
	for (uint32_t k = 0; k < b->count; k++)
		all += b->items[k].count + 2;
	joined.corners = eco_alloc(all, sizeof *joined.corners);
	memcpy(joined.corners, b->items[outer].corners, joined.count * sizeof *joined.corners);
	for (uint32_t k = 0; k < b->count; k++) {
		const struct gen_ring *hole = &b->items[k];
		if (!hole->hole || hole->outer != outer)
			continue;
		uint32_t from = rightmost(hole),
			 to = bridge_to(b, joined.corners, joined.count, outer, hole->corners[from]);
		memmove(&joined.corners[to + hole->count + 2], &joined.corners[to],
			(joined.count - to) * sizeof *joined.corners);
		for (uint32_t i = 0; i <= hole->count; i++)
			joined.corners[to + 1 + i] = hole->corners[(from + i) % hole->count];
		joined.count += hole->count + 2;
	}
	return joined;
}

static bool is_in(struct gen_corner a, struct gen_corner b, struct gen_corner c, struct gen_corner p)
{
	return !same(p, a) && !same(p, b) && !same(p, c) && cross(a, b, p) >= 0 && cross(b, c, p) >= 0 &&
		cross(c, a, p) >= 0;
}

static bool is_ear(const struct gen_corner *c, const uint32_t *left, uint32_t count, uint32_t i)
{
	struct gen_corner before = c[left[(i + count - 1) % count]], at = c[left[i]],
			  after = c[left[(i + 1) % count]];
	if (cross(before, at, after) <= 0)
		return false;
	for (uint32_t k = 0; k < count; k++)
		if (is_in(before, at, after, c[left[k]]))
			return false;
	return true;
}

static bool is_convex(const struct gen_ring *r)
{
	for (uint32_t i = 0; i < r->count; i++)
		if (cross(r->corners[i], r->corners[(i + 1) % r->count], r->corners[(i + 2) % r->count]) <= 0)
			return false;
	return true;
}

/* A ring without an ear, as holes that cross it leave, loses its next corner all the same. */
void gen_ring_pieces(const struct gen_ring *r, gen_on_piece *on, void *ctx)
{
	if (is_convex(r)) {
		on(ctx, r->corners, r->count);
		return;
	}
	uint32_t *left = eco_alloc(r->count + 1u, sizeof *left), count = r->count;
	for (uint32_t i = 0; i < count; i++)
		left[i] = i;
	for (uint32_t i = 0, tried = 0; count > 2;) {
		i %= count;
		if (tried < count && !is_ear(r->corners, left, count, i)) {
			tried++;
			i++;
			continue;
		}
		struct gen_corner ear[3] = { r->corners[left[(i + count - 1) % count]], r->corners[left[i]],
			r->corners[left[(i + 1) % count]] };
		if (cross(ear[0], ear[1], ear[2]) > 0)
			on(ctx, ear, 3);
		memmove(&left[i], &left[i + 1], (count - i - 1) * sizeof *left);
		count--;
		tried = 0;
		i++; /* not a fan about one corner */
	}
	free(left);
}
