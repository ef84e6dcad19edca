#include "lod/bake.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/array_grow.h"
#include "lod/light.h"

/* The mean outline of a convex body is a quarter of its surface (Cauchy). */
#define OCTAHEDRON 1.3467736             /* its half axis over a ball's radius: sqrt(pi / sqrt 3) */
#define ICOSAHEDRON 1.1456345            /* the same of its circumscribed radius */
#define PRISM 0.6045998                  /* its circumscribed radius over a line's width: pi / (3 sqrt 3) */

#define FEW 64u                          /* balls: then they are large in the picture, and rounder */

enum shape { TRIANGLE, LINE, BALL, ROUND_BALL, SHAPES };
static const struct { uint32_t vertices, indices; } shapes[SHAPES] = { { 3, 3 }, { 6, 18 }, { 6, 24 },
	{ 12, 60 } };
/* around the first end, then around the second */
static const uint8_t prism_index[18] = { 0, 1, 4, 0, 4, 3, 1, 2, 5, 1, 5, 4, 2, 0, 3, 2, 3, 5 };
/* the ends of the first half axis, of the second, of the third */
static const uint8_t octahedron_index[24] = { 0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5,
	0, 3, 5 };
/* in circumscribed radii: (1, golden ratio) of length 1, turned through the axes */
#define ICO_A 0.5257311
#define ICO_B 0.8506508
static const double icosahedron[12][3] = { { -ICO_A, ICO_B, 0 }, { ICO_A, ICO_B, 0 }, { -ICO_A, -ICO_B, 0 },
	{ ICO_A, -ICO_B, 0 }, { 0, -ICO_A, ICO_B }, { 0, ICO_A, ICO_B }, { 0, -ICO_A, -ICO_B },
	{ 0, ICO_A, -ICO_B }, { ICO_B, 0, -ICO_A }, { ICO_B, 0, ICO_A }, { -ICO_B, 0, -ICO_A },
	{ -ICO_B, 0, ICO_A } };
static const uint8_t icosahedron_index[60] = { 0, 11, 5, 0, 5, 1, 0, 1, 7, 0, 7, 10, 0, 10, 11, 1, 5, 9, 5,
	11,
	4, 11, 10, 2, 10, 7, 6, 7, 1, 8, 3, 9, 4, 3, 4, 2, 3, 2, 6, 3, 6, 8, 3, 8, 9, 4, 9, 5, 2, 4, 11, 6, 2,
	10, 8, 6, 7, 9, 8, 1 };
static const uint8_t *const shape_index[SHAPES] = { NULL, prism_index, octahedron_index, icosahedron_index };

enum eco_code lod_bake_room(struct lod_bake *bake, size_t vertices, size_t indices, bool uv,
	struct eco_error *error)
{
	if (vertices > UINT32_MAX || indices > UINT32_MAX)
		return eco_fail(error, ECO_TOO_LARGE,
			"a list has more triangles than a file of them may have");
	*bake = (struct lod_bake){ .vertex_count = (uint32_t)vertices };
	bake->index_count = (uint32_t)indices;
	bake->position = malloc(vertices * 3 * sizeof *bake->position + 1);
	bake->color = malloc(vertices * 4 * sizeof *bake->color + 1);
	bake->uv = uv ? malloc(vertices * 2 * sizeof *bake->uv + 1) : NULL;
	bake->index = malloc(indices * sizeof *bake->index + 1);
	if (bake->position && bake->color && bake->index && (bake->uv || !uv))
		return ECO_OK;
	lod_bake_free(bake);
	return eco_fail(error, ECO_NO_MEMORY, "no memory for triangles");
}

/* The direction of a line, and two of length 1 across it and each other. */
static void frame_of(const float *a, double across[2][3])
{
	double along[3], length = 0;
	int least = 0;
	for (int k = 0; k < 3; k++) {
		along[k] = (double)a[3 + k] - a[k];
		length += along[k] * along[k];
		least = fabs(along[k]) < fabs(along[least]) ? k : least;
	}
	length = length > 0 ? sqrt(length) : 1;

	double part = along[least] / length, rest = sqrt(fmax(1 - part * part, 1e-12));
	for (int k = 0; k < 3; k++)
		across[0][k] = ((k == least) - part * along[k] / length) / rest;
	for (int k = 0; k < 3; k++)
		across[1][k] = (along[(k + 1) % 3] * across[0][(k + 2) % 3]
			- along[(k + 2) % 3] * across[0][(k + 1) % 3]) / length;
}

static void put_prism(const float *a, double width, float *out)
{
	static const double corner[3][2] = { { 1, 0 }, { -0.5, 0.8660254 }, { -0.5, -0.8660254 } };
	double across[2][3];
	frame_of(a, across);
	for (int i = 0; i < 6; i++)
		for (int k = 0; k < 3; k++)
			out[3 * i + k] = (float)((double)a[3 * (i / 3) + k] + PRISM * width
				* (corner[i % 3][0] * across[0][k] + corner[i % 3][1] * across[1][k]));
}

