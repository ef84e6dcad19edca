/* Refines the order as a whole: from which key on an element is drawn, and its growth code. */
#ifndef LOD_RANK_REFINE_H
#define LOD_RANK_REFINE_H

#include "lod/build/order/rank.h"
#include "lod/build/order/rank_crown.h"

/* The share of lod_rank_make's progress before the refinement. */
#define LOD_RANK_REFINE_FROM 0.7

struct lod_rank_refining {
	struct lod_crown *crown;
	const struct lod_rank_options *options;      /* progress, each, ctx */
	uint32_t count;              /* elements */
	uint32_t *order;             /* in and out */
	uint8_t *growth;             /* per element: in and out */
	bool many_points;            /* leaves are points far into the list */
};
/* False if progress returns false. The caller releases scratch memory of the arena. */
bool lod_rank_refine(const struct lod_rank_refining *refining, struct lod_arena *arena);

#endif
