/* Orders of leaves for one view: Lee, Peng, Kuo 2007. */
#include <float.h>
#include <string.h>

#include "lod/sort.h"
#include "tests/bench/baseline/paper_rules.h"

void lod_lee_group_make(struct lod_lee_group *group, const struct lod_v3 *center, const struct lod_v3 *normal,
	const uint32_t *leaves, uint32_t count)
{
	memset(group, 0, sizeof *group);
	group->count = count;
	for (uint32_t i = 0; i < count; i++) {
		struct lod_v3 n = lod_v3_unit(normal[leaves[i]]);
		const double product[6] = { n.x * n.x, n.y * n.y, n.z * n.z, n.x * n.y, n.x * n.z,
			n.y * n.z };
		for (int k = 0; k < 6; k++)
			group->facing[k] += product[k] / count;
		group->center = lod_v3_add(group->center, lod_v3_scale(center[leaves[i]], 1.0 / count));
	}
}

/* Square of the mean |n . v|, v from the group to the eye. */
static double facing(const struct lod_lee_group *group, struct lod_v3 eye)
{
	struct lod_v3 v = lod_v3_unit(lod_v3_sub(eye, group->center));
	const double *f = group->facing;
	return f[0] * v.x * v.x + f[1] * v.y * v.y + f[2] * v.z * v.z
		+ 2 * (f[3] * v.x * v.y + f[4] * v.x * v.z + f[5] * v.y * v.z);
}

/* Groups order[0..count) in turn until `budget` more leaves are kept; returns what is left of it. */
static uint64_t keep(uint32_t *kept, const struct lod_lee_group *groups, const struct lod_keyed *order,
	uint32_t count, uint64_t budget)
{
	for (uint32_t i = 0; i < count && budget; i++) {
		uint32_t g = order[i].value;
		uint64_t more = groups[g].count - kept[g];
		more = more < budget ? more : budget;
		kept[g] += (uint32_t)more;
		budget -= more;
	}
	return budget;
}

/* `order` becomes layer after layer, each by normal; first[i] is where layer i begins. */
static void order_layers(struct lod_keyed *order, uint32_t *first, uint32_t layers,
	const struct lod_lee_group *groups, uint32_t count, const struct lod_lee_view *view,
	struct lod_arena *arena)
{
	double near = DBL_MAX, far = -DBL_MAX;
	double *depth = lod_arena_take(arena, count, sizeof *depth);
	for (uint32_t i = 0; i < count; i++) {
		depth[i] = lod_v3_dot(lod_v3_sub(groups[i].center, view->eye), view->forward);
		near = fmin(near, depth[i]);
		far = fmax(far, depth[i]);
	}
	for (uint32_t i = 0; i < count; i++)
		order[i] = (struct lod_keyed){ lod_sort_key(-facing(&groups[i], view->eye)), i };
	lod_sort(arena, order, count);
	for (uint32_t i = 0; i < count; i++) {
		double at = far > near ? (depth[order[i].value] - near) / (far - near) * layers : 0;
		order[i].key = at >= layers ? layers - 1 : (uint64_t)at;
	}
	lod_sort(arena, order, count);
	for (uint32_t layer = 0, i = 0; layer <= layers; layer++) {
		while (i < count && order[i].key < layer)
			i++;
		first[layer] = i;
	}
}

static void keep_layers(uint32_t *kept, const struct lod_lee_group *groups, uint32_t count,
	const struct lod_lee_view *view, uint64_t budget, struct lod_arena *arena)
{
	uint32_t layers = view->layers ? view->layers : LOD_LEE_LAYERS;
	uint64_t sum = (uint64_t)layers * (layers + 1) / 2, weight = 0, given = 0, left = 0;
	struct lod_keyed *order = lod_arena_take(arena, count, sizeof *order);
	uint32_t *first = lod_arena_take(arena, (size_t)layers + 1, sizeof *first);
	order_layers(order, first, layers, groups, count, view, arena);
	for (uint32_t layer = 0; layer < layers; layer++) {
		weight += layers - layer;
		/* shares add up to the budget */
		uint64_t share = budget / sum * weight + budget % sum * weight / sum - given;
		given += share;
		left = keep(kept, groups, order + first[layer], first[layer + 1] - first[layer],
			share + left);
	}
	for (uint32_t layer = 0; layer < layers && left; layer++)
		left = keep(kept, groups, order + first[layer], first[layer + 1] - first[layer], left);
}

void lod_lee_keep(uint32_t *kept, enum lod_lee_method method, const struct lod_lee_group *groups,
	uint32_t group_count, const struct lod_lee_view *view, uint64_t budget, struct lod_arena *arena)
{
	struct lod_arena_piece *mark = arena->last;
	memset(kept, 0, group_count * sizeof *kept);
	if (method == LOD_LEE_LAYER && group_count) {
		keep_layers(kept, groups, group_count, view, budget, arena);
	} else if (group_count) {
		struct lod_keyed *order = lod_arena_take(arena, group_count, sizeof *order);
		for (uint32_t i = 0; i < group_count; i++) {
			struct lod_v3 d = lod_v3_sub(groups[i].center, view->eye);
			double rank = method == LOD_LEE_DISTANCE ? lod_v3_dot(d, d)
				: -facing(&groups[i], view->eye);
			order[i] = (struct lod_keyed){ lod_sort_key(rank), i };
		}
		lod_sort(arena, order, group_count);
		keep(kept, groups, order, group_count, budget);
	}
	lod_arena_release(arena, mark);
}
