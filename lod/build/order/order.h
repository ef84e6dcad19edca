/* Which element of a plant is worth most: Neubert 2011, section 3, the combined order.
 *
 * Elements are balls of a density field (equation 5, with the clamp that the print leaves out) of radius 5 % of the plant's height.
 * Orientation: an element facing along the field's gradient at the nearest point of the iso-surface survives longer. Density: thin
 * dense regions out first, until density is even; there stochastic order takes over. Both in [0,1], combined as P = o^2 + d,
 * normalised, with noise: little of it strips whole regions whose leaves happen to face away from the surface, such as the tops of
 * conifers. Of 0.05, 0.5 and 1.5 (of P's range) the last is best: Q 0.815, 0.822, 0.823 of a park at 30,000 vertices, 0.967, 0.969, 0.971 of a
 * forest at 300,000. */
#ifndef LOD_ORDER_H
#define LOD_ORDER_H

#include <stdint.h>

#include "lod/arena.h"
#include "lod/vector.h"

/* Orders by name: `ecopack make --order NAME`, ecobench. */
enum lod_order_method { LOD_ORDER_GREEDY, LOD_ORDER_STOCHASTIC, LOD_ORDER_DENSITY, LOD_ORDER_ORIENTATION, LOD_ORDER_COMBINED, LOD_ORDER_COUNT };
extern const char *const lod_order_names[LOD_ORDER_COUNT];      /* greedy, stochastic, density, orientation, combined */

struct lod_order_input {
	uint32_t count;
	const struct lod_v3 *center, *normal;    /* metres; any length, zero normals face nowhere */
	double height;               /* of the plant, metres */
	uint32_t seed;
};

/* Fills survival[0..count) for one of the static baselines (not GREEDY, which is lod/build/order/rank.h) with values that are higher for what is kept
 * longer. Linear in elements. */
void lod_order_survival_by(double *survival, enum lod_order_method method, const struct lod_order_input *input, struct lod_arena *arena);

#endif
