/* The tree of components: from the trunk upwards each hangs on the nearest that hangs already (Kratt 2014,
 * 3.1: chains are connected at points of overlap).
 *
 * Prim's algorithm on corners in cells. Of each component one corner a cell stands for all that it has there;
 * a component that is taken looks for others in the cells around its own. What none has reached is looked for
 * in cells twice as wide, and so on. A cell is looked around again only for a much larger component, so the
 * work is linear in corners. Nearness counts in cells, and among the equally near the largest bears: a leaf
 * hangs on its twig and not on the leaf beside it. */
#include "lod/sort.h"
#include "tests/bench/baseline/billboard_state.h"

#define CELL_FIRST (1.0 / 128)
#define OFFSET 1048576.0             /* cells stay positive */
#define TRUNK_BELOW 0.05             /* the trunk begins this near the ground */
#define SURPASSES 2.0                /* extent of a component that looks around a cell again */

struct rep { uint32_t corner, component, cell; };

struct attach {
	const struct lod_mesh *mesh;
	struct billboard_link *link;
	struct lod_arena *arena;
	double *extent;
	bool *taken;
	uint32_t *near, *bearer;     /* cells away, and by which component, of what is not taken */
	struct lod_heap_item *heap;
	uint32_t heap_count, heap_room;
	/* of a level */
	double cell;
	struct rep *reps;            /* by cell */
	uint32_t rep_count, cell_count, *own_first, *own;        /* reps by component */
	uint64_t *cell_key;
	uint32_t *cell_first;
	double *seen;                /* extent of what looked around the cell */
};

static const float *corner_of(const struct lod_mesh *mesh, uint32_t corner)
{
	return mesh->place + 3 * (size_t)mesh->index[corner];
}

static void measure(struct attach *a)
{
	const struct lod_mesh *mesh = a->mesh;
	for (uint32_t c = 0; c < mesh->component_count; c++) {
		double low[3] = { 1e9, 1e9, 1e9 }, high[3] = { -1e9, -1e9, -1e9 };
		for (uint32_t i = mesh->member_first[c]; i < mesh->member_first[c + 1]; i++)
			for (uint32_t k = 0; k < 9; k++) {
				double x = corner_of(mesh, 3 * mesh->member[i] + k / 3)[k % 3];
				low[k % 3] = x < low[k % 3] ? x : low[k % 3];
				high[k % 3] = x > high[k % 3] ? x : high[k % 3];
			}
		struct lod_v3 box = { high[0] - low[0], high[1] - low[1], high[2] - low[2] };
		a->extent[c] = lod_v3_length(box);
		a->taken[c] = false;
		a->near[c] = ECO_NONE;
	}
}

/* The largest component that begins near the ground. */
static uint32_t find_trunk(const struct attach *a, uint32_t *lowest_corner)
{
	const struct lod_mesh *mesh = a->mesh;
	uint32_t best = 0;
	double best_extent = -1;
	for (uint32_t c = 0; c < mesh->component_count; c++) {
		uint32_t lowest = ECO_NONE;
		for (uint32_t i = mesh->member_first[c]; i < mesh->member_first[c + 1]; i++)
			for (uint32_t k = 0; k < 3; k++) {
				uint32_t corner = 3 * mesh->member[i] + k;
				if (lowest == ECO_NONE
						|| corner_of(mesh, corner)[2] < corner_of(mesh, lowest)[2])
					lowest = corner;
			}
		if (corner_of(mesh, lowest)[2] > mesh->low[2] + TRUNK_BELOW || !(a->extent[c] > best_extent))
			continue;
		best = c;
		best_extent = a->extent[c];
		*lowest_corner = lowest;
	}
	return best;
}

/* ---- Cells ---- */

static uint64_t cell_of(const struct attach *a, const float *at, int dx, int dy, int dz)
{
	uint64_t key = 0;
	const int step[3] = { dx, dy, dz };
	for (int k = 0; k < 3; k++)
		key = key << 21 | (uint64_t)(floor((double)at[k] / a->cell) + OFFSET + step[k]);
	return key;
}

static uint32_t find_cell(const struct attach *a, uint64_t key)
{
	uint32_t low = 0, high = a->cell_count;
	while (low < high) {
		uint32_t middle = low + (high - low) / 2;
		if (a->cell_key[middle] < key)
			low = middle + 1;
		else
			high = middle;
	}
	return low < a->cell_count && a->cell_key[low] == key ? low : ECO_NONE;
}

static void list_own(struct attach *a)
{
	uint32_t n = a->mesh->component_count;
	a->own_first = lod_arena_take(a->arena, (size_t)n + 2, sizeof *a->own_first);
	a->own = lod_arena_take(a->arena, a->rep_count, sizeof *a->own);
	for (uint32_t i = 0; i < a->rep_count; i++)
		a->own_first[a->reps[i].component + 2]++;
	for (uint32_t c = 0; c < n; c++)
		a->own_first[c + 2] += a->own_first[c + 1];
	for (uint32_t i = 0; i < a->rep_count; i++)
		a->own[a->own_first[a->reps[i].component + 1]++] = i;
}

