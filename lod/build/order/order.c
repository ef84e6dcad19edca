#include "lod/build/order/order.h"

#include <float.h>
#include <stdbool.h>
#include <string.h>

#include "ecofiles/format/model.h"
#include "lod/sort.h"

#define RADIUS 0.05              /* of the plant's height */
#define WIDEST 64.0              /* radii in the largest extent at most: flat covers are wide and low */
#define ISO 0.05

/* The hull of a plant: the density of its elements in space and the iso-surface around them (Neubert 2011, 3.1;
 * balls of Blinn 1982). The field is sampled on a grid of half its radius. It is smooth at that scale, so
 * interpolation is exact enough for its use as a probability, and one exact distance transform (Felzenszwalb
 * and Huttenlocher 2012) finds the nearest point of the iso-surface for all elements. The iso-value in the
 * paper, 0, is degenerate with the clamp (the gradient vanishes there); a small positive one replaces it. */
struct surface {
	struct lod_v3 low;
	double radius, cell;         /* of a ball; distance of nodes */
	uint32_t size[3];
	float *density;              /* at nodes, x fastest */
	uint32_t *surface;           /* per node: the nearest node of the iso-surface, or ECO_NONE */
};

static size_t node_at(const struct surface *h, uint32_t x, uint32_t y, uint32_t z)
{
	return ((size_t)z * h->size[1] + y) * h->size[0] + x;
}

static void place_grid(struct surface *h, const struct lod_v3 *center, uint32_t count, double height)
{
	double low[3], high[3], extent = 0;
	for (int a = 0; a < 3; a++) {
		low[a] = DBL_MAX;
		high[a] = -DBL_MAX;
		for (uint32_t i = 0; i < count; i++) {
			double p = lod_v3_axis(center[i], a);
			low[a] = p < low[a] ? p : low[a];
			high[a] = p > high[a] ? p : high[a];
		}
		extent = fmax(extent, high[a] - low[a]);
	}
	h->radius = fmax(RADIUS * height, extent / WIDEST);
	if (!(h->radius > 0))
		h->radius = 1;
	h->cell = h->radius / 2;
	double pad = h->radius + 2 * h->cell;
	h->low = (struct lod_v3){ low[0] - pad, low[1] - pad, low[2] - pad };
	for (int a = 0; a < 3; a++)
		h->size[a] = (uint32_t)((high[a] - low[a] + 2 * pad) / h->cell) + 2;
}

static void add_ball(struct surface *h, struct lod_v3 p)
{
	uint32_t first[3], last[3];
	for (int a = 0; a < 3; a++) {
		double at = (lod_v3_axis(p, a) - lod_v3_axis(h->low, a)) / h->cell;
		first[a] = (uint32_t)(at - 2) + 1;
		last[a] = (uint32_t)(at + 2);
	}
	double reach = 1 / (h->radius * h->radius);
	for (uint32_t z = first[2]; z <= last[2]; z++)
		for (uint32_t y = first[1]; y <= last[1]; y++)
			for (uint32_t x = first[0]; x <= last[0]; x++) {
				struct lod_v3 d =
					{ h->low.x + x * h->cell - p.x, h->low.y + y * h->cell - p.y,
						h->low.z + z * h->cell - p.z };
				double left = 1 - lod_v3_dot(d, d) * reach;
				if (left > 0)
					h->density[node_at(h, x, y, z)] += (float)(left * left);
			}
}

static bool on_surface(const struct surface *h, size_t node)
{
	size_t row = h->size[0], slice = row * h->size[1];
	const float *d = h->density + node;
	return *d >= ISO && (d[-1] < ISO || d[1] < ISO || *(d - row) < ISO || d[row] < ISO
		|| *(d - slice) < ISO || d[slice] < ISO);
}

/* ---- Distance transform with the nearest node, one axis after the other ---- */

struct envelope {
	uint32_t *site, *nearest;    /* parabolas of the lower envelope: their place on the line, their
	                              * nearest node */
	double *height, *from;
};

