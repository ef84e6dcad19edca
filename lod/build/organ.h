/* Which triangles are wood, which foliage, which flowers: what the scene file says, else shape, then place, colour and names.
 *
 * Wood is what is tube-like: lines and simplification suit it, points and scaled leaves do not. For a tube of radius r and length L,
 * branched or bent as it likes, the integral of mean curvature M and the area A are M = pi L and A = 2 pi r L, so that
 *
 *   r = A / (2 M),  L = M / pi
 *
 * follow from sums over edges (Steiner's formula for polyhedra: M is half the sum of length times angle, concave edges counted
 * negative). Wood is thin (r against the component's diagonal), as long as it is large (L against the same: a sheet's M is much too small
 * for its extent), and round: its volume V fills what A and M allow (4 V M / A^2 is 1 for tubes, 4/3 for balls, little for blades), and
 * the angles around it are all moderate, while a closed blade has its whole turn in two sharp rims.
 *
 * Where shape leaves doubt, a component follows the clear ones of its material: artists put bark and leaves apart, and this asks only
 * whether two components share a material, not what it is called. Then names break the tie (organ_name.h), then colours.
 *
 * What is thick is a crown or fruit modelled as a hull, or else a thing: a stump, a stout trunk, a pot, a rock. Things stand on the
 * ground with most of the plant above them, or are brown and all there is: brown lumps above the ground are crowns in autumn. Soil is a
 * level sheet that is neither green nor one of many. Things count as wood: never pruned into holes nor scaled into balloons. A
 * plant of nothing but green tubes is a herb, all foliage. Names decide between hull and thing where they say so. Measured on 28
 * models from seven sources: without names less than 1 % of any model's area is found otherwise, and wrong names on what is clear
 * change nothing; they are for rocks, logs, buds and what has no colours.
 *
 * Rules of the scene file (eco_model.organ) win over all of this, for exactly the triangles that they name: components end where the
 * rule changes. */
#ifndef LOD_ORGAN_H
#define LOD_ORGAN_H

#include "ecofiles/format/pack.h"
#include "lod/build/weld.h"

struct lod_component {
	uint32_t triangle_count, material;
	uint8_t organ;               /* enum eco_organ */
	bool closed;                 /* no border to speak of: each ray hits it twice, its area counts half */
	double area;                 /* m^2, all triangles, both sides of what is closed */
	bool stout;                  /* no tube at all: a pot, a stump, soil */
	double radius, length;       /* of the tube that it would be */
	double turn;                 /* radians, mean edge angle weighted by angle: 2 pi / k for tubes of k sides */
	float low[3], high[3];
	uint8_t rgb[3];              /* mean colour */
};

struct lod_organs {
	struct lod_component *components;    /* per component of the mesh */
	double *area;                /* per triangle, m^2 that it counts for: half where its component is closed, times its opaque share */
	uint8_t (*rgb)[3];           /* per triangle, mean colour of what is opaque; brown wood, green leaves where the file says none */
};

/* Arrays come from `arena`. The mesh's components are regrouped (organ_split.h). */
void lod_organs_find(struct lod_organs *organs, struct lod_mesh *mesh, const struct eco_model *model, struct lod_arena *arena);

/* Mean colour of at least one triangle, by what is opaque of them. */
void lod_organs_mean(const struct lod_organs *organs, const uint32_t *triangles, uint32_t count, uint8_t rgb[3]);

#endif
