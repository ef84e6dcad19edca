/* Positions are hashed into cells of a few tolerances. A vertex joins the first earlier vertex within the
 * tolerance, in the up to eight cells that its ball of that radius touches. */
#include "lod/build/weld.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "ecofiles/format/list.h"
#include "ecofiles/format/pack.h"
#include "ecofiles/base/union.h"
#include "lod/raster/texel.h"
#include "lod/sort.h"
#include "lod/vector.h"

#define TOLERANCE 1e-6           /* of the largest extent */
#define UV_MOST (1 << 26)        /* beyond it texture coordinates are noise, taken as 0 */
/* Metres: a vertex farther off is no part of a plant, and its square would leave the range of floats. */
#define COORDINATE_MOST 1e8f
#define KINDS_OF_RULE (ECO_ORGAN_COUNT + 1u)

/* ---- Usable triangles ---- */

static bool in_range(float v) { return isfinite(v) && fabsf(v) <= COORDINATE_MOST; }

bool lod_mesh_usable(const struct eco_model *model, uint32_t t, enum eco_drop *why)
{
	const uint32_t *v = model->index + 3 * (size_t)t;
	enum eco_drop unasked;
	why = why ? why : &unasked;
	*why = ECO_DROP_BAD_INDEX;
	if (v[0] >= model->vertex_count || v[1] >= model->vertex_count || v[2] >= model->vertex_count)
		return false;
	*why = ECO_DROP_NOT_FINITE;
	for (int k = 0; k < 3; k++)
		for (int a = 0; a < 3; a++)
			if (!in_range(model->position[3 * (size_t)v[k] + a]))
				return false;
	return true;
}

/* Keeps the usable triangles; their indices still name the model's vertices. Returns the largest extent. */
static double take_triangles(struct lod_mesh *mesh, const struct eco_model *model, struct lod_arena *arena)
{
	uint32_t n = model->triangle_count, kept = 0;
	mesh->index = lod_arena_take(arena, 3 * (size_t)n, sizeof *mesh->index);
	mesh->material = lod_arena_take(arena, n, sizeof *mesh->material);
	mesh->uv = lod_arena_take(arena, 6 * (size_t)n, sizeof *mesh->uv);
	mesh->source = lod_arena_take(arena, n, sizeof *mesh->source);
	for (int a = 0; a < 3; a++) {
		mesh->low[a] = INFINITY;
		mesh->high[a] = -INFINITY;
	}
	for (uint32_t t = 0; t < n; t++) {
		enum eco_drop why;
		if (!lod_mesh_usable(model, t, &why)) {
			mesh->dropped[why]++;
			continue;
		}
		mesh->material[kept] = model->material[t] < model->material_count ? model->material[t]
			: ECO_NONE;
		mesh->source[kept] = t;
		bool textured = lod_mesh_image(model, mesh->material[kept]) != NULL;
		for (int k = 0; k < 3; k++) {
			uint32_t v = model->index[3 * (size_t)t + k];
			mesh->index[3 * (size_t)kept + k] = v;
			for (int a = 0; a < 3; a++) {
				mesh->low[a] = fminf(mesh->low[a], model->position[3 * (size_t)v + a]);
				mesh->high[a] = fmaxf(mesh->high[a], model->position[3 * (size_t)v + a]);
			}
			for (int a = 0; a < 2 && textured; a++) {
				double uv = (double)model->uv[2 * (size_t)v + a] * ECO_UV_ONE;
				mesh->uv[6 * (size_t)kept + 2 * k + a] = fabs(uv) < UV_MOST
					? (int32_t)floor(uv + 0.5) : 0;
			}
		}
		kept++;
	}
	mesh->triangle_count = kept;
	double extent = 0;
	for (int a = 0; a < 3; a++)
		if (kept)
			extent = fmax(extent, (double)mesh->high[a] - mesh->low[a]);
		else
			mesh->low[a] = mesh->high[a] = 0;
	return extent;
}

/* ---- Welding ---- */

struct welder {
	double cell, tolerance;
	const double *low;
	uint32_t *table, mask;       /* head of the chain of welded vertices in a cell's hash */
	uint32_t *next;
};

