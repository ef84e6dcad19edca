/* The forest, its line of places, and sectors. A heap holds every leaf with its best partner. Where that
 * partner is gone by the time the leaf comes up, the next best is looked for then, and not before: the leaf's
 * cost only rises by that. A new quad looks for its best partner among all that are there. The pair that
 * comes up is then the cheapest of all. */
#include "tests/bench/baseline/leaf_collapse.h"

#include <string.h>

#include "lod/heap.h"
#include "lod/sort.h"

#define CORNERS_MAX (2 * ECO_CORNERS_MAX)
/* an axis shorter than that over the leaves' extent has no direction: corners are floats */
#define COINCIDENT 1e-6

const struct lod_collapse_options lod_collapse_defaults = { .weight = { 1, 0.25, 1, 0.5, 0.1 },
	.distance_most = 0.12, .angle_most_rad = LOD_PI * 4 / 9 };

/* ---- Leaves ---- */

void lod_collapse_node_of(struct lod_collapse_node *node, const float (*corner)[3], uint32_t corners)
{
	struct lod_v3 sum = { 0, 0, 0 }, first = lod_v3_of(corner[0]), far = sum;
	double wide = 0;
	*node = (struct lod_collapse_node){ .represents = 1, .child = { ECO_NONE, ECO_NONE },
		.parent = ECO_NONE };
	for (uint32_t k = 0; k < corners; k++)
		node->center = lod_v3_add(node->center, lod_v3_scale(lod_v3_of(corner[k]), 1.0 / corners));
	for (uint32_t k = 1; k + 1 < corners; k++) {
		struct lod_v3 n = lod_v3_cross(lod_v3_sub(lod_v3_of(corner[k]), first),
			lod_v3_sub(lod_v3_of(corner[k + 1]), first));
		/* bent leaves: triangles add up, whichever way they are wound */
		n = lod_v3_dot(n, sum) < 0 ? lod_v3_scale(n, -1) : n;
		node->area += lod_v3_length(n) / 2;
		sum = lod_v3_add(sum, n);
	}
	node->normal = lod_v3_unit(sum);
	node->opaque_area = node->area;
	/* half of the longest extent from the centre, and across it in the leaf's plane */
	for (uint32_t k = 0; k < corners; k++) {
		struct lod_v3 d = lod_v3_sub(lod_v3_of(corner[k]), node->center);
		far = lod_v3_dot(d, d) > lod_v3_dot(far, far) ? d : far;
	}
	struct lod_v3 across = lod_v3_unit(lod_v3_cross(node->normal, far));
	for (uint32_t k = 0; k < corners; k++)
		wide = fmax(wide, fabs(lod_v3_dot(across, lod_v3_sub(lod_v3_of(corner[k]), node->center))));
	node->half[0] = far;
	node->half[1] = lod_v3_scale(across, wide);
}

static void leaf_node(struct lod_collapse_node *node, const struct lod_foliage *leaves, uint32_t i)
{
	uint32_t at = leaves->first[i];
	lod_collapse_node_of(node, (const float (*)[3])(leaves->corner + at), leaves->first[i + 1] - at);
	node->opaque_area = leaves->area ? leaves->area[i] : node->area;
}

uint32_t lod_collapse_corners(const struct lod_collapse *collapse, const struct lod_foliage *leaves,
	uint32_t id, struct lod_v3 corner[ECO_CORNERS_MAX])
{
	static const int sign[4][2] = { { -1, -1 }, { 1, -1 }, { 1, 1 }, { -1, 1 } };
	const struct lod_collapse_node *node = &collapse->node[id];
	uint32_t leaf = id < collapse->leaves ? collapse->leaf[id] : ECO_NONE,
		count = leaf == ECO_NONE ? 4 : leaves->first[leaf + 1] - leaves->first[leaf];
	for (uint32_t k = 0; k < count; k++)
		corner[k] = leaf != ECO_NONE ? lod_v3_of(leaves->corner[leaves->first[leaf] + k])
			: lod_v3_add(node->center, lod_v3_add(lod_v3_scale(node->half[0], sign[k][0]),
			lod_v3_scale(node->half[1], sign[k][1])));
	return count;
}

/* ---- The new quad (section 3.2) ---- */

static struct lod_v3 in_plane(struct lod_v3 v, struct lod_v3 normal)
{
	return lod_v3_sub(v, lod_v3_scale(normal, lod_v3_dot(v, normal)));
}

/* The weighted mean of the normals; b's is turned to the side of a's first, as a leaf has no back. */
static struct lod_v3 mean_normal(const struct lod_collapse_node *a, const struct lod_collapse_node *b)
{
	double turn = lod_v3_dot(a->normal, b->normal) < 0 ? -1 : 1;
	struct lod_v3 sum = lod_v3_unit(lod_v3_add(lod_v3_scale(a->normal, a->represents),
		lod_v3_scale(b->normal, turn * b->represents)));
	return lod_v3_length(sum) > 0 ? sum : (struct lod_v3){ 0, 0, 1 };
}

