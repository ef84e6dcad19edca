#include "lod/build/organ/organ_state.h"

#include <math.h>
#include <string.h>

#include "ecofiles/base/union.h"
#include "lod/sort.h"
#include "lod/vector.h"

#define COLOURED_LEAST 32u       /* triangles of a component that colours may part */
#define COLOURED_SIZE 0.3        /* of the plant's diagonal: fruits and leaves have several colours, too */
#define CLASS_LEAST 0.02         /* of its area, either colour */
#define SEAM_MOST 0.1            /* of its edges by length: a longer seam is a pattern */

#define SHEETS_LEAST 8u          /* on one tube */
#define SHEET_TRIANGLES 64u
#define SHEET_AREA 0.05          /* of the component's */
#define SHEET_LENGTH 0.35        /* of its diagonal, as a tube: it is flat */
#define SHEET_BORDER 0.25        /* of its edges, by length */
#define HOST_RADIUS 0.045        /* of its diagonal: thin like wood */
#define HOST_LENGTH 0.7

struct part { double area, bend, edges, border; float low[3], high[3]; uint32_t triangles; };

struct splitter {
	struct lod_mesh *mesh;
	const struct eco_model *model;
	const uint8_t (*rgb)[3];
	uint32_t *label; /* per triangle: a triangle of its part, the same one for the whole part */
	uint32_t *parent;            /* union-find over triangles */
	struct part *part;           /* per root triangle */
	bool any;
};

static double edge_length(const struct lod_mesh *mesh, uint32_t t, uint32_t k)
{
	return lod_v3_distance(lod_mesh_corner(mesh, t, k), lod_mesh_corner(mesh, t, k + 1));
}

static struct part empty(void)
{
	return (struct part){ .low = { INFINITY, INFINITY, INFINITY },
		.high = { -INFINITY, -INFINITY, -INFINITY } };
}

static void include(struct part *part, const struct lod_mesh *mesh, uint32_t t)
{
	for (uint32_t k = 0; k < 3; k++)
		for (int a = 0; a < 3; a++) {
			float at = mesh->place[3 * (size_t)mesh->index[3 * (size_t)t + k] + a];
			part->low[a] = fminf(part->low[a], at);
			part->high[a] = fmaxf(part->high[a], at);
		}
}

static double diagonal(const struct part *p)
{
	return lod_v3_distance(lod_v3_of(p->low), lod_v3_of(p->high));
}

/* ---- Colours of one surface ---- */

static bool kin(const struct splitter *s, uint32_t t, uint32_t u)
{
	uint32_t a = s->mesh->material[t], b = s->mesh->material[u];
	if (a == b || a >= s->model->material_count || b >= s->model->material_count
			|| s->mesh->rule[t] != s->mesh->rule[u])
		return false;
	const struct eco_material *m = &s->model->materials[a], *n = &s->model->materials[b];
	return m->name[0] && strcmp(m->name, n->name) == 0 && m->image == n->image
		&& lod_colour_is_green(s->rgb[t]) == lod_colour_is_green(s->rgb[u]);
}

static void join_kin(struct splitter *s)
{
	const struct lod_mesh *mesh = s->mesh;
	for (size_t i = 0; i < 3 * (size_t)mesh->triangle_count; i++) {
		uint32_t t = (uint32_t)(i / 3), u = mesh->across[i] == ECO_NONE ? t : mesh->across[i] / 3;
		if (u <= t || s->label[t] == s->label[u] || !kin(s, t, u))
			continue;
		eco_union_join(s->parent, s->label[t], s->label[u]);
		s->any = true;
	}
	for (uint32_t t = 0; t < mesh->triangle_count && s->any; t++)
		s->label[t] = eco_union_root(s->parent, s->label[t]);
	for (uint32_t t = 0; t < mesh->triangle_count; t++)
		s->parent[t] = t;
}

/* ---- Parting by colour ---- */

