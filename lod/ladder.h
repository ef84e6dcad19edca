/* Ladders: how many vertices of an organ at an anchor -> which cuts. Pure rules; struct eco_ladder has the
 * lists, ladder.c the three kinds.
 *
 * A way is a ladder prepared for questions. Each question walks along the ladder's curve (about a microsecond
 * a sample). A caller with many questions keeps the legs of the walk, and bisection gives the same answers:
 *
 *   lod_way_begin(&way, scene, ladder);
 *   legs = malloc(lod_way_legs_bound(&way) * sizeof *legs);
 *   lod_way_keep(&way, legs);                       once; then constant, so threads may share it
 *   lod_way_floor(&way, vertices) ... */
#pragma once

#include "lod/forms.h"

struct lod_way {
	const struct eco_scene *scene;
	const struct eco_ladder *ladder;
	bool has_forms, has_splats;  /* neither: levels */
	struct lod_forms forms;
	uint64_t full;               /* vertices of full detail */
	uint64_t stage_end;          /* if kept, else UINT64_MAX */
};
void lod_way_begin(struct lod_way *way, const struct eco_scene *scene, const struct eco_ladder *ladder);
/* `legs` may be NULL if the bound is 0; they must outlive the way. */
uint32_t lod_way_legs_bound(const struct lod_way *way);
void lod_way_keep(struct lod_way *way, struct lod_forms_leg *legs);

uint64_t lod_ladder_full(const struct eco_scene *scene, const struct eco_ladder *ladder); /* of full detail */

/* The greatest vertex count, not above `vertices`, that a set of cuts of the ladder draws. */
uint64_t lod_way_floor(const struct lod_way *way, uint64_t vertices);
/* The smallest such count above `vertices`, or UINT64_MAX at the end. */
uint64_t lod_way_next(const struct lod_way *way, uint64_t vertices);

/* Splats: vertices of the smallest level with more than `vertices`. UINT64_MAX at the end, and of other
 * ladders. */
uint64_t lod_way_level_above(const struct lod_way *way, uint64_t vertices);

/* The cuts that draw exactly `vertices` (a value that floor returns), to the primitive: writes cuts with list, first,
 * end and scale, the rest zero; returns their number, at most lod_way_cuts_bound, which is at most
 * LOD_LADDER_CUTS_MAX. `density`, in (0, 1], is the share of the region's elements (or lines) that the picture shows
 * in any form, the coarse list included: each is scaled to stand for 1 / density. It is lod_way_density, except for a
 * whole-plant list beside cells that show more: there it is theirs. `above` is that of lod_ladder_curve_seen. Splats
 * have density 1, and scale 1 without leaves. */
#define LOD_LADDER_CUTS_MAX (2 + ECO_FRONT_MAX)
uint32_t lod_way_cuts_bound(const struct lod_way *way);
uint32_t lod_way_cuts(const struct lod_way *way, uint64_t vertices, double density, double above,
	struct eco_cut cuts[LOD_LADDER_CUTS_MAX]);
double lod_way_density(const struct lod_way *way, uint64_t vertices);

/* The end of the first stage, beyond which this ladder alone does not suffice. Leaves: the vertices at which
 * a whole-plant list draws all its elements while the cells hold more (without cells: full detail). Unless
 * cells are drawn the list stops there, since an eighth of the leaves in full detail shows less of a plant
 * than the same leaves as points. Wood: the end of the lines. Splats: their end. */
uint64_t lod_way_stage_end(const struct lod_way *way);

/* The share (lambda) of the region's full detail that `vertices` of this ladder amount to, together with the
 * region's elements in the whole-plant list (ladder->before). Curves are sampled over it. The whole-plant
 * list of a plant with cells has a share only together with the cells. */
double lod_way_share(const struct lod_way *way, uint64_t vertices);
/* The greatest number of vertices whose share is at most `share`. */
uint64_t lod_way_vertices(const struct lod_way *way, double share);

/* The curve at `share`, interpolated linearly and clamped; a ladder without a curve has scale 1 and
 * the errors of what is missing. */
struct eco_curve lod_ladder_curve(const struct eco_scene *scene, const struct eco_ladder *ladder,
	double share);
/* The same, seen from above by `above` (lod_seen_above): 0 takes the curve from all around, 1 the curve from
 * above if there is one. */
struct eco_curve lod_ladder_curve_seen(const struct eco_scene *scene, const struct eco_ladder *ladder,
	double share, double above);