/* The line through the projected centres; where they coincide, the larger leaf's own main axis; else any. */
static struct lod_v3 main_axis(const struct lod_collapse_node *a, const struct lod_collapse_node *b,
	struct lod_v3 normal)
{
	const struct lod_v3 tried[3] = { lod_v3_sub(b->center, a->center), b->area > a->area ? b->half[0]
		: a->half[0], fabs(normal.z) < 0.9 ? (struct lod_v3){ 0, 0, 1 } : (struct lod_v3){ 1, 0,
			0 } };
	double extent = lod_v3_length(a->half[0]) + lod_v3_length(b->half[0]);
	for (int i = 0; i < 2; i++)
		if (lod_v3_length(in_plane(tried[i], normal)) > COINCIDENT * extent)
			return lod_v3_unit(in_plane(tried[i], normal));
	return lod_v3_unit(in_plane(tried[2], normal));
}

/* Sides of the rectangle along both axes that encloses all corners projected onto their plane. */
static void enclose(double side[2], const struct lod_v3 *corner, uint32_t count, const struct lod_v3 axis[2])
{
	for (int a = 0; a < 2; a++) {
		double low = INFINITY, high = -INFINITY;
		for (uint32_t k = 0; k < count; k++) {
			low = fmin(low, lod_v3_dot(corner[k], axis[a]));
			high = fmax(high, lod_v3_dot(corner[k], axis[a]));
		}
		side[a] = high - low;
	}
}

/* The quad in place of nodes a and b, as the last node. */
static uint32_t add_quad(struct lod_collapse *collapse, const struct lod_foliage *leaves, uint32_t a,
	uint32_t b)
{
	uint32_t id = collapse->leaves + collapse->made++;
	struct lod_collapse_node *node = &collapse->node[id], *one = &collapse->node[a],
		*two = &collapse->node[b];
	struct lod_v3 corner[CORNERS_MAX];
	double weight = (double)two->represents / ((double)one->represents + two->represents), side[2];
	*node = (struct lod_collapse_node){ .center = lod_v3_mix(one->center, two->center, weight),
		.normal = mean_normal(one, two), .opaque_area = one->opaque_area + two->opaque_area,
		.represents = one->represents + two->represents, .child = { a, b }, .parent = ECO_NONE };
	one->parent = two->parent = id;
	struct lod_v3 axis[2] = { main_axis(one, two, node->normal) };
	axis[1] = lod_v3_cross(node->normal, axis[0]);
	uint32_t count = lod_collapse_corners(collapse, leaves, a, corner);
	count += lod_collapse_corners(collapse, leaves, b, corner + count);
	enclose(side, corner, count, axis);
	double enclosing = side[0] * side[1];
	node->area = (one->area + two->area + enclosing) / 2;
	/* seen from the side both leaves are a line: the quad has their area as a square */
	double root = sqrt(node->area), grow = enclosing > 0 ? sqrt(node->area / enclosing) : 0;
	node->half[0] = lod_v3_scale(axis[0], (enclosing > 0 ? grow * side[0] : root) / 2);
	node->half[1] = lod_v3_scale(axis[1], (enclosing > 0 ? grow * side[1] : root) / 2);
	return id;
}

/* ---- The best partner: in the cells of a grid, as wide as partners may lie apart, around the leaf ---- */

struct work {
	struct lod_collapse *collapse;
	const struct lod_foliage *leaves;
	const struct lod_collapse_options *options;
	double across, most;         /* the crown's radius around the axis; how far partners may lie apart */
	struct lod_v3 low;           /* the grid's corner */
	int cells[3];
	uint32_t *head, *next;       /* per cell and node: lists of nodes */
	bool *dead;                  /* per node */
	struct lod_heap_item *heap;
	uint32_t heap_count, *partner;
};

static double from_axis(struct lod_v3 at) { return sqrt(at.x * at.x + at.y * at.y); }

static double difference(double a, double b)
{
	return a + b > 0 ? fabs(a - b) / (a + b) : 0;
}

/* A leaf without area lies in every plane. */
static double angle_between(struct lod_v3 a, struct lod_v3 b)
{
	double length = lod_v3_length(a) * lod_v3_length(b);
	return length > 0 ? lod_arc_cosine(fabs(lod_v3_dot(a, b)) / length) : 0;
}

/* The cost if that is below `least`; else anything that is not. Terms that take a root or an angle come last:
 * most candidates are out by the others. */
