/* A model made ready for decisions: vertices welded by position, useless triangles dropped and counted, every
 * vertex on the plant's integer grid, neighbours across edges, connected components.
 *
 * Decisions (organs, order, cells) use `place`, the welded positions in metres, so that they do not depend on
 * the grid; lists store `grid`. A component is connected by vertices within one material and one organ rule:
 * a leaf that touches a twig but has another material stays a leaf. */
#pragma once

#include <stddef.h>

#include "ecofiles/format/model.h"
#include "lod/arena.h"
#include "lod/vector.h"

#define LOD_WELD_BITS_MAX 20u

struct lod_mesh {
	double origin[3], step;      /* metres = origin + grid * step, for every list of the plant */
	float low[3], high[3];       /* bounds of all vertices, metres */
	uint32_t vertex_count;
	float *place;                /* 3 per vertex, metres */
	int32_t *grid;               /* 3 per vertex, in [0, 2^bits] */
	uint32_t triangle_count;
	uint32_t *index;             /* 3 per triangle */
	uint32_t *material;          /* per triangle: index into the model's materials, or ECO_NONE */
	uint32_t *source;            /* per triangle: its index in the model */
	/* per triangle: enum eco_organ of a rule, or ECO_ORGAN_FOUND; << 8 | its number in the model's
	 * importances */
	uint16_t *rule;
	int32_t *uv;                 /* 6 per triangle in 1/ECO_UV_ONE, zero if its material has no image */
	bool *collapsed;             /* per triangle: used for decisions, but not stored: it has no area on
	                              * the grid, or it is a rim that only closes its leaf (a line over
	                              * transparent texels) */
	uint32_t *across;            /* per triangle edge (k to k+1): 3 * neighbour + its edge, or ECO_NONE at
	                              * a border or between more than two triangles; the neighbour may be of
	                              * another component */
	uint32_t component_count;
	uint32_t *component;         /* per triangle */
	uint32_t *member_first; /* component c has triangles member[member_first[c] .. member_first[c+1]) */
	uint32_t *member;
	uint32_t dropped[ECO_DROP_COUNT];    /* triangles of the model dropped here */
	uint32_t unstored;           /* of `dropped`: collapsed */
};

/* Corner k (modulo 3) of triangle t, metres. */
static inline struct lod_v3 lod_mesh_corner(const struct lod_mesh *mesh, uint32_t t, uint32_t k)
{
	return lod_v3_of(mesh->place + 3 * (size_t)mesh->index[3 * (size_t)t + k % 3]);
}

/* Normal of triangle t, as long as its area. */
static inline struct lod_v3 lod_mesh_area_normal(const struct lod_mesh *mesh, uint32_t t)
{
	struct lod_v3 a = lod_mesh_corner(mesh, t, 0);
	return lod_v3_scale(lod_v3_cross(lod_v3_sub(lod_mesh_corner(mesh, t, 1), a),
		lod_v3_sub(lod_mesh_corner(mesh, t, 2), a)), 0.5);
}

/* Arrays come from `arena`. `bits`: of the grid over the largest extent (1 to LOD_WELD_BITS_MAX). Vertices
 * closer than 1e-6 of the largest extent become one. Afterwards triangle_count - unstored + sum of dropped =
 * model->triangle_count. A mesh without triangles is a valid result. */
void lod_weld(struct lod_mesh *mesh, const struct eco_model *model, uint32_t bits, struct lod_arena *arena);

/* Whether three vertices span no area on the grid. */
bool lod_mesh_flat(const struct lod_mesh *mesh, const uint32_t *vertices);

/* Whether a triangle of the model has valid and finite corners; otherwise *why (may be NULL) is set. */
bool lod_mesh_usable(const struct eco_model *model, uint32_t triangle, enum eco_drop *why);

/* Numbers components: triangles with one root (ecofiles/base/union.h: `parent` has one entry each) are one,
 * in the order of their first triangles. Fills component, member and member_first, which has room for
 * triangle_count + 2. */
void lod_mesh_number(struct lod_mesh *mesh, uint32_t *parent);

/* Finds `across` again after triangles have changed. */
void lod_weld_neighbours(struct lod_mesh *mesh, struct lod_arena *arena);

/* The neighbour across edge k of triangle t within its component: 3 * triangle + edge, or ECO_NONE. */
static inline uint32_t lod_mesh_across(const struct lod_mesh *mesh, uint32_t t, uint32_t k)
{
	uint32_t edge = mesh->across[3 * (size_t)t + k];
	return edge != ECO_NONE && mesh->component[edge / 3] == mesh->component[t] ? edge : ECO_NONE;
}

static inline const struct eco_material *lod_mesh_material(const struct eco_model *model, uint32_t material)
{
	static const struct eco_material none = { .name = "", .rgb = { 128, 128, 128 }, .image = ECO_NONE };
	return material < model->material_count ? &model->materials[material] : &none;
}

/* The material's image, or NULL. */
static inline const struct eco_image *lod_mesh_image(const struct eco_model *model, uint32_t material)
{
	const struct eco_material *m = lod_mesh_material(model, material);
	return m->image < model->image_count && model->uv ? &model->images[m->image] : NULL;
}
