#include "lod/build/plant_state.h"

#include <assert.h>
#include <stdbool.h>
#include <string.h>

#define TINY 16                  /* a cell with fewer than limit / TINY triangles joins another */

static uint32_t octant(const struct lod_cells *cells, struct lod_v3 p)
{
	uint32_t index = 0;
	for (int a = 2; a >= 0; a--) {
		double size = lod_v3_axis(cells->size, a),
			at = size > 0 ? 4 * (lod_v3_axis(p, a) - lod_v3_axis(cells->low, a)) / size : 0;
		index = 4 * index + (at >= 3 ? 3 : at >= 2 ? 2 : at >= 1 ? 1 : 0);
	}
	return index;
}

uint32_t lod_cells_at(const struct lod_cells *cells, struct lod_v3 point)
{
	return cells->map[octant(cells, point)];
}

/* The root's child that contains a second-level octant. */
static uint32_t coarse(uint32_t index)
{
	return (index >> 1 & 1) | (index >> 3 & 1) << 1 | (index >> 5 & 1) << 2;
}

struct leaf { uint64_t triangles; struct lod_v3 sum; };

/* The tiny leaf with the fewest triangles joins the leaf with the nearest contents. False if none is tiny. */
static bool join_smallest(struct lod_cells *cells, struct leaf leaves[LOD_CELLS_MAX], uint32_t limit)
{
	uint32_t least = LOD_CELLS_MAX, nearest = LOD_CELLS_MAX;
	bool used[LOD_CELLS_MAX] = { false };
	for (uint32_t i = 0; i < LOD_CELLS_MAX; i++)
		used[cells->map[i]] = true;
	for (uint32_t i = 0; i < LOD_CELLS_MAX; i++)
		if (used[i] && leaves[i].triangles < limit
				&& (least == LOD_CELLS_MAX || leaves[i].triangles < leaves[least].triangles))
			least = i;
	if (least == LOD_CELLS_MAX)
		return false;
	struct lod_v3 from = leaves[least].triangles
		? lod_v3_scale(leaves[least].sum, 1.0 / (double)leaves[least].triangles)
		: (struct lod_v3){ (least & 3) + 0.5, (least >> 2 & 3) + 0.5, (least >> 4) + 0.5 };
	double best = 0;
	for (uint32_t i = 0; i < LOD_CELLS_MAX; i++) {
		if (!used[i] || i == least || leaves[i].triangles == 0)
			continue;
		double d =
			lod_v3_distance(from, lod_v3_scale(leaves[i].sum, 1.0 / (double)leaves[i].triangles));
		if (nearest == LOD_CELLS_MAX || d < best) {
			best = d;
			nearest = i;
		}
	}
	if (nearest == LOD_CELLS_MAX)
		return false;
	for (uint32_t i = 0; i < LOD_CELLS_MAX; i++)
		if (cells->map[i] == least)
			cells->map[i] = (uint8_t)nearest;
	leaves[nearest].triangles += leaves[least].triangles;
	leaves[nearest].sum = lod_v3_add(leaves[nearest].sum, leaves[least].sum);
	return true;
}

static void number_cells(struct lod_cells *cells)
{
	uint8_t number[LOD_CELLS_MAX];
	memset(number, 255, sizeof number);
	cells->count = 0;
	for (uint32_t i = 0; i < LOD_CELLS_MAX; i++) {
		if (number[cells->map[i]] == 255)
			number[cells->map[i]] = (uint8_t)cells->count++;
		cells->map[i] = number[cells->map[i]];
	}
}

void lod_cells_make(struct lod_cells *cells, const struct lod_cells_input *in)
{
	*cells = (struct lod_cells){ .low = in->low, .size = lod_v3_sub(in->high, in->low) };
	struct leaf fine[LOD_CELLS_MAX] = { { 0 } }, leaves[LOD_CELLS_MAX] = { { 0 } };
	uint64_t total = 0, child[8] = { 0 };
	assert(in->limit > 0);
	for (uint32_t i = 0; i < in->count; i++) {
		uint32_t o = octant(cells, in->center[i]);
		struct lod_v3 at = { 0, 0, 0 }; /* in octants, so that an empty one has a place too */
		at.x = cells->size.x > 0 ? 4 * (in->center[i].x - in->low.x) / cells->size.x : 0;
		at.y = cells->size.y > 0 ? 4 * (in->center[i].y - in->low.y) / cells->size.y : 0;
		at.z = cells->size.z > 0 ? 4 * (in->center[i].z - in->low.z) / cells->size.z : 0;
		fine[o].triangles += in->triangles[i];
		fine[o].sum = lod_v3_add(fine[o].sum, lod_v3_scale(at, in->triangles[i]));
		child[coarse(o)] += in->triangles[i];
		total += in->triangles[i];
	}
	if (total <= in->limit)
		return;
	for (uint32_t i = 0; i < LOD_CELLS_MAX; i++) {
		/* A child that is not split is named by its first octant. */
		cells->map[i] = (uint8_t)(child[coarse(i)] > in->limit ? i : i & ~UINT32_C(21));
		leaves[cells->map[i]].triangles += fine[i].triangles;
		leaves[cells->map[i]].sum = lod_v3_add(leaves[cells->map[i]].sum, fine[i].sum);
	}
	uint32_t least = in->limit / TINY ? in->limit / TINY : 1;
	while (join_smallest(cells, leaves, least))
		;
	number_cells(cells);
	if (cells->count < 2)
		*cells = (struct lod_cells){ .low = cells->low, .size = cells->size };
}