static double cost_below(const struct work *w, const struct lod_collapse_node *a,
	const struct lod_collapse_node *b, double least)
{
	const double *weight = w->options->weight;
	double apart = lod_v3_distance(a->center, b->center);
	if (apart > w->most)
		return INFINITY;
	double cost = weight[LOD_COLLAPSE_DISTANCE] * (w->most > 0 ? apart / w->most : 0)
		+ weight[LOD_COLLAPSE_LEAVES] * difference(a->represents, b->represents)
		+ weight[LOD_COLLAPSE_AREA] * difference(a->area, b->area);
	if (cost >= least)
		return cost;
	double angle = angle_between(a->normal, b->normal);
	if (angle > w->options->angle_most_rad)
		return INFINITY;
	return cost + weight[LOD_COLLAPSE_INTERIORITY] * (w->across > 0
		? from_axis(lod_v3_mix(a->center, b->center, 0.5)) / w->across : 0)
		+ weight[LOD_COLLAPSE_ANGLE] * angle / (LOD_PI / 2);
}

static void cell_of(const struct work *w, struct lod_v3 at, int cell[3])
{
	for (int k = 0; k < 3; k++)
		cell[k] = w->most > 0 ? (int)fmax(0, (lod_v3_axis(at, k) - lod_v3_axis(w->low, k)) / w->most)
		: 0;
}

/* NULL outside the grid. */
static uint32_t *list_at(const struct work *w, int x, int y, int z)
{
	if (x < 0 || y < 0 || z < 0 || x >= w->cells[0] || y >= w->cells[1] || z >= w->cells[2])
		return NULL;
	return &w->head[((size_t)z * (size_t)w->cells[1] + (size_t)y) * (size_t)w->cells[0] + (size_t)x];
}

static void put(struct work *w, uint32_t id)
{
	int cell[3];
	cell_of(w, w->collapse->node[id].center, cell);
	uint32_t *list = list_at(w, cell[0], cell[1], cell[2]);
	w->next[id] = *list;
	*list = id;
}

/* Those that are gone leave the list on the way. */
static void look_at(struct work *w, uint32_t self, uint32_t *list, double *cost)
{
	const struct lod_collapse_node *node = w->collapse->node;
	while (list && *list != ECO_NONE) {
		uint32_t id = *list;
		if (w->dead[id]) {
			*list = w->next[id];
			continue;
		}
		list = &w->next[id];
		double now = id == self ? INFINITY : cost_below(w, &node[self], &node[id], *cost);
		if (now < *cost) {
			*cost = now;
			w->partner[self] = id;
		}
	}
}

/* Finds the leaf's partner of least cost: the leaf stands in the heap with it, or leaves the heap without. */
static void settle(struct work *w, uint32_t id, uint32_t at)
{
	double cost = INFINITY;
	int cell[3];
	w->partner[id] = ECO_NONE;
	cell_of(w, w->collapse->node[id].center, cell);
	for (int i = 0; i < 27; i++)
		look_at(w, id, list_at(w, cell[0] + i % 3 - 1, cell[1] + i / 3 % 3 - 1, cell[2] + i / 9 - 1),
			&cost);
	if (w->partner[id] != ECO_NONE)
		w->heap[at] = (struct lod_heap_item){ -cost, id };
	else
		w->heap[at] = w->heap[--w->heap_count];
}

/* ---- The forest ---- */

/* The extent of the crown, which costs and the grid are over. */
static void measure(struct work *w, const struct lod_collapse_node *node, uint32_t count)
{
	struct lod_v3 low = { INFINITY, INFINITY, INFINITY }, high = lod_v3_scale(low, -1);
	for (uint32_t i = 0; i < count; i++) {
		struct lod_v3 at = node[i].center;
		low = (struct lod_v3){ fmin(low.x, at.x), fmin(low.y, at.y), fmin(low.z, at.z) };
		high = (struct lod_v3){ fmax(high.x, at.x), fmax(high.y, at.y), fmax(high.z, at.z) };
		w->across = fmax(w->across, from_axis(at));
	}
	w->low = low;
	w->most = w->options->distance_most * lod_v3_distance(low, high) / 2;
	cell_of(w, high, w->cells);
	for (int k = 0; k < 3; k++)
		w->cells[k]++;
}

static void collapse_all(struct work *w)
{
	while (w->heap_count) {
		uint32_t id = w->heap[0].id, other = w->partner[id];
		if (w->dead[id]) {
			w->heap[0] = w->heap[--w->heap_count];
		} else if (w->dead[other]) {
			settle(w, id, 0);
		} else {
			uint32_t made = add_quad(w->collapse, w->leaves, id, other);
			w->dead[id] = w->dead[other] = true;
			put(w, made);
			settle(w, made, 0);
		}
		lod_heap_sift(w->heap, w->heap_count, 0);
	}
}