static void part_colours(struct splitter *s, const uint32_t *member, uint32_t count)
{
	const struct lod_mesh *mesh = s->mesh;
	double area[2] = { 0, 0 }, edges = 0, seam = 0;
	uint32_t first[2] = { ECO_NONE, ECO_NONE };
	struct part whole = empty();
	if (count < COLOURED_LEAST)
		return;
	for (uint32_t i = 0; i < count; i++) {
		uint32_t t = member[i];
		bool green = lod_colour_is_green(s->rgb[t]);
		include(&whole, mesh, t);
		area[green] += lod_v3_length(lod_mesh_area_normal(mesh, t));
		first[green] = first[green] == ECO_NONE ? t : first[green];
	}
	double size = lod_v3_distance(lod_v3_of(mesh->low), lod_v3_of(mesh->high));
	if (fmin(area[0], area[1]) < CLASS_LEAST * (area[0] + area[1])
			|| diagonal(&whole) < COLOURED_SIZE * size)
		return;
	for (uint32_t i = 0; i < count; i++)
		for (uint32_t k = 0; k < 3; k++) {
			uint32_t edge = lod_mesh_across(mesh, member[i], k);
			if (edge == ECO_NONE)
				continue;
			double length = edge_length(mesh, member[i], k);
			edges += length;
			if (lod_colour_is_green(s->rgb[member[i]]) != lod_colour_is_green(s->rgb[edge / 3]))
				seam += length;
		}
	if (seam > SEAM_MOST * edges)
		return;
	for (uint32_t i = 0; i < count; i++)
		s->label[member[i]] = first[lod_colour_is_green(s->rgb[member[i]])];
	s->any = true;
}

/* ---- Parting by form ---- */

static void grow(struct part *to, const struct part *part)
{
	to->area += part->area;
	to->bend += part->bend;
	to->edges += part->edges;
	to->border += part->border;
	to->triangles += part->triangles;
	for (int a = 0; a < 3; a++) {
		to->low[a] = fminf(to->low[a], part->low[a]);
		to->high[a] = fmaxf(to->high[a], part->high[a]);
	}
}

/* Bending ignores its sign and the triangles' sides: rough, but sheets and tubes are far apart. */
static struct part measure(const struct splitter *s, uint32_t t)
{
	const struct lod_mesh *mesh = s->mesh;
	struct lod_v3 normal = lod_mesh_area_normal(mesh, t);
	struct part p = empty();
	p.area = lod_v3_length(normal);
	p.triangles = 1;
	for (uint32_t k = 0; k < 3; k++) {
		uint32_t edge = lod_mesh_across(mesh, t, k);
		double length = edge_length(mesh, t, k);
		bool border = edge == ECO_NONE || s->label[edge / 3] != s->label[t];
		p.edges += length;
		p.border += border ? length : 0;
		if (!border) {
			double cosine =
				lod_v3_dot(lod_v3_unit(normal),
				lod_v3_unit(lod_mesh_area_normal(mesh, edge / 3)));
			bool alike = mesh->index[edge] != mesh->index[3 * (size_t)t + k];
			p.bend += lod_arc_cosine(alike ? cosine : -cosine) * length / 2;
		}
	}
	include(&p, mesh, t);
	return p;
}

static bool is_sheet(const struct part *p, double whole_area)
{
	return p->triangles <= SHEET_TRIANGLES && p->area < SHEET_AREA * whole_area
		&& p->border > SHEET_BORDER * p->edges && p->bend / 2 / LOD_PI < SHEET_LENGTH * diagonal(p);
}