static uint32_t slot(const struct welder *w, const int64_t c[3])
{
	return (uint32_t)lod_mix((uint64_t)c[0] + lod_mix((uint64_t)c[1] + lod_mix((uint64_t)c[2])))
		& w->mask;
}

static uint32_t find_near(const struct welder *w, const struct lod_mesh *mesh, const float *p)
{
	int64_t low[3], high[3], c[3];
	uint32_t best = ECO_NONE;
	for (int a = 0; a < 3; a++) {
		low[a] = (int64_t)floor((p[a] - w->low[a] - w->tolerance) / w->cell);
		high[a] = (int64_t)floor((p[a] - w->low[a] + w->tolerance) / w->cell);
	}
	for (c[0] = low[0]; c[0] <= high[0]; c[0]++)
		for (c[1] = low[1]; c[1] <= high[1]; c[1]++)
			for (c[2] = low[2]; c[2] <= high[2]; c[2]++)
				for (uint32_t v = w->table[slot(w, c)]; v != ECO_NONE; v = w->next[v])
					if (v < best
							&& lod_v3_distance(lod_v3_of(p),
							lod_v3_of(mesh->place + 3 * (size_t)v))
							<= w->tolerance)
						best = v;
	return best;
}

static uint32_t add_vertex(struct welder *w, struct lod_mesh *mesh, const float *p)
{
	uint32_t v = mesh->vertex_count++;
	int64_t c[3];
	for (int a = 0; a < 3; a++) {
		mesh->place[3 * (size_t)v + a] = p[a];
		mesh->grid[3 * (size_t)v + a] = (int32_t)floor((p[a] - mesh->origin[a]) / mesh->step + 0.5);
		c[a] = (int64_t)floor((p[a] - w->low[a]) / w->cell);
	}
	uint32_t *head = &w->table[slot(w, c)];
	w->next[v] = *head;
	*head = v;
	return v;
}

static void weld_vertices(struct lod_mesh *mesh, const struct eco_model *model, double extent,
	struct lod_arena *arena)
{
	uint32_t n = model->vertex_count, size = 16;
	while (size < n && size < UINT32_C(1) << 31)
		size *= 2;
	mesh->place = lod_arena_take(arena, 3 * (size_t)n, sizeof *mesh->place);
	mesh->grid = lod_arena_take(arena, 3 * (size_t)n, sizeof *mesh->grid);
	struct lod_arena_piece *mark = arena->last;
	struct welder w = { .cell = 4 * TOLERANCE * extent, .tolerance = TOLERANCE * extent,
		.low = mesh->origin, .mask = size - 1 };
	uint32_t *welded = lod_arena_take(arena, n, sizeof *welded);
	w.table = lod_arena_take(arena, size, sizeof *w.table);
	w.next = lod_arena_take(arena, n, sizeof *w.next);
	memset(w.table, 0xff, size * sizeof *w.table);
	memset(welded, 0xff, n * sizeof *welded);
	for (size_t i = 0; i < 3 * (size_t)mesh->triangle_count; i++) {
		uint32_t v = mesh->index[i];
		const float *p = model->position + 3 * (size_t)v;
		if (welded[v] == ECO_NONE)
			welded[v] = find_near(&w, mesh, p);
		if (welded[v] == ECO_NONE)
			welded[v] = add_vertex(&w, mesh, p);
		mesh->index[i] = welded[v];
	}
	lod_arena_release(arena, mark);
}

/* ---- Dropping ---- */

static bool flat(const struct lod_mesh *mesh, const uint32_t *v)
{
	struct lod_v3 a = lod_v3_of(mesh->place + 3 * (size_t)v[0]),
		b = lod_v3_of(mesh->place + 3 * (size_t)v[1]), c = lod_v3_of(mesh->place + 3 * (size_t)v[2]);
	struct lod_v3 normal = lod_v3_cross(lod_v3_sub(b, a), lod_v3_sub(c, a));
	return v[0] == v[1] || v[1] == v[2] || v[2] == v[0] || lod_v3_dot(normal, normal) == 0;
}

