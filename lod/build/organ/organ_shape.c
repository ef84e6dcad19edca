/* Everything is a sum over triangles and edges, so components of any form are measured in one pass. Volume is
 * the sum of tetrahedra towards one point; each loop of an open component's border (tubes mostly are open at
 * both ends) is closed by a fan around its middle. Soups are wound at random, so triangles are first oriented
 * to one side. */
#include "lod/build/organ/organ_state.h"

#include <math.h>

#include "ecofiles/base/union.h"
#include "lod/light.h"
#include "lod/vector.h"

struct sums {                    /* over one component */
	double bend, angle, angle2;  /* length-weighted sums of signed, absolute and squared angle */
	double border, edges, glued; /* lengths */
	double volume, level, opaque;
	struct lod_light light;
};

struct border { uint32_t from, to; };

struct measure {
	const struct lod_mesh *mesh;
	const int8_t *sign;
	const uint8_t (*rgb)[3];
	const double *opaque;
	struct lod_v3 origin;        /* of the component: keeps sums small */
	struct border *border;       /* edges of the component's border, along its triangles' winding after
	                              * `sign` */
	uint32_t border_count;
	uint32_t *loop;              /* per vertex: union-find over that border */
	struct lod_v3 *middle;       /* per vertex: at a loop's root, the sum of its edges' starts */
	uint32_t *length;            /* per vertex: at a loop's root, its edges */
};

bool lod_colour_is_green(const uint8_t rgb[3])
{
	return 100 * rgb[1] > 102 * rgb[0] && 100 * rgb[1] > 105 * rgb[2];
}

/* ---- Orientation ---- */

/* 1 or -1 per triangle, such that neighbours face the same side. */
static int8_t *orient(const struct lod_mesh *mesh, struct lod_arena *arena)
{
	int8_t *sign = lod_arena_take(arena, mesh->triangle_count, sizeof *sign);
	struct lod_arena_piece *mark = arena->last;
	uint32_t *stack = lod_arena_take(arena, mesh->triangle_count, sizeof *stack), depth = 0;
	for (uint32_t seed = 0; seed < mesh->triangle_count; seed++) {
		if (sign[seed])
			continue;
		sign[seed] = 1;
		stack[depth++] = seed;
		while (depth) {
			uint32_t t = stack[--depth];
			for (uint32_t k = 0; k < 3; k++) {
				uint32_t edge = lod_mesh_across(mesh, t, k);
				if (edge == ECO_NONE || sign[edge / 3])
					continue;
				/* Two triangles of the same winding run along their common edge in opposite
				 * directions. */
				sign[edge / 3] = mesh->index[edge] == mesh->index[3 * (size_t)t + k]
					? (int8_t)-sign[t] : sign[t];
				stack[depth++] = edge / 3;
			}
		}
	}
	lod_arena_release(arena, mark);
	return sign;
}

/* ---- Sums ---- */

static double volume_of(struct lod_v3 a, struct lod_v3 b, struct lod_v3 c)
{
	return lod_v3_dot(a, lod_v3_cross(b, c)) / 6;
}

static void add_border(struct measure *m, struct lod_shape *shape, struct sums *sums, uint32_t t, uint32_t k,
	double length)
{
	const struct lod_mesh *mesh = m->mesh;
	uint32_t other = mesh->across[3 * (size_t)t + k], from = mesh->index[3 * (size_t)t + k],
		to = mesh->index[3 * (size_t)t + (k + 1) % 3];
	m->border[m->border_count++] = m->sign[t] > 0 ? (struct border){ from, to }
		: (struct border){ to, from };
	sums->border += length;
	if (other != ECO_NONE) {
		sums->glued += length;
		shape->glued_to = mesh->component[other / 3];
	}
}

static void add_edges(struct measure *m, struct lod_shape *shape, struct sums *sums, uint32_t t)
{
	const struct lod_mesh *mesh = m->mesh;
	struct lod_v3 normal = lod_v3_scale(lod_v3_unit(lod_mesh_area_normal(mesh, t)), m->sign[t]);
	for (uint32_t k = 0; k < 3; k++) {
		uint32_t edge = lod_mesh_across(m->mesh, t, k), u = edge / 3;
		double length = lod_v3_distance(lod_mesh_corner(mesh, t, k), lod_mesh_corner(mesh, t, k + 1));
		sums->edges += length;
		if (edge == ECO_NONE)
			add_border(m, shape, sums, t, k, length);
		if (edge == ECO_NONE || u < t)
			continue;
		struct lod_v3 other = lod_v3_scale(lod_v3_unit(lod_mesh_area_normal(mesh, u)), m->sign[u]);
		double angle = lod_arc_cosine(lod_v3_dot(normal, other));
		struct lod_v3 away = lod_v3_sub(lod_mesh_corner(mesh, u, edge % 3 + 2),
			lod_mesh_corner(mesh, t, k));
		sums->bend += (lod_v3_dot(normal, away) < 0 ? angle : -angle) * length;
		sums->angle += angle * length;
		sums->angle2 += angle * angle * length;
	}
}

