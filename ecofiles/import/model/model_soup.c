/* A soup while a reader makes it: vertices in double, with colours, and meshes of one material each. At the end
 * it is known how far from the origin everything is, and which colours of vertices differ: lists have a
 * colour per primitive, not per vertex, so each colour becomes a material. */
#include "ecofiles/import/model/import_model.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/geometry.h"
#include "ecofiles/base/memory.h"

#define NEAR 16.0                /* times the extent: floats then still resolve a millionth of it */
#define COARSE 1e-4              /* share of the extent: a coarser rounding of coordinates is reported */
#define ONE_COLOUR 0.02f         /* vertex colours this near to the first are one */

void eco_bounds_add(struct eco_bounds *b, const double place[3])
{
	for (int k = 0; k < 3 && isfinite(place[0] + place[1] + place[2]); k++) {
		b->low[k] = fmin(b->low[k], place[k]);
		b->high[k] = fmax(b->high[k], place[k]);
	}
}

static double extent_of(const struct eco_bounds *b)
{
	return fmax(fmax(0, b->high[0] - b->low[0]), fmax(b->high[1] - b->low[1], b->high[2] - b->low[2]));
}

void eco_model_reserve(struct eco_model *m, uint64_t vertices, uint64_t triangles)
{
	m->position = eco_alloc(vertices + 1, 3 * sizeof *m->position);
	m->uv = eco_alloc(vertices + 1, 2 * sizeof *m->uv);
	m->index = eco_alloc(triangles + 1, 3 * sizeof *m->index);
	m->material = eco_alloc(triangles + 1, sizeof *m->material);
	m->part = eco_alloc(triangles + 1, sizeof *m->part);
}

void eco_soup_part(struct eco_soup *s, const char *node, size_t node_bytes, const char *mesh, size_t mesh_bytes)
{
	struct eco_model *m = s->model;
	bool both = node_bytes && mesh_bytes
		&& (node_bytes != mesh_bytes || memcmp(node, mesh, node_bytes) != 0);
	struct eco_part part = { .name = "" };
	snprintf(part.name, sizeof part.name, "%.*s%s%.*s", (int)node_bytes, node, both ? "/" : "",
		both || !node_bytes ? (int)mesh_bytes : 0, mesh);
	if (!m->part_count || (m->part_count < ECO_MODEL_PARTS_MAX
			&& strcmp(m->parts[m->part_count - 1].name, part.name) != 0)) {
		eco_grow(&m->parts, &s->part_room, m->part_count, sizeof *m->parts);
		m->parts[m->part_count++] = part;
	}
	s->part = m->part_count - 1;
}

void eco_soup_mesh(struct eco_soup *s, uint32_t material, bool colored)
{
	eco_grow(&s->meshes, &s->mesh_room, s->mesh_count, sizeof *s->meshes);
	s->meshes[s->mesh_count++] = (struct eco_soup_mesh){ s->triangle_count, material, colored };
}

uint32_t eco_soup_vertex(struct eco_soup *s, const double place[3], const float uv[2], const float rgb[3])
{
	struct eco_soup_vertex v = { .place = { place[0], place[1], place[2] } };
	if (uv)
		memcpy(v.uv, uv, sizeof v.uv);
	if (rgb)
		memcpy(v.rgb, rgb, sizeof v.rgb);
	eco_grow(&s->vertices, &s->vertex_room, s->vertex_count, sizeof v);
	s->vertices[s->vertex_count] = v;
	return s->vertex_count++;
}

void eco_soup_triangle(struct eco_soup *s, uint32_t a, uint32_t b, uint32_t c)
{
	eco_grow(&s->triangles, &s->triangle_room, s->triangle_count, sizeof *s->triangles);
	s->triangles[s->triangle_count++] = (struct eco_soup_triangle){ { a, b, c }, s->part };
}

/* ---- Polygons ---- */

double *eco_soup_corners(struct eco_soup *s)
{
	if (!s->corners) {
		s->corners = eco_alloc(ECO_POLYGON_CORNERS_MAX, 3 * sizeof *s->corners);
		s->split = eco_alloc(ECO_POLYGON_CORNERS_MAX, 4 * sizeof *s->split);
	}
	return s->corners;
}

const uint32_t *eco_soup_split(struct eco_soup *s, uint32_t n)
{
	uint32_t *triangles = s->split + n;
	bool sound = n > 3;
	for (uint32_t i = 0; i < 3 * n && sound; i++)
		sound = isfinite(s->corners[i]);
	if (sound)
		eco_polygon_split(s->corners, n, s->split, triangles);
	for (uint32_t i = 0; i + 2 < n && !sound; i++) {
		triangles[i * 3] = 0;
		triangles[i * 3 + 1] = i + 1;
		triangles[i * 3 + 2] = i + 2;
	}
	return triangles;
}

/* ---- The end ---- */

