/* Nodes of the skeleton: the level sets of the distance along the surface from where a component hangs (Kratt
 * 2014, 3.1: extruded elements become chains of graph nodes). A tube becomes a chain of rings, one that forks
 * becomes a chain that forks; what is shorter than a node, such as a leaf, is one node. */
#include <math.h>

#include "ecofiles/base/union.h"
#include "lod/sort.h"
#include "tests/bench/baseline/billboard_state.h"

struct skeleton {
	struct billboard_nodes *nodes;
	const struct lod_mesh *mesh;
	struct lod_arena *arena;
	double length;
	const struct billboard_link *link;
	uint32_t *around_first, *around;     /* triangles at a vertex */
	double *distance;            /* per vertex, of the component at hand */
	uint32_t *stamp;             /* per vertex: 1 + the component that `distance` is of */
	uint32_t *level, *set;       /* per triangle: its level; union-find over those that are one node */
	struct lod_heap_item *heap;
	uint32_t heap_count;
};

static uint32_t vertex_of(const struct skeleton *s, uint32_t triangle, uint32_t k)
{
	return s->mesh->index[3 * (size_t)triangle + k];
}

static struct lod_v3 place_of(const struct skeleton *s, uint32_t vertex)
{
	return lod_v3_of(s->mesh->place + 3 * (size_t)vertex);
}

static void list_around(struct skeleton *s)
{
	const struct lod_mesh *mesh = s->mesh;
	size_t n = 3 * (size_t)mesh->triangle_count;
	s->around_first = lod_arena_take(s->arena, (size_t)mesh->vertex_count + 2, sizeof *s->around_first);
	s->around = lod_arena_take(s->arena, n, sizeof *s->around);
	for (size_t i = 0; i < n; i++)
		s->around_first[mesh->index[i] + 2]++;
	for (uint32_t v = 0; v < mesh->vertex_count; v++)
		s->around_first[v + 2] += s->around_first[v + 1];
	for (size_t i = 0; i < n; i++)
		s->around[s->around_first[mesh->index[i] + 1]++] = (uint32_t)(i / 3);
}

/* ---- Distances along the surface ---- */

static void reach(struct skeleton *s, uint32_t component, uint32_t vertex, double distance)
{
	if (s->stamp[vertex] == component + 1 && s->distance[vertex] <= distance)
		return;
	s->stamp[vertex] = component + 1;
	s->distance[vertex] = distance;
	billboard_heap_push(s->heap, &s->heap_count, -distance, vertex);
}

/* Dijkstra over edges. */
static void measure(struct skeleton *s, uint32_t component, uint32_t from)
{
	s->heap_count = 0;
	reach(s, component, from, 0);
	while (s->heap_count > 0) {
		double at = -s->heap[0].key;
		uint32_t v = billboard_heap_pop(s->heap, &s->heap_count);
		if (at > s->distance[v])
			continue;
		for (uint32_t i = s->around_first[v]; i < s->around_first[v + 1]; i++)
			for (uint32_t k = 0; k < 3 && s->mesh->component[s->around[i]] == component; k++) {
				uint32_t to = vertex_of(s, s->around[i], k);
				reach(s, component, to,
					at + lod_v3_distance(place_of(s, v), place_of(s, to)));
			}
	}
}

/* ---- Levels ---- */

static double nearest(const struct skeleton *s, uint32_t triangle)
{
	return fmin(s->distance[vertex_of(s, triangle, 0)], fmin(s->distance[vertex_of(s, triangle, 1)],
		s->distance[vertex_of(s, triangle, 2)]));
}

/* Triangles of one level that share a vertex are of one node. */
static void join_levels(struct skeleton *s, uint32_t component)
{
	const struct lod_mesh *mesh = s->mesh;
	for (uint32_t i = mesh->member_first[component]; i < mesh->member_first[component + 1]; i++) {
		uint32_t t = mesh->member[i];
		s->level[t] = (uint32_t)(nearest(s, t) / s->length);
		s->set[t] = t;
	}
	for (uint32_t i = mesh->member_first[component]; i < mesh->member_first[component + 1]; i++)
		for (uint32_t k = 0; k < 3; k++) {
			uint32_t t = mesh->member[i], v = vertex_of(s, t, k);
			for (uint32_t j = s->around_first[v]; j < s->around_first[v + 1]; j++) {
				uint32_t other = s->around[j];
				if (mesh->component[other] != component || s->level[other] != s->level[t])
					continue;
				eco_union_join(s->set, t, other);      /* the first: all join that one */
				break;
			}
		}
}

static uint32_t number_sets(struct skeleton *s, uint32_t component, struct lod_keyed *slices)
{
	const struct lod_mesh *mesh = s->mesh;
	uint32_t count = 0;
	for (uint32_t i = mesh->member_first[component]; i < mesh->member_first[component + 1]; i++) {
		uint32_t t = mesh->member[i], root = eco_union_root(s->set, t);
		double d = nearest(s, t);
		if (root == t) {
			s->nodes->of[t] = count;
			slices[count++] = (struct lod_keyed){ lod_sort_key(d), t };
		}
		/* roots are the first of their sets */
		struct lod_keyed *slice = &slices[s->nodes->of[root]];
		uint64_t key = lod_sort_key(d);
		slice->key = key < slice->key ? key : slice->key;
	}
	return count;
}

