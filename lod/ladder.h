/* Ladders: how many vertices of an organ at an anchor -> which cuts. Pure rules; see struct eco_ladder for the forms and ladder.c for
 * the way through them.
 *
 * A way is a ladder made ready to be asked. lod_way_begin walks nowhere yet; each question then walks along the ladder's curve
 * (about a microsecond a sample). Who asks often keeps the legs of the walk, and the same questions are answered by bisection:
 *
 *   lod_way_begin(&way, scene, ladder);
 *   legs = malloc(lod_way_legs_bound(&way) * sizeof *legs);
 *   lod_way_keep(&way, legs);                       once; never changes then, so threads may share it
 *   lod_way_floor(&way, vertices) ...
 *
 * lod_ladder_floor and the others begin a way for one question. */
#ifndef LOD_LADDER_H
#define LOD_LADDER_H

#include "lod/forms.h"

struct lod_way {
	const struct eco_scene *scene;
	const struct eco_ladder *ladder;
	bool has_forms;
	struct lod_forms forms;
	uint64_t full;               /* vertices of everything */
	uint64_t stage_end;          /* where it is kept, else UINT64_MAX */
};
void lod_way_begin(struct lod_way *way, const struct eco_scene *scene, const struct eco_ladder *ladder);
/* `legs` may be NULL where the bound is 0; they must outlive the way. */
uint32_t lod_way_legs_bound(const struct lod_way *way);
void lod_way_keep(struct lod_way *way, struct lod_forms_leg *legs);

uint64_t lod_ladder_full(const struct eco_scene *scene, const struct eco_ladder *ladder);   /* vertices of everything */

/* Greatest vertex count that a cut set of the ladder can draw and that is not above `vertices`. */
uint64_t lod_ladder_floor(const struct eco_scene *scene, const struct eco_ladder *ladder, uint64_t vertices);
uint64_t lod_way_floor(const struct lod_way *way, uint64_t vertices);
/* Smallest such count above `vertices`, or UINT64_MAX at the end. */
uint64_t lod_ladder_next(const struct eco_scene *scene, const struct eco_ladder *ladder, uint64_t vertices);
uint64_t lod_way_next(const struct lod_way *way, uint64_t vertices);

/* The cut set that draws exactly `vertices` (a value that floor returns): writes at most 2 cuts with list, first, end and scale set
 * and the rest zero; returns their number. Draws `vertices` to the primitive. `density` is the share of this region's elements (or
 * lines) that the picture shows in any form, coarse list included, in (0,1]: what is left stands for 1/density as much. It is
 * lod_ladder_density, but for a whole-plant list beside cells that show more than it holds: then it is theirs. `above`: as
 * lod_ladder_curve_seen; of lod_ladder_cuts 0. */
#define LOD_LADDER_CUTS_MAX 2
uint32_t lod_ladder_cuts(const struct eco_scene *scene, const struct eco_ladder *ladder, uint64_t vertices, double density,
	struct eco_cut cuts[LOD_LADDER_CUTS_MAX]);
uint32_t lod_way_cuts(const struct lod_way *way, uint64_t vertices, double density, double above, struct eco_cut cuts[LOD_LADDER_CUTS_MAX]);
double lod_ladder_density(const struct eco_scene *scene, const struct eco_ladder *ladder, uint64_t vertices);
double lod_way_density(const struct lod_way *way, uint64_t vertices);

/* Where this ladder alone does not suffice any more. Leaves: the amount at which all of a whole-plant list's elements are drawn while
 * there are more in cells (without cells: everything); while a plant's cells are not drawn, its whole-plant list cannot go beyond it,
 * as an eighth of the leaves in full detail would be less of a plant than the same leaves as points. Wood: the end of the lines. */
uint64_t lod_ladder_stage_end(const struct eco_scene *scene, const struct eco_ladder *ladder);
uint64_t lod_way_stage_end(const struct lod_way *way);

/* Share of the region's full detail that `vertices` of this ladder come to, together with what the whole-plant list shows of the region
 * (ladder->before): what the curve is sampled over. A whole-plant list of a plant with cells has a share only together with them. */
double lod_ladder_share(const struct eco_scene *scene, const struct eco_ladder *ladder, uint64_t vertices);
double lod_way_share(const struct lod_way *way, uint64_t vertices);
/* The greatest amount that comes to no more than `share`. */
uint64_t lod_ladder_vertices(const struct eco_scene *scene, const struct eco_ladder *ladder, double share);
uint64_t lod_way_vertices(const struct lod_way *way, double share);

/* Interpolates the curve linearly at `share` (clamped; a ladder without a curve is exact: scale 1, no error). */
struct eco_curve lod_ladder_curve(const struct eco_scene *scene, const struct eco_ladder *ladder, double share);
/* The same for what is seen so far from above (lod_seen_above): 0 is the curve from all around, 1 the one from above, if there is one. */
struct eco_curve lod_ladder_curve_seen(const struct eco_scene *scene, const struct eco_ladder *ladder, double share, double above);

#endif
