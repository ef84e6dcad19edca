/* Shapes of a model's components, in the sense of organ.h. Private to the finder of organs. */
#ifndef LOD_ORGAN_SHAPE_H
#define LOD_ORGAN_SHAPE_H

#include "lod/build/weld.h"

struct lod_shape {
	uint32_t triangle_count, first, material;    /* its first triangle, and the material of that one */
	double area;                 /* m^2, all triangles */
	double radius, length;       /* of the tube with the same area and curvature (organ.h) */
	double turn; /* radians, mean edge angle weighted by angle: 2 pi / k for tubes of k sides */
	double round;                /* 4 V M / A^2: 4/3 for a ball, 1 for a tube, 0.79 for a square section,
	                              * 0.44 for one of 5 : 1 */
	double diagonal;             /* of its bounds */
	double level;                /* mean |z| of its normals, by area: 1 if level, 0.5 for a ball */
	double open;                 /* share of its edges that is border, by length */
	double glued;                /* share of that border which continues in another component */
	uint32_t glued_to;           /* the last such component */
	double clear;                /* share of its area with clear texture */
	float low[3], high[3];
	uint8_t rgb[3];              /* mean opaque colour */
};

/* Whether a colour is that of a leaf in summer: more green than red and blue. */
bool lod_colour_is_green(const uint8_t rgb[3]);

/* One shape per component, from `arena`. `rgb` and `opaque` (m^2) are per triangle. */
struct lod_shape *lod_shapes_find(const struct lod_mesh *mesh, const uint8_t (*rgb)[3], const double *opaque,
	struct lod_arena *arena);

#endif