static void add_triangle(struct measure *m, struct lod_shape *shape, struct sums *sums, uint32_t t)
{
	const struct lod_mesh *mesh = m->mesh;
	struct lod_v3 normal = lod_mesh_area_normal(mesh, t);
	double area = lod_v3_length(normal);
	if (shape->triangle_count++ == 0) {
		shape->first = t;
		shape->material = mesh->material[t];
		m->origin = lod_mesh_corner(mesh, t, 0);
	}
	for (uint32_t k = 0; k < 3; k++)
		for (int a = 0; a < 3; a++) {
			float p = mesh->place[3 * (size_t)mesh->index[3 * (size_t)t + k] + a];
			shape->low[a] = fminf(shape->low[a], p);
			shape->high[a] = fmaxf(shape->high[a], p);
		}
	shape->area += area;
	sums->level += fabs(normal.z);
	sums->volume += m->sign[t] * volume_of(lod_v3_sub(lod_mesh_corner(mesh, t, 0), m->origin),
		lod_v3_sub(lod_mesh_corner(mesh, t, 1), m->origin),
		lod_v3_sub(lod_mesh_corner(mesh, t, 2), m->origin));
	lod_light_add(&sums->light, m->rgb[t], m->opaque[t]);
	sums->opaque += m->opaque[t];
	add_edges(m, shape, sums, t);
}

/* The volume of the fans that close the loops of the border. */
static double close_loops(struct measure *m)
{
	double volume = 0;
	for (uint32_t i = 0; i < m->border_count; i++)
		for (int end = 0; end < 2; end++) {
			uint32_t v = end ? m->border[i].to : m->border[i].from;
			m->loop[v] = v;
			m->length[v] = 0;
			m->middle[v] = (struct lod_v3){ 0, 0, 0 };
		}
	for (uint32_t i = 0; i < m->border_count; i++)
		m->loop[eco_union_root(m->loop, m->border[i].from)] =
			eco_union_root(m->loop, m->border[i].to);
	for (uint32_t i = 0; i < m->border_count; i++) {
		uint32_t v = m->border[i].from, root = eco_union_root(m->loop, v);
		m->middle[root] =
			lod_v3_add(m->middle[root],
			lod_v3_sub(lod_v3_of(m->mesh->place + 3 * (size_t)v), m->origin));
		m->length[root]++;
	}
	for (uint32_t i = 0; i < m->border_count; i++) {
		struct lod_v3 a = lod_v3_sub(lod_v3_of(m->mesh->place + 3 * (size_t)m->border[i].from),
			m->origin);
		struct lod_v3 b = lod_v3_sub(lod_v3_of(m->mesh->place + 3 * (size_t)m->border[i].to),
			m->origin);
		uint32_t root = eco_union_root(m->loop, m->border[i].from);
		volume += volume_of(b, a, lod_v3_scale(m->middle[root], 1.0 / m->length[root]));
	}
	return volume;
}

static void finish(struct lod_shape *shape, const struct sums *sums)
{
	double bend = fabs(sums->bend) / 2;
	shape->diagonal = lod_v3_distance(lod_v3_of(shape->low), lod_v3_of(shape->high));
	shape->length = bend / LOD_PI;
	shape->radius = bend > 0 ? shape->area / (2 * bend) : INFINITY;
	shape->turn = sums->angle > 0 ? sums->angle2 / sums->angle : 0;
	shape->round = shape->area > 0 ? 4 * fabs(sums->volume) * bend / (shape->area * shape->area) : 0;
	shape->level = shape->area > 0 ? sums->level / shape->area : 0;
	shape->open = sums->edges > 0 ? sums->border / sums->edges : 0;
	shape->glued = sums->border > 0 ? sums->glued / sums->border : 0;
	shape->clear = shape->area > 0 ? 1 - sums->opaque / shape->area : 0;
	lod_light_mean(&sums->light, shape->rgb);
}

static void measure_component(struct measure *m, struct lod_shape *shape, uint32_t c)
{
	const struct lod_mesh *mesh = m->mesh;
	struct sums sums = { 0 };
	for (int a = 0; a < 3; a++) {
		shape->low[a] = INFINITY;
		shape->high[a] = -INFINITY;
	}
	m->border_count = 0;
	for (uint32_t i = mesh->member_first[c]; i < mesh->member_first[c + 1]; i++)
		add_triangle(m, shape, &sums, mesh->member[i]);
	sums.volume += close_loops(m);
	finish(shape, &sums);
}

struct lod_shape *lod_shapes_find(const struct lod_mesh *mesh, const uint8_t (*rgb)[3], const double *opaque,
	struct lod_arena *arena)
{
	struct lod_shape *shapes = lod_arena_take(arena, mesh->component_count, sizeof *shapes);
	struct lod_arena_piece *mark = arena->last;
	struct measure m = { .mesh = mesh, .rgb = rgb, .opaque = opaque };
	m.sign = orient(mesh, arena);
	m.border = lod_arena_take(arena, 3 * (size_t)mesh->triangle_count, sizeof *m.border);
	m.loop = lod_arena_take(arena, mesh->vertex_count, sizeof *m.loop);
	m.length = lod_arena_take(arena, mesh->vertex_count, sizeof *m.length);
	m.middle = lod_arena_take(arena, mesh->vertex_count, sizeof *m.middle);
	for (uint32_t c = 0; c < mesh->component_count; c++)
		measure_component(&m, &shapes[c], c);
	lod_arena_release(arena, mark);
	return shapes;
}
