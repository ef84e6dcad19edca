#include "ecofiles/base/geometry.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

/* ---- Polygons ---- */

/* Ear clipping in the coordinate plane in which the polygon is largest (Newell's normal). An ear is a
 * convex corner whose closed triangle holds no other corner, except at the triangle's own three places.
 * The triangle must be closed: if a corner lies on the cut edge, the next cut runs outside the polygon,
 * which is where simpler clippers fail. Polygons of models have four to some thirty corners, so the cubic
 * worst case does not matter; very large ones become fans. */

#define CLIPPED_MAX 512u

struct flat { const double *corners; int x, y; double sign; };

/* Drops the axis along which the normal is longest; `sign` makes the polygon run counter-clockwise. */
static struct flat flatten(const double *corners, uint32_t n)
{
	double normal[3] = { 0, 0, 0 };
	int axis = 0;
	for (uint32_t i = 0; i < n; i++) {
		const double *a = &corners[i * 3], *b = &corners[(i + 1) % n * 3];
		for (int k = 0; k < 3; k++) {
			int u = (k + 1) % 3, v = (k + 2) % 3;
			normal[k] += (a[u] - b[u]) * (a[v] + b[v]);
		}
	}
	for (int k = 1; k < 3; k++)
		if (fabs(normal[k]) > fabs(normal[axis]))
			axis = k;
	return (struct flat){ corners, (axis + 1) % 3, (axis + 2) % 3, normal[axis] < 0 ? -1 : 1 };
}

/* Twice the area of a triangle, positive when it runs like the polygon. */
static double turn(const struct flat *f, uint32_t a, uint32_t b, uint32_t c)
{
	const double *p = &f->corners[a * 3], *q = &f->corners[b * 3], *r = &f->corners[c * 3];
	return f->sign * ((q[f->x] - p[f->x]) * (r[f->y] - p[f->y])
		- (q[f->y] - p[f->y]) * (r[f->x] - p[f->x]));
}

static bool same_place(const struct flat *f, uint32_t a, uint32_t b)
{
	return f->corners[a * 3 + (uint32_t)f->x] == f->corners[b * 3 + (uint32_t)f->x]
		&& f->corners[a * 3 + (uint32_t)f->y] == f->corners[b * 3 + (uint32_t)f->y];
}

static bool is_ear(const struct flat *f, const uint32_t *ring, uint32_t n, uint32_t at)
{
	uint32_t a = ring[(at + n - 1) % n], b = ring[at], c = ring[(at + 1) % n];
	if (!(turn(f, a, b, c) > 0))
		return false;
	for (uint32_t i = 0; i < n; i++) {
		uint32_t p = ring[i];
		if (p == a || p == b || p == c || same_place(f, p, a) || same_place(f, p, b)
				|| same_place(f, p, c))
			continue;
		if (turn(f, a, b, p) >= 0 && turn(f, b, c, p) >= 0 && turn(f, c, a, p) >= 0)
			return false;
	}
	return true;
}

/* The next corner to cut off: the first ear; without an ear, the corner with the smallest triangle, which
 * does least harm. */
static uint32_t choose(const struct flat *f, const uint32_t *ring, uint32_t n, uint32_t from)
{
	uint32_t best = 0;
	double least = INFINITY;
	for (uint32_t i = 0; i < n; i++)
		if (is_ear(f, ring, n, (from + i) % n))
			return (from + i) % n;
	for (uint32_t i = 0; i < n; i++) {
		double size = fabs(turn(f, ring[(i + n - 1) % n], ring[i], ring[(i + 1) % n]));
		if (size < least) {
			least = size;
			best = i;
		}
	}
	return best;
}

static void emit(uint32_t **to, uint32_t a, uint32_t b, uint32_t c)
{
	(*to)[0] = a;
	(*to)[1] = b;
	(*to)[2] = c;
	*to += 3;
}

void eco_polygon_split(const double *corners, uint32_t n, uint32_t *scratch, uint32_t *triangles)
{
	uint32_t from = 1;
	if (n == 3 || n > CLIPPED_MAX) {
		for (uint32_t i = 2; i < n; i++)
			emit(&triangles, 0, i - 1, i);
		return;
	}
	struct flat f = flatten(corners, n);
	for (uint32_t i = 0; i < n; i++)
		scratch[i] = i;
	while (n > 3) {
		uint32_t at = choose(&f, scratch, n, from % n);
		emit(&triangles, scratch[(at + n - 1) % n], scratch[at], scratch[(at + 1) % n]);
		n--;
		for (uint32_t i = at; i < n; i++)
			scratch[i] = scratch[i + 1];
		from = at;
	}
	emit(&triangles, scratch[0], scratch[1], scratch[2]);
}

/* ---- Clusters ---- */

static int compare_cells(const double a[2], const double b[2], double side)
{
	for (int k = 0; k < 2; k++) {
		double cell_a = floor(a[k] / side), cell_b = floor(b[k] / side);
		if (cell_a != cell_b)
			return cell_a < cell_b ? -1 : 1;
	}
	return 0;
}

static int by_cell(const void *a, const void *b, void *side)
{
	return compare_cells(a, b, *(const double *)side);
}

uint32_t eco_clusters_find(double (*points)[2], uint32_t count, double side, struct eco_cluster *out)
{
	uint32_t crowds = 0;
	qsort_r(points, count, sizeof *points, by_cell, &side);
	for (uint32_t i = 0, end; i < count; i = end) {
		struct eco_cluster *crowd = &out[crowds++];
		*crowd = (struct eco_cluster){ .count = 0 };
		for (end = i; end < count && compare_cells(points[i], points[end], side) == 0; end++) {
			crowd->count++;
			for (int k = 0; k < 2; k++)
				crowd->middle[k] += (points[end][k] - crowd->middle[k]) / crowd->count;
		}
	}
	return crowds;
}

const struct eco_cluster *eco_cluster_near(const struct eco_cluster *crowds, uint32_t count, const double at[2])
{
	const struct eco_cluster *nearest = NULL;
	uint32_t most = 0;
	double least = INFINITY;
	for (uint32_t i = 0; i < count; i++)
		most = crowds[i].count > most ? crowds[i].count : most;
	for (uint32_t i = 0; i < count; i++) {
		double away = hypot(crowds[i].middle[0] - at[0], crowds[i].middle[1] - at[1]);
		if (crowds[i].count >= most - most / 2 && away < least) {
			least = away;
			nearest = &crowds[i];
		}
	}
	return nearest;
}