static void name_nodes(struct skeleton *s, uint32_t component, uint32_t first)
{
	const struct lod_mesh *mesh = s->mesh;
	uint32_t members = mesh->member_first[component + 1] - mesh->member_first[component];
	struct lod_arena_piece *mark = s->arena->last;
	struct lod_keyed *slices = lod_arena_take(s->arena, members, sizeof *slices);
	uint32_t count = number_sets(s, component, slices);
	lod_sort(s->arena, slices, count);
	for (uint32_t i = 0; i < count; i++)
		s->nodes->of[slices[i].value] = first + i;
	for (uint32_t i = mesh->member_first[component]; i < mesh->member_first[component + 1]; i++) {
		uint32_t t = mesh->member[i];
		s->nodes->of[t] = s->nodes->of[eco_union_root(s->set, t)];
	}
	s->nodes->count = first + count;
	lod_arena_release(s->arena, mark);
}

/* A node's parent is one of the level below that it touches: the first that is found; it is connected in the
 * middle of what they share. */
static void link_nodes(struct skeleton *s, uint32_t component, uint32_t first)
{
	const struct lod_mesh *mesh = s->mesh;
	struct billboard_nodes *nodes = s->nodes;
	struct lod_arena_piece *mark = s->arena->last;
	uint32_t *shared = lod_arena_take(s->arena, nodes->count - first, sizeof *shared);
	for (uint32_t n = first + 1; n < nodes->count; n++)
		nodes->parent[n] = first;
	for (uint32_t i = mesh->member_first[component]; i < mesh->member_first[component + 1]; i++)
		for (uint32_t k = 0; k < 3; k++) {
			uint32_t t = mesh->member[i], v = vertex_of(s, t, k), n = nodes->of[t],
				below = ECO_NONE;
			for (uint32_t j = s->around_first[v]; j < s->around_first[v + 1] && n > first; j++) {
				uint32_t other = s->around[j];
				if (mesh->component[other] == component && s->level[other] < s->level[t]
						&& nodes->of[other] < n) {
					below = nodes->of[other];
					break;
				}
			}
			if (below == ECO_NONE)
				continue;
			if (!shared[n - first]++)
				nodes->parent[n] = below;
			nodes->connector[n] = lod_v3_add(nodes->connector[n], place_of(s, v));
		}
	for (uint32_t n = first + 1; n < nodes->count; n++)
		if (shared[n - first])
			nodes->connector[n] = lod_v3_scale(nodes->connector[n], 1.0 / shared[n - first]);
		else
			nodes->connector[n] = nodes->connector[first];
	lod_arena_release(s->arena, mark);
}

/* ---- Components ---- */

static double extent_of(const struct skeleton *s, uint32_t component)
{
	const struct lod_mesh *mesh = s->mesh;
	struct lod_v3 low = { 1e9, 1e9, 1e9 }, high = { -1e9, -1e9, -1e9 };
	for (uint32_t i = mesh->member_first[component]; i < mesh->member_first[component + 1]; i++)
		for (uint32_t k = 0; k < 3; k++) {
			struct lod_v3 p = place_of(s, vertex_of(s, mesh->member[i], k));
			low = (struct lod_v3){ fmin(low.x, p.x), fmin(low.y, p.y), fmin(low.z, p.z) };
			high = (struct lod_v3){ fmax(high.x, p.x), fmax(high.y, p.y), fmax(high.z, p.z) };
		}
	return lod_v3_distance(low, high);
}

static void add_component(struct skeleton *s, uint32_t component)
{
	const struct lod_mesh *mesh = s->mesh;
	struct billboard_nodes *nodes = s->nodes;
	const struct billboard_link *link = &s->link[component];
	uint32_t first = nodes->count, own = mesh->index[link->own];
	nodes->parent[first] = link->parent == ECO_NONE ? ECO_NONE : nodes->of[link->parent / 3];
	nodes->connector[first] = place_of(s, own);
	if (extent_of(s, component) > 2 * s->length) {
		measure(s, component, own);
		join_levels(s, component);
		name_nodes(s, component, first);
		link_nodes(s, component, first);
		return;
	}
	for (uint32_t i = mesh->member_first[component]; i < mesh->member_first[component + 1]; i++)
		nodes->of[mesh->member[i]] = first;
	nodes->count++;
}

void billboard_nodes_make(struct billboard_nodes *nodes, const struct lod_mesh *mesh, double length,
	struct lod_arena *arena)
{
	uint32_t n = mesh->component_count, most = mesh->triangle_count;
	struct skeleton s = { .nodes = nodes, .mesh = mesh, .arena = arena, .length = length };
	*nodes = (struct billboard_nodes){ .parent = lod_arena_take(arena, most, sizeof *nodes->parent),
		.connector = lod_arena_take(arena, most, sizeof *nodes->connector),
		.of = lod_arena_take(arena, most, sizeof *nodes->of) };
	struct lod_arena_piece *mark = arena->last;
	struct billboard_link *link = lod_arena_take(arena, n, sizeof *link);
	uint32_t *order = lod_arena_take(arena, n, sizeof *order);
	billboard_attach(mesh, link, order, arena);
	s.link = link;
	s.distance = lod_arena_take(arena, mesh->vertex_count, sizeof *s.distance);
	s.stamp = lod_arena_take(arena, mesh->vertex_count, sizeof *s.stamp);
	s.level = lod_arena_take(arena, most, sizeof *s.level);
	s.set = lod_arena_take(arena, most, sizeof *s.set);
	/* each edge pushes at most once from each triangle and end */
	s.heap = lod_arena_take(arena, 9 * (size_t)most + 1, sizeof *s.heap);
	list_around(&s);
	for (uint32_t i = 0; i < n; i++)
		add_component(&s, order[i]);
	lod_arena_release(arena, mark);
}
