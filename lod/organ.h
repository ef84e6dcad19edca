/* Which triangles are wood, which foliage, which flowers: by shape and colour. Names never decide.
 *
 * Wood is what is tube-like: lines and simplification suit it, points and scaled leaves do not. For a tube of radius r and length L,
 * branched or bent as it likes, the integral of mean curvature M and the area A are M = pi L and A = 2 pi r L, so that
 *
 *   r = A / (2 M),  L = M / pi
 *
 * follow from sums over edges (Steiner's formula for polyhedra: M is half the sum of length times angle, concave edges counted
 * negative). Wood is thin (r against the component's diagonal), as long as it is large (L against the same: a sheet's M is much too
 * small for its extent), and round (the angles around a tube are all moderate; a closed blade has its whole turn in two sharp rims).
 * Where that leaves doubt, the component follows the clear ones of its material: artists put bark and leaves apart, and this asks
 * only whether two components share a material, not what it is called.
 *
 * Everything else is foliage, crowns modelled as a hull, pots and stumps included: points and triangles represent any surface.
 * Flowers are small components whose colour stands out from that of the foliage (Deussen 2002, 4.3). */
#ifndef LOD_ORGAN_H
#define LOD_ORGAN_H

#include "ecofiles/pack.h"
#include "lod/weld.h"

struct lod_component {
	uint32_t triangle_count, material;
	uint8_t organ;               /* enum eco_organ */
	bool closed;                 /* no border to speak of: each ray hits it twice, its area counts half */
	double area;                 /* m^2, all triangles, both sides of what is closed */
	double radius, length;       /* of the tube that it would be */
	double turn;                 /* radians, mean edge angle weighted by angle: 2 pi / k for tubes of k sides */
	float low[3], high[3];
	uint8_t rgb[3];              /* mean colour */
};

struct lod_organs {
	struct lod_component *components;    /* per component of the mesh */
	double *area;                /* per triangle, m^2 that it counts for: half where its component is closed, times its opaque share */
	uint8_t (*rgb)[3];           /* per triangle, mean colour of what is opaque */
};

/* Arrays come from `arena`. */
void lod_organs_find(struct lod_organs *organs, const struct lod_mesh *mesh, const struct eco_model *model, struct lod_arena *arena);

#endif