/* An ellipsoid by its half axes; `seen`: the share of its outline that is covered. */
static void put_ball(enum shape shape, const float center[3], const float half[9], double seen, float *out)
{
	double size = sqrt(seen) * (shape == ROUND_BALL ? ICOSAHEDRON : OCTAHEDRON);
	for (uint32_t i = 0; i < shapes[shape].vertices; i++)
		for (int k = 0; k < 3; k++, out++) {
			double at = 0;
			if (shape == BALL)
				at = (i & 1 ? -1 : 1) * (double)half[3 * (i / 2) + (uint32_t)k];
			else
				for (int axis = 0; axis < 3; axis++)
					at += icosahedron[i][axis] * (double)half[3 * axis + k];
			*out = (float)((double)center[k] + size * at);
		}
}

static void put_own_ball(const struct lod_bake_input *in, enum shape shape, uint32_t i, float *out)
{
	const struct lod_geometry *g = in->geometry;
	const float *center = g->position + 3 * (size_t)i;
	if (g->half) {
		put_ball(shape, center, g->half + 9 * (size_t)i, g->opacity ? (double)g->opacity[i] : 1, out);
		return;
	}
	float r = sqrtf(in->area * (g->size ? g->size[i] : 1) / 3.14159265f);
	put_ball(shape, center, (const float[9]){ r, 0, 0, 0, r, 0, 0, 0, r },
		g->opacity ? (double)g->opacity[i] : 1, out);
}

static void own_color(const struct lod_bake_input *in, uint32_t i, uint8_t rgb[3])
{
	static const uint8_t plain[3] = { 95, 127, 79 }, white[3] = { 255, 255, 255 };
	const struct eco_list *list = in->list;
	int32_t color = in->geometry->color[i];
	memcpy(rgb, color >= 0 && (uint32_t)color < list->palette_count ? in->palette[color]
		: list->image != ECO_NONE ? white : plain, 3);
}

void lod_bake_color(const uint8_t rgb[3], uint32_t count, uint16_t *out)
{
	for (uint32_t i = 0; i < count; i++, out += 4) {
		for (int k = 0; k < 3; k++)
			out[k] = lod_light_of[rgb[k]];
		out[3] = 65535;
	}
}

static void put_primitive(struct lod_bake *bake, const struct lod_bake_input *in, enum shape shape,
	uint32_t i)
{
	uint32_t vertex = i * shapes[shape].vertices;
	float *position = bake->position + 3 * (size_t)vertex;
	uint32_t *index = bake->index + (size_t)i * shapes[shape].indices;
	uint8_t rgb[3];
	if (shape == TRIANGLE)
		memcpy(position, in->geometry->position + 9 * (size_t)i, 9 * sizeof *position);
	else if (shape == LINE)
		put_prism(in->geometry->position + 6 * (size_t)i, (double)in->geometry->width[i], position);
	else
		put_own_ball(in, shape, i, position);
	for (uint32_t k = 0; k < shapes[shape].indices; k++)
		index[k] = vertex + (shape == TRIANGLE ? k : shape_index[shape][k]);
	if (bake->uv)
		memcpy(bake->uv + 2 * (size_t)vertex, in->geometry->uv + 6 * (size_t)i,
			6 * sizeof *bake->uv);
	own_color(in, i, rgb);
	lod_bake_color(rgb, shapes[shape].vertices, bake->color + 4 * (size_t)vertex);
}

static enum eco_code bake_impostor(struct lod_bake *bake, const struct lod_impostor *impostor,
	struct eco_error *error)
{
	const struct eco_impostor_body *body = &impostor->body;
	struct lod_light light = { .weight = 0 };
	uint8_t rgb[3] = { 95, 127, 79 };
	enum eco_code code = lod_bake_room(bake, shapes[ROUND_BALL].vertices, shapes[ROUND_BALL].indices,
		false,
		error);
	if (code)
		return code;
	for (uint32_t i = 0; i < impostor->cell_count; i++)
		lod_light_add(&light, impostor->rgb[i], 1);
	lod_light_mean(&light, rgb);
	put_ball(ROUND_BALL, body->center, (const float[9]){ body->wide, 0, 0, 0, body->wide, 0, 0, 0,
		body->high }, 1, bake->position);
	for (uint32_t k = 0; k < shapes[ROUND_BALL].indices; k++)
		bake->index[k] = icosahedron_index[k];
	lod_bake_color(rgb, shapes[ROUND_BALL].vertices, bake->color);
	return ECO_OK;
}

enum eco_code lod_bake_make(struct lod_bake *bake, const struct lod_bake_input *in, struct eco_error *error)
{
	uint8_t kind = in->list->kind;
	enum shape shape = kind == ECO_LIST_TRIANGLES ? TRIANGLE : kind == ECO_LIST_LINES ? LINE
		: in->count < FEW ? ROUND_BALL : BALL;
	if (in->impostor)
		return bake_impostor(bake, in->impostor, error);
	enum eco_code code = lod_bake_room(bake, (size_t)in->count * shapes[shape].vertices,
		(size_t)in->count * shapes[shape].indices, in->geometry->uv, error);
	for (uint32_t i = 0; i < in->count && !code; i++)
		put_primitive(bake, in, shape, i);
	return code;
}

void lod_bake_free(struct lod_bake *bake)
{
	eco_free(bake->position, bake->color, bake->uv, bake->index);
	*bake = (struct lod_bake){ .position = NULL };
}
