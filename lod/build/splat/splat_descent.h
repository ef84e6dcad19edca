/* Gradient descent of one level of splats: Adam (Kingma and Ba 2015) on batches of views, with falling steps
 * and edges that grow sharper. */
#ifndef LOD_SPLAT_DESCENT_H
#define LOD_SPLAT_DESCENT_H

#include "lod/build/splat/splat_state.h"

struct splat_descent {
	const struct splat_views *views, *coarse;
	float coarse_share;              /* so much of the descent looks at `coarse`, the rest at `views` */
	struct splat_params *splats;     /* a level; in: where it begins, out: where it ends */
	uint32_t count;
	/* The level before, as it ended, or NULL: then some steps draw some of it with the children of the
	 * others, so that pictures between two levels are good, too. */
	const struct splat_params *parents;
	uint32_t children;               /* of each parent */
	bool opaque, blades;             /* blades: of a plant of blades, which takes more views a step */
	float chance;                    /* struct splat_softness */
	bool settle;                     /* shapes stay, as they have been rounded; a few steps of the rest */
	uint32_t level, levels;          /* for progress */
	const struct lod_splats_options *options;
	double loss;                     /* out: mean 1 - soft Q of all views */
};

/* False if progress says stop. */
bool splat_descend(struct splat_descent *descent, struct lod_arena *arena);

#endif
