/* The skeleton (Kratt 2014, 3.1): extruded elements become chains of graph nodes, chains are connected at
 * points of overlap. It becomes a binary tree in preorder, with its faces. */
#include <string.h>

#include "ecofiles/base/status.h"
#include "ecofiles/base/union.h"
#include "lod/heap.h"
#include "tests/bench/baseline/billboard_cloud.h"

#define NODE (1.0 / 64)              /* length of a node */
#define CELL_FIRST (1.0 / 128)
#define TRUNK_BELOW 0.05             /* the trunk begins this near the ground */
#define SURPASSES 2.0                /* extent of a component that looks around a cell again */
#define NEAR_MOST 8u                 /* half cells between points of neighbouring cells, more than that */

struct skeleton {
	const struct lod_mesh *mesh;
	struct lod_arena *arena;
	double *extent;              /* per component */
	/* how a component hangs on the one that bears it: a corner (3 * triangle + k) of each; ECO_NONE: a
	 * root */
	struct link { uint32_t parent, own; } *link;
	struct lod_heap_item *heap;
	uint32_t heap_count;
	/* nodes of chains; a parent is smaller than the node's own number, ECO_NONE for node 0 */
	uint32_t count, *parent, *of;        /* of: per triangle */
	struct lod_v3 *connector;            /* where it meets its parent */
	uint32_t *around_first, *around;     /* corners at a vertex */
	double *distance;            /* per vertex, of the component at hand */
	uint32_t *stamp;             /* per vertex: 1 + the component that `distance` is of */
	uint32_t *level, *set;       /* per triangle: its level; union-find over those that are one node */
};

static void *take(struct skeleton *s, size_t count, size_t size)
{
	return lod_arena_take(s->arena, count, size);
}

/* The heap has room for another item. */
static void push(struct skeleton *s, double key, uint32_t id)
{
	lod_heap_push(s->heap, s->heap_count++, (struct lod_heap_item){ key, id });
}

static uint32_t pop(struct skeleton *s)
{
	uint32_t id = s->heap[0].id;
	s->heap[0] = s->heap[--s->heap_count];
	lod_heap_sift(s->heap, s->heap_count, 0);
	return id;
}

/* Items i with key[i] = k are list[first[k] .. first[k + 1]), for k < n; others are left out. Returns first.
 * */
static uint32_t *list_by(struct skeleton *s, const uint32_t *key, uint32_t count, uint32_t n, uint32_t **list)
{
	uint32_t *first = take(s, (size_t)n + 2, sizeof *first);
	*list = take(s, count, sizeof **list);
	for (uint32_t i = 0; i < count; i++)
		if (key[i] < n)
			first[key[i] + 2]++;
	for (uint32_t k = 0; k < n; k++)
		first[k + 2] += first[k + 1];
	for (uint32_t i = 0; i < count; i++)
		if (key[i] < n)
			(*list)[first[key[i] + 1]++] = i;
	return first;
}

static struct lod_v3 corner_at(const struct skeleton *s, uint32_t corner)
{
	return lod_mesh_corner(s->mesh, corner / 3, corner % 3);
}

/* ---- The tree of components ----
 *
 * Prim's algorithm on corners in cells: from the trunk upwards each component hangs on the nearest that hangs
 * already. One corner of a component stands for all its corners in a cell; a component that is taken looks
 * for others in the cells around its own. Components that none has reached are looked for in cells twice as
 * wide, and so on. A cell is looked around again only for a much larger component, so the work is linear in
 * corners. Nearness counts in half cells, and among the equally near the largest bears: a leaf hangs on its
 * twig and not on the leaf beside it. */

struct rep { uint32_t corner, component, cell; };
struct attach {
	struct skeleton *s;
	bool *taken;
	uint32_t *near, *bearer;     /* half cells away, and by which component, of what is not taken */
	double side;                 /* of cells */
	struct lod_keyed *cells;     /* by key; value: the first rep */
	uint32_t cell_count, rep_count;
	struct rep *reps;            /* by cell */
	uint32_t *own_first, *own;   /* reps by component */
	double *seen;                /* per cell: extent of what looked around it */
};

