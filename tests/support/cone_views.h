/* Directions inside a cone: what lists per sector of view are built from and tested with. */
#ifndef TESTS_SUPPORT_CONE_VIEWS_H
#define TESTS_SUPPORT_CONE_VIEWS_H

#include <math.h>

#include "lod/build/foliage.h"

/* As lod_directions_spread, whose heights from -0.2 to 0.95 become those of a cap, inside a cone of half
 * angle `cone_rad` around `axis`. */
static inline void cone_views(double (*directions)[3], uint32_t count, const double axis[3], double cone_rad,
	uint32_t seed)
{
	struct lod_v3 along = lod_v3_unit((struct lod_v3){ axis[0], axis[1], axis[2] });
	struct lod_v3 other = fabs(along.z) < 0.9 ? (struct lod_v3){ 0, 0, 1 } : (struct lod_v3){ 1, 0, 0 };
	struct lod_v3 u = lod_v3_unit(lod_v3_cross(along, other)), v = lod_v3_cross(along, u);
	lod_directions_spread(directions, count, seed);
	for (uint32_t i = 0; i < count; i++) {
		double *d = directions[i], z = 1 - (1 - cos(cone_rad)) * (d[2] + 0.2) / 1.15,
			turn = sqrt(fmax(0, 1 - z * z)) / hypot(d[0], d[1]);
		struct lod_v3 at = lod_v3_add(lod_v3_scale(along, z),
			lod_v3_add(lod_v3_scale(u, turn * d[0]), lod_v3_scale(v, turn * d[1])));
		d[0] = at.x;
		d[1] = at.y;
		d[2] = at.z;
	}
}

#endif
