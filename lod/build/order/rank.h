/* The greedy order on Precision and Recall: each time the element whose footprint adds most, right minus
 * wrong pixels over many views, at the scale that serves the octave of the list best; then the list is
 * refined as a whole (rank_refine.c). Growth codes (eco_growth) and simple triangles come with it.
 * Deterministic: counts of pixels decide, ties go to the smaller element. */
#pragma once

#include "lod/build/foliage.h"
#include "lod/build/plant.h"

struct lod_rank_options {
	uint32_t views, pixels;              /* 0: chosen by the plant */
	uint32_t seed;
	bool leaves;                         /* no leaf will be drawn as a point */
	/* as in lod_plant_options */
	bool (*progress)(void *ctx, double share);
	lod_each *each;
	void *ctx;
};

struct lod_rank {                    /* arrays of the arena */
	uint32_t *order;             /* elements, the most valuable first */
	uint8_t *growth;             /* per element: code for eco_growth */
	struct lod_simple *simple;   /* per element: the triangle that stands for it */
};

/* ECO_INTERRUPTED if progress returns false. A tree of 500,000 triangles takes at most 3 minutes on two
 * cores. */
enum eco_code lod_rank_make(struct lod_rank *rank, const struct lod_foliage *foliage,
	const struct lod_rank_options *options, struct lod_arena *arena, struct eco_error *error);
