/* One triangle that stands for a leaf: what covers most like it. */
#ifndef LOD_RANK_SIMPLE_H
#define LOD_RANK_SIMPLE_H

#include "lod/build/order/footprint.h"

/* The leaf itself where it is a single triangle. Seen face on and from four sides aslant, pixels that only one of the two covers are
 * fewest among what is tried. Opaque: it is fitted to what the leaf's cut-out leaves. Corners are finite, and lie within the leaf's
 * bounding sphere grown by a half. */
void lod_simple_fit(struct lod_simple *simple, const struct lod_fan *leaf);

#endif
