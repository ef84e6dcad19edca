/* The triangle that covers most like a leaf, and stands for it. */
#ifndef LOD_RANK_SIMPLE_H
#define LOD_RANK_SIMPLE_H

#include "lod/build/order/footprint.h"

/* Fits the triangle with the fewest pixels that only one of the two covers, among the candidates, face on and
 * from four oblique sides; a leaf of one triangle is its own. The triangle is opaque and fitted to the leaf's
 * opaque part. Corners are finite and lie within the leaf's bounding sphere grown by a half. */
void lod_simple_fit(struct lod_simple *simple, const struct lod_fan *leaf);

#endif
