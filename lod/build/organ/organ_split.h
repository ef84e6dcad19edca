/* Components regrouped for the finder of organs: welded parts need not belong together, and a difference of
 * colour alone separates nothing. Private to the finder of organs.
 *
 * - Materials that differ only in a colour (as an import makes of vertex colours: a scan has hundreds) are
 *   one surface. Components that continue each other across edges are joined, unless one is green and the
 *   other is not.
 * - A trunk and crown in one mesh, distinguished only by the texture (often a palette of a few flat colours),
 *   are parted where green meets other colours, if that seam is a clear line and not a pattern.
 * - Leaves welded to a twig by their corners: a sheet meets a tube's wall only in single vertices or in edges
 *   of more than two triangles. Parts connected by ordinary edges are tested one by one; small flat sheets on
 *   a tube each become a component. */
#ifndef LOD_ORGAN_SPLIT_H
#define LOD_ORGAN_SPLIT_H

#include "lod/build/weld.h"

/* Regroups the mesh's triangles into components; those of different rules stay apart. `rgb` is per
 * triangle. */
void lod_organs_split(struct lod_mesh *mesh, const struct eco_model *model, const uint8_t (*rgb)[3],
	struct lod_arena *arena);

#endif