/* The line of places and the table of levels (section 4). Roots that were made last are placed first: they
 * are the largest. */
static void place_all(struct lod_collapse *collapse, struct lod_arena *arena)
{
	uint32_t n = collapse->leaves, nodes = n + collapse->made, p = 0,
		q = n;         /* first free places */
	collapse->place = lod_arena_take(arena, nodes, sizeof *collapse->place);
	collapse->level = lod_arena_take(arena, (size_t)collapse->made + 1, sizeof *collapse->level);
	for (uint32_t i = nodes; i-- > 0;)
		if (collapse->node[i].parent == ECO_NONE)
			collapse->place[i < n ? p++ : q++] = i;
	collapse->roots = p + q - n;
	collapse->level[0] = (struct lod_collapse_level){ p, n, q - n };
	for (uint32_t i = 0; i < collapse->made; i++) {
		const uint32_t *child = collapse->node[collapse->place[n + i]].child;
		for (int k = 0; k < 2; k++)
			collapse->place[child[k] < n ? p++ : q++] = child[k];
		collapse->level[i + 1] = (struct lod_collapse_level){ p, n + i + 1, q - n - i - 1 };
	}
}

static void make_forest(struct work *w, struct lod_arena *arena)
{
	struct lod_arena_piece *mark = arena->last;
	uint32_t n = w->collapse->leaves;
	size_t cells = (size_t)w->cells[0] * (size_t)w->cells[1] * (size_t)w->cells[2];
	w->head = lod_arena_take(arena, cells, sizeof *w->head);
	w->next = lod_arena_take(arena, 2 * (size_t)n, sizeof *w->next);
	w->dead = lod_arena_take(arena, 2 * (size_t)n, sizeof *w->dead);
	w->partner = lod_arena_take(arena, 2 * (size_t)n, sizeof *w->partner);
	w->heap = lod_arena_take(arena, n, sizeof *w->heap);
	w->heap_count = 0;
	memset(w->head, 0xff, cells * sizeof *w->head);          /* ECO_NONE */
	for (uint32_t i = n; i-- > 0;)
		put(w, i);
	for (uint32_t i = 0; i < n; i++)
		settle(w, i, w->heap_count++);
	lod_heap_make(w->heap, w->heap_count);
	collapse_all(w);
	lod_arena_release(arena, mark);
	place_all(w->collapse, arena);
}

/* ---- Sectors ---- */

/* Grows with the angle around the axis, from 0 to 4, without libm. */
static double turn_of(struct lod_v3 at)
{
	double sum = fabs(at.x) + fabs(at.y), t = sum > 0 ? at.y / sum : 0;
	return at.x < 0 ? 2 - t : t < 0 ? 4 + t : t;
}

static void sort_leaves(uint32_t *leaf, const struct lod_collapse_node *node, uint32_t count,
	double (*key)(struct lod_v3 at), struct lod_arena *arena)
{
	struct lod_arena_piece *mark = arena->last;
	struct lod_keyed *items = lod_arena_take(arena, count, sizeof *items);
	for (uint32_t i = 0; i < count; i++)
		items[i] = (struct lod_keyed){ lod_sort_key(key(node[leaf[i]].center)), leaf[i] };
	lod_sort(arena, items, count);
	for (uint32_t i = 0; i < count; i++)
		leaf[i] = items[i].value;
	lod_arena_release(arena, mark);
}

void lod_collapse_make(struct lod_collapse *forests, uint32_t sectors, const struct lod_foliage *leaves,
	const struct lod_collapse_options *options, struct lod_arena *arena)
{
	uint32_t n = leaves->count, *leaf = lod_arena_take(arena, n, sizeof *leaf);
	struct lod_collapse_node *node = lod_arena_take(arena, n, sizeof *node);
	struct work w = { .leaves = leaves, .options = options ? options : &lod_collapse_defaults };
	for (uint32_t i = 0; i < n; i++) {
		leaf[i] = i;
		leaf_node(&node[i], leaves, i);
	}
	measure(&w, node, n);
	if (sectors > 1) {
		sort_leaves(leaf, node, n, from_axis, arena);
		sort_leaves(leaf + n / sectors, node, n - n / sectors, turn_of, arena);
	}
	for (uint32_t s = 0; s < sectors; s++) {
		uint32_t first = (uint32_t)((uint64_t)n * s / sectors),
			count = (uint32_t)((uint64_t)n * (s + 1) / sectors) - first;
		w.collapse = &forests[s];
		forests[s] = (struct lod_collapse){ .leaves = count, .leaf = leaf + first,
			.node = lod_arena_take(arena, 2 * (size_t)count, sizeof *node) };
		for (uint32_t i = 0; i < count; i++)
			forests[s].node[i] = node[leaf[first + i]];
		make_forest(&w, arena);
	}
}