/* One line of `count` nodes, `stride` apart; distance[] holds the squared distances in cells so far. */
static void transform_line(float *distance, uint32_t *nearest, size_t stride, uint32_t count,
	const struct envelope *e)
{
	uint32_t k = 0;
	for (uint32_t q = 0; q < count; q++) {
		if (nearest[q * stride] == ECO_NONE)
			continue;
		double h = distance[q * stride], from = -DBL_MAX;
		while (k > 0) {
			double p = e->site[k - 1];
			from = (h + (double)q * q - e->height[k - 1] - p * p) / (2 * (q - p));
			if (from > e->from[k - 1])
				break;
			from = -DBL_MAX;
			k--;
		}
		e->site[k] = q;
		e->height[k] = h;
		e->nearest[k] = nearest[q * stride];
		e->from[k++] = from;
	}
	for (uint32_t q = 0, i = 0; q < count && k > 0; q++) {
		while (i + 1 < k && e->from[i + 1] <= q)
			i++;
		double d = (double)q - e->site[i];
		distance[q * stride] = (float)(d * d + e->height[i]);
		nearest[q * stride] = e->nearest[i];
	}
}

static void find_surface(struct surface *h, struct lod_arena *arena)
{
	size_t count = (size_t)h->size[0] * h->size[1] * h->size[2], longest = (size_t)h->size[0] + h->size[1]
		+ h->size[2];
	h->surface = lod_arena_take(arena, count, sizeof *h->surface);
	struct lod_arena_piece *mark = arena->last;
	float *distance = lod_arena_take(arena, count, sizeof *distance);
	struct envelope e = { lod_arena_take(arena, longest, sizeof *e.site),
		lod_arena_take(arena, longest, sizeof *e.nearest),
		lod_arena_take(arena, longest, sizeof *e.height),
		lod_arena_take(arena, longest, sizeof *e.from) };
	memset(h->surface, 0xff, count * sizeof *h->surface);
	for (uint32_t z = 1; z + 1 < h->size[2]; z++)
		for (uint32_t y = 1; y + 1 < h->size[1]; y++)
			for (uint32_t x = 1; x + 1 < h->size[0]; x++)
				if (on_surface(h, node_at(h, x, y, z)))
					h->surface[node_at(h, x, y, z)] = (uint32_t)node_at(h, x, y, z);
	size_t row = h->size[0], slice = row * h->size[1];
	for (size_t i = 0; i < (size_t)h->size[1] * h->size[2]; i++)
		transform_line(distance + i * row, h->surface + i * row, 1, h->size[0], &e);
	for (uint32_t z = 0; z < h->size[2]; z++)
		for (uint32_t x = 0; x < h->size[0]; x++)
			transform_line(distance + z * slice + x, h->surface + z * slice + x, row, h->size[1],
				&e);
	for (size_t i = 0; i < slice; i++)
		transform_line(distance + i, h->surface + i, slice, h->size[2], &e);
	lod_arena_release(arena, mark);
}

static void make_surface(struct surface *h, const struct lod_v3 *center, uint32_t count, double height,
	struct lod_arena *arena)
{
	place_grid(h, center, count, height);
	h->density = lod_arena_take(arena, (size_t)h->size[0] * h->size[1] * h->size[2], sizeof *h->density);
	for (uint32_t i = 0; i < count; i++)
		add_ball(h, center[i]);
	find_surface(h, arena);
}

/* Sum of the balls at a point within the bounds of the centres. */
static double density_at(const struct surface *h, struct lod_v3 p)
{
	uint32_t i[3];
	double t[3], sum = 0;
	for (int a = 0; a < 3; a++) {
		double at = (lod_v3_axis(p, a) - lod_v3_axis(h->low, a)) / h->cell;
		i[a] = (uint32_t)at;
		t[a] = at - i[a];
	}
	for (uint32_t k = 0; k < 8; k++) {
		double weight = (k & 1 ? t[0] : 1 - t[0]) * (k & 2 ? t[1] : 1 - t[1]) * (k & 4 ? t[2]
			: 1 - t[2]);
		sum += weight * h->density[node_at(h, i[0] + (k & 1), i[1] + (k >> 1 & 1), i[2] + (k >> 2))];
	}
	return sum;
}

static struct lod_v3 normal_at(const struct surface *h, size_t node)
{
	size_t row = h->size[0], slice = row * h->size[1];
	const float *d = h->density + node;
	return lod_v3_unit((struct lod_v3){ (double)d[-1] - d[1], (double)*(d - row) - d[row],
		(double)*(d - slice) - d[slice] });
}

