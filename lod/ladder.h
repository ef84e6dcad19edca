/* Ladders: how many vertices of an organ at an anchor -> which cuts. Pure rules; see struct eco_ladder for the forms and ladder.c for
 * the way through them. Each call walks along the ladder's curve (about a microsecond): who asks often keeps the answers. */
#ifndef LOD_LADDER_H
#define LOD_LADDER_H

#include "ecofiles/plan.h"

uint64_t lod_ladder_full(const struct eco_scene *scene, const struct eco_ladder *ladder);   /* vertices of everything */

/* Greatest vertex count that a cut set of the ladder can draw and that is not above `vertices`. */
uint64_t lod_ladder_floor(const struct eco_scene *scene, const struct eco_ladder *ladder, uint64_t vertices);
/* Smallest such count above `vertices`, or UINT64_MAX at the end. */
uint64_t lod_ladder_next(const struct eco_scene *scene, const struct eco_ladder *ladder, uint64_t vertices);

/* The cut set that draws exactly `vertices` (a value that floor returns): writes at most 2 cuts with list, first, end and scale set
 * and the rest zero; returns their number. Draws `vertices` to the primitive. `density` is the share of this region's elements (or
 * lines) that the picture shows in any form, coarse list included, in (0,1]: what is left stands for 1/density as much. It is
 * lod_ladder_density, but for a whole-plant list beside cells that show more than it holds: then it is theirs. */
#define LOD_LADDER_CUTS_MAX 2
uint32_t lod_ladder_cuts(const struct eco_scene *scene, const struct eco_ladder *ladder, uint64_t vertices, double density,
	struct eco_cut cuts[LOD_LADDER_CUTS_MAX]);
double lod_ladder_density(const struct eco_scene *scene, const struct eco_ladder *ladder, uint64_t vertices);

/* Where this ladder alone does not suffice any more. Leaves: the amount at which all of a whole-plant list's elements are drawn while
 * there are more in cells (without cells: everything); while a plant's cells are not drawn, its whole-plant list cannot go beyond it,
 * as an eighth of the leaves in full detail would be less of a plant than the same leaves as points. Wood: the end of the lines. */
uint64_t lod_ladder_stage_end(const struct eco_scene *scene, const struct eco_ladder *ladder);

/* Share of the region's full detail that `vertices` of this ladder come to, together with what the whole-plant list shows of the region
 * (ladder->before): what the curve is sampled over. A whole-plant list of a plant with cells has a share only together with them. */
double lod_ladder_share(const struct eco_scene *scene, const struct eco_ladder *ladder, uint64_t vertices);
/* The greatest amount that comes to no more than `share`. */
uint64_t lod_ladder_vertices(const struct eco_scene *scene, const struct eco_ladder *ladder, double share);

/* Interpolates the curve linearly at `share` (clamped; a ladder without a curve is exact: scale 1, no error). */
struct eco_curve lod_ladder_curve(const struct eco_scene *scene, const struct eco_ladder *ladder, double share);

#endif