bool lod_mesh_flat(const struct lod_mesh *mesh, const uint32_t *v)
{
	const int32_t *a = mesh->grid + 3 * (size_t)v[0], *b = mesh->grid + 3 * (size_t)v[1],
		*c = mesh->grid + 3 * (size_t)v[2];
	int64_t u[3], w[3];
	for (int k = 0; k < 3; k++) {
		u[k] = (int64_t)b[k] - a[k];
		w[k] = (int64_t)c[k] - a[k];
	}
	return u[1] * w[2] == u[2] * w[1] && u[2] * w[0] == u[0] * w[2] && u[0] * w[1] == u[1] * w[0];
}

/* The order of corners in which the vertices ascend. */
static void ascending(const uint32_t *v, int order[3])
{
	order[0] = v[0] < v[1] ? (v[0] < v[2] ? 0 : 2) : (v[1] < v[2] ? 1 : 2);
	order[2] = v[0] > v[1] ? (v[0] > v[2] ? 0 : 2) : (v[1] > v[2] ? 1 : 2);
	order[1] = 3 - order[0] - order[2];
}

/* The same three corners, material and texture: the second triangle covers nothing that the first does
 * not. */
static bool same(const struct lod_mesh *mesh, uint32_t s, uint32_t t)
{
	const uint32_t *a = mesh->index + 3 * (size_t)s, *b = mesh->index + 3 * (size_t)t;
	int i[3], j[3];
	ascending(a, i);
	ascending(b, j);
	for (int k = 0; k < 3; k++)
		if (a[i[k]] != b[j[k]]
			|| memcmp(mesh->uv + 6 * (size_t)s + 2 * i[k], mesh->uv + 6 * (size_t)t + 2 * j[k],
			2 * sizeof(int32_t)))
			return false;
	return mesh->material[s] == mesh->material[t];
}

static void move_triangle(struct lod_mesh *mesh, uint32_t from, uint32_t to)
{
	memmove(mesh->index + 3 * (size_t)to, mesh->index + 3 * (size_t)from, 3 * sizeof *mesh->index);
	memmove(mesh->uv + 6 * (size_t)to, mesh->uv + 6 * (size_t)from, 6 * sizeof *mesh->uv);
	mesh->material[to] = mesh->material[from];
	mesh->source[to] = mesh->source[from];
}

/* Masks of a model's cut-outs, each made when first needed. */
struct masks { struct lod_mask *mask; uint64_t work; };

static bool hidden(struct masks *masks, const struct lod_mesh *mesh, const struct eco_model *model,
	uint32_t t, struct lod_arena *arena)
{
	const struct eco_image *image = lod_mesh_image(model, mesh->material[t]);
	if (!image || !lod_mesh_material(model, mesh->material[t])->cutout)
		return false;
	struct lod_mask *mask = &masks->mask[image - model->images];
	if (!mask->opaque)
		lod_mask_open(mask, image, arena);
	return lod_mask_hidden(mask, mesh->uv + 6 * (size_t)t, &masks->work);
}

static bool line_in_texture(const int32_t uv[6])
{
	return ((int64_t)uv[2] - uv[0]) * ((int64_t)uv[5] - uv[1])
		== ((int64_t)uv[4] - uv[0]) * ((int64_t)uv[3] - uv[1]);
}