/* Extents; returns the largest component that begins near the ground, with its lowest corner. */
static uint32_t find_trunk(struct skeleton *s, uint32_t *corner)
{
	const struct lod_mesh *mesh = s->mesh;
	uint32_t best = 0;
	double best_extent = -1;
	for (uint32_t c = 0; c < mesh->component_count; c++) {
		struct lod_v3 low = { 1e9, 1e9, 1e9 }, high = { -1e9, -1e9, -1e9 };
		uint32_t lowest = ECO_NONE;
		for (uint32_t i = 3 * mesh->member_first[c]; i < 3 * mesh->member_first[c + 1]; i++) {
			uint32_t at = 3 * mesh->member[i / 3] + i % 3;
			struct lod_v3 p = corner_at(s, at);
			lowest = p.z < low.z ? at : lowest;
			low = (struct lod_v3){ fmin(low.x, p.x), fmin(low.y, p.y), fmin(low.z, p.z) };
			high = (struct lod_v3){ fmax(high.x, p.x), fmax(high.y, p.y), fmax(high.z, p.z) };
		}
		s->extent[c] = lod_v3_distance(low, high);
		if (low.z <= (double)mesh->low[2] + TRUNK_BELOW && s->extent[c] > best_extent) {
			best = c;
			best_extent = s->extent[c];
			*corner = lowest;
		}
	}
	return best;
}

static void make_level(struct attach *a, double side)
{
	struct skeleton *s = a->s;
	const struct lod_mesh *mesh = s->mesh;
	uint32_t n = 3 * mesh->triangle_count, *component = take(s, n, sizeof *component);
	struct lod_keyed *items = take(s, n, sizeof *items);
	a->side = side;
	a->cells = take(s, (size_t)n + 1, sizeof *a->cells);
	a->seen = take(s, n, sizeof *a->seen);
	a->reps = take(s, n, sizeof *a->reps);
	/* in the order of components, which the sort keeps within a cell */
	for (uint32_t i = 0; i < n; i++) {
		uint32_t corner = 3 * mesh->member[i / 3] + i % 3;
		items[i] = (struct lod_keyed){ billboard_cell(corner_at(s, corner), side, 0, 0, 0), corner };
	}
	lod_sort(s->arena, items, n);
	a->rep_count = a->cell_count = 0;
	for (uint32_t i = 0; i < n; i++) {
		uint32_t of = mesh->component[items[i].value / 3];
		bool new_cell = i == 0 || items[i].key != items[i - 1].key;
		if (new_cell) {
			a->seen[a->cell_count] = -1;
			a->cells[a->cell_count++] = (struct lod_keyed){ items[i].key, a->rep_count };
		}
		if (new_cell || component[a->rep_count - 1] != of) {
			component[a->rep_count] = of;
			a->reps[a->rep_count++] = (struct rep){ items[i].value, of, a->cell_count - 1 };
		}
	}
	a->cells[a->cell_count].value = a->rep_count;
	a->own_first = list_by(s, component, a->rep_count, mesh->component_count, &a->own);
	s->heap_count = 0;
	s->heap = take(s, NEAR_MOST * (size_t)mesh->component_count, sizeof *s->heap);
	memset(a->near, 0xff, mesh->component_count * sizeof *a->near);  /* ECO_NONE */
}

static void offer(struct attach *a, const struct rep *from, const struct rep *to)
{
	const double *extent = a->s->extent;
	uint32_t c = to->component, near = (uint32_t)(2 * lod_v3_distance(corner_at(a->s, from->corner),
		corner_at(a->s, to->corner)) / a->side);
	if (a->taken[c] || near > a->near[c] || (near == a->near[c]
			&& !(extent[from->component] > extent[a->bearer[c]])))
		return;
	if (near < a->near[c])               /* extents stay below 64 */
		push(a->s, -64.0 * near + extent[c], c);
	a->near[c] = near;
	a->bearer[c] = from->component;
	a->s->link[c] = (struct link){ from->corner, to->corner };
}

