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

void eco_model_split(const double *corners, uint32_t n, uint32_t *split)
{
	uint32_t *triangles = split + n;
	bool sound = n > 3;
	for (uint32_t i = 0; i < 3 * n && sound; i++)
		sound = isfinite(corners[i]);
	if (sound)
		eco_polygon_split(corners, n, split, triangles);
	for (uint32_t i = 0; i + 2 < n && !sound; i++) {
		triangles[i * 3] = 0;
		triangles[i * 3 + 1] = i + 1;
		triangles[i * 3 + 2] = i + 2;
	}
}

void eco_model_reserve(struct eco_model *m, uint64_t vertices, uint64_t triangles, uint64_t parts)
{
	m->position = eco_alloc(vertices + 1, 3 * sizeof *m->position);
	m->uv = eco_alloc(vertices + 1, 2 * sizeof *m->uv);
	m->index = eco_alloc(triangles + 1, 3 * sizeof *m->index);
	m->material = eco_alloc(triangles + 1, sizeof *m->material);
	m->part = eco_alloc(triangles + 1, sizeof *m->part);
	m->parts = eco_alloc(parts + 1, sizeof *m->parts);
}

void eco_soup_reserve(struct eco_soup *s, uint64_t vertices, uint64_t triangles, uint64_t parts, bool colors)
{
	s->place = eco_alloc(vertices + 1, sizeof *s->place);
	s->color = colors ? eco_alloc(vertices + 1, sizeof *s->color) : NULL;
	eco_model_reserve(s->model, vertices, triangles, parts);
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
			&& strcmp(m->parts[m->part_count - 1].name, part.name) != 0))
		m->parts[m->part_count++] = part;
	s->part = m->part_count - 1;
}

void eco_soup_mesh(struct eco_soup *s, uint32_t material, bool colored)
{
	eco_grow(&s->meshes, &s->mesh_room, s->mesh_count, sizeof *s->meshes);
	s->meshes[s->mesh_count++] = (struct eco_soup_mesh){ s->model->triangle_count, material, colored };
}

uint32_t eco_soup_vertex(struct eco_soup *s, const double place[3], const float uv[2], const float rgb[3])
{
	uint32_t v = s->model->vertex_count++;
	memcpy(s->place[v], place, sizeof s->place[v]);
	if (uv)
		memcpy(&s->model->uv[(size_t)v * 2], uv, 2 * sizeof *uv);
	if (rgb && s->color)
		memcpy(s->color[v], rgb, sizeof s->color[v]);
	return v;
}

void eco_soup_triangle(struct eco_soup *s, uint32_t a, uint32_t b, uint32_t c)
{
	struct eco_model *m = s->model;
	const uint32_t v[3] = { a, b, c };
	memcpy(&m->index[(size_t)m->triangle_count * 3], v, sizeof v);
	m->part[m->triangle_count++] = s->part;
}

/* ---- The end ---- */

/* The base to subtract: 0 unless coordinates are far from the origin for their extent. Whole numbers. */
static void set_positions(struct eco_soup *s)
{
	struct eco_bounds b = ECO_NO_BOUNDS;
	double far = 0;
	for (uint32_t i = 0; i < s->model->vertex_count; i++)
		eco_bounds_add(&b, s->place[i]);
	for (int k = 0; k < 3 && b.low[0] <= b.high[0]; k++)
		far = fmax(far, fmax(b.high[k], -b.low[k]));
	for (int k = 0; k < 3; k++) {
		double middle = (b.low[k] + b.high[k]) / 2;
		bool moves = far > NEAR * extent_of(&b) && middle > -1e15 && middle < 1e15;
		s->frame->base[k] = moves ? (double)(int64_t)middle : 0;
	}
	for (size_t i = 0; i < 3 * (size_t)s->model->vertex_count; i++)
		s->model->position[i] = (float)(s->place[i / 3][i % 3] - s->frame->base[i % 3]);
	if (isfinite(s->far) && s->far * 0x1p-24 > extent_of(&b) * COARSE)
		eco_note(s->notes,
			"its coordinates are up to %g from the origin, in single precision, and so only "
			"exact to %.2g of their unit: export it with a local origin",
			s->far, s->far * 0x1p-24);
}

struct colors { float first[3]; double sum[3]; uint64_t count; bool differ; };

static void add_corners(struct colors *c, const struct eco_soup *s, uint32_t triangle)
{
	const uint32_t *v = &s->model->index[(size_t)triangle * 3];
	for (int i = 0; i < 3; i++) {
		for (int k = 0; k < 3 && v[i] != ECO_NONE; k++) {
			float value = isfinite(s->color[v[i]][k]) ? s->color[v[i]][k] : 1;
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

/* Sets materials; triangles of invisible ones are dropped. */
static void set_materials(struct eco_soup *s, struct eco_tints *tints, const char *fields)
{
	struct eco_model *m = s->model;
	uint32_t kept = 0, averaged = 0, hidden = 0;
	m->triangles_in = m->triangle_count;
	for (uint32_t i = 0; i < s->mesh_count; i++) {
		const struct eco_soup_mesh *mesh = &s->meshes[i];
		uint32_t end = i + 1 < s->mesh_count ? mesh[1].triangle : m->triangle_count, whole;
		if (s->invisible[mesh->material]) {
			hidden += end - mesh->triangle;
			continue;
		}
		whole = material_of(s, tints, i, end, &averaged);
		for (uint32_t t = mesh->triangle; t < end; t++, kept++) {
			m->material[kept] = whole != ECO_NONE ? whole
				: triangle_material(s, tints, mesh->material, t);
			memmove(&m->index[(size_t)kept * 3], &m->index[(size_t)t * 3], 3 * sizeof *m->index);
			m->part[kept] = m->part[t];
		}
	}
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
	set_positions(s);
	set_materials(s, &tints, fields);
	eco_tints_end(&tints);
}

void eco_soup_free(struct eco_soup *s)
{
	free(s->place);
	free(s->color);
	free(s->meshes);
}
