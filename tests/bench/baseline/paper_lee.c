#include <float.h>
#include <stdlib.h>
#include <string.h>

#include "lod/geometry.h"
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

#define LEAVES_A_CELL 2.0 /* fewer are the whole's */

/* ---- Cells ---- */

static void make_group(const struct paper_scene *s, uint32_t list, struct lod_lee_group *group,
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
		longjmp(arena->failed, 1);
	lod_list_geometry(&held->list, &held->elements, 0, triangles, 1, &corners);
	for (uint32_t i = 0; i < n; t += held->elements.corners[i++] - 2u) {
		const float *c = corners.position + 9 * (size_t)t;
		struct lod_v3 a = lod_v3_of(c), b = lod_v3_of(c + 3), d = lod_v3_of(c + 6);
		center[i] = lod_v3_scale(lod_v3_add(a, lod_v3_add(b, d)), 1 / 3.0);
		normal[i] = lod_v3_cross(lod_v3_sub(b, a), lod_v3_sub(d, a));
		leaves[i] = i;
	}
	lod_lee_group_make(group, center, normal, leaves, n);
	lod_geometry_free(&corners);
	lod_arena_release(arena, mark);
}

static void make_plant(const struct paper_scene *s, uint32_t plant, struct paper_lee_plant *out,
	struct lod_arena *arena)
{
	const struct eco_plant *of = &s->scene->plants[plant];
	out->groups = lod_arena_take(arena, of->ladder_count, sizeof *out->groups);
	out->ladders = lod_arena_take(arena, of->ladder_count, sizeof *out->ladders);
	for (uint32_t i = of->ladder_first; i < of->ladder_first + of->ladder_count; i++) {
		const struct eco_ladder *l = &s->scene->ladders[i];
		if (!paper_is_leaves(l) || l->anchor == of->anchor_first
				|| !s->scene->lists[l->triangles].element_count)
			continue;
		make_group(s, l->triangles, &out->groups[out->count], arena);
		out->leaves += out->groups[out->count].count;
		out->ladders[out->count++] = i;
	}
}

enum eco_code paper_lee_begin(struct paper_lee *lee, const struct paper_scene *s, struct eco_error *error)
{
	lee->arena = calloc(1, sizeof *lee->arena);
	if (!lee->arena || setjmp(lee->arena->failed))
		return eco_fail(error, ECO_NO_MEMORY, "no memory for the cells of %u plants",
			s->scene->plant_count);
	lee->plants = lod_arena_take(lee->arena, s->scene->plant_count, sizeof *lee->plants);
	for (uint32_t i = 0; i < s->scene->plant_count; i++)
		make_plant(s, i, &lee->plants[i], lee->arena);
	return ECO_OK;
}

void paper_lee_end(struct paper_lee *lee)
{
	if (lee->arena)
		lod_arena_free(lee->arena);
	free(lee->arena);
}

/* ---- Plants in view ---- */

struct each { struct paper *p; const struct paper_lee *lee; double full_m; };

static double lambda_at(const struct each *e, uint8_t band)
{
	return paper_cook_lambda(lod_band_distance_m(band), e->full_m);
}

static float scale_at(const struct each *e, uint32_t plant, double lambda)
{
	return e->lee->tables ? (float)paper_tables_cook(e->lee->tables, plant, lambda) : 1;
}

/* Cells replace the whole plant's leaves, which belong to no cell. */
static void add_cells(const struct each *e, const struct lod_anchor_band *anchors, uint32_t count,
	uint32_t plant, uint32_t hash, struct lod_v3 eye)
{
	const struct paper_lee_plant *of = &e->lee->plants[plant];
	const struct eco_scene *scene = e->p->s->scene;
	double lambda = lambda_at(e, anchors[0].band);
	struct lod_arena_piece *mark = e->lee->arena->last;
	uint32_t *kept = lod_arena_take(e->lee->arena, of->count, sizeof *kept);
	struct lod_v3 center = lod_v3_of(scene->anchors[scene->plants[plant].anchor_first].center);
	const struct lod_lee_view view = { .eye = eye, .forward = lod_v3_unit(lod_v3_sub(center, eye)) };
	lod_lee_keep(kept, e->lee->method, of->groups, of->count, &view, (uint64_t)(lambda * of->leaves),
		e->lee->arena);
	for (uint32_t a = 1; a < count; a++)
		for (uint32_t g = 0; g < of->count; g++) {
			const struct eco_ladder *l = &scene->ladders[of->ladders[g]];
			struct lod_slot slot = { .anchor = anchors[a].anchor, .plant = plant,
				.band = anchors[a].band };
			if (l->anchor == anchors[a].anchor)
				paper_cut(e->p, &slot, &(struct eco_cut){ .list = l->triangles,
					.end = paper_triangles(e->p->s, l->triangles, kept[g]),
					.scale = scale_at(e, plant, lambda), .share_first = hash,
						.share_end = hash + 1 });
		}
	lod_arena_release(e->lee->arena, mark);
}

static void add_group(const struct each *e, const struct lod_node *node, const struct eco_group *group)
{
	struct paper *p = e->p;
	const struct eco_scene *scene = p->s->scene;
	const struct eco_plant *of = &scene->plants[group->plant];
	const struct eco_placement *placement = &p->p.visible.placements[node->placement];
	struct lod_anchor_band *anchors = p->p.visible.scratch;
	for (uint32_t i = 0; i < group->count && e->lee->plants[group->plant].count; i++) {
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
	bool near = e->lee->plants[slot->plant].count
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
	for (int band = ECO_BANDS - 1; band >= 0 && plant->count; band--)
		if (lambda_at(e, (uint8_t)band) * plant->leaves >= LEAVES_A_CELL * plant->count)
			return (uint32_t)(band + 1) * ECO_SHARE_ONE;
	return 0;
}

enum eco_code paper_lee(struct paper *p, double full_m, void *ctx, struct eco_error *error)
{
	struct paper_lee *lee = ctx;
	struct each e = { p, lee, full_m };
	const struct eco_scene *scene = p->s->scene;
	if (setjmp(lee->arena->failed))
		return eco_fail(error, ECO_NO_MEMORY, "no memory for cells");
	for (uint32_t i = 0; i < scene->plant_count; i++)
		p->p.gates[i] = gate_of(&e, &lee->plants[i]);
	enum eco_code code = paper_open(p, 0, error);
	for (uint32_t i = 0; i < p->p.visible.slot_count && !code; i++)
		if (p->p.visible.slots[i].count)
			add_slot(&e, &p->p.visible.slots[i]);
	for (uint32_t n = 0; n < p->p.visible.node_count && !code; n++) {
		const struct lod_node *node = &p->p.visible.nodes[n];
		const struct eco_tile *tile = &scene->tiles[node->tile];
		for (uint32_t g = 0; node->state == LOD_OPEN && g < tile->group_count; g++)
			add_group(&e, node, &scene->groups[tile->group_first + g]);
	}
	return code;
}
