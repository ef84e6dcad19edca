/* Elements: fans of one to four triangles around a common corner, kept, dropped or scaled as one.
 *
 * A leaf of up to four triangles usually is one fan. Larger surfaces are cut into fans greedily: the triangle
 * with the fewest free neighbours goes first (it is the likeliest to be left alone) and takes the largest fan
 * that contains it. */
#pragma once

#include "lod/build/organ/organ.h"

struct lod_element {
	uint8_t corners; /* 3 to ECO_CORNERS_MAX; triangle i of the fan is corners 0, i + 1, i + 2 */
	uint32_t vertex[ECO_CORNERS_MAX];        /* of the mesh */
	uint32_t triangle[ECO_CORNERS_MAX - 2];  /* of the mesh: each triangle of the fan */
};

struct lod_elements {
	uint32_t count;
	struct lod_element *items;
};

/* Turns the diagonal of a planar quad where that makes one fan of a component of four triangles: a leaf of
 * two quads whose exporter chose the other diagonal. The same surface is covered (within 1e-4 of the quad's
 * size, textures included). To be called before anything is derived from triangles. */
void lod_elements_turn_diagonals(struct lod_mesh *mesh, struct lod_arena *arena);

/* All triangles that are neither wood nor collapsed, each in exactly one element. Triangles of an element
 * belong to one component and continue each other's texture. Array from `arena`. */
void lod_elements_make(struct lod_elements *elements, const struct lod_mesh *mesh,
	const struct lod_organs *organs, struct lod_arena *arena);

/* Texture coordinates of the element's corners in 1/ECO_UV_ONE, shifted by whole turns so that the least are
 * in [0, 1). */
void lod_element_uv(const struct lod_element *element, const struct lod_mesh *mesh, int32_t *uv);
/* Shifts texture coordinates (2 each) by whole turns, to the least that are not negative. */
void lod_uv_unturn(int32_t *uv, uint32_t corners);

struct lod_v3;
/* Metres: mean of the corners; sum of the triangles' normals with signs made to agree (its length is the
 * area). */
struct lod_v3 lod_element_center(const struct lod_element *element, const struct lod_mesh *mesh);
struct lod_v3 lod_element_normal(const struct lod_element *element, const struct lod_mesh *mesh);

/* The two most distant corners of the element, as indices into its corners. */
void lod_element_axis(const struct lod_element *element, const struct lod_mesh *mesh, uint32_t ends[2]);
