/* One quad, or triangle, that stands for a leaf: what covers most like it. */
#ifndef LOD_RANK_QUAD_H
#define LOD_RANK_QUAD_H

#include "lod/footprint.h"

/* Half as dear as the leaf or less: a quad for three triangles and more, a triangle for two; the leaf itself where it is a single triangle.
 * Seen face on and from four sides aslant, pixels that only one of the two covers are fewest among what is tried. Opaque: it is fitted to
 * what the leaf's cut-out leaves. Corners are finite, and lie within the leaf's bounding sphere grown by a half. */
void lod_quad_fit(struct lod_quad *quad, const struct lod_fan *leaf);

#endif