static void drop_triangles(struct lod_mesh *mesh, const struct eco_model *model, struct lod_arena *arena)
{
	uint32_t n = mesh->triangle_count, kept = 0, size = 16;
	while (size < 2 * (uint64_t)n && size < UINT32_C(1) << 31)
		size *= 2;
	mesh->collapsed = lod_arena_take(arena, n, sizeof *mesh->collapsed);
	struct lod_arena_piece *mark = arena->last;
	uint32_t *table = lod_arena_take(arena, size, sizeof *table);
	memset(table, 0xff, size * sizeof *table);
	struct masks masks = { .mask = lod_arena_take(arena, model->image_count, sizeof *masks.mask) };
	for (uint32_t t = 0; t < n; t++) {
		const uint32_t *v = mesh->index + 3 * (size_t)t;
		int order[3];
		if (flat(mesh, v)) {
			mesh->dropped[ECO_DROP_DEGENERATE]++;
			continue;
		}
		ascending(v, order);
		uint32_t at = (uint32_t)lod_mix(v[order[0]] + lod_mix(v[order[1]] + lod_mix(v[order[2]])))
			& (size - 1);
		while (table[at] != ECO_NONE && !same(mesh, table[at], t))
			at = (at + 1) & (size - 1);
		if (table[at] != ECO_NONE) {
			mesh->dropped[ECO_DROP_DUPLICATE]++;
			continue;
		}
		bool nothing = hidden(&masks, mesh, model, t, arena);
		mesh->dropped[ECO_DROP_TRANSPARENT] += nothing;
		if (nothing && !line_in_texture(mesh->uv + 6 * (size_t)t))
			continue;
		mesh->unstored += nothing;
		mesh->collapsed[kept] = nothing;
		move_triangle(mesh, t, kept);
		table[at] = kept++;
	}
	mesh->triangle_count = kept;
	lod_arena_release(arena, mark);
}

static void note_rules(struct lod_mesh *mesh, const struct eco_model *model, struct lod_arena *arena)
{
	mesh->rule = lod_arena_take(arena, mesh->triangle_count, sizeof *mesh->rule);
	for (uint32_t t = 0; t < mesh->triangle_count; t++) {
		uint8_t organ = model->organ ? model->organ[mesh->source[t]] : ECO_ORGAN_FOUND;
		uint8_t importance = model->importance ? model->importance[mesh->source[t]] : 0;
		mesh->rule[t] = (uint16_t)(importance << 8
			| (organ < ECO_ORGAN_COUNT ? organ : ECO_ORGAN_FOUND));
	}
}

static void mark_collapsed(struct lod_mesh *mesh)
{
	for (uint32_t t = 0; t < mesh->triangle_count; t++)
		if (!mesh->collapsed[t] && lod_mesh_flat(mesh, mesh->index + 3 * (size_t)t)) {
			mesh->collapsed[t] = true;
			mesh->dropped[ECO_DROP_QUANTIZED]++;
			mesh->unstored++;
		}
}

/* ---- Neighbours and components ---- */

void lod_weld_neighbours(struct lod_mesh *mesh, struct lod_arena *arena)
{
	uint32_t n = 3 * mesh->triangle_count;
	if (!mesh->across)
		mesh->across = lod_arena_take(arena, n, sizeof *mesh->across);
	memset(mesh->across, 0xff, n * sizeof *mesh->across);
	struct lod_arena_piece *mark = arena->last;
	struct lod_keyed *edges = lod_arena_take(arena, n, sizeof *edges);
	for (uint32_t i = 0; i < n; i++) {
		uint64_t a = mesh->index[i], b = mesh->index[i - i % 3 + (i + 1) % 3];
		edges[i] = (struct lod_keyed){ a < b ? a << 32 | b : b << 32 | a, i };
	}
	lod_sort(arena, edges, n);
	for (uint32_t i = 0, end; i < n; i = end) {
		for (end = i + 1; end < n && edges[end].key == edges[i].key; end++)
			;
		if (end - i == 2) {
			mesh->across[edges[i].value] = edges[i + 1].value;
			mesh->across[edges[i + 1].value] = edges[i].value;
		}
	}
	lod_arena_release(arena, mark);
}

/* Triangles around vertices: those of vertex v are around[first[v] .. first[v+1]). */
static uint32_t *list_around(const struct lod_mesh *mesh, uint32_t **first, struct lod_arena *arena)
{
	size_t corners = 3 * (size_t)mesh->triangle_count;
	uint32_t *around = lod_arena_take(arena, corners, sizeof *around);
	*first = lod_arena_take(arena, (size_t)mesh->vertex_count + 2, sizeof **first);
	for (size_t i = 0; i < corners; i++)
		(*first)[mesh->index[i] + 2]++;
	for (uint32_t v = 2; v <= mesh->vertex_count + 1; v++)
		(*first)[v] += (*first)[v - 1];
	for (size_t i = 0; i < corners; i++)
		around[(*first)[mesh->index[i] + 1]++] = (uint32_t)(i / 3);
	return around;
}

