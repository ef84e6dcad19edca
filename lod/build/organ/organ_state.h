/* The inside of the finder of organs (organ.h). */
#pragma once

#include "lod/build/weld.h"

/* ---- Components (organ_split.c, organ_shape.c) ---- */

/* Regroups components: welded parts need not belong together, and a colour alone separates nothing.
 *
 * - Components of materials that differ only in a colour (a scan's vertex colours) are joined where they continue
 *   each other across edges, unless just one is green.
 * - A trunk and crown in one mesh are parted where green meets other colours, if that seam is a clear line. -
 * Leaves welded to a twig by corners, or by edges of more than two triangles, are parted from it if they are
 *   small flat sheets on a tube.
 *
 * Triangles of different rules stay apart. `rgb` is per triangle. */
void lod_organs_split(struct lod_mesh *mesh, const struct eco_model *model, const uint8_t (*rgb)[3],
	struct lod_arena *arena);

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

/* ---- Names (organ_name.c) ---- */

/* The organ that the name of a material or a part hints at, by words in a dozen languages. A hint only breaks
 * ties, since names are often wrong (a trunk's material on leaves, `Material.003`) and never needed. */
enum lod_hint { LOD_HINT_NONE, LOD_HINT_WOOD, LOD_HINT_FOLIAGE, LOD_HINT_FLOWER };

/* Pots, soil, rocks and fences hint at wood, which they are treated as. A name with words of different hints
 * gives none. UTF-8; case is ignored for ASCII. */
enum lod_hint lod_name_hint(const char *name);

/* ---- Flowers (organ_flower.c) ---- */

/* Flowers among the foliage, by colour (Deussen 2002, 4.3): pink, violet, blue; pale and warm colours that
 * stand out against green, unless warm ones are the majority and alike (autumn). Large components are none. A
 * name breaks the tie.
 *
 * Turns foliage into flowers in `organ`; arrays are per component, `fixed` ones stay. `extent`: the plant's
 * largest. */
void lod_flowers_find(uint8_t *organ, const struct lod_shape *shapes, uint32_t count, const bool *fixed,
	const enum lod_hint *hint, double extent);
