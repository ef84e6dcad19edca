/* A plant's hull: the density of its elements in space and the iso-surface around them (Neubert 2011, 3.1; balls of Blinn 1982).
 *
 *   lod_hull_make(&hull, center, count, height, &arena);
 *   lod_hull_density(&hull, p), lod_hull_normal(&hull, p, &normal)     for orders (lod/order.h)
 *   lod_hull_sample(&hull, samples, room, seed)                        points on it, for occlusion (Neubert 2011, 4)
 *   f = lod_hull_visible(samples, count, &sight)                       lambda_occluded = lambda * max(f, 0.1) */
#ifndef LOD_HULL_H
#define LOD_HULL_H

#include <stdbool.h>
#include <stdint.h>

#include "lod/arena.h"
#include "lod/vector.h"
#include "lod/view.h"

struct lod_hull {                    /* arrays of an arena */
	struct lod_v3 low;
	double radius, cell;         /* of a ball; between nodes */
	uint32_t size[3];
	float *density;              /* at nodes, x fastest */
	uint32_t *surface;           /* per node: the nearest node of the iso-surface, or ECO_NONE */
};

/* height: of the plant; balls have 5 % of it as radius, more where the elements span a multiple of it. One element at least. Linear in
 * elements. */
void lod_hull_make(struct lod_hull *hull, const struct lod_v3 *center, uint32_t count, double height, struct lod_arena *arena);

/* Sum of the balls at a point inside the bounds of the centres. */
double lod_hull_density(const struct lod_hull *hull, struct lod_v3 at);

/* Outward unit normal of the iso-surface at its point nearest to `at` (inside the bounds of the centres). False where there is none. */
bool lod_hull_normal(const struct lod_hull *hull, struct lod_v3 at, struct lod_v3 *normal);

/* ---- Occlusion ---- */

struct lod_hull_sample { float at[3], normal[3]; };      /* object space */

/* At most `room` points spread over the iso-surface, the same for the same seed; returns how many. */
uint32_t lod_hull_sample(const struct lod_hull *hull, struct lod_hull_sample *samples, uint32_t room, uint32_t seed);

/* A finished picture: reciprocals of view distance (lod/raster.h), 0 where nothing is drawn. */
struct lod_hull_sight {
	const struct lod_eye *eye;
	const struct lod_place *place;
	uint32_t width, height;
	const float *depth;
	const uint64_t *owner;       /* or NULL */
	uint64_t self;               /* what this plant is drawn as: it does not hide itself. Without owners give slack_m, as it does then */
	double slack_m;              /* what lies less than this in front of a sample does not hide it */
};

/* Share of the samples facing the eye that nothing hides. What falls outside the picture counts as visible (Neubert 2011, 4), samples on
 * the far side do not count: they are hidden by the plant itself whatever stands around it. 1 without samples. */
double lod_hull_visible(const struct lod_hull_sample *samples, uint32_t count, const struct lod_hull_sight *sight);

#endif
