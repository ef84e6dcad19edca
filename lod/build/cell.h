/* Cells of a complex plant: an octree of small depth over its triangles (Deussen 2002, 6.1), so that the near
 * side can be polygons while the far side of the same plant is points.
 *
 * There are at most two levels, so a leaf of the octree is a set of the 64 octants of octants, and the tree
 * is a table. A leaf with next to nothing in it joins the nearest one: any cell costs a fetch and a few
 * records. */
#ifndef LOD_CELL_H
#define LOD_CELL_H

#include <stdint.h>

#include "lod/arena.h"
#include "lod/vector.h"

#define LOD_CELLS_MAX 64u

struct lod_cells {
	uint32_t count;              /* 0: the plant is not divided */
	struct lod_v3 low, size;     /* of the box */
	uint8_t map[LOD_CELLS_MAX];  /* octant of octant (x, y, z in [0,4)) -> cell */
};

struct lod_cells_input {
	struct lod_v3 low, high;
	uint32_t count;
	const struct lod_v3 *center; /* of units that stay together */
	const uint32_t *triangles;   /* of each unit */
	uint32_t limit;              /* a node is split above this many triangles */
};

void lod_cells_make(struct lod_cells *cells, const struct lod_cells_input *input);

/* The cell of a point: less than cells->count. A point outside the box belongs to the nearest octant. */
uint32_t lod_cells_at(const struct lod_cells *cells, struct lod_v3 point);

#endif
