/* The forest, its line of places, and sectors. A heap holds every leaf with its best partner. Where that
 * partner is gone by the time the leaf comes up, the next best is looked for then, and not before: the leaf's
 * cost only rises by that. A new quad looks for its best partner among all that are there. So the pair that
 * comes up is the cheapest of all. */
#include "tests/bench/baseline/leaf_collapse.h"

#include <string.h>

#include "lod/heap.h"
#include "lod/sort.h"
#include "tests/bench/baseline/leaf_collapse_state.h"

const struct lod_collapse_options lod_collapse_defaults = { .weight = { 1, 0.25, 1, 0.5, 0.1 },
	.distance_most = 0.12, .angle_most_rad = LOD_PI * 4 / 9 };

/* ---- The forest ---- */

struct work {
	struct lod_collapse *collapse;
	struct lod_collapse_search search;
	struct lod_heap_item *heap;
	uint32_t heap_count, *partner;
};

/* The leaf at the top has this partner from now on, or leaves the heap. */
static void settle(struct work *w, uint32_t id)
{
	double cost;
	w->partner[id] = lod_collapse_search_best(&w->search, id, &cost);
	if (w->partner[id] != ECO_NONE)
		w->heap[0] = (struct lod_heap_item){ -cost, id };
	else
		w->heap[0] = w->heap[--w->heap_count];
	lod_heap_sift(w->heap, w->heap_count, 0);
}

static void start(struct work *w, uint32_t count)
{
	for (uint32_t i = 0; i < count; i++) {
		double cost;
		w->partner[i] = lod_collapse_search_best(&w->search, i, &cost);
		if (w->partner[i] != ECO_NONE)
			w->heap[w->heap_count++] = (struct lod_heap_item){ -cost, i };
	}
	lod_heap_make(w->heap, w->heap_count);
}

static void run(struct work *w, const struct lod_collapse_leaves *leaves)
{
	while (w->heap_count) {
		uint32_t id = w->heap[0].id, other = w->partner[id];
		if (w->search.dead[id]) {
			w->heap[0] = w->heap[--w->heap_count];
			lod_heap_sift(w->heap, w->heap_count, 0);
		} else if (w->search.dead[other]) {
			settle(w, id);
		} else {
			lod_collapse_pair(w->collapse, leaves, id, other);
			lod_collapse_search_remove(&w->search, id);
			lod_collapse_search_remove(&w->search, other);
			uint32_t made = leaves->count + w->collapse->made - 1;
			lod_collapse_search_add(&w->search, made);
			settle(w, made);
		}
	}
}

/* crown NULL: that of these leaves. */
static void make_in(struct lod_collapse *collapse, const struct lod_collapse_leaves *leaves,
	const struct lod_collapse_crown *crown, const struct lod_collapse_options *options,
	struct lod_arena *arena)
{
	size_t n = leaves->count, room = n ? 2 * n - 1 : 0;
	*collapse = (struct lod_collapse){ .leaves = leaves->count,
		.node = lod_arena_take(arena, room, sizeof *collapse->node) };
	for (uint32_t i = 0; i < leaves->count; i++)
		lod_collapse_node_of(&collapse->node[i], leaves, i);
	struct lod_arena_piece *mark = arena->last;
	struct work w = { .collapse = collapse, .heap = lod_arena_take(arena, n, sizeof *w.heap),
		.partner = lod_arena_take(arena, room, sizeof *w.partner) };
	if (crown)
		w.search.crown = *crown;
	else
		lod_collapse_extent(&w.search.crown, collapse->node, leaves);
	lod_collapse_search_make(&w.search, collapse, options ? options : &lod_collapse_defaults,
		(uint32_t)room, leaves->count, arena);
	start(&w, leaves->count);
	run(&w, leaves);
	lod_arena_release(arena, mark);
	lod_collapse_place(collapse, arena);
}

void lod_collapse_make(struct lod_collapse *collapse, const struct lod_collapse_leaves *leaves,
	const struct lod_collapse_options *options, struct lod_arena *arena)
{
	make_in(collapse, leaves, NULL, options, arena);
}

/* ---- Places ---- */

struct line { uint32_t p, q; };      /* the first free place of each kind */

static void place(struct lod_collapse *collapse, struct line *line, uint32_t id)
{
	collapse->place[id < collapse->leaves ? line->p++ : line->q++] = id;
}

/* Roots that were made last are placed first: they are the largest. */
void lod_collapse_place(struct lod_collapse *collapse, struct lod_arena *arena)
{
	uint32_t n = collapse->leaves, nodes = n + collapse->made;
	struct line line = { 0, n };
	collapse->place = lod_arena_take(arena, nodes, sizeof *collapse->place);
	collapse->level = lod_arena_take(arena, (size_t)collapse->made + 1, sizeof *collapse->level);
	for (uint32_t i = nodes; i-- > 0;)
		if (collapse->node[i].parent == ECO_NONE)
			place(collapse, &line, i);
	collapse->roots = line.p + line.q - n;
	collapse->level[0] = (struct lod_collapse_level){ line.p, n, line.q - n };
	for (uint32_t i = 0; i < collapse->made; i++) {
		const struct lod_collapse_node *split = &collapse->node[collapse->place[n + i]];
		place(collapse, &line, split->child[0]);
		place(collapse, &line, split->child[1]);
		uint32_t b = n + i + 1;
		collapse->level[i + 1] = (struct lod_collapse_level){ line.p, b, line.q - b };
	}
}

const struct lod_collapse_level *lod_collapse_level_of(const struct lod_collapse *collapse, uint32_t count)
{
	uint32_t i = count > collapse->roots ? count - collapse->roots : 0;
	return &collapse->level[i < collapse->made ? i : collapse->made];
}

