/* Ladders: how many vertices of an organ at an anchor -> which cuts. Deussen 2002, section 5, with the corrections listed in
 * planner.c. Pure integer rules; see struct eco_ladder for the stages. */
#ifndef LOD_LADDER_H
#define LOD_LADDER_H

#include "ecofiles/plan.h"

uint64_t lod_ladder_full(const struct eco_scene *scene, const struct eco_ladder *ladder);   /* vertices of everything */

/* Greatest vertex count that a cut set of the ladder can draw and that is not above `vertices`. */
uint64_t lod_ladder_floor(const struct eco_scene *scene, const struct eco_ladder *ladder, uint64_t vertices);
/* Smallest such count above `vertices`, or UINT64_MAX at the end. */
uint64_t lod_ladder_next(const struct eco_scene *scene, const struct eco_ladder *ladder, uint64_t vertices);

/* The cut set that draws exactly `vertices` (a value that floor returns): writes at most 2 cuts with list, first, end and scale set
 * and the rest zero; returns their number. Draws `vertices` to the primitive. `density` is the share of this region's points (or
 * lines, or triangles) that the picture shows, coarse list included, in (0,1]: what is left stands for 1/density as much. */
#define LOD_LADDER_CUTS_MAX 2
uint32_t lod_ladder_cuts(const struct eco_scene *scene, const struct eco_ladder *ladder, uint64_t vertices, double density,
	struct eco_cut cuts[LOD_LADDER_CUTS_MAX]);

/* Where the first stage (points, lines or plain triangles) ends. While a plant's cells are not drawn, its whole-plant list cannot go
 * beyond it: an eighth of the leaves as unscaled triangles would be less of a plant than the same leaves as scaled points. */
uint64_t lod_ladder_stage_end(const struct eco_scene *scene, const struct eco_ladder *ladder);

/* Share of the region's full detail that `vertices` of this ladder come to, together with what the whole-plant list shows of the region
 * (ladder->before): what the curve is sampled over. A whole-plant list of a plant with cells never comes to 1 by itself. */
double lod_ladder_share(const struct eco_scene *scene, const struct eco_ladder *ladder, uint64_t vertices);

/* Interpolates the curve linearly at `share` (clamped; a ladder without a curve is exact: scale 1, no error). */
struct eco_curve lod_ladder_curve(const struct eco_scene *scene, const struct eco_ladder *ladder, double share);

#endif