static void expand(struct attach *a, uint32_t component)
{
	double extent = a->s->extent[component];
	for (uint32_t k = a->own_first[component]; k < a->own_first[component + 1]; k++) {
		const struct rep *from = &a->reps[a->own[k]];
		if (extent <= SURPASSES * a->seen[from->cell])
			continue;
		a->seen[from->cell] = extent;
		for (int i = 0; i < 27; i++) {
			uint64_t key = billboard_cell(corner_at(a->s, from->corner), a->side, i % 3 - 1,
				i / 3 % 3 - 1, i / 9 - 1);
			uint32_t cell = billboard_find(a->cells, a->cell_count, key);
			if (cell == a->cell_count || a->cells[cell].key != key)
				continue;
			for (uint32_t to = a->cells[cell].value; to < a->cells[cell + 1].value; to++)
				offer(a, from, &a->reps[to]);
		}
	}
}

/* Fills `order` with all components, each after the one that bears it, and links. */
static void attach_all(struct skeleton *s, uint32_t *order)
{
	uint32_t n = s->mesh->component_count, count = 1, lowest = 0, trunk = find_trunk(s, &lowest);
	struct attach a = { .s = s, .taken = take(s, n, sizeof *a.taken), .near = take(s, n, sizeof *a.near),
		.bearer = take(s, n, sizeof *a.bearer) };
	s->link[trunk] = (struct link){ ECO_NONE, lowest };
	a.taken[trunk] = true;
	order[0] = trunk;
	for (double side = CELL_FIRST; count < n; side *= 2) {
		struct lod_arena_piece *mark = s->arena->last;
		make_level(&a, side);
		for (uint32_t i = 0; i < count; i++)
			expand(&a, order[i]);
		while (s->heap_count > 0) {
			uint32_t c = pop(s);
			if (a.taken[c])
				continue;
			a.taken[c] = true;
			order[count++] = c;
			expand(&a, c);
		}
		lod_arena_release(s->arena, mark);
	}
}

/* ---- Nodes: level sets of the distance along the surface from where a component hangs ----
 *
 * A tube becomes a chain of rings, one that forks becomes a chain that forks. A component that is shorter
 * than two nodes, such as a leaf, is one node. */

static uint32_t vertex_of(const struct skeleton *s, uint32_t triangle, uint32_t k)
{
	return s->mesh->index[3 * (size_t)triangle + k];
}

static struct lod_v3 place_of(const struct skeleton *s, uint32_t vertex)
{
	return lod_v3_of(s->mesh->place + 3 * (size_t)vertex);
}

static void reach(struct skeleton *s, uint32_t component, uint32_t vertex, double distance)
{
	if (s->stamp[vertex] == component + 1 && s->distance[vertex] <= distance)
		return;
	s->stamp[vertex] = component + 1;
	s->distance[vertex] = distance;
	push(s, -distance, vertex);
}

/* Dijkstra over edges. */
static void measure(struct skeleton *s, uint32_t component, uint32_t from)
{
	s->heap_count = 0;
	reach(s, component, from, 0);
	while (s->heap_count > 0) {
		double at = -s->heap[0].key;
		uint32_t v = pop(s);
		for (uint32_t i = s->around_first[v]; i < s->around_first[v + 1] && at <= s->distance[v]; i++)
			for (uint32_t k = 0; k < 3 && s->mesh->component[s->around[i]
				/ 3] == component; k++) {
				uint32_t to = vertex_of(s, s->around[i] / 3, k);
				reach(s, component, to,
					at + lod_v3_distance(place_of(s, v), place_of(s, to)));
			}
	}
}

static double nearest(const struct skeleton *s, uint32_t triangle)
{
	return fmin(s->distance[vertex_of(s, triangle, 0)], fmin(s->distance[vertex_of(s, triangle, 1)],
		s->distance[vertex_of(s, triangle, 2)]));
}