/* The leaves below a node: down to the first child, then on to the next that is not done. */
static void show_below(const struct lod_collapse *collapse, uint32_t root, uint32_t *shown)
{
	uint32_t id = root, from = ECO_NONE;
	for (;;) {
		const struct lod_collapse_node *node = &collapse->node[id];
		uint32_t next = id < collapse->leaves || from == node->child[1] ? ECO_NONE
			: from == node->child[0] ? node->child[1] : node->child[0];
		if (id < collapse->leaves)
			shown[id] = root;
		if (next == ECO_NONE && id == root)
			return;
		from = next == ECO_NONE ? id : ECO_NONE;
		id = next == ECO_NONE ? node->parent : next;
	}
}

void lod_collapse_shown(const struct lod_collapse *collapse, const struct lod_collapse_level *level,
	uint32_t *shown)
{
	for (uint32_t i = 0; i < level->a; i++)
		show_below(collapse, collapse->place[i], shown);
	for (uint32_t i = level->b; i < level->b + level->c; i++)
		show_below(collapse, collapse->place[i], shown);
}

/* ---- Sectors ---- */

/* Grows with the angle around the axis, from 0 to 4, without libm. */
static double turn_of(double x, double y)
{
	double sum = fabs(x) + fabs(y), t = sum > 0 ? y / sum : 0;
	return x < 0 ? 2 - t : t < 0 ? 4 + t : t;
}

static void sort_leaves(uint32_t *leaf, const double *key, uint32_t count, struct lod_arena *arena)
{
	struct lod_arena_piece *mark = arena->last;
	struct lod_keyed *items = lod_arena_take(arena, count, sizeof *items);
	for (uint32_t i = 0; i < count; i++)
		items[i] = (struct lod_keyed){ lod_sort_key(key[leaf[i]]), leaf[i] };
	lod_sort(arena, items, count);
	for (uint32_t i = 0; i < count; i++)
		leaf[i] = items[i].value;
	lod_arena_release(arena, mark);
}

/* leaf[] becomes sector after sector. Writes the whole crown's extent. */
static void divide(struct lod_collapse_sectors *sectors, const struct lod_collapse_leaves *leaves,
	struct lod_collapse_crown *crown, struct lod_arena *arena)
{
	uint32_t n = leaves->count;
	struct lod_arena_piece *mark = arena->last;
	struct lod_collapse_node *node = lod_arena_take(arena, n, sizeof *node);
	double *away = lod_arena_take(arena, n, sizeof *away), *turn = lod_arena_take(arena, n, sizeof *turn);
	for (uint32_t i = 0; i < n; i++) {
		lod_collapse_node_of(&node[i], leaves, i);
		double x = node[i].center.x - leaves->axis_x, y = node[i].center.y - leaves->axis_y;
		away[i] = x * x + y * y;
		turn[i] = turn_of(x, y);
		sectors->leaf[i] = i;
	}
	for (uint32_t s = 0; s <= sectors->count; s++)
		sectors->first[s] = (uint32_t)((uint64_t)n * s / sectors->count);
	sort_leaves(sectors->leaf, away, n, arena);
	sort_leaves(sectors->leaf + sectors->first[1], turn, n - sectors->first[1], arena);
	lod_collapse_extent(crown, node, leaves);
	lod_arena_release(arena, mark);
}

static void copy_leaves(struct lod_collapse_leaves *to, const struct lod_collapse_leaves *from,
	const uint32_t *leaf, uint32_t count, struct lod_arena *arena)
{
	size_t corners = 0;
	for (uint32_t i = 0; i < count; i++)
		corners += from->first[leaf[i] + 1] - from->first[leaf[i]];
	uint32_t *first = lod_arena_take(arena, (size_t)count + 1, sizeof *first);
	float (*corner)[3] = lod_arena_take(arena, corners, sizeof *corner);
	double *area = from->opaque_area ? lod_arena_take(arena, count, sizeof *area) : NULL;
	for (uint32_t i = 0; i < count; i++) {
		uint32_t at = from->first[leaf[i]], size = from->first[leaf[i] + 1] - at;
		memcpy(corner + first[i], from->corner + at, size * sizeof *corner);
		first[i + 1] = first[i] + size;
		if (area)
			area[i] = from->opaque_area[leaf[i]];
	}
	*to = (struct lod_collapse_leaves){ count, first, (const float (*)[3])corner, area, from->axis_x,
		from->axis_y };
}

void lod_collapse_sectors_make(struct lod_collapse_sectors *sectors, uint32_t count,
	const struct lod_collapse_leaves *leaves, const struct lod_collapse_options *options,
	struct lod_arena *arena)
{
	*sectors = (struct lod_collapse_sectors){ .count = count,
		.first = lod_arena_take(arena, (size_t)count + 1, sizeof *sectors->first),
		.leaf = lod_arena_take(arena, leaves->count, sizeof *sectors->leaf),
		.forest = lod_arena_take(arena, count, sizeof *sectors->forest),
		.leaves = lod_arena_take(arena, count, sizeof *sectors->leaves) };
	struct lod_collapse_crown crown;
	divide(sectors, leaves, &crown, arena);
	for (uint32_t s = 0; s < count; s++) {
		uint32_t first = sectors->first[s];
		copy_leaves(&sectors->leaves[s], leaves, sectors->leaf + first, sectors->first[s + 1] - first,
			arena);
		make_in(&sectors->forest[s], &sectors->leaves[s], &crown, options, arena);
	}
}
