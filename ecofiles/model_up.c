/* The soup is sampled by points that stand for equal shares of its area, and the points are sorted into slices across an axis. Each
 * slice knows its area, its centre and how far it spreads around it; what follows from these is a handful of numbers per axis. The x
 * axis is horizontal either way: what the y and z axes are compared with when it comes to being round. */
#include "ecofiles/model_up.h"

#include <math.h>
#include <stddef.h>

#define SLICES 32
#define SPLIT_MOST 32                /* parts a triangle's side is cut into, each about half a slice long */
#define COORDINATE_MAX 1e9f

struct slice { double area, sum[2], square; };
struct profile { struct slice slice[SLICES]; struct slice all; double square[2]; };
struct box { double low[3], high[3], extent; };

/* What an axis looks like, from its lower end. */
enum trait {
	NARROW,                      /* spread of the lower quarter */
	HEAVY,                       /* share of the area in the lowest sixteenth */
	CENTRED,                     /* how far the lower end is off the centre of mass */
	ROUND,                       /* spread along the one direction across the axis and along the other */
	LOPSIDED,                    /* how much the two ends differ */
	TRAITS
};

static bool usable(const struct eco_model *m, uint32_t t, const float *p[3])
{
	for (int k = 0; k < 3; k++) {
		uint32_t v = m->index[3 * (size_t)t + k];
		if (v >= m->vertex_count)
			return false;
		p[k] = m->position + 3 * (size_t)v;
		for (int a = 0; a < 3; a++)
			if (!(fabsf(p[k][a]) <= COORDINATE_MAX))
				return false;
	}
	return true;
}

static struct box bound(const struct eco_model *m)
{
	struct box box = { { INFINITY, INFINITY, INFINITY }, { -INFINITY, -INFINITY, -INFINITY }, 0 };
	const float *p[3];
	for (uint32_t t = 0; t < m->triangle_count; t++) {
		if (!usable(m, t, p))
			continue;
		for (int k = 0; k < 3; k++)
			for (int a = 0; a < 3; a++) {
				box.low[a] = fmin(box.low[a], p[k][a]);
				box.high[a] = fmax(box.high[a], p[k][a]);
			}
	}
	for (int a = 0; a < 3; a++)
		box.extent = fmax(box.extent, box.high[a] - box.low[a]);
	return box;
}

static void add_point(struct profile *profile, const struct box *box, int axis, const double p[3], double area)
{
	int u = 0, v = 3 - axis;     /* x, and the other of y and z */
	double at = (p[axis] - box->low[axis]) / (box->high[axis] - box->low[axis]) * SLICES;
	int i = at > 0 ? (at < SLICES - 1 ? (int)at : SLICES - 1) : 0;
	double x = (p[u] - box->low[u]) / box->extent, y = (p[v] - box->low[v]) / box->extent;
	struct slice *to[2] = { &profile->slice[i], &profile->all };
	for (int k = 0; k < 2; k++) {
		to[k]->area += area;
		to[k]->sum[0] += area * x;
		to[k]->sum[1] += area * y;
		to[k]->square += area * (x * x + y * y);
	}
	profile->square[0] += area * x * x;
	profile->square[1] += area * y * y;
}

/* Cuts the triangle into n * n congruent ones and adds their centres. */
static void add_triangle(struct profile profile[3], const struct box *box, const float *p[3])
{
	double u[3], v[3], n[3], longest = 0;
	for (int a = 0; a < 3; a++) {
		u[a] = (double)p[1][a] - p[0][a];
		v[a] = (double)p[2][a] - p[0][a];
		longest = fmax(longest, fmax(fabs(u[a]), fmax(fabs(v[a]), fabs(u[a] - v[a]))));
	}
	for (int a = 0; a < 3; a++)
		n[a] = u[(a + 1) % 3] * v[(a + 2) % 3] - u[(a + 2) % 3] * v[(a + 1) % 3];
	double area = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]), parts = longest / box->extent * 2 * SLICES + 1;
	int cuts = parts < SPLIT_MOST ? (int)parts : SPLIT_MOST;
	for (int i = 0; i < cuts; i++)
		for (int j = 0; i + j < cuts; j++)
			for (int flip = 0; flip < (i + j < cuts - 1 ? 2 : 1); flip++) {
				double b = (i + (1 + flip) / 3.0) / cuts, c = (j + (1 + flip) / 3.0) / cuts, at[3];
				for (int a = 0; a < 3; a++)
					at[a] = p[0][a] + b * u[a] + c * v[a];
				for (int axis = 1; axis < 3; axis++)
					add_point(&profile[axis], box, axis, at, area / ((double)cuts * cuts));
			}
}

