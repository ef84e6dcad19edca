/* Lines for wood (Deussen 2002, 4.2): the skeleton of any tubular surface, trunk, branches and twigs in one mesh or each its own.
 *
 * The distance along the surface from a component's lower end is a function whose level sets are rings. Cut at equal steps, the
 * surface falls into slabs; a ring joins two slabs, its centre is a joint, and a line leads through each slab from joint to joint.
 * Where a branch leaves, a slab has three rings. (This is the Reeb graph of that function, with the rings' centres for a position.)
 * Rings are found by interpolation inside triangles, so that a low-poly tube gets as good an axis as a fine one. Afterwards lines that
 * run on straight at similar width become one.
 *
 * A line is as wide as area asks: a tube of surface a and length l has diameter a / (pi l), an open strip width a / l, and so all lines
 * together project to the same area as the wood. What is treated as wood and is no tube (pots, stumps) gets one line, fitted to its surface. */
#ifndef LOD_BONE_H
#define LOD_BONE_H

#include "lod/build/organ.h"
#include "lod/vector.h"

struct lod_bone {
	struct lod_v3 end[2];        /* metres */
	double width, error;         /* metres; greatest distance from what the line stands for, less its radius */
	uint32_t component;
	uint8_t rgb[3];              /* mean of the triangles that it stands for */
};

struct lod_bones {
	uint32_t count;
	struct lod_bone *items;
};

/* Lines of all wood, component by component. Array from `arena`. */
void lod_bones_make(struct lod_bones *bones, const struct lod_mesh *mesh, const struct lod_organs *organs, struct lod_arena *arena);

/* Puts bones in drawing order: the largest (length times width) first, those of similar size (half octaves) in random order, so that
 * the first ones are spread over the plant. */
void lod_bones_sort(struct lod_bones *bones, uint32_t seed, struct lod_arena *arena);

#endif
