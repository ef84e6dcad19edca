/* Orders of leaves for one view: Lee, Peng, Kuo 2007. */
#include <float.h>
#include <string.h>

#include "ecofiles/base/memory.h"
#include "lod/geometry.h"
#include "lod/sort.h"
#include "tests/bench/baseline/paper_rules.h"

#define LEAVES_A_CELL 2.0 /* fewer are the whole's */

void lod_lee_cells(struct lod_lee_leaves *cells, uint32_t most, struct lod_arena *arena)
{
	*cells = (struct lod_lee_leaves){ .size = lod_arena_take(arena, most, sizeof *cells->size),
		.center = lod_arena_take(arena, most, sizeof *cells->center),
		.facing = lod_arena_take(arena, most, sizeof *cells->facing) };
}

void lod_lee_cell_add(struct lod_lee_leaves *cells, const struct lod_v3 *center, const struct lod_v3 *normal,
	const uint32_t *leaves, uint32_t count)
{
	uint32_t at = cells->count++;
	cells->size[at] = count;
	for (uint32_t i = 0; i < count; i++) {
		struct lod_v3 n = lod_v3_unit(normal[leaves[i]]);
		const double product[6] = { n.x * n.x, n.y * n.y, n.z * n.z, n.x * n.y, n.x * n.z,
			n.y * n.z };
		for (int k = 0; k < 6; k++)
			cells->facing[at][k] += product[k] / count;
		cells->center[at] = lod_v3_add(cells->center[at], lod_v3_scale(center[leaves[i]],
			1.0 / count));
	}
}

/* Square of |n . v|, v from the leaf to the eye, or the mean over a cell; `d` is the other way. */
static double facing(const struct lod_lee_leaves *leaves, uint32_t i, struct lod_v3 d)
{
	struct lod_v3 v = lod_v3_unit(d);
	if (!leaves->facing) {
		double cosine = lod_v3_dot(lod_v3_unit(leaves->normal[i]), v);
		return cosine * cosine;
	}
	const double *f = leaves->facing[i];
	return f[0] * v.x * v.x + f[1] * v.y * v.y + f[2] * v.z * v.z
		+ 2 * (f[3] * v.x * v.y + f[4] * v.x * v.z + f[5] * v.y * v.z);
}

