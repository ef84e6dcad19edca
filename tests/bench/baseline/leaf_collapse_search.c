/* The best partner of a leaf. A cost is no less than that of its distance and of the least interiority that a
 * point so near can have, so that boxes beyond that of the best so far are not looked into: a few hundred
 * candidates a leaf, where leaves are spread. */
#include "tests/bench/baseline/leaf_collapse_state.h"

#define BUCKET 8u

/* ---- Building ---- */

static bool before(const struct lod_collapse_search *s, uint32_t a, uint32_t b, int axis)
{
	double x = lod_v3_axis(s->node[a].center, axis), y = lod_v3_axis(s->node[b].center, axis);
	return x != y ? x < y : a < b;
}

/* Afterwards ids[0 .. middle) come before ids[middle], and the others after it. */
static void select_middle(const struct lod_collapse_search *s, uint32_t *ids, uint32_t count, uint32_t middle,
	int axis)
{
	uint32_t first = 0, last = count - 1;
	while (first < last) {
		uint32_t pivot = ids[first + (last - first) / 2], i = first, j = last;
		for (;;) {
			while (before(s, ids[i], pivot, axis))
				i++;
			while (before(s, pivot, ids[j], axis))
				j--;
			if (i >= j)
				break;
			uint32_t swapped = ids[i];
			ids[i++] = ids[j];
			ids[j--] = swapped;
		}
		if (middle <= j)
			last = j;
		else
			first = j + 1;
	}
}

static void widen(struct lod_collapse_box *box, struct lod_v3 at)
{
	for (int a = 0; a < 3; a++) {
		box->low[a] = fmin(box->low[a], lod_v3_axis(at, a));
		box->high[a] = fmax(box->high[a], lod_v3_axis(at, a));
	}
}

static void put(struct lod_collapse_search *s, uint32_t box, uint32_t id)
{
	s->next[id] = s->box[box].head;
	s->box[box].head = id;
	s->box_of[id] = box;
}

static uint32_t make_box(struct lod_collapse_search *s, uint32_t *ids, uint32_t count, uint32_t parent)
{
	uint32_t index = s->box_count++, middle = count / 2;
	struct lod_collapse_box *box = &s->box[index];
	*box = (struct lod_collapse_box){ .low = { INFINITY, INFINITY, INFINITY },
		.high = { -INFINITY, -INFINITY, -INFINITY }, .side = { ECO_NONE, ECO_NONE }, .parent = parent,
		.alive = count, .head = ECO_NONE };
	for (uint32_t i = 0; i < count; i++)
		widen(box, s->node[ids[i]].center);
	if (count <= BUCKET) {
		for (uint32_t i = count; i-- > 0;)
			put(s, index, ids[i]);
		return index;
	}
	for (uint32_t a = 1; a < 3; a++)
		if (box->high[a] - box->low[a] > box->high[box->axis] - box->low[box->axis])
			box->axis = a;
	select_middle(s, ids, count, middle, (int)box->axis);
	box->at = lod_v3_axis(s->node[ids[middle]].center, (int)box->axis);
	box->side[0] = make_box(s, ids, middle, index);
	box->side[1] = make_box(s, ids + middle, count - middle, index);
	return index;
}

static void build(struct lod_collapse_search *s, uint32_t nodes)
{
	s->alive = 0;
	for (uint32_t i = 0; i < nodes; i++)
		if (!s->dead[i])
			s->ids[s->alive++] = i;
	s->box_count = 0;
	s->built = s->alive;
	if (s->alive)
		make_box(s, s->ids, s->alive, ECO_NONE);
}

void lod_collapse_search_make(struct lod_collapse_search *s, const struct lod_collapse *collapse,
	const struct lod_collapse_options *options, uint32_t room, uint32_t count, struct lod_arena *arena)
{
	*s = (struct lod_collapse_search){ .node = collapse->node, .options = options, .crown = s->crown,
		.box = lod_arena_take(arena, (size_t)count + 1, sizeof *s->box),
		.dead = lod_arena_take(arena, room, sizeof *s->dead),
		.next = lod_arena_take(arena, room, sizeof *s->next),
		.box_of = lod_arena_take(arena, room, sizeof *s->box_of),
		.ids = lod_arena_take(arena, count, sizeof *s->ids) };
	build(s, count);
}

void lod_collapse_search_remove(struct lod_collapse_search *s, uint32_t id)
{
	s->dead[id] = true;
	s->alive--;
	for (uint32_t box = s->box_of[id]; box != ECO_NONE; box = s->box[box].parent)
		s->box[box].alive--;
}

