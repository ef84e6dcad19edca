/* Static orders of a plant's elements after Neubert 2011, section 3.
 *
 * Elements are balls of a density field (equation 5, with the clamp that the print omits) of radius 5 % of
 * the plant's height. Orientation: an element that faces along the field's gradient at the nearest point of
 * the iso-surface survives longer. Density: dense regions are thinned first, until density is even; from
 * there on the order is stochastic. Both are in [0,1] and combined as P = o^2 + d, normalised, plus noise.
 * Without much noise whole regions whose leaves face away from the surface, such as the tops of conifers, are
 * stripped (lod/EXPERIMENTS.md, Noise in the combined order). */
#pragma once

#include <stdint.h>

#include "lod/arena.h"
#include "lod/vector.h"

/* Orders by name: `ecopack make --order NAME`, ecobench. */
enum lod_order_method { LOD_ORDER_GREEDY, LOD_ORDER_STOCHASTIC, LOD_ORDER_DENSITY, LOD_ORDER_ORIENTATION,
	LOD_ORDER_COMBINED, LOD_ORDER_COUNT };
extern const char *const lod_order_names[LOD_ORDER_COUNT + 1];  /* indexed by method; ends with NULL */

struct lod_order_input {
	uint32_t count;
	const struct lod_v3 *center, *normal; /* metres; normals of any length, zero normals face nowhere */
	double height;               /* of the plant, metres */
	uint32_t seed;
	double noise;                /* of orientation and combined, whose values are in [0, 1]; 0: ours */
};

/* Fills survival[0..count) for a static order (not GREEDY: that is lod/build/order/rank.h) with values that
 * are higher for elements kept longer. Linear in elements. */
void lod_order_survival_by(double *survival, enum lod_order_method method,
	const struct lod_order_input *input, struct lod_arena *arena);
