/* The hull of a plant: the density of its elements in space and the iso-surface around them (Neubert 2011,
 * 3.1; balls of Blinn 1982).
 *
 *   lod_iso_surface_make(&hull, center, count, height, &arena);
 *   lod_iso_surface_density(&hull, p), lod_iso_surface_normal(&hull, p, &normal)     for orders
 * (lod/build/order/order.h) */
#ifndef LOD_ISO_SURFACE_H
#define LOD_ISO_SURFACE_H

#include <stdbool.h>
#include <stdint.h>

#include "lod/arena.h"
#include "lod/vector.h"

struct lod_iso_surface {                    /* arrays of an arena */
	struct lod_v3 low;
	double radius, cell;         /* of a ball; distance of nodes */
	uint32_t size[3];
	float *density;              /* at nodes, x fastest */
	uint32_t *surface;           /* per node: the nearest node of the iso-surface, or ECO_NONE */
};

/* height: of the plant; a ball's radius is 5 % of it, more if the elements extend far beyond it. At least one
 * element. Linear in elements. */
void lod_iso_surface_make(struct lod_iso_surface *hull, const struct lod_v3 *center, uint32_t count, double height,
	struct lod_arena *arena);

/* Sum of the balls at a point within the bounds of the centres. */
double lod_iso_surface_density(const struct lod_iso_surface *hull, struct lod_v3 at);

/* Outward unit normal of the iso-surface at its point nearest to `at` (within the bounds of the centres).
 * False if there is none. */
bool lod_iso_surface_normal(const struct lod_iso_surface *hull, struct lod_v3 at, struct lod_v3 *normal);

#endif