/* Outward unit normal of the iso-surface at its point nearest to p; false if there is none. */
static bool surface_normal(const struct surface *h, struct lod_v3 p, struct lod_v3 *normal)
{
	uint32_t i[3];
	for (int a = 0; a < 3; a++)
		i[a] = (uint32_t)((lod_v3_axis(p, a) - lod_v3_axis(h->low, a)) / h->cell + 0.5);
	uint32_t s = h->surface[node_at(h, i[0], i[1], i[2])];
	if (s == ECO_NONE)
		return false;
	*normal = normal_at(h, s);
	return lod_v3_dot(*normal, *normal) > 0;
}

/* ---- Orders ---- */

const char *const lod_order_names[LOD_ORDER_COUNT + 1] = {
	[LOD_ORDER_GREEDY] = "greedy",
	[LOD_ORDER_STOCHASTIC] = "stochastic",
	[LOD_ORDER_DENSITY] = "density",
	[LOD_ORDER_ORIENTATION] = "orientation",
	[LOD_ORDER_COMBINED] = "combined",
};

static double dice(const struct lod_order_input *in, uint32_t i)
{
	return eco_random_unit(lod_mix(~lod_mix(in->seed) + i));
}

/* 1 if the element faces along the normal at the nearest point of the surface, 0 if across. */
static double orientation(const struct surface *hull, struct lod_v3 p, struct lod_v3 normal)
{
	struct lod_v3 outward;
	double length = lod_v3_length(normal);
	if (!(length > 0) || !surface_normal(hull, p, &outward))
		return 0.5;
	return 1 - lod_arc_cosine(fabs(lod_v3_dot(outward, normal)) / length) / (LOD_PI / 2);
}

/* The density of elements spread evenly over the space that they fill: an element at density F fills 1 /
 * F. */
static double even_density(const double *density, uint32_t count)
{
	double volume = 0;
	for (uint32_t i = 0; i < count; i++)
		volume += 1 / density[i];
	return count / volume;
}

/* Thinning a region of density F to `even` keeps the share even / F of its elements, at random: these get
 * probability 1. The others fall off such that every threshold above leaves even density as well. */
static void density_survival(double *survival, const struct surface *hull, const struct lod_order_input *in)
{
	for (uint32_t i = 0; i < in->count; i++)
		survival[i] = density_at(hull, in->center[i]);
	double even = even_density(survival, in->count);
	for (uint32_t i = 0; i < in->count; i++) {
		double u = 1 - eco_random_unit(lod_mix(lod_mix(in->seed) + i));
		survival[i] = fmin(1, even / (survival[i] * u));
	}
}

static void normalise(double *values, uint32_t count)
{
	double low = DBL_MAX, high = -DBL_MAX;
	for (uint32_t i = 0; i < count; i++) {
		low = fmin(low, values[i]);
		high = fmax(high, values[i]);
	}
	for (uint32_t i = 0; i < count; i++)
		values[i] = high > low ? (values[i] - low) / (high - low) : 1;
}

void lod_order_survival_by(double *survival, enum lod_order_method method, const struct lod_order_input *in,
	struct lod_arena *arena)
{
	static const double noise[LOD_ORDER_COUNT] = { [LOD_ORDER_STOCHASTIC] = 1, [LOD_ORDER_DENSITY] = 1e-3,
		[LOD_ORDER_ORIENTATION] = 0.05, [LOD_ORDER_COMBINED] = 1.5 };
	struct lod_arena_piece *mark = arena->last;
	struct surface hull;
	bool mixed = method == LOD_ORDER_ORIENTATION || method == LOD_ORDER_COMBINED;
	double much = mixed && in->noise > 0 ? in->noise : noise[method];
	if (in->count == 0)
		return;
	for (uint32_t i = 0; i < in->count; i++)
		survival[i] = 0;
	if (method != LOD_ORDER_STOCHASTIC)
		make_surface(&hull, in->center, in->count, in->height, arena);
	if (mixed) {
		for (uint32_t i = 0; i < in->count; i++)
			survival[i] = orientation(&hull, in->center[i], in->normal[i]);
		normalise(survival, in->count);
	}
	if (method == LOD_ORDER_DENSITY || method == LOD_ORDER_COMBINED) {
		double *density = lod_arena_take(arena, in->count, sizeof *density);
		density_survival(density, &hull, in);
		normalise(density, in->count);
		for (uint32_t i = 0; i < in->count; i++)
			survival[i] = survival[i] * survival[i] + density[i];
		normalise(survival, in->count);
	}
	for (uint32_t i = 0; i < in->count; i++)
		survival[i] += much * dice(in, i);
	lod_arena_release(arena, mark);
}
