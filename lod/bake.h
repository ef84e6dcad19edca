/* A list's primitives as plain triangles, for programs that know neither wide lines nor points nor
 * ellipsoids: a line is a prism (6 triangles), a point or ellipsoid an octahedron (8; an icosahedron, 20,
 * where there are few), an impostor an icosahedron about the plant in its mean colour. The mean area of their
 * outlines over all directions is that of what they stand for; of a splat its opacity's share. */
#pragma once

#include "lod/geometry.h"
#include "lod/impostor.h"

struct lod_bake {                        /* owns its arrays; zero is empty */
	float *position;                 /* 3 a vertex */
	uint16_t *color;                 /* 4 a vertex: light, not sRGB, of 65535; the last is 65535 */
	float *uv;                       /* 2 a vertex, from the top left; NULL: no texture */
	uint32_t *index;                 /* 3 a triangle */
	uint32_t vertex_count, index_count;
};

struct lod_bake_input {
	const struct eco_list *list;
	const uint8_t (*palette)[3];             /* of the list */
	const struct lod_geometry *geometry;     /* with color, at the cut's scale */
	const struct lod_impostor *impostor;     /* in its place; or NULL */
	uint32_t count;                          /* primitives */
	float area;                              /* of points: the list's unit_area * the cut's scale */
};
/* Into an empty bake, which stays so on failure. */
enum eco_code lod_bake_make(struct lod_bake *bake, const struct lod_bake_input *input,
	struct eco_error *error);
void lod_bake_free(struct lod_bake *bake);

/* Arrays to be filled by the caller. */
enum eco_code lod_bake_room(struct lod_bake *bake, size_t vertices, size_t indices, bool uv,
	struct eco_error *error);
/* `count` vertices of an sRGB colour. */
void lod_bake_color(const uint8_t rgb[3], uint32_t count, uint16_t *out);
