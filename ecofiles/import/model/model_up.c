/* The soup is sampled by points of equal area, which are sorted into slices across an axis. Area, centre
 * and spread of the slices give a handful of numbers per axis. The x axis is horizontal either way, so y
 * and z are compared with it to find how round the plant is. Weights and
 * limits: lod/EXPERIMENTS.md, Up axis by shape. */
#include "ecofiles/base/memory.h"
#include "ecofiles/import/model/model_clean.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>

#define SLICES 32
#define SPLIT_MOST 32                /* most parts of a triangle's side, each about half a slice long */
#define STEM_WIDTH 0.35              /* of the whole's spread */
#define STEM_AREA 0.002              /* of a slice's mean area: least area of a stem */
#define LARGE 0.3                    /* of the diagonal: stems, boughs, pots */
#define LARGE_LEAST 0.003            /* of the area: large parts below this or above LARGE_MOST do not tell */
#define LARGE_MOST 0.97
#define FLAT 0.002                   /* of the extent: a thinner model is a card, and tells nothing */
#define CLEAR 1.3                    /* a sum of contrasts without doubt; the largest wrong one is 0.43 */
#define AT_ZERO 0.03                 /* of the extent */
#define TRIANGLES 24                 /* fewer (one blade of grass, two crossed cards) tell less */
#define PLACED 0.25                  /* weight of the file's zero at the lower end of one axis only */
#define FLOOR 2.0                    /* weight of parts that begin at one level along one axis only */
#define FLOOR_PARTS 8                /* a crown and a trunk side by side say nothing */
#define FLOOR_LEAST 0.9              /* of all parts; along the other axis FLOOR_OTHER at most */
#define FLOOR_OTHER 0.5

struct slice { double area, sum[2], square; };
struct profile { struct slice slice[SLICES]; struct slice all; double square[2]; };
struct box { struct eco_bounds of; double extent; };

/* Properties of an axis, from its lower end. */
enum trait {
	NARROW,                      /* spread of the lower quarter */
	HEAVY,                       /* share of the area in the lowest sixteenth */
	CENTRED,                     /* distance of the lower end from the centre of mass */
	ROUND,                       /* spreads along the two directions across the axis */
	LOPSIDED,                    /* difference between the two ends */
	STEM,                        /* how far up it stays narrow */
	TRAITS
};

static bool usable(const struct eco_model *m, uint32_t t, const float *p[3])
{
	bool good = eco_triangle_usable(m, t);
	for (int k = 0; k < 3 && good; k++)
		p[k] = m->position + 3 * (size_t)m->index[3 * (size_t)t + (size_t)k];
	return good;
}

/* Box of the triangles that `wanted` marks; NULL: of all. */
static struct box bound(const struct eco_model *m, const bool *wanted)
{
	struct box box = { .of = ECO_NO_BOUNDS };
	const float *p[3];
	for (uint32_t t = 0; t < m->triangle_count; t++)
		for (int k = 0; k < 3 && (!wanted || wanted[t]) && usable(m, t, p); k++)
			eco_bounds_add(&box.of, (const double[3]){ (double)p[k][0], (double)p[k][1],
				(double)p[k][2] });
	for (int a = 0; a < 3; a++)
		box.extent = fmax(box.extent, box.of.high[a] - box.of.low[a]);
	return box;
}

