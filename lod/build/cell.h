/* Cells of a complex plant: an octree of small depth over its triangles (Deussen 2002, 6.1), so that what is near can be polygons
 * while the far side of the same plant is points.
 *
 * Two levels at most, so a leaf of the octree is a set of the 64 octants of octants and the tree is a table. Leaves with next to
 * nothing in them join the nearest one: a cell costs a fetch and a few records however little it holds. */
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
	const struct lod_v3 *center; /* of what is kept together */
	const uint32_t *triangles;   /* in it */
	uint32_t limit;              /* a node is split above this many triangles */
};

void lod_cells_make(struct lod_cells *cells, const struct lod_cells_input *input);

/* The cell of a point: less than cells->count. Points outside the box belong to the nearest octant. */
uint32_t lod_cells_at(const struct lod_cells *cells, struct lod_v3 point);

#endif
