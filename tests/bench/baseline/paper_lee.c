/* Orders of leaves for one view: Lee, Peng, Kuo 2007. */
#include <float.h>

#include "lod/sort.h"
#include "tests/bench/baseline/paper_rules.h"

/* Square of |n . v|, v from the leaf to the eye; `d` is the other way. */
static double facing(struct lod_v3 normal, struct lod_v3 d)
{
	double cosine = lod_v3_dot(lod_v3_unit(normal), lod_v3_unit(d));
	return cosine * cosine;
}

/* `order` becomes layer after layer, each by rank; first[i] is where layer i begins. */
static void order_layers(struct lod_keyed *order, uint32_t *first, uint32_t layers,
	enum lod_lee_method method,
	const struct lod_lee_leaves *leaves, const struct lod_lee_view *view, struct lod_arena *arena)
{
	double near = DBL_MAX, far = -DBL_MAX, *depth = lod_arena_take(arena, leaves->count, sizeof *depth);
	for (uint32_t i = 0; i < leaves->count; i++) {
		struct lod_v3 d = lod_v3_sub(leaves->center[i], view->eye);
		double rank = method == LOD_LEE_DISTANCE ? lod_v3_dot(d, d) : -facing(leaves->normal[i], d);
		order[i] = (struct lod_keyed){ lod_sort_key(rank), i };
		depth[i] = lod_v3_dot(d, view->forward);
		near = fmin(near, depth[i]);
		far = fmax(far, depth[i]);
	}
	lod_sort(arena, order, leaves->count);
	for (uint32_t i = 0; i < leaves->count; i++) {
		double at = far > near ? (depth[order[i].value] - near) / (far - near) * layers : 0;
		order[i].key = at >= layers ? layers - 1 : (uint64_t)at;
	}
	lod_sort(arena, order, leaves->count);
	for (uint32_t layer = 0, i = 0; layer <= layers; layer++) {
		while (i < leaves->count && order[i].key < layer)
			i++;
		first[layer] = i;
	}
}

uint32_t lod_lee_keep(uint32_t *kept, enum lod_lee_method method, const struct lod_lee_leaves *leaves,
	const struct lod_lee_view *view, uint32_t budget, struct lod_arena *arena)
{
	struct lod_arena_piece *mark = arena->last;
	uint32_t layers = method != LOD_LEE_LAYER ? 1 : view->layers ? view->layers : LOD_LEE_LAYERS,
		count = 0;
	uint64_t sum = (uint64_t)layers * (layers + 1) / 2, weight = 0, given = 0, left = 0;
	struct lod_keyed *order = lod_arena_take(arena, leaves->count, sizeof *order);
	uint32_t *first = lod_arena_take(arena, layers + 1, sizeof *first),
		*taken = lod_arena_take(arena, layers, sizeof *taken);
	order_layers(order, first, layers, method, leaves, view, arena);
	for (uint32_t turn = 0; turn < 2 * layers; turn++) {
		uint32_t layer = turn % layers;
		if (turn < layers) {             /* shares add up to the budget */
			weight += layers - layer;
			left += budget * weight / sum - given;
			given = budget * weight / sum;
		}
		for (; left && first[layer] + taken[layer] < first[layer + 1]; left--)
			kept[count++] = order[first[layer] + taken[layer]++].value;
	}
	lod_arena_release(arena, mark);
	return count;
}
