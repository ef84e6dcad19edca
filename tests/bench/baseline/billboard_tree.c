/* The skeleton as a binary tree in preorder, with its faces and how hidden each node is. Node 0 of the
 * skeleton is the root. Siblings are halved by the median of their middles along the axis in which these are
 * widest, with a node without faces for each half: so a bough with a hundred leaves can be cut evenly. */
#include "ecofiles/base/status.h"
#include "lod/sort.h"
#include "tests/bench/baseline/billboard_state.h"

struct shape { struct lod_v3 center; double area; };

struct growth {
	const struct billboard_nodes *nodes;
	struct billboard_tree *tree;
	struct lod_arena *arena;
	struct shape *below;         /* per node of the skeleton: all that hangs on it */
	uint32_t *child_first, *child;
	uint32_t *place;             /* node of the skeleton -> node of the tree */
	/* what is still to be placed: children [first, first + count) under a node of the tree */
	struct span { uint32_t first, count, parent; } *spans;
	uint32_t span_count;
};

static void list_children(struct growth *g)
{
	uint32_t n = g->nodes->count;
	g->child_first = lod_arena_take(g->arena, (size_t)n + 2, sizeof *g->child_first);
	g->child = lod_arena_take(g->arena, n, sizeof *g->child);
	for (uint32_t i = 1; i < n; i++)
		g->child_first[g->nodes->parent[i] + 2]++;
	for (uint32_t i = 0; i < n; i++)
		g->child_first[i + 2] += g->child_first[i + 1];
	for (uint32_t i = 1; i < n; i++)
		g->child[g->child_first[g->nodes->parent[i] + 1]++] = i;
}

static void measure(struct growth *g, const struct lod_mesh *mesh)
{
	for (uint32_t t = 0; t < mesh->triangle_count; t++) {
		struct shape *shape = &g->below[g->nodes->of[t]];
		double area = lod_v3_length(lod_mesh_area_normal(mesh, t));
		for (uint32_t k = 0; k < 3; k++)
			shape->center = lod_v3_add(shape->center,
				lod_v3_scale(lod_mesh_corner(mesh, t, k), area / 3));
		shape->area += area;
	}
	for (uint32_t i = g->nodes->count; i-- > 1;) {
		struct shape *to = &g->below[g->nodes->parent[i]];
		to->center = lod_v3_add(to->center, g->below[i].center);
		to->area += g->below[i].area;
	}
	for (uint32_t i = 0; i < g->nodes->count; i++)
		g->below[i].center = g->below[i].area > 0 ? lod_v3_scale(g->below[i].center,
			1 / g->below[i].area) : g->nodes->connector[i];
}

/* Sorts siblings along their widest axis. */
static void sort_span(struct growth *g, const struct span *span)
{
	double low[3] = { 1e9, 1e9, 1e9 }, high[3] = { -1e9, -1e9, -1e9 };
	struct lod_arena_piece *mark = g->arena->last;
	struct lod_keyed *items = lod_arena_take(g->arena, span->count, sizeof *items);
	uint32_t *child = g->child + span->first;
	int axis = 0;
	for (uint32_t i = 0; i < span->count; i++)
		for (int k = 0; k < 3; k++) {
			double x = lod_v3_axis(g->below[child[i]].center, k);
			low[k] = x < low[k] ? x : low[k];
			high[k] = x > high[k] ? x : high[k];
		}
	for (int k = 1; k < 3; k++)
		axis = high[k] - low[k] > high[axis] - low[axis] ? k : axis;
	for (uint32_t i = 0; i < span->count; i++)
		items[i] = (struct lod_keyed){ lod_sort_key(lod_v3_axis(g->below[child[i]].center, axis)),
			child[i] };
	lod_sort(g->arena, items, span->count);
	for (uint32_t i = 0; i < span->count; i++)
		child[i] = items[i].value;
	lod_arena_release(g->arena, mark);
}

static uint32_t new_node(struct growth *g, uint32_t parent, struct lod_v3 connector)
{
	uint32_t node = g->tree->count++;
	g->tree->parent[node] = parent;
	g->tree->connector[node] = connector;
	return node;
}

static void place_node(struct growth *g, uint32_t node, uint32_t parent)
{
	uint32_t at = new_node(g, parent, g->nodes->connector[node]),
		count = g->child_first[node + 1] - g->child_first[node];
	g->place[node] = at;
	if (count > 0)
		g->spans[g->span_count++] = (struct span){ g->child_first[node], count, at };
}

