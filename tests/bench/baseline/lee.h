/* View-dependent choice of leaves under a budget (Lee, Peng, Kuo: View-Dependent Visibility Estimation for
 * Tree Models).
 *
 * Groups of leaves are ranked for one view, and the budget says how many leaves of each are kept. A group is
 * one leaf, as in the paper's table, or a cell of the plant (lod/build/cell.h), as the paper says that it
 * must be at run time; inside a cell the first of the cell's own static order are kept.
 *
 *   distance       the nearest group first, by Euclidean distance
 *   normal         the group that faces the eye best first: |normal . direction to the eye|
 *   layer+normal   G layers of equal thickness along the view; layer i from the front gets (G - i + 1) / (1 +
 *                  ... + G) of the budget, what it
 *                  cannot use goes to the next, and what the last cannot use goes to the front again; inside
 *                  a layer by normal */
#ifndef TESTS_BENCH_BASELINE_LEE_H
#define TESTS_BENCH_BASELINE_LEE_H

#include <stdint.h>

#include "lod/arena.h"
#include "lod/vector.h"

enum lod_lee_method { LOD_LEE_DISTANCE, LOD_LEE_NORMAL, LOD_LEE_LAYER, LOD_LEE_COUNT };

/* The paper does not say how many. */
#define LOD_LEE_LAYERS 5u

struct lod_lee_group {
	struct lod_v3 center;
	/* mean of n n^T over its leaves' unit normals: xx, yy, zz, xy, xz, yz. Then sqrt(v^T F v) is the root
	 * mean square of |n . v|, and for one leaf |n . v| itself */
	double facing[6];
	uint32_t count;              /* leaves */
};

/* One group from its leaves; normals of any length, zero ones face nowhere. */
void lod_lee_group_make(struct lod_lee_group *group, const struct lod_v3 *center, const struct lod_v3 *normal,
	const uint32_t *leaves, uint32_t count);

/* forward: unit; layers: 0 for LOD_LEE_LAYERS */
struct lod_lee_view { struct lod_v3 eye, forward; uint32_t layers; };

/* kept[i] becomes how many leaves of groups[i] are drawn: in all the budget, or all there are. Ties go to the
 * smaller index. */
void lod_lee_keep(uint32_t *kept, enum lod_lee_method method, const struct lod_lee_group *groups,
	uint32_t group_count, const struct lod_lee_view *view, uint64_t budget, struct lod_arena *arena);

#endif
