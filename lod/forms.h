/* Ladders of forms: the elements of one list as points, lines, simple triangles or the triangles themselves,
 * each cheaper than the next. A state is (stage, e, f): elements [0, f) are drawn in one form, [f, e) in the
 * one before.
 *
 * The curve's samples say which states are best (`reach` gives e, the vertices stage and f). A leg leads from
 * one to the next: e and f grow in proportion. States on legs ascend in vertices, so a larger number never
 * drops an element nor coarsens it.
 *
 *   lod_forms_find(&forms, scene, ladder)       false: the ladder has levels
 *   lod_forms_floor(&forms, vertices) ...       walks from the curve's first sample to the leg
 *   lod_forms_keep(&forms, legs)                from then on legs are found by bisection
 *
 * Ladders of cells share the curve of the whole: a state counts a cell's region, of which the whole-plant
 * list holds the first `before` elements. */
#pragma once

#include "ecofiles/format/plan.h"

#define LOD_FORMS_MAX 4

/* Elements [0, f) in form stage + 1, elements [f, e) in form `stage`. */
struct lod_forms_state { uint32_t stage, e, f; };
struct lod_forms_leg { struct lod_forms_state from, to; uint64_t vertices[2]; double share[2]; };

struct lod_forms {                   /* of one ladder */
	const struct eco_scene *scene;
	const struct eco_ladder *ladder;
	const struct eco_list *triangles;
	uint32_t list[LOD_FORMS_MAX], count;     /* coarsest first; the triangles are last */
	uint32_t unit[LOD_FORMS_MAX];    /* vertices of an element, for all forms but the last */
	uint32_t each;               /* triangles of an element if all have as many, else 0 */
	uint32_t own, before, total; /* elements: in the lists, in the whole-plant list, in the region */
	const struct lod_forms_leg *legs;  uint32_t leg_count;     /* the caller's, if kept */
};

/* False for a ladder of levels. Keeps no legs. */
bool lod_forms_find(struct lod_forms *forms, const struct eco_scene *scene, const struct eco_ladder *ladder);

/* Fills `legs` (lod_forms_legs_bound of them) and uses them while `forms` lives. Answers are the same. */
uint32_t lod_forms_legs_bound(const struct lod_forms *forms);
void lod_forms_keep(struct lod_forms *forms, struct lod_forms_leg *legs);

uint64_t lod_forms_vertices(const struct lod_forms *forms, const struct lod_forms_state *state);
/* Primitives of the first `elements` in a form. */
uint64_t lod_forms_range_end(const struct lod_forms *forms, uint32_t form, uint32_t elements);
/* The greatest state of at most `vertices`. */
struct lod_forms_state lod_forms_floor(const struct lod_forms *forms, uint64_t vertices);
/* Vertices of the smallest state above, or UINT64_MAX. */
uint64_t lod_forms_next(const struct lod_forms *forms, uint64_t vertices);
/* The share at which a number of vertices is, and the greatest number of vertices whose share is at most
 * `share`. */
double lod_forms_share(const struct lod_forms *forms, uint64_t vertices);
/* The share at which it begins: less than lod_forms_share where a whole-plant list has no more elements and
 * cells go on. */
double lod_forms_first_share(const struct lod_forms *forms, uint64_t vertices);
uint64_t lod_forms_of_share(const struct lod_forms *forms, double share);
/* The fewest vertices that draw all elements in some form, or UINT64_MAX. */
uint64_t lod_forms_all_drawn(const struct lod_forms *forms);