static double spread(const struct slice *s)
{
	if (!(s->area > 0))
		return 0;
	double x = s->sum[0] / s->area, y = s->sum[1] / s->area, square = s->square / s->area - x * x - y * y;
	return square > 0 ? sqrt(square) : 0;
}

static double offset(const struct slice *s, const struct slice *all)
{
	if (!(s->area > 0))
		return 0;
	double x = s->sum[0] / s->area - all->sum[0] / all->area, y = s->sum[1] / s->area - all->sum[1] / all->area;
	return sqrt(x * x + y * y);
}

static void find_traits(const struct profile *p, double trait[TRAITS])
{
	double whole = spread(&p->all) + 1e-9, area = p->all.area;
	double x = p->all.sum[0] / area, y = p->all.sum[1] / area;
	double wide = p->square[0] / area - x * x + 1e-9, deep = p->square[1] / area - y * y + 1e-9;
	for (int i = 0; i < TRAITS; i++)
		trait[i] = 0;
	for (int i = 0; i < SLICES / 4; i++)
		trait[NARROW] += spread(&p->slice[i]) / whole / (SLICES / 4);
	for (int i = 0; i < SLICES / 16; i++)
		trait[HEAVY] += p->slice[i].area / area;
	for (int i = 0; i < SLICES / 8; i++)
		trait[CENTRED] += offset(&p->slice[i], &p->all) / whole / (SLICES / 8);
	trait[ROUND] = wide < deep ? wide / deep : deep / wide;
	for (int i = 0; i < SLICES / 2; i++) {
		const struct slice *low = &p->slice[i], *high = &p->slice[SLICES - 1 - i];
		trait[LOPSIDED] += fabs(low->area - high->area) / area + fabs(spread(low) - spread(high)) / whole / (SLICES / 2);
	}
}

/* How much more the second is than the first, from -1 to 1; `least` is what makes no difference. */
static double contrast(double first, double second, double least)
{
	return (second - first) / (first + second + least);
}

enum eco_up eco_model_find_up(const struct eco_model *soup, double *certainty)
{
	static const struct { double weight, least; } rule[TRAITS] = {
		[NARROW] = { -1.0, 0.1 }, [HEAVY] = { 0.8, 0.01 }, [CENTRED] = { -0.4, 0.2 }, [ROUND] = { 0.8, 0.1 }, [LOPSIDED] = { 0.6, 0.2 },
	};
	struct profile profile[3] = { { .all = { 0 } } };
	struct box box = bound(soup);
	double trait[3][TRAITS], sum = 0;
	const float *p[3];
	*certainty = 0;
	if (!(box.high[0] > box.low[0] && box.high[1] > box.low[1] && box.high[2] > box.low[2]))
		return ECO_UP_Y;
	for (uint32_t t = 0; t < soup->triangle_count; t++)
		if (usable(soup, t, p))
			add_triangle(profile, &box, p);
	if (!(profile[1].all.area > 0))
		return ECO_UP_Y;
	for (int axis = 1; axis < 3; axis++)
		find_traits(&profile[axis], trait[axis]);
	for (int i = 0; i < TRAITS; i++)
		sum += rule[i].weight * contrast(trait[1][i], trait[2][i], rule[i].least);
	*certainty = fmin(fabs(sum), 1);
	return sum > 0 ? ECO_UP_Z : ECO_UP_Y;
}
