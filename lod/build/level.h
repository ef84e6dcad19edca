/* Simplified levels of wood by meshoptimizer: about a sixteenth and a quarter of the triangles, then all of
 * them.
 *
 * Wood is never pruned into holes (a missing piece of branch is noticed at once), so its levels are exchanged
 * as a whole. Branches of similar width are simplified together, by an error in proportion to that width: one
 * error for all of them would take the thin ones away. The border at the end of a cell or a width is kept, so
 * that different levels meet. */
#ifndef LOD_LEVEL_H
#define LOD_LEVEL_H

#include <stdbool.h>

#include "lod/build/weld.h"

#define LOD_LEVELS_SIMPLE 2u

struct lod_corner { uint32_t vertex, component; int32_t uv[2]; };        /* vertex of the mesh */

struct lod_levels {
	uint32_t count;              /* simplified levels that pay, coarse first, without full detail */
	uint32_t triangle_count[LOD_LEVELS_SIMPLE];
	struct lod_corner *corner[LOD_LEVELS_SIMPLE];    /* 3 per triangle */
};

/* Triangles of the mesh that are simplified together, since they belong to branches of similar width. */
struct lod_levels_part {
	const uint32_t *triangle;
	uint32_t count;
	/* Metres by which the surface may move, less than a tube's radius, beyond which it would lose its
	 * form. */
	double reach;
	bool keep_border;            /* neighbours of its triangles are in other parts, or in other cells */
};

/* Vertex counts ascend strictly, and each level has at most 70 % of the next one's triangles. Arrays from
 * `arena`. */
void lod_levels_make(struct lod_levels *levels, const struct lod_mesh *mesh,
	const struct lod_levels_part *parts, uint32_t part_count, struct lod_arena *arena);

#endif
