/* Ladders of forms: the elements of one list in several forms, each cheaper than the next: points, lines, simple ones, the triangles
 * themselves. Elements [0,f) are drawn in one form and [f,e) in the one before it.
 *
 * A state is (stage, e, f). The curve's samples say which states are best (`reach` gives e, the sample's vertices give stage
 * and f); between two samples a leg leads from state to state, e and f growing in proportion, one element at a time. What a ladder
 * can draw are the states on its legs: their vertices ascend, so the greatest that a budget allows is found by bisection, and no
 * element that was drawn is ever missing in a larger amount, nor in a coarser form.
 *
 *   lod_forms_find(&forms, scene, ladder)       false: it has none
 *   lod_forms_floor(&forms, vertices) ...       walks from the curve's first sample to the leg that is asked for
 *   lod_forms_keep(&forms, legs)                from then on legs are found by bisection
 *
 * The ladders of a plant's cells share the curve of the whole: a state is that of the region's elements, of which the whole-plant
 * list holds the first `before`, and the ladder what is left. */
#ifndef LOD_FORMS_H
#define LOD_FORMS_H

#include "ecofiles/format/plan.h"

#define LOD_FORMS_MAX 4

/* Elements [0, f) in form stage + 1, elements [f, e) in form `stage`. */
struct lod_forms_state { uint32_t stage, e, f; };
struct lod_forms_leg { struct lod_forms_state from, to; uint64_t vertices[2]; double share[2]; };

struct lod_forms {                   /* of one ladder */
	const struct eco_scene *scene;
	const struct eco_ladder *ladder;
	const struct eco_list *triangles;
	uint32_t list[LOD_FORMS_MAX], count;     /* coarsest first; the last are the triangles */
	uint32_t unit[LOD_FORMS_MAX];    /* vertices of an element, of all forms but the last */
	uint32_t each;               /* triangles of an element where all have the same number, else 0 */
	uint32_t own, before, total; /* elements: in the lists, in the whole-plant list, in the region */
	const struct lod_forms_leg *legs;  uint32_t leg_count;     /* the caller's, where they are kept */
};

/* False for ladders of levels. Keeps no legs. */
bool lod_forms_find(struct lod_forms *forms, const struct eco_scene *scene, const struct eco_ladder *ladder);

/* Fills `legs`, which has lod_forms_legs_bound, and uses them while `forms` lives. Answers are the same. */
uint32_t lod_forms_legs_bound(const struct lod_forms *forms);
void lod_forms_keep(struct lod_forms *forms, struct lod_forms_leg *legs);

uint64_t lod_forms_vertices(const struct lod_forms *forms, const struct lod_forms_state *state);
/* Primitives of the first `elements` in a form. */
uint64_t lod_forms_range_end(const struct lod_forms *forms, uint32_t form, uint32_t elements);
/* The greatest state of no more than `vertices`. */
struct lod_forms_state lod_forms_floor(const struct lod_forms *forms, uint64_t vertices);
/* Vertices of the smallest above, or UINT64_MAX. */
uint64_t lod_forms_next(const struct lod_forms *forms, uint64_t vertices);
/* Where on the curve an amount is; the greatest amount that comes to no more than `share`. */
double lod_forms_share(const struct lod_forms *forms, uint64_t vertices);
/* Where on the curve an amount begins: less than lod_forms_share where a whole-plant list has no more elements and cells go on. */
double lod_forms_first_share(const struct lod_forms *forms, uint64_t vertices);
uint64_t lod_forms_of_share(const struct lod_forms *forms, double share);
/* The smallest amount with all elements in some form, or UINT64_MAX. */
uint64_t lod_forms_all_drawn(const struct lod_forms *forms);

#endif