static void make_level(struct attach *a, double cell)
{
	const struct lod_mesh *mesh = a->mesh;
	uint32_t n = 3 * mesh->triangle_count;
	struct lod_keyed *items = lod_arena_take(a->arena, n, sizeof *items);
	a->cell = cell;
	a->reps = lod_arena_take(a->arena, n, sizeof *a->reps);
	a->cell_key = lod_arena_take(a->arena, n, sizeof *a->cell_key);
	a->cell_first = lod_arena_take(a->arena, (size_t)n + 1, sizeof *a->cell_first);
	a->seen = lod_arena_take(a->arena, n, sizeof *a->seen);
	/* in the order of components, which the sort keeps within a cell */
	for (uint32_t i = 0; i < n; i++) {
		uint32_t corner = 3 * mesh->member[i / 3] + i % 3;
		items[i] = (struct lod_keyed){ cell_of(a, corner_of(mesh, corner), 0, 0, 0), corner };
	}
	lod_sort(a->arena, items, n);
	a->rep_count = a->cell_count = 0;
	for (uint32_t i = 0; i < n; i++) {
		uint32_t component = mesh->component[items[i].value / 3];
		bool same_cell = i > 0 && items[i].key == items[i - 1].key;
		if (!same_cell) {
			a->seen[a->cell_count] = -1;
			a->cell_key[a->cell_count] = items[i].key;
			a->cell_first[a->cell_count++] = a->rep_count;
		}
		if (!same_cell || a->reps[a->rep_count - 1].component != component)
			a->reps[a->rep_count++] = (struct rep){ items[i].value, component,
				a->cell_count - 1 };
	}
	a->cell_first[a->cell_count] = a->rep_count;
	list_own(a);
}

/* ---- Growing ---- */

static void push(struct attach *a, uint32_t component)
{
	if (a->heap_count == a->heap_room) {
		struct lod_heap_item *wider = lod_arena_take(a->arena, 2 * (size_t)a->heap_room + 16,
			sizeof *wider);
		for (uint32_t i = 0; i < a->heap_count; i++)
			wider[i] = a->heap[i];
		a->heap = wider;
		a->heap_room = 2 * a->heap_room + 16;
	}
	/* extents stay below 64 */
	billboard_heap_push(a->heap, &a->heap_count, -64.0 * a->near[component] + a->extent[component],
		component);
}

static void offer(struct attach *a, const struct rep *from, const struct rep *to)
{
	struct lod_v3 p = lod_v3_of(corner_of(a->mesh, from->corner)),
		q = lod_v3_of(corner_of(a->mesh, to->corner));
	uint32_t near = (uint32_t)(2 * lod_v3_distance(p, q) / a->cell), c = to->component;
	if (near > a->near[c]
			|| (near == a->near[c] && !(a->extent[from->component] > a->extent[a->bearer[c]])))
		return;
	bool nearer = near < a->near[c];
	a->near[c] = near;
	a->bearer[c] = from->component;
	a->link[c] = (struct billboard_link){ from->corner, to->corner };
	if (nearer)
		push(a, c);
}

static void look_around(struct attach *a, const struct rep *from)
{
	double extent = a->extent[from->component];
	if (extent <= SURPASSES * a->seen[from->cell])
		return;
	a->seen[from->cell] = extent;
	for (int i = 0; i < 27; i++) {
		uint32_t cell = find_cell(a, cell_of(a, corner_of(a->mesh, from->corner), i % 3 - 1,
			i / 3 % 3 - 1, i / 9 - 1));
		for (uint32_t r = cell == ECO_NONE ? 0 : a->cell_first[cell]; cell != ECO_NONE
				&& r < a->cell_first[cell + 1]; r++)
			if (!a->taken[a->reps[r].component])
				offer(a, from, &a->reps[r]);
	}
}

static void expand(struct attach *a, uint32_t component)
{
	for (uint32_t i = a->own_first[component]; i < a->own_first[component + 1]; i++)
		look_around(a, &a->reps[a->own[i]]);
}

static uint32_t grow(struct attach *a, uint32_t *order, uint32_t count)
{
	for (uint32_t i = 0; i < count; i++)
		expand(a, order[i]);
	while (a->heap_count > 0) {
		uint32_t c = billboard_heap_pop(a->heap, &a->heap_count);
		if (a->taken[c])
			continue;
		a->taken[c] = true;
		order[count++] = c;
		expand(a, c);
	}
	return count;
}

void billboard_attach(const struct lod_mesh *mesh, struct billboard_link *link, uint32_t *order,
	struct lod_arena *arena)
{
	uint32_t n = mesh->component_count, count = 0;
	struct attach a = { .mesh = mesh, .link = link, .arena = arena };
	struct lod_arena_piece *mark = arena->last;
	if (!n)
		return;
	a.extent = lod_arena_take(arena, n, sizeof *a.extent);
	a.taken = lod_arena_take(arena, n, sizeof *a.taken);
	a.near = lod_arena_take(arena, n, sizeof *a.near);
	a.bearer = lod_arena_take(arena, n, sizeof *a.bearer);
	measure(&a);
	uint32_t lowest = 0, trunk = find_trunk(&a, &lowest);
	link[trunk] = (struct billboard_link){ ECO_NONE, lowest };
	a.taken[trunk] = true;
	order[count++] = trunk;
	for (double cell = CELL_FIRST; count < n; cell *= 2) {
		struct lod_arena_piece *level = arena->last;
		a.heap = NULL;
		a.heap_room = a.heap_count = 0;
		make_level(&a, cell);
		count = grow(&a, order, count);
		for (uint32_t c = 0; c < n; c++)
			a.near[c] = ECO_NONE;
		lod_arena_release(arena, level);
	}
	lod_arena_release(arena, mark);
}