static void add_point(struct profile *profile, const struct box *box, int axis, const double p[3],
	double area)
{
	int u = 0, v = 3 - axis;     /* x, and the other of y and z */
	double at = (p[axis] - box->of.low[axis]) / (box->of.high[axis] - box->of.low[axis]) * SLICES;
	int i = at > 0 ? (at < SLICES - 1 ? (int)at : SLICES - 1) : 0;
	double x = (p[u] - box->of.low[u]) / box->extent, y = (p[v] - box->of.low[v]) / box->extent;
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
static void add_triangle(struct profile profile[3], const struct box *box, const float *p[3], double area)
{
	double u[3], v[3], longest = 0;
	for (int a = 0; a < 3; a++) {
		u[a] = (double)p[1][a] - p[0][a];
		v[a] = (double)p[2][a] - p[0][a];
		longest = fmax(longest, fmax(fabs(u[a]), fmax(fabs(v[a]), fabs(u[a] - v[a]))));
	}
	double parts = longest / box->extent * 2 * SLICES + 1;
	int cuts = parts < SPLIT_MOST ? (int)parts : SPLIT_MOST;
	for (int i = 0; i < cuts; i++)
		for (int j = 0; i + j < cuts; j++)
			for (int flip = 0; flip < (i + j < cuts - 1 ? 2 : 1); flip++) {
				double b = (i + (1 + flip) / 3.0) / cuts, c = (j + (1 + flip) / 3.0) / cuts,
					at[3];
				for (int a = 0; a < 3; a++)
					at[a] = p[0][a] + b * u[a] + c * v[a];
				for (int axis = 1; axis < 3; axis++)
					add_point(&profile[axis], box, axis, at,
						area / ((double)cuts * cuts));
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
	double x = s->sum[0] / s->area - all->sum[0] / all->area,
		y = s->sum[1] / s->area - all->sum[1] / all->area;
	return sqrt(x * x + y * y);
}

static double stem_of(const struct profile *p, double whole)
{
	int i = 0;
	while (i < SLICES && p->slice[i].area * SLICES > STEM_AREA * p->all.area && spread(&p->slice[i])
			< STEM_WIDTH * whole)
		i++;
	return (double)i / SLICES;
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
		trait[LOPSIDED] += fabs(low->area - high->area) / area
			+ fabs(spread(low) - spread(high)) / whole / (SLICES / 2);
	}
	trait[STEM] = stem_of(p, whole);
}

/* The contrast of the second to the first, from -1 to 1; `least` makes no difference. */
static double contrast(double first, double second, double least)
{
	return (second - first) / (first + second + least);
}

struct rule { double weight, least; };

/* Sum of weighted contrasts between y and z, positive for z, over the triangles that `wanted` marks (NULL:
 * all). False: no volume. */
static bool compare(const struct eco_model *soup, const bool *wanted, const struct rule rule[TRAITS],
double *sum)
{
	struct box box = bound(soup, wanted);
	struct profile profile[3] = { { .all = { 0 } } };
	double trait[3][TRAITS];
	const float *p[3];
	for (int a = 0; a < 3; a++)
		if (!(box.of.high[a] - box.of.low[a] > FLAT * box.extent))
			return false;
	for (uint32_t t = 0; t < soup->triangle_count; t++)
		if ((!wanted || wanted[t]) && usable(soup, t, p))
			add_triangle(profile, &box, p, eco_triangle_area(soup, t));
	if (!(profile[1].all.area > 0))
		return false;
	for (int axis = 1; axis < 3; axis++)
		find_traits(&profile[axis], trait[axis]);
	for (int i = 0; i < TRAITS; i++)
		if (rule[i].weight != 0)
			*sum += rule[i].weight * contrast(trait[1][i], trait[2][i], rule[i].least);
	return true;
}

/* ---- Parts ---- */

/* Marks the triangles of large parts; false if these tell nothing. */
static bool mark_large(const struct eco_model *m, const struct box *box, const struct eco_components *parts,
	bool *large)
{
	double whole = 0, all = 0, some = 0;
	for (int a = 0; a < 3; a++)
		whole += (box->of.high[a] - box->of.low[a]) * (box->of.high[a] - box->of.low[a]);
	for (uint32_t t = 0; t < m->triangle_count; t++) {
		const struct eco_component *of = &parts->items[parts->of[t]];
		double size = 0, area = eco_triangle_usable(m, t) ? eco_triangle_area(m, t) : 0;
		for (int a = 0; a < 3; a++)
			size += (of->high[a] - of->low[a]) * (of->high[a] - of->low[a]);
		large[t] = size > LARGE * LARGE * whole;
		all += area;
		some += large[t] ? area : 0;
	}
	return some > LARGE_LEAST * all && some < LARGE_MOST * all;
}

/* Share of the parts that begin at the lower end of an axis; 0 of few parts. */
static double floor_share(const struct eco_model *m, const struct box *box,
	const struct eco_components *parts, int axis)
{
	double floor = box->of.low[axis] + AT_ZERO * (box->of.high[axis] - box->of.low[axis]);
	uint32_t all = 0, on = 0;
	for (uint32_t i = 0; i < parts->count; i++) {
		bool counts = eco_triangle_usable(m, parts->items[i].first);
		all += counts;
		on += counts && parts->items[i].low[axis] <= floor;
	}
	return all >= FLOOR_PARTS ? (double)on / all : 0;
}

/* Tufts of a patch and trees of a row stand on one floor: 1 if along z alone, -1 along y alone. */
static double floors(const struct eco_model *m, const struct box *box, const struct eco_components *parts)
{
	double y = floor_share(m, box, parts, 1), z = floor_share(m, box, parts, 2);
	return z >= FLOOR_LEAST && y <= FLOOR_OTHER ? 1 : y >= FLOOR_LEAST && z <= FLOOR_OTHER ? -1 : 0;
}

static void ask_parts(struct eco_model *soup, const struct box *box, double *sum)
{
	static const struct rule rule[TRAITS] = { [NARROW] = { -0.2, 0.1 }, [HEAVY] = { 0.7, 0.02 },
		[CENTRED] = { -0.5, 0.2 }, [ROUND] = { 0.2, 0.4 } };
	struct eco_components parts;
	uint32_t *place = eco_alloc((size_t)soup->vertex_count + 1, sizeof *place);
	bool *large = eco_alloc((size_t)soup->triangle_count + 1, sizeof *large);
	eco_model_places(soup, place);
	eco_components_find(&parts, soup, place, soup->material != NULL);
	*sum += FLOOR * floors(soup, box, &parts);
	if (mark_large(soup, box, &parts, large))
		compare(soup, large, rule, sum);
	eco_components_free(&parts);
	free(place);
	free(large);
}

/* ---- All ---- */

/* 1 if the file's zero is at the lower end of z but of neither y nor x; -1: of y but of neither z nor x. */
static double placed(const struct box *box)
{
	bool zero[3];
	for (int a = 0; a < 3; a++)
		zero[a] = fabs(box->of.low[a]) < AT_ZERO * box->extent;
	return zero[0] || zero[1] == zero[2] ? 0 : zero[2] ? 1 : -1;
}

enum eco_up eco_model_find_up(struct eco_model *soup, double *certainty)
{
	static const struct rule rule[TRAITS] = { [NARROW] = { -1.0, 0.1 }, [HEAVY] = { 0.8, 0.01 },
		[CENTRED] = { -0.4, 0.2 }, [ROUND] = { 0.7, 0.4 }, [LOPSIDED] = { 0.6, 0.2 },
		[STEM] = { 0.4, 0.1 } };
	struct box box = bound(soup, NULL);
	double sum = 0;
	*certainty = 0;
	if (!compare(soup, NULL, rule, &sum))
		return ECO_UP_Y;
	ask_parts(soup, &box, &sum);
	sum += PLACED * placed(&box);
	*certainty = fmin(fabs(sum) / CLEAR, 1) * fmin((double)soup->triangle_count / TRIANGLES, 1);
	return sum > 0 ? ECO_UP_Z : ECO_UP_Y;
}