static void part_sheets(struct splitter *s, const uint32_t *member, uint32_t count)
{
	const struct lod_mesh *mesh = s->mesh;
	uint32_t parts = 0, sheets = 0, host = ECO_NONE;
	struct part tube = empty();
	double area = 0;
	if (count < 2 * SHEETS_LEAST)
		return;
	for (uint32_t i = 0; i < count; i++)
		for (uint32_t k = 0; k < 3; k++) {
			uint32_t edge = lod_mesh_across(mesh, member[i], k);
			if (edge != ECO_NONE && s->label[edge / 3] == s->label[member[i]])
				eco_union_join(s->parent, member[i], edge / 3);
		}
	for (uint32_t i = 0; i < count; i++)
		parts += s->parent[member[i]] == member[i];
	if (parts <= SHEETS_LEAST)
		return;
	for (uint32_t i = 0; i < count; i++)
		s->part[member[i]] = empty();
	for (uint32_t i = 0; i < count; i++) {
		struct part p = measure(s, member[i]);
		grow(&s->part[eco_union_root(s->parent, member[i])], &p);
		area += p.area;
	}
	for (uint32_t i = 0; i < count; i++) {
		uint32_t t = member[i];
		if (s->parent[t] != t)
			continue;
		if (is_sheet(&s->part[t], area)) {
			sheets++;
		} else {
			grow(&tube, &s->part[t]);
			host = host == ECO_NONE ? t : host;
		}
	}
	double wide = diagonal(&tube), bend = tube.bend / 2;
	if (sheets < SHEETS_LEAST || host == ECO_NONE || bend / LOD_PI < HOST_LENGTH * wide
			|| tube.area > HOST_RADIUS * wide * 2 * bend)
		return;
	for (uint32_t i = 0; i < count; i++) {
		uint32_t root = eco_union_root(s->parent, member[i]);
		if (is_sheet(&s->part[root], area))
			s->label[member[i]] = root;
		else if (s->label[member[i]] == s->label[host])
			s->label[member[i]] = host;
	}
	s->any = true;
}

/* ---- Components again ---- */

/* Triangles of one label that share a vertex become one component. */
static void number_again(struct splitter *s, struct lod_arena *arena)
{
	struct lod_mesh *mesh = s->mesh;
	uint32_t n = mesh->triangle_count;
	struct lod_keyed *at = lod_arena_take(arena, 3 * (size_t)n, sizeof *at);
	for (uint32_t t = 0; t < n; t++)
		s->parent[t] = t;
	for (uint32_t i = 0; i < 3 * n; i++)
		at[i] = (struct lod_keyed){ (uint64_t)mesh->index[i] << 32 | s->label[i / 3], i / 3 };
	lod_sort(arena, at, 3 * n);
	for (uint32_t i = 1; i < 3 * n; i++)
		if (at[i].key == at[i - 1].key)
			eco_union_join(s->parent, at[i - 1].value, at[i].value);
	lod_mesh_number(mesh, s->parent);
}

void lod_organs_split(struct lod_mesh *mesh, const struct eco_model *model, const uint8_t (*rgb)[3],
	struct lod_arena *arena)
{
	struct lod_arena_piece *mark = arena->last;
	struct splitter s = { .mesh = mesh, .model = model, .rgb = rgb };
	s.label = lod_arena_take(arena, mesh->triangle_count, sizeof *s.label);
	s.parent = lod_arena_take(arena, mesh->triangle_count, sizeof *s.parent);
	s.part = lod_arena_take(arena, mesh->triangle_count, sizeof *s.part);
	for (uint32_t t = 0; t < mesh->triangle_count; t++) {
		s.label[t] = mesh->member[mesh->member_first[mesh->component[t]]];
		s.parent[t] = t;
	}
	join_kin(&s);
	for (uint32_t c = 0; c < mesh->component_count; c++)
		part_colours(&s, mesh->member + mesh->member_first[c],
			mesh->member_first[c + 1] - mesh->member_first[c]);
	for (uint32_t c = 0; c < mesh->component_count; c++)
		part_sheets(&s, mesh->member + mesh->member_first[c],
			mesh->member_first[c + 1] - mesh->member_first[c]);
	if (s.any)
		number_again(&s, arena);
	lod_arena_release(arena, mark);
}