/* `order` becomes layer after layer, each by rank; first[i] is where layer i begins. */
static void order_layers(struct lod_keyed *order, uint32_t *first, uint32_t layers,
	enum lod_lee_method method,
	const struct lod_lee_leaves *leaves, const struct lod_lee_view *view, struct lod_arena *arena)
{
	double near = DBL_MAX, far = -DBL_MAX, *depth = lod_arena_take(arena, leaves->count, sizeof *depth);
	for (uint32_t i = 0; i < leaves->count; i++) {
		struct lod_v3 d = lod_v3_sub(leaves->center[i], view->eye);
		double rank = method == LOD_LEE_DISTANCE ? lod_v3_dot(d, d) : -facing(leaves, i, d);
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
		*taken = lod_arena_take(arena, layers, sizeof *taken), /* whole cells */
		*part = lod_arena_take(arena, layers, sizeof *part);  /* leaves of the next */
	order_layers(order, first, layers, method, leaves, view, arena);
	for (uint32_t turn = 0; turn < 2 * layers; turn++) {
		uint32_t layer = turn % layers;
		if (turn < layers) {             /* shares add up to the budget */
			weight += layers - layer;
			left += budget * weight / sum - given;
			given = budget * weight / sum;
		}
		for (; left && first[layer] + taken[layer] < first[layer + 1]; left--) {
			uint32_t next = order[first[layer] + taken[layer]].value;
			kept[count++] = next;
			if (!leaves->size || ++part[layer] == leaves->size[next]) {
				part[layer] = 0;
				taken[layer]++;
			}
		}
	}
	lod_arena_release(arena, mark);
	return count;
}

/* ---- Cells of plants ---- */

const char *const paper_lee_names[LOD_LEE_COUNT] = { "Lee distance", "Lee normal", "Lee layer+normal" };

struct paper_lee_plant { struct lod_lee_leaves cells; uint32_t *ladders; double leaves; };

static void add_cell(const struct paper_scene *s, uint32_t list, struct lod_lee_leaves *cells,
	struct lod_arena *arena)
{
	const struct view_list *held = view_store_list(s->store, list);
	uint32_t n = held->elements.element_count, t = 0, triangles = held->elements.primitive_count;
	struct lod_arena_piece *mark = arena->last;
	struct lod_geometry corners = { 0 };
	struct lod_v3 *center = lod_arena_take(arena, n, sizeof *center),
		*normal = lod_arena_take(arena, n, sizeof *normal);
	uint32_t *leaves = lod_arena_take(arena, n, sizeof *leaves);
	if (!lod_geometry_make(&corners, &held->list, triangles, false))
		eco_end("no memory for the leaves of a cell");
	lod_list_geometry(&held->list, &held->elements, 0, triangles, 1, &corners);
	for (uint32_t i = 0; i < n; t += held->elements.corners[i++] - 2u) {
		const float *c = corners.position + 9 * (size_t)t;
		struct lod_v3 a = lod_v3_of(c), b = lod_v3_of(c + 3), d = lod_v3_of(c + 6);
		center[i] = lod_v3_scale(lod_v3_add(a, lod_v3_add(b, d)), 1 / 3.0);
		normal[i] = lod_v3_cross(lod_v3_sub(b, a), lod_v3_sub(d, a));
		leaves[i] = i;
	}
	lod_lee_cell_add(cells, center, normal, leaves, n);
	lod_geometry_free(&corners);
	lod_arena_release(arena, mark);
}

void paper_lee_begin(struct paper_lee *lee, const struct paper_scene *s)
{
	struct lod_arena *arena = &lee->arena;
	lee->plants = lod_arena_take(arena, s->scene->plant_count, sizeof *lee->plants);
	for (uint32_t i = 0; i < s->scene->plant_count; i++) {
		const struct eco_plant *of = &s->scene->plants[i];
		struct paper_lee_plant *out = &lee->plants[i];
		lod_lee_cells(&out->cells, of->ladder_count, arena);
		out->ladders = lod_arena_take(arena, of->ladder_count, sizeof *out->ladders);
		for (uint32_t k = of->ladder_first; k < of->ladder_first + of->ladder_count; k++) {
			const struct eco_ladder *l = &s->scene->ladders[k];
			if (!paper_is_leaves(l) || l->anchor == of->anchor_first
					|| !s->scene->lists[l->triangles].element_count)
				continue;
			out->ladders[out->cells.count] = k;
			add_cell(s, l->triangles, &out->cells, arena);
			out->leaves += out->cells.size[out->cells.count - 1];
		}
	}
}

void paper_lee_end(struct paper_lee *lee) { lod_arena_free(&lee->arena); }

/* Leaves of each cell for an eye in the plant's own coordinates. */
static void keep_cells(uint32_t *kept, enum lod_lee_method method, const struct lod_lee_leaves *cells,
	struct lod_v3 center, struct lod_v3 eye, uint32_t budget, struct lod_arena *arena)
{
	struct lod_arena_piece *mark = arena->last;
	uint32_t *list = lod_arena_take(arena, budget, sizeof *list);
	const struct lod_lee_view view = { .eye = eye, .forward = lod_v3_unit(lod_v3_sub(center, eye)) };
	uint32_t count = lod_lee_keep(list, method, cells, &view, budget, arena);
	while (count--)
		kept[list[count]]++;
	lod_arena_release(arena, mark);
}

/* ---- Plants in view ---- */

struct each { struct paper *p; struct paper_lee *lee; double full_m; };

static double lambda_at(const struct each *e, uint8_t band)
{
	return paper_cook_lambda(lod_band_distance_m(band), e->full_m);
}

static float scale_at(const struct each *e, uint32_t plant, double lambda)
{
	return e->lee->tables ? (float)paper_table_cook(&e->lee->tables[plant], lambda) : 1;
}

/* Cells replace the whole plant's leaves, which belong to no cell. */
static void add_cells(const struct each *e, const struct lod_anchor_band *anchors, uint32_t count,
	uint32_t plant, uint32_t hash, struct lod_v3 eye)
{
	const struct paper_lee_plant *of = &e->lee->plants[plant];
	const struct eco_scene *scene = e->p->s->scene;
	double lambda = lambda_at(e, anchors[0].band);
	struct lod_arena_piece *mark = e->lee->arena.last;
	uint32_t *kept = lod_arena_take(&e->lee->arena, of->cells.count, sizeof *kept);
	struct lod_v3 center = lod_v3_of(scene->anchors[scene->plants[plant].anchor_first].center);
	keep_cells(kept, e->lee->method, &of->cells, center, eye, (uint32_t)(lambda * of->leaves),
		&e->lee->arena);
	for (uint32_t a = 1; a < count; a++)
		for (uint32_t g = 0; g < of->cells.count; g++) {
			const struct eco_ladder *l = &scene->ladders[of->ladders[g]];
			struct lod_slot slot = { .anchor = anchors[a].anchor, .plant = plant,
				.band = anchors[a].band };
			if (l->anchor == anchors[a].anchor)
				paper_cut(e->p, &slot, &(struct eco_cut){ .list = l->triangles,
					.end = paper_triangles(e->p->s, l->triangles, kept[g]),
					.scale = scale_at(e, plant, lambda), .share_first = hash,
						.share_end = hash + 1 });
		}
	lod_arena_release(&e->lee->arena, mark);
}

static void add_group(const struct each *e, const struct lod_node *node, const struct eco_group *group)
{
	struct paper *p = e->p;
	const struct eco_scene *scene = p->s->scene;
	const struct eco_plant *of = &scene->plants[group->plant];
	const struct eco_placement *placement = &p->p.visible.placements[node->placement];
	struct lod_anchor_band *anchors = p->p.visible.scratch;
	for (uint32_t i = 0; i < group->count && e->lee->plants[group->plant].cells.count; i++) {
		struct eco_place stored = eco_place_read(scene, group->place_first + i);
		struct lod_place place;
		lod_place_instance(&place, placement, &scene->lists[group->list], &stored);
		uint32_t hash = lod_share_hash(placement->path, group->list, group->first + i);
		uint32_t count = lod_open_hash(hash) < node->left ? 0
			: lod_instance_anchors(&p->p.visible.eye, &place, scene->anchors + of->anchor_first,
			of->anchor_first, of->anchor_count, p->p.gates[group->plant], hash, anchors);
		if (!count || eco_gate_place(anchors[0].band, hash) >= p->p.gates[group->plant])
			continue;
		double d[3];
		for (int k = 0; k < 3; k++)
			d[k] = (p->p.visible.eye.at[k] - place.at[k]) / place.scale;
		add_cells(e, anchors, count, group->plant, hash, (struct lod_v3){ d[0] * place.cosine
			+ d[1] * place.sine, d[1] * place.cosine - d[0] * place.sine, d[2] });
	}
}

/* Wood of all plants, and the leaves of those without cells of their own choice. */
static void add_slot(const struct each *e, const struct lod_slot *slot)
{
	double lambda = lambda_at(e, slot->band);
	const struct eco_scene *scene = e->p->s->scene;
	bool near = e->lee->plants[slot->plant].cells.count
		&& eco_gate_place(slot->band, 0) < e->p->p.gates[slot->plant];
	uint32_t count;
	const uint32_t *ladders = lod_plan_tables_anchor(e->p->s->tables, slot->anchor, &count);
	for (uint32_t k = 0; k < count; k++) {
		const struct eco_ladder *l = &scene->ladders[ladders[k]];
		if (!paper_applies(e->p, l, slot))
			continue;
		if (!paper_is_leaves(l))
			paper_wood(e->p, slot, ladders[k], lambda, 0, ECO_SHARE_ONE);
		else if (!slot->cell && !near)
			paper_leaves(e->p, slot, l, lambda * l->total, (double)scale_at(e, slot->plant,
				lambda), 0, ECO_SHARE_ONE);
	}
}

static uint32_t gate_of(const struct each *e, const struct paper_lee_plant *plant)
{
	for (int band = ECO_BANDS - 1; band >= 0 && plant->cells.count; band--)
		if (lambda_at(e, (uint8_t)band) * plant->leaves >= LEAVES_A_CELL * plant->cells.count)
			return (uint32_t)(band + 1) * ECO_SHARE_ONE;
	return 0;
}

bool paper_lee(struct paper *p, double full_m, void *ctx)
{
	struct paper_lee *lee = ctx;
	struct each e = { p, lee, full_m };
	const struct eco_scene *scene = p->s->scene;
	for (uint32_t i = 0; i < scene->plant_count; i++)
		p->p.gates[i] = gate_of(&e, &lee->plants[i]);
	if (!paper_open(p, 0))
		return false;
	for (uint32_t i = 0; i < p->p.visible.slot_count; i++)
		if (p->p.visible.slots[i].count)
			add_slot(&e, &p->p.visible.slots[i]);
	for (uint32_t n = 0; n < p->p.visible.node_count; n++) {
		const struct lod_node *node = &p->p.visible.nodes[n];
		const struct eco_tile *tile = &scene->tiles[node->tile];
		for (uint32_t g = 0; node->state == LOD_OPEN && g < tile->group_count; g++)
			add_group(&e, node, &scene->groups[tile->group_first + g]);
	}
	return true;
}
