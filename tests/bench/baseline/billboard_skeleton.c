/* The skeleton (Kratt 2014, 3.1): extruded elements become chains of graph nodes, chains are connected at
 * points of overlap. It becomes a binary tree in preorder, with its faces. */
#include <string.h>

#include "ecofiles/base/status.h"
#include "ecofiles/base/union.h"
#include "tests/bench/baseline/billboard_cloud.h"

#define NODE (1.0 / 64)              /* length of a node */
#define CELL_FIRST (1.0 / 128)
#define TRUNK_BELOW 0.05             /* the trunk begins this near the ground */

struct skeleton {
	const struct lod_mesh *mesh;
	struct lod_arena *arena;
	double *extent;              /* per component */
	/* how a component hangs on the one that bears it: a corner (3 * triangle + k) of each; ECO_NONE: a
	 * root */
	struct link { uint32_t parent, own; } *link;
	/* nodes of chains; a parent is smaller than the node's own number, ECO_NONE for node 0 */
	uint32_t count, *parent, *of;        /* of: per triangle */
	struct lod_v3 *connector;            /* where it meets its parent */
	uint32_t *around_first, *around;     /* corners at a vertex */
	uint32_t *level, *set;       /* per triangle: its level; union-find over those that are one node */
};

static void *take(struct skeleton *s, size_t count, size_t size)
{
	return lod_arena_take(s->arena, count, size);
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
 * Each component hangs on the nearest that is larger. One corner of a component stands for all its corners in
 * a cell; what finds no larger one in the cells around its own looks in cells twice as wide, and so on.
 * Nearness counts in half cells, and among the equally near the largest bears: a leaf hangs on its twig and
 * not on the leaf beside it. */

struct rep { uint32_t corner, component; };
struct cells {
	double side;
	struct lod_keyed *cells;     /* by key; value: the first rep; one more ends the last */
	uint32_t count;
	struct rep *reps;            /* by cell */
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

static void make_cells(struct skeleton *s, struct cells *c, double side)
{
	const struct lod_mesh *mesh = s->mesh;
	uint32_t n = 3 * mesh->triangle_count, reps = 0;
	struct lod_keyed *items = take(s, n, sizeof *items);
	*c = (struct cells){ side, take(s, (size_t)n + 1, sizeof *c->cells), 0, take(s, n, sizeof *c->reps) };
	/* in the order of components, which the sort keeps within a cell */
	for (uint32_t i = 0; i < n; i++) {
		uint32_t corner = 3 * mesh->member[i / 3] + i % 3;
		items[i] = (struct lod_keyed){ billboard_cell(corner_at(s, corner), side, 0, 0, 0), corner };
	}
	lod_sort(s->arena, items, n);
	for (uint32_t i = 0; i < n; i++) {
		uint32_t of = mesh->component[items[i].value / 3];
		bool new_cell = i == 0 || items[i].key != items[i - 1].key;
		if (new_cell)
			c->cells[c->count++] = (struct lod_keyed){ items[i].key, reps };
		if (new_cell || c->reps[reps - 1].component != of)
			c->reps[reps++] = (struct rep){ items[i].value, of };
	}
	c->cells[c->count].value = reps;
}

/* Links a component to the nearest that comes before it in the order, if cells around its corners have one. */
static bool hang(struct skeleton *s, const struct cells *c, const uint32_t *place, uint32_t component)
{
	const uint32_t *member_first = s->mesh->member_first;
	uint32_t least = ECO_NONE, bearer = ECO_NONE;
	for (uint32_t i = 27 * 3 * member_first[component]; i < 27 * 3 * member_first[component + 1]; i++) {
		uint32_t own = 3 * s->mesh->member[i / 81] + i / 27 % 3, k = i % 27;
		struct lod_v3 at = corner_at(s, own);
		uint64_t key = billboard_cell(at, c->side, (int)(k % 3) - 1, (int)(k / 3 % 3) - 1, (int)(k / 9) - 1);
		uint32_t cell = billboard_find(c->cells, c->count, key);
		if (cell == c->count || c->cells[cell].key != key)
			continue;
		for (uint32_t r = c->cells[cell].value; r < c->cells[cell + 1].value; r++) {
			const struct rep *to = &c->reps[r];
			if (place[to->component] >= place[component])
				continue;
			uint32_t near = (uint32_t)(2 * lod_v3_distance(at, corner_at(s, to->corner)) / c->side);
			if (near > least || (near == least && place[to->component] >= place[bearer]))
				continue;
			least = near;
			bearer = to->component;
			s->link[component] = (struct link){ to->corner, own };
		}
	}
	return bearer != ECO_NONE;
}

/* Fills `order` with all components, the trunk first, then the largest, and links. */
static void attach_all(struct skeleton *s, uint32_t *order)
{
	uint32_t n = s->mesh->component_count, left = n - 1, lowest = 0, trunk = find_trunk(s, &lowest),
		*place = take(s, n, sizeof *place);
	struct lod_keyed *items = take(s, n, sizeof *items);
	bool *hangs = take(s, n, sizeof *hangs);
	for (uint32_t c = 0; c < n; c++)
		items[c] = (struct lod_keyed){ c == trunk ? 0 : ~lod_sort_key(s->extent[c]), c };
	lod_sort(s->arena, items, n);
	for (uint32_t i = 0; i < n; i++) {
		order[i] = items[i].value;
		place[order[i]] = i;
	}
	s->link[trunk] = (struct link){ ECO_NONE, lowest };
	hangs[trunk] = true;
	for (double side = CELL_FIRST; left; side *= 2) {
		struct lod_arena_piece *mark = s->arena->last;
		struct cells cells;
		make_cells(s, &cells, side);
		for (uint32_t i = 1; i < n; i++)
			if (!hangs[order[i]] && hang(s, &cells, place, order[i])) {
				hangs[order[i]] = true;
				left--;
			}
		lod_arena_release(s->arena, mark);
	}
}

/* ---- Nodes: level sets of the distance from where a component hangs ----
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

static double nearest(const struct skeleton *s, uint32_t triangle, struct lod_v3 from)
{
	double least = INFINITY;
	for (uint32_t k = 0; k < 3; k++)
		least = fmin(least, lod_v3_distance(place_of(s, vertex_of(s, triangle, k)), from));
	return least;
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
static void make_nodes(struct skeleton *s, uint32_t component, struct lod_v3 from)
{
	const uint32_t *member = s->mesh->member + s->mesh->member_first[component];
	uint32_t members = s->mesh->member_first[component + 1] - s->mesh->member_first[component];
	struct lod_arena_piece *mark = s->arena->last;
	struct lod_keyed *items = take(s, members, sizeof *items);
	for (uint32_t i = 0; i < members; i++) {
		uint32_t t = member[i];
		s->level[t] = (uint32_t)(nearest(s, t, from) / NODE);
		s->set[t] = t;
		s->of[t] = ECO_NONE;
		items[i] = (struct lod_keyed){ lod_sort_key(nearest(s, t, from)), t };
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
		make_nodes(s, component, place_of(s, own));
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
	s.level = take(&s, most, sizeof *s.level);
	s.set = take(&s, most, sizeof *s.set);
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
