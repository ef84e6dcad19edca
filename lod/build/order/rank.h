/* Our order: greedy on Precision and Recall. Elements are picked one by one (the first as points), each the one whose footprint adds most
 * (right minus wrong) pixels over many views to what is covered already, octave by octave of the list at the scale that serves the octave
 * best, lazily (gains mostly fall as more is covered), and the list is then looked at again as a whole (rank_refine.h). With it come how
 * far each element follows a scale (eco_growth) and simpler shapes.
 *
 * Deterministic: counts of pixels decide, ties go to the smaller element. */
#ifndef LOD_RANK_H
#define LOD_RANK_H

#include "lod/build/foliage.h"

typedef void lod_rank_each(void *ctx, uint32_t count, void (*piece)(void *pieces, uint32_t i), void *pieces);

struct lod_rank_options {
	uint32_t views, pixels;              /* 0: chosen by the plant */
	const double (*directions)[3];       /* `views` of them; NULL: spread all around. For lists per sector of view */
	uint32_t seed;
	bool plain;                          /* neither growth codes nor simpler shapes: the order alone */
	bool leaves;                         /* no leaf will be drawn as a point */
	bool wrong_pixels;                   /* what counts is pixels that are wrong, as in Lee's table, not Q; no leaf is drawn as a point */
	double from_share;                   /* prefixes below this share of the triangles are looked at no second time */
	bool unscaled;                       /* for drawing at scale 1 throughout: most pixels covered by every prefix */
	/* as in lod_plant_options */
	bool (*progress)(void *ctx, double share);
	lod_rank_each *each;
	void *ctx;
};

/* Is the list's beginning made for points? */
static inline bool lod_rank_begins_with_points(const struct lod_rank_options *options)
{
	return !options->plain && !options->leaves && !options->wrong_pixels;
}

struct lod_rank {                    /* arrays of the arena */
	uint32_t *order;             /* elements, the one worth most first */
	uint8_t *growth;             /* per element: code for eco_growth */
	struct lod_simple *simple;   /* per element: the triangle that stands for it best */
};

/* ECO_INTERRUPTED where progress says so. A tree of 500,000 triangles takes at most 3 minutes on two cores. */
enum eco_code lod_rank_make(struct lod_rank *rank, const struct lod_foliage *foliage, const struct lod_rank_options *options,
	struct lod_arena *arena, struct eco_error *error);

#endif