/* A triangle at the vertex in the component, of the level (`lower`: of a lower one and of a node before
 * `node`); ECO_NONE if there is none. */
static uint32_t neighbour(const struct skeleton *s, uint32_t vertex, uint32_t triangle, bool lower,
	uint32_t node)
{
	for (uint32_t j = s->around_first[vertex]; j < s->around_first[vertex + 1]; j++) {
		uint32_t other = s->around[j] / 3;
		if (s->mesh->component[other] == s->mesh->component[triangle] && (lower
				? s->level[other] < s->level[triangle] && s->of[other] < node
				: s->level[other] == s->level[triangle]))
			return other;
	}
	return ECO_NONE;
}

/* Triangles of one level that share a vertex are of one node. Nodes are numbered by their distance. */
static void make_nodes(struct skeleton *s, uint32_t component)
{
	const uint32_t *member = s->mesh->member + s->mesh->member_first[component];
	uint32_t members = s->mesh->member_first[component + 1] - s->mesh->member_first[component];
	struct lod_arena_piece *mark = s->arena->last;
	struct lod_keyed *items = take(s, members, sizeof *items);
	for (uint32_t i = 0; i < members; i++) {
		uint32_t t = member[i];
		s->level[t] = (uint32_t)(nearest(s, t) / NODE);
		s->set[t] = t;
		s->of[t] = ECO_NONE;
		items[i] = (struct lod_keyed){ lod_sort_key(nearest(s, t)), t };
	}
	for (uint32_t i = 0; i < 3 * members; i++) {     /* the first at a vertex: all join that one */
		uint32_t t = member[i / 3];
		eco_union_join(s->set, t, neighbour(s, vertex_of(s, t, i % 3), t, false, 0));
	}
	lod_sort(s->arena, items, members);
	for (uint32_t i = 0; i < members; i++) {
		uint32_t root = eco_union_root(s->set, items[i].value);
		if (s->of[root] == ECO_NONE)
			s->of[root] = s->count++;
		s->of[items[i].value] = s->of[root];
	}
	lod_arena_release(s->arena, mark);
}

/* A node's parent is one of the level below that it touches: the first that is found; it is connected in the
 * middle of what they share. */
static void link_nodes(struct skeleton *s, uint32_t component, uint32_t first)
{
	const struct lod_mesh *mesh = s->mesh;
	struct lod_arena_piece *mark = s->arena->last;
	uint32_t *shared = take(s, s->count - first, sizeof *shared);
	for (uint32_t n = first + 1; n < s->count; n++)
		s->parent[n] = first;
	for (uint32_t i = 3 * mesh->member_first[component]; i < 3 * mesh->member_first[component + 1]; i++) {
		uint32_t t = mesh->member[i / 3], v = vertex_of(s, t, i % 3), n = s->of[t],
			below = n > first ? neighbour(s, v, t, true, n) : ECO_NONE;
		if (below == ECO_NONE)
			continue;
		if (!shared[n - first]++)
			s->parent[n] = s->of[below];
		s->connector[n] = lod_v3_add(s->connector[n], place_of(s, v));
	}
	for (uint32_t n = first + 1; n < s->count; n++)
		s->connector[n] = shared[n - first] ? lod_v3_scale(s->connector[n], 1.0 / shared[n - first])
			: s->connector[first];
	lod_arena_release(s->arena, mark);
}

static void add_component(struct skeleton *s, uint32_t component)
{
	const struct lod_mesh *mesh = s->mesh;
	const struct link *link = &s->link[component];
	uint32_t first = s->count, own = mesh->index[link->own];
	s->parent[first] = link->parent == ECO_NONE ? ECO_NONE : s->of[link->parent / 3];
	s->connector[first] = place_of(s, own);
	if (s->extent[component] > 2 * NODE) {
		measure(s, component, own);
		make_nodes(s, component);
		link_nodes(s, component, first);
		return;
	}
	for (uint32_t i = mesh->member_first[component]; i < mesh->member_first[component + 1]; i++)
		s->of[mesh->member[i]] = first;
	s->count++;
}

