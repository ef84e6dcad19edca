/* An order for leaves that are drawn as they are: every prefix covers as much as can be of what all leaves cover together, over the wood.
 *
 * Greedy maximal coverage on pictures from many directions (no prefix covers less than 63 % of what its number of leaves can; Nemhauser,
 * Wolsey, Fisher 1978), with lazy evaluation (Minoux 1978). Unscaled leaves cover nothing that all leaves together do not, so coverage is
 * all there is to gain. What counts beside a pixel that nothing covers is one that is covered once, as between two of the pictures the
 * leaf in front of it may have moved on: that decides where nothing is uncovered any more.
 *
 * Directions all around give one list for all views, directions in a cone one for a sector of view. */
#ifndef LOD_COVER_H
#define LOD_COVER_H

#include "lod/build/foliage.h"

struct lod_cover_options {
	const double (*directions)[3];
	uint32_t views, pixels;      /* views * pixels * pixels (rounded up to whole words) at most LOD_COVER_PIXELS_MAX */
	bool (*progress)(void *ctx, double share);       /* may be NULL */
	void *ctx;
};
#define LOD_COVER_PIXELS_MAX (1u << 26)

/* Fills order[0..foliage->count). ECO_INTERRUPTED where progress says so. */
enum eco_code lod_cover_order(uint32_t *order, const struct lod_foliage *foliage, const struct lod_cover_options *options,
	struct lod_arena *arena, struct eco_error *error);

/* missed[i]: so many of the views' pixels that all leaves cover are left uncovered by budget[i] leaves, at least, whichever they are; wood's
 * do not count. For i in [0, budgets). A proof, not a choice: the linear relaxation, bounded by its Lagrangian. Directions in use by a list
 * bound that list on them; a single one bounds every choice in that view. */
enum eco_code lod_cover_least(uint64_t *missed, const uint32_t *budget, uint32_t budgets, const struct lod_foliage *foliage,
	const struct lod_cover_options *options, struct lod_arena *arena, struct eco_error *error);

#endif