/* Nodes are added in the order of their numbers, so all up to this one are known. */
void lod_collapse_search_add(struct lod_collapse_search *s, uint32_t id)
{
	struct lod_v3 at = s->node[id].center;
	if (s->alive <= s->built / 2) {
		build(s, id + 1);
		return;
	}
	s->alive++;
	uint32_t index = 0;
	for (;;) {
		struct lod_collapse_box *box = &s->box[index];
		box->alive++;
		widen(box, at);
		if (box->side[0] == ECO_NONE)
			break;
		index = box->side[lod_v3_axis(at, (int)box->axis) >= box->at];
	}
	put(s, index, id);
}

/* ---- Searching ---- */

struct look {                    /* of one leaf */
	struct lod_collapse_search *s;
	uint32_t id, best, looks;
	double cost, most, per_m, inner, per_inner;
};

/* The least cost of a partner that is `apart` metres away or more. Interiority falls by half of the way,
 * until the point between the two is on the axis. */
static double bound(const struct look *look, double apart)
{
	if (look->per_m < look->per_inner / 2)               /* farther ones may cost less */
		apart = fmax(apart, fmin(2 * look->inner, look->most));
	double inner = look->inner - apart / 2;
	return look->per_m * apart + look->per_inner * (inner > 0 ? inner : 0);
}

static double box_distance(const struct lod_collapse_box *box, struct lod_v3 at)
{
	double sum = 0;
	for (int a = 0; a < 3; a++) {
		double x = lod_v3_axis(at, a), below = box->low[a] - x, above = x - box->high[a];
		double out = below > above ? below : above;
		sum += out > 0 ? out * out : 0;
	}
	return sqrt(sum);
}

static bool beyond(const struct look *look, double apart)
{
	/* the bound is computed in another order than the cost: it leaves room for rounding */
	return apart > look->most * (1 + 1e-12) || bound(look, apart) * (1 - 1e-12) >= look->cost;
}

/* Those that are gone leave the list on the way. */
static void look_at(struct look *look, uint32_t box)
{
	struct lod_collapse_search *s = look->s;
	const struct lod_collapse_node *self = &s->node[look->id];
	for (uint32_t *at = &s->box[box].head; *at != ECO_NONE && look->looks < LOD_COLLAPSE_LOOKS;) {
		uint32_t id = *at;
		if (s->dead[id]) {
			*at = s->next[id];
			continue;
		}
		at = &s->next[id];
		if (id == look->id)
			continue;
		look->looks++;
		double cost = lod_collapse_cost_below(self, &s->node[id], &s->crown, s->options, look->cost);
		if (cost < look->cost) {
			look->cost = cost;
			look->best = id;
		}
		if (beyond(look, 0))
			return;
	}
}

static void look_into(struct look *look, uint32_t index, double apart)
{
	const struct lod_collapse_box *box = &look->s->box[index];
	if (box->alive == 0 || look->looks >= LOD_COLLAPSE_LOOKS || beyond(look, apart))
		return;
	if (box->side[0] == ECO_NONE) {
		look_at(look, index);
		return;
	}
	struct lod_v3 at = look->s->node[look->id].center;
	double away[2] = { box_distance(&look->s->box[box->side[0]], at),
		box_distance(&look->s->box[box->side[1]], at) };
	/* boxes may overlap, as nodes were added: then that side of the plane first where it is */
	int first = away[0] != away[1] ? away[1] < away[0]
		: lod_v3_axis(at, (int)box->axis) >= box->at;
	look_into(look, box->side[first], away[first]);
	look_into(look, box->side[!first], away[!first]);
}

uint32_t lod_collapse_search_best(struct lod_collapse_search *s, uint32_t id, double *cost)
{
	const double *weight = s->options->weight;
	struct lod_v3 at = s->node[id].center;
	double x = at.x - s->crown.axis_x, y = at.y - s->crown.axis_y;
	struct look look = { .s = s, .id = id, .best = ECO_NONE, .cost = INFINITY,
		.most = s->options->distance_most * s->crown.radius, .inner = sqrt(x * x + y * y),
		.per_inner = s->crown.across > 0 ? weight[LOD_COLLAPSE_INTERIORITY] / s->crown.across : 0 };
	look.per_m = look.most > 0 ? weight[LOD_COLLAPSE_DISTANCE] / look.most : 0;
	if (s->box_count)
		look_into(&look, 0, 0);
	*cost = look.cost;
	return look.best;
}