/* ---- The binary tree ----
 *
 * Siblings are halved by the median of their middles along the axis in which these are widest, with a node
 * without faces for each half: so a bough with a hundred leaves can be cut evenly. */

struct growth {
	struct skeleton *s;
	struct billboard_tree *tree;
	/* per node of the skeleton: its own faces, and all that hangs on it; center times area */
	struct shape { struct lod_v3 center; double area; } *own, *below;
	uint32_t *child_first, *child;
	uint32_t *place;             /* node of the skeleton -> node of the tree */
};

static struct lod_v3 middle_of(const struct growth *g, const struct shape *shape, uint32_t node)
{
	return shape->area > 0 ? lod_v3_scale(shape->center, 1 / shape->area) : g->s->connector[node];
}

static void measure_shapes(struct growth *g)
{
	struct skeleton *s = g->s;
	g->own = take(s, s->count, sizeof *g->own);
	g->below = take(s, s->count, sizeof *g->below);
	for (uint32_t t = 0; t < s->mesh->triangle_count; t++) {
		struct shape *shape = &g->own[s->of[t]];
		double area = lod_v3_length(lod_mesh_area_normal(s->mesh, t));
		for (uint32_t k = 0; k < 3; k++)
			shape->center = lod_v3_add(shape->center,
				lod_v3_scale(lod_mesh_corner(s->mesh, t, k), area / 3));
		shape->area += area;
	}
	memcpy(g->below, g->own, s->count * sizeof *g->below);
	for (uint32_t i = s->count; i-- > 1;) {
		struct shape *to = &g->below[s->parent[i]];
		to->center = lod_v3_add(to->center, g->below[i].center);
		to->area += g->below[i].area;
	}
}

/* Sorts siblings along their widest axis. */
static void sort_siblings(struct growth *g, uint32_t *child, uint32_t count)
{
	double low[3] = { 1e9, 1e9, 1e9 }, high[3] = { -1e9, -1e9, -1e9 };
	struct lod_arena_piece *mark = g->s->arena->last;
	struct lod_keyed *items = take(g->s, count, sizeof *items);
	int axis = 0;
	for (int k = 0; k < 3; k++) {
		for (uint32_t i = 0; i < count; i++) {
			double at = lod_v3_axis(middle_of(g, &g->below[child[i]], child[i]), k);
			low[k] = fmin(low[k], at);
			high[k] = fmax(high[k], at);
		}
		axis = high[k] - low[k] > high[axis] - low[axis] ? k : axis;
	}
	for (uint32_t i = 0; i < count; i++)
		items[i] = (struct lod_keyed){ lod_sort_key(lod_v3_axis(middle_of(g, &g->below[child[i]],
			child[i]), axis)), child[i] };
	lod_sort(g->s->arena, items, count);
	for (uint32_t i = 0; i < count; i++)
		child[i] = items[i].value;
	lod_arena_release(g->s->arena, mark);
}

static uint32_t new_node(struct growth *g, uint32_t parent, struct lod_v3 connector)
{
	uint32_t node = g->tree->count++;
	g->tree->parent[node] = parent;
	g->tree->connector[node] = connector;
	return node;
}

static void place_node(struct growth *g, uint32_t node, uint32_t parent);

static void place_siblings(struct growth *g, uint32_t *child, uint32_t count, uint32_t parent)
{
	if (count > 2)
		sort_siblings(g, child, count);
	for (uint32_t i = 0, half; i < count; i += half) {
		half = i || count < 2 ? count - i : count / 2;
		if (half == 1) {
			place_node(g, child[i], parent);
			continue;
		}
		uint32_t node = new_node(g, parent, g->tree->connector[parent]);
		place_siblings(g, child + i, half, node);
		g->tree->end[node] = g->tree->count;
	}
}

