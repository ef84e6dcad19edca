/* An order for leaves drawn at scale 1: every prefix covers as much as possible of what all leaves and the
 * wood cover together.
 *
 * Greedy maximal coverage on pictures from many directions with lazy evaluation (Minoux 1978): no prefix
 * covers less than 63 % of the best for its number of leaves (Nemhauser, Wolsey, Fisher 1978). Unscaled
 * leaves cover nothing outside the reference, so coverage is the whole gain. A pixel that is covered once
 * gains a little, too: between two of the pictures the leaf in front of it may have moved on. That decides
 * once no pixel is uncovered.
 *
 * Directions all around give one list for all views, directions in a cone a list for a sector of view. */
#ifndef LOD_COVER_H
#define LOD_COVER_H

#include "lod/build/foliage.h"

struct lod_cover_options {
	const double (*directions)[3];
	uint32_t views, pixels;      /* views * pixels * pixels (rounded up to words) at most
	                              * LOD_COVER_PIXELS_MAX */
	bool (*progress)(void *ctx, double share);       /* may be NULL */
	void *ctx;
};
#define LOD_COVER_PIXELS_MAX (1u << 26)

/* Fills order[0..foliage->count). ECO_INTERRUPTED if progress returns false. */
enum eco_code lod_cover_order(uint32_t *order, const struct lod_foliage *foliage,
	const struct lod_cover_options *options, struct lod_arena *arena, struct eco_error *error);

#endif