/* The base to subtract: 0 unless coordinates are far from the origin for their extent. Whole numbers. */
static void set_positions(struct eco_soup *s)
{
	struct eco_bounds b = ECO_NO_BOUNDS;
	struct eco_model *m = s->model;
	double far = 0, *base = s->frame->base;
	for (uint32_t i = 0; i < s->vertex_count; i++)
		eco_bounds_add(&b, s->vertices[i].place);
	for (int k = 0; k < 3 && b.low[0] <= b.high[0]; k++)
		far = fmax(far, fmax(b.high[k], -b.low[k]));
	for (int k = 0; k < 3; k++) {
		double middle = (b.low[k] + b.high[k]) / 2;
		bool moves = far > NEAR * extent_of(&b) && middle > -1e15 && middle < 1e15;
		base[k] = moves ? (double)(int64_t)middle : 0;
	}
	for (uint32_t i = 0; i < s->vertex_count; i++) {
		for (int k = 0; k < 3; k++)
			m->position[(size_t)i * 3 + (size_t)k] = (float)(s->vertices[i].place[k] - base[k]);
		memcpy(&m->uv[(size_t)i * 2], s->vertices[i].uv, 2 * sizeof *m->uv);
	}
	m->vertex_count = s->vertex_count;
	if (isfinite(s->far) && s->far * 0x1p-24 > extent_of(&b) * COARSE)
		eco_note(s->notes,
			"its coordinates are up to %g from the origin, in single precision, and so only "
			"exact to %.2g of their unit: export it with a local origin",
			s->far, s->far * 0x1p-24);
}

struct colors { float first[3]; double sum[3]; uint64_t count; bool differ; };

static void add_corners(struct colors *c, const struct eco_soup *s, uint32_t triangle)
{
	const uint32_t *v = s->triangles[triangle].v;
	for (int i = 0; i < 3; i++) {
		for (int k = 0; k < 3 && v[i] != ECO_NONE; k++) {
			float value = s->vertices[v[i]].rgb[k];
			value = isfinite(value) ? value : 1;
			c->first[k] = c->count ? c->first[k] : value;
			c->differ |= fabsf(value - c->first[k]) > ONE_COLOUR;
			c->sum[k] += (double)value;
		}
		c->count += v[i] != ECO_NONE;
	}
}

static void mean_of(const struct eco_soup *s, const struct colors *c, uint8_t rgb[3])
{
	for (int k = 0; k < 3; k++) {
		double mean = c->sum[k] / (double)c->count;
		rgb[k] = s->linear ? eco_srgb_from_linear(mean) : eco_byte_from_share(mean);
	}
}

/* The material of a whole mesh, times the mean of its colours; ECO_NONE: they differ, and triangles have
 * materials of their own. With a picture, colours that differ are averaged, and counted: every further colour
 * would need another image, and would cut leaves and branches into pieces. */
static uint32_t material_of(struct eco_soup *s, struct eco_tints *tints, uint32_t mesh, uint32_t end,
	uint32_t *averaged)
{
	const struct eco_soup_mesh *of = &s->meshes[mesh];
	struct colors c = { .count = 0 };
	uint8_t rgb[3];
	for (uint32_t t = of->triangle; t < end && of->colored; t++)
		add_corners(&c, s, t);
	if (c.count == 0)
		return of->material;
	if (c.differ && s->model->materials[of->material].image == ECO_NONE)
		return ECO_NONE;
	*averaged += c.differ;
	mean_of(s, &c, rgb);
	return eco_tints_get(tints, of->material, rgb);
}

static uint32_t triangle_material(struct eco_soup *s, struct eco_tints *tints, uint32_t material, uint32_t triangle)
{
	struct colors c = { .count = 0 };
	uint8_t rgb[3];
	add_corners(&c, s, triangle);
	if (c.count < 3)
		return material;
	mean_of(s, &c, rgb);
	eco_tint_step(rgb);
	return eco_tints_get(tints, material, rgb);
}

/* Triangles of invisible materials are dropped. */
static void set_triangles(struct eco_soup *s, struct eco_tints *tints, const char *fields)
{
	struct eco_model *m = s->model;
	uint32_t kept = 0, averaged = 0;
	for (uint32_t i = 0; i < s->mesh_count; i++) {
		const struct eco_soup_mesh *mesh = &s->meshes[i];
		uint32_t end = i + 1 < s->mesh_count ? mesh[1].triangle : s->triangle_count;
		if (s->invisible[mesh->material])
			continue;
		uint32_t whole = material_of(s, tints, i, end, &averaged);
		for (uint32_t t = mesh->triangle; t < end; t++, kept++) {
			m->material[kept] = whole != ECO_NONE ? whole
				: triangle_material(s, tints, mesh->material, t);
			memcpy(&m->index[(size_t)kept * 3], s->triangles[t].v, 3 * sizeof *m->index);
			m->part[kept] = s->triangles[t].part;
		}
	}
	const uint32_t hidden = s->triangle_count - kept;
	m->triangles_in = s->triangle_count;
	m->triangle_count = kept;
	m->dropped[ECO_DROP_TRANSPARENT] = hidden;
	if (hidden > 0)
		eco_note(s->notes, "%u triangles have materials with alpha below 0.5 (%s): they are left out", hidden,
			fields);
	if (averaged > 0)
		eco_note(s->notes, "%u textured meshes have vertex colours that differ: each is drawn in their "
			"mean", averaged);
}

void eco_soup_end(struct eco_soup *s, const char *fields)
{
	struct eco_tints tints;
	eco_tints_start(&tints, s->model);
	eco_model_reserve(s->model, s->vertex_count, s->triangle_count);
	if (!s->model->parts)
		s->model->parts = eco_alloc(1, sizeof *s->model->parts);
	set_positions(s);
	set_triangles(s, &tints, fields);
	eco_tints_end(&tints);
}

void eco_soup_free(struct eco_soup *s)
{
	free(s->vertices);
	free(s->triangles);
	free(s->meshes);
	free(s->corners);
	free(s->split);
}
