/* The inside of making impostors, shared by impostor_views.c (pictures of the model) and impostor_make.c
 * (levels of them). */
#ifndef LOD_IMPOSTOR_STATE_H
#define LOD_IMPOSTOR_STATE_H

#include "lod/arena.h"
#include "lod/build/impostor/impostor_make.h"

#define VIEW_TEXELS ECO_IMPOSTOR_TEXELS_MAX
#define VIEW_CELLS 16u                   /* a side, of depths and colours */
#define VIEW_SAMPLES 4u                  /* a side of a texel */

struct impostor_cell {
	double count;                        /* covered samples */
	double middle;                       /* sums: middle between near and far surface, towards the
	                                      * eye, radii */
	double light[3];                     /* 1/65535 */
};
/* A tile as it is. */
struct impostor_view {
	uint8_t count[VIEW_TEXELS * VIEW_TEXELS];        /* covered samples */
	struct impostor_cell cell[VIEW_CELLS * VIEW_CELLS];
	double thick, ball;                  /* sums over samples: half the thickness, radii, and that of an
	                                      * ellipsoid that fills the tile and is 1 in its middle */
};

/* The cylinder around the usable triangles, without `thick`. False: there are none. */
bool impostor_body_find(struct eco_impostor_body *body, const struct eco_model *model);

/* The views of all tiles of a set, in memory of the arena. `rgb` as in lod_impostors_options. */
enum eco_code impostor_views_make(struct impostor_view **views, enum eco_impostor_set set,
	const struct eco_impostor_body *body, const struct eco_model *model,
	const struct lod_impostors_options *options, const uint8_t (*rgb)[3], struct lod_arena *arena,
	struct eco_error *error);

#endif
