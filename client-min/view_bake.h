/* What a cut, or a tile of the ground, draws as plain triangles (lod/bake.h). */
#ifndef VIEW_BAKE_H
#define VIEW_BAKE_H

#include "client-min/view_select.h"
#include "lod/bake.h"

/* In plant space. *image: its texture, which stays the store's, or NULL. */
enum eco_code view_bake_cut(struct lod_bake *bake, const struct view_list **image,
	const struct view_store *store, const struct eco_cut *cut, struct eco_error *error);
/* Light of ground without an image, about. */
extern const float view_bake_plain[3];
/* From ground->at, with the diagonals that are drawn; white, or with an image its colours at the samples, the
 * ground's own where it has none. */
enum eco_code view_bake_ground(struct lod_bake *bake, const struct view_ground *ground,
	const struct view_image *image, const struct view_ground_tile *tile, struct eco_error *error);

#endif
