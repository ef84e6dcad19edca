/* Components as organs need them: what is welded together need not belong together, and colours alone part nothing. Private to the
 * finder of organs.
 *
 * - Materials that differ in nothing but a colour (as those that an import makes of vertex colours do: a scan has hundreds) are one
 *   surface: components that continue each other across edges are joined, unless one is green where the other is not.
 * - Trunk and crown in one mesh, told apart by the texture only, often a palette of a few flat colours: parted where green meets what
 *   is not, if that is a clear line and not a pattern.
 * - Leaves whose corners are welded to a twig: a sheet cannot join a tube's wall but by single vertices or by edges with more than two
 *   triangles. Parts that hang together by ordinary edges are looked at one by one; where small flat sheets hang on a tube, each is a
 *   component of its own. */
#ifndef LOD_ORGAN_SPLIT_H
#define LOD_ORGAN_SPLIT_H

#include "lod/build/weld.h"

/* Regroups the mesh's triangles into components; rules are kept apart. `rgb` is per triangle. */
void lod_organs_split(struct lod_mesh *mesh, const struct eco_model *model, const uint8_t (*rgb)[3], struct lod_arena *arena);

#endif