/* Recursion is as deep as chains are long. */
static void place_node(struct growth *g, uint32_t node, uint32_t parent)
{
	uint32_t at = g->place[node] = new_node(g, parent, g->s->connector[node]);
	g->tree->area[at] = g->own[node].area;
	g->tree->center[at] = middle_of(g, &g->own[node], node);
	place_siblings(g, g->child + g->child_first[node], g->child_first[node + 1] - g->child_first[node],
		at);
	g->tree->end[at] = g->tree->count;
}

static void sort_faces(struct growth *g)
{
	const struct lod_mesh *mesh = g->s->mesh;
	struct billboard_tree *tree = g->tree;
	uint32_t n = mesh->triangle_count, node = 0;
	struct lod_keyed *items = take(g->s, n, sizeof *items);
	for (uint32_t t = 0; t < n; t++)
		items[t] = (struct lod_keyed){ g->place[g->s->of[t]], t };
	lod_sort(g->s->arena, items, n);
	for (uint32_t i = 0; i < n; i++) {
		uint32_t t = items[i].value;
		struct lod_v3 normal = lod_mesh_area_normal(mesh, t);
		if (!(lod_v3_length(normal) > 0))
			continue;
		while (node < items[i].key)
			tree->face_first[++node] = tree->face_count;
		tree->faces[tree->face_count++] = (struct billboard_face){ .normal = lod_v3_unit(normal),
			.area = lod_v3_length(normal), .triangle = t, .corner = { lod_mesh_corner(mesh, t, 0),
			lod_mesh_corner(mesh, t, 1), lod_mesh_corner(mesh, t, 2) } };
	}
	while (node < tree->count)
		tree->face_first[++node] = tree->face_count;
}

void billboard_tree_make(struct billboard_tree *tree, const struct lod_mesh *mesh, struct lod_arena *arena)
{
	uint32_t n = mesh->component_count, most = mesh->triangle_count, room = 2 * most + 1;
	struct skeleton s = { .mesh = mesh, .arena = arena };
	*tree = (struct billboard_tree){ .parent = take(&s, room, sizeof *tree->parent),
		.end = take(&s, room, sizeof *tree->end),
		.face_first = take(&s, (size_t)room + 1, sizeof *tree->face_first),
		.connector = take(&s, room, sizeof *tree->connector), .center = take(&s, room,
			sizeof *tree->center),
		.area = take(&s, room, sizeof *tree->area), .sigma = take(&s, room, sizeof *tree->sigma),
		.faces = take(&s, most, sizeof *tree->faces) };
	if (!n)
		return;
	struct lod_arena_piece *mark = arena->last;
	uint32_t *order = take(&s, n, sizeof *order);
	s.extent = take(&s, n, sizeof *s.extent);
	s.link = take(&s, n, sizeof *s.link);
	attach_all(&s, order);
	s.parent = take(&s, most, sizeof *s.parent);
	s.of = take(&s, most, sizeof *s.of);
	s.connector = take(&s, most, sizeof *s.connector);
	s.distance = take(&s, mesh->vertex_count, sizeof *s.distance);
	s.stamp = take(&s, mesh->vertex_count, sizeof *s.stamp);
	s.level = take(&s, most, sizeof *s.level);
	s.set = take(&s, most, sizeof *s.set);
	s.heap = take(&s, 9 * (size_t)most + 1,
		sizeof *s.heap);         /* each edge from each triangle and end */
	s.around_first = list_by(&s, mesh->index, 3 * most, mesh->vertex_count, &s.around);
	for (uint32_t i = 0; i < n; i++)
		add_component(&s, order[i]);
	struct growth g = { .s = &s, .tree = tree, .place = take(&s, s.count, sizeof *g.place) };
	g.child_first = list_by(&s, s.parent, s.count, s.count, &g.child);
	measure_shapes(&g);
	place_node(&g, 0, ECO_NONE);
	sort_faces(&g);
	lod_arena_release(arena, mark);
}
