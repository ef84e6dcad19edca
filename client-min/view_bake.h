/* What a cut draws as plain triangles, for programs that know neither wide lines nor points nor ellipsoids:
 *
 *   triangle         itself
 *   line             a prism of three sides: 6 triangles
 *   point, ellipsoid an octahedron, 8 triangles; an icosahedron, 20, where the cut has few of them
 *   impostor         an icosahedron about the whole plant, in the impostor's mean colour
 *
 * They are as large as makes their outlines' area, mean over all directions, that of what
 * they stand for; of a splat its opacity's share of that. */
#ifndef VIEW_BAKE_H
#define VIEW_BAKE_H

#include "client-min/view_select.h"

struct view_bake {                       /* owns its arrays; zero is empty */
	float *position;                 /* 3 a vertex: plant space, or from ground->at */
	uint16_t *color;                 /* 4 a vertex: light, not sRGB, of 65535; the last is 65535 */
	float *uv;                       /* 2 a vertex, from the top left; NULL: no texture */
	uint32_t *index;                 /* 3 a triangle */
	uint32_t vertex_count, index_count;
	const struct view_list *image;   /* its texture, or NULL */
};

enum eco_code view_bake_cut(struct view_bake *bake, const struct view_store *store, const struct eco_cut *cut,
	struct eco_error *error);
/* A tile of the ground, whose diagonals are those that are drawn; without a colour of its own. */
enum eco_code view_bake_ground(struct view_bake *bake, const struct view_ground *ground,
	const struct view_ground_tile *tile, struct eco_error *error);
void view_bake_free(struct view_bake *bake);

#endif
