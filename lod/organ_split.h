/* Components that hold more than one organ, taken apart: what is welded together need not belong together. Private to the finder of
 * organs. Two kinds are found:
 *
 * - Trunk and crown in one mesh, told apart by the texture only, often a palette of a few flat colours: parted where green meets what
 *   is not, if that is a clear line and not a pattern.
 * - Leaves whose corners are welded to a twig: a sheet cannot join a tube's wall but by single vertices or by edges with more than two
 *   triangles. Parts that hang together by ordinary edges are looked at one by one; where small flat sheets hang on a tube, each is a
 *   component of its own. */
#ifndef LOD_ORGAN_SPLIT_H
#define LOD_ORGAN_SPLIT_H

#include "lod/weld.h"

/* Refines the mesh's components. `rgb` is per triangle. New arrays come from `arena`. */
void lod_organs_split(struct lod_mesh *mesh, const uint8_t (*rgb)[3], struct lod_arena *arena);

#endif