/* Joins triangles of one material and rule that meet in a vertex. */
static void join_all(const struct lod_mesh *mesh, uint32_t *parent, const struct eco_model *model,
	struct lod_arena *arena)
{
	uint32_t *first, *around = list_around(mesh, &first, arena);
	uint32_t material_count = model->material_count,
		rules = KINDS_OF_RULE * (model->importance ? model->importance_count : 1);
	size_t kinds = ((size_t)material_count + 1) * rules;
	uint32_t *seen = lod_arena_take(arena, kinds, sizeof *seen); /* vertex + 1, by material and rule */
	uint32_t *mate = lod_arena_take(arena, kinds, sizeof *mate);
	for (uint32_t t = 0; t < mesh->triangle_count; t++)
		parent[t] = t;
	for (uint32_t v = 0; v < mesh->vertex_count; v++)
		for (uint32_t i = first[v]; i < first[v + 1]; i++) {
			uint32_t t = around[i], material = mesh->material[t] == ECO_NONE ? material_count
				: mesh->material[t];
			uint32_t organ = mesh->rule[t] & 255u, rule = mesh->rule[t] >> 8;
			rule = rule * KINDS_OF_RULE + (organ == ECO_ORGAN_FOUND ? ECO_ORGAN_COUNT : organ);
			size_t m = (size_t)material * rules + rule;
			if (seen[m] == v + 1)
				eco_union_join(parent, mate[m], t);
			seen[m] = v + 1;
			mate[m] = t;
		}
}

void lod_mesh_number(struct lod_mesh *mesh, uint32_t *parent)
{
	uint32_t n = mesh->triangle_count;
	mesh->component_count = 0;
	memset(mesh->member_first, 0, ((size_t)n + 2) * sizeof *mesh->member_first);
	for (uint32_t t = 0; t < n; t++) {
		uint32_t root = eco_union_root(parent, t);
		mesh->component[t] = root == t ? mesh->component_count++ : mesh->component[root];
		mesh->member_first[mesh->component[t] + 2]++;
	}
	for (uint32_t c = 2; c <= mesh->component_count + 1; c++)
		mesh->member_first[c] += mesh->member_first[c - 1];
	for (uint32_t t = 0; t < n; t++)
		mesh->member[mesh->member_first[mesh->component[t] + 1]++] = t;
}

static void find_components(struct lod_mesh *mesh, const struct eco_model *model, struct lod_arena *arena)
{
	uint32_t n = mesh->triangle_count;
	mesh->component = lod_arena_take(arena, n, sizeof *mesh->component);
	mesh->member = lod_arena_take(arena, n, sizeof *mesh->member);
	mesh->member_first = lod_arena_take(arena, (size_t)n + 2, sizeof *mesh->member_first);
	struct lod_arena_piece *mark = arena->last;
	uint32_t *parent = lod_arena_take(arena, n, sizeof *parent);
	join_all(mesh, parent, model, arena);
	lod_mesh_number(mesh, parent);
	lod_arena_release(arena, mark);
}

void lod_weld(struct lod_mesh *mesh, const struct eco_model *model, uint32_t bits, struct lod_arena *arena)
{
	assert(bits >= 1 && bits <= LOD_WELD_BITS_MAX);
	*mesh = (struct lod_mesh){ 0 };
	double extent = take_triangles(mesh, model, arena);
	if (!(extent > 0)) {         /* no triangle, or all in one point */
		mesh->dropped[ECO_DROP_DEGENERATE] += mesh->triangle_count;
		mesh->triangle_count = 0;
		extent = 1;
	}
	for (int a = 0; a < 3; a++)
		mesh->origin[a] = mesh->triangle_count ? mesh->low[a] : 0;
	mesh->step = extent / (double)(UINT32_C(1) << bits);
	weld_vertices(mesh, model, extent, arena);
	drop_triangles(mesh, model, arena);
	note_rules(mesh, model, arena);
	mark_collapsed(mesh);
	lod_weld_neighbours(mesh, arena);
	find_components(mesh, model, arena);
}