/* One child, or half of more than two, of the last span; what is left waits below it. */
static void place_next(struct growth *g)
{
	struct span span = g->spans[--g->span_count];
	if (span.count == 1) {
		place_node(g, g->child[span.first], span.parent);
		return;
	}
	if (span.count > 2)
		sort_span(g, &span);
	uint32_t half = span.count / 2;
	struct span rest = { span.first + half, span.count - half, span.parent };
	if (span.count > 2 && rest.count > 1)
		rest.count |= 1u << 31;
	g->spans[g->span_count++] = rest;
	if (half == 1) {
		place_node(g, g->child[span.first], span.parent);
		return;
	}
	uint32_t at = new_node(g, span.parent, g->tree->connector[span.parent]);
	g->spans[g->span_count++] = (struct span){ span.first, half, at };
}

static void place_all(struct growth *g)
{
	place_node(g, 0, ECO_NONE);
	while (g->span_count > 0) {
		struct span *last = &g->spans[g->span_count - 1];
		if (last->count >> 31) {     /* a second half, which needs a node of its own */
			last->count &= ~(1u << 31);
			last->parent = new_node(g, last->parent, g->tree->connector[last->parent]);
		}
		place_next(g);
	}
	struct billboard_tree *tree = g->tree;
	for (uint32_t i = tree->count; i-- > 0;) {
		tree->end[i] = tree->end[i] > i + 1 ? tree->end[i] : i + 1;
		if (i > 0 && tree->end[tree->parent[i]] < tree->end[i])
			tree->end[tree->parent[i]] = tree->end[i];
	}
}

/* ---- Faces ---- */

static bool make_face(struct billboard_face *face, const struct lod_mesh *mesh, uint32_t t)
{
	struct lod_v3 normal = lod_mesh_area_normal(mesh, t);
	face->area = lod_v3_length(normal);
	face->triangle = t;
	if (!(face->area > 0))
		return false;
	face->normal = lod_v3_scale(normal, 1 / face->area);
	for (uint32_t k = 0; k < 3; k++)
		face->corner[k] = lod_mesh_corner(mesh, t, k);
	return true;
}

static void sort_faces(struct growth *g, const struct lod_mesh *mesh)
{
	struct billboard_tree *tree = g->tree;
	uint32_t n = mesh->triangle_count, node = 0;
	struct lod_keyed *items = lod_arena_take(g->arena, n, sizeof *items);
	for (uint32_t t = 0; t < n; t++)
		items[t] = (struct lod_keyed){ g->place[g->nodes->of[t]], t };
	lod_sort(g->arena, items, n);
	for (uint32_t i = 0; i < n; i++) {
		struct billboard_face *face = &tree->faces[tree->face_count];
		if (!make_face(face, mesh, items[i].value))
			continue;
		while (node < items[i].key)
			tree->face_first[++node] = tree->face_count;
		tree->area[node] += face->area;
		for (uint32_t k = 0; k < 3; k++)
			tree->center[node] = lod_v3_add(tree->center[node],
				lod_v3_scale(face->corner[k], face->area / 3));
		tree->face_count++;
	}
	while (node < tree->count)
		tree->face_first[++node] = tree->face_count;
	for (uint32_t i = 0; i < tree->count; i++)
		if (tree->area[i] > 0)
			tree->center[i] = lod_v3_scale(tree->center[i], 1 / tree->area[i]);
}

static void take_tree(struct billboard_tree *tree, uint32_t room, uint32_t faces, struct lod_arena *arena)
{
	*tree = (struct billboard_tree){ .parent = lod_arena_take(arena, room, sizeof *tree->parent),
		.end = lod_arena_take(arena, room, sizeof *tree->end),
		.face_first = lod_arena_take(arena, (size_t)room + 1, sizeof *tree->face_first),
		.connector = lod_arena_take(arena, room, sizeof *tree->connector),
		.center = lod_arena_take(arena, room, sizeof *tree->center),
		.area = lod_arena_take(arena, room, sizeof *tree->area),
		.sigma = lod_arena_take(arena, room, sizeof *tree->sigma),
		.faces = lod_arena_take(arena, faces, sizeof *tree->faces) };
}

void billboard_tree_make(struct billboard_tree *tree, const struct billboard_nodes *nodes,
	const struct lod_mesh *mesh, struct lod_arena *arena)
{
	struct growth g = { .nodes = nodes, .tree = tree, .arena = arena };
	take_tree(tree, 2 * nodes->count + 1, mesh->triangle_count, arena);
	if (!nodes->count)
		return;
	struct lod_arena_piece *mark = arena->last;
	g.below = lod_arena_take(arena, nodes->count, sizeof *g.below);
	g.place = lod_arena_take(arena, nodes->count, sizeof *g.place);
	g.spans = lod_arena_take(arena, 2 * (size_t)nodes->count + 2, sizeof *g.spans);
	list_children(&g);
	measure(&g, mesh);
	place_all(&g);
	sort_faces(&g, mesh);
	lod_arena_release(arena, mark);
}
