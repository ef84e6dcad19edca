#include "lod/build/order/order.h"

#include <float.h>

#include "lod/build/order/iso_surface.h"
#include "lod/sort.h"

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
static double orientation(const struct lod_iso_surface *hull, struct lod_v3 p, struct lod_v3 normal)
{
	struct lod_v3 outward;
	double length = lod_v3_length(normal);
	if (!(length > 0) || !lod_iso_surface_normal(hull, p, &outward))
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
static void density_survival(double *survival, const struct lod_iso_surface *hull, const struct lod_order_input *in)
{
	for (uint32_t i = 0; i < in->count; i++)
		survival[i] = lod_iso_surface_density(hull, in->center[i]);
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
	struct lod_iso_surface hull;
	bool mixed = method == LOD_ORDER_ORIENTATION || method == LOD_ORDER_COMBINED;
	double much = mixed && in->noise > 0 ? in->noise : noise[method];
	if (in->count == 0)
		return;
	for (uint32_t i = 0; i < in->count; i++)
		survival[i] = 0;
	if (method != LOD_ORDER_STOCHASTIC)
		lod_iso_surface_make(&hull, in->center, in->count, in->height, arena);
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
