/* The steps of a ladder that are worth taking, in falling gain per vertex: the lower convex hull of its error over its vertices. A step
 * that only becomes worth it together with the next is taken together with it. They depend on no view: a slot's steps are
 * its ladder's, times what a wrong pixel of it weighs.
 *
 *   lod_steps_make(&steps, scene, ladder, from, to, room)       amounts[0] is `from`; amount i has error amounts[i].fp + amounts[i].fn
 *   x = lod_steps_position(&steps, price)                       how far up at that price of a vertex: amounts[floor(x)], and the next for a
 *                                                               share of x - floor(x) of the plants */
#ifndef LOD_STEPS_H
#define LOD_STEPS_H

#include "lod/ladder.h"

#define LOD_STEPS_MAX 97u        /* with the last */

struct lod_amount {
	uint64_t vertices;           /* a value that lod_ladder_floor returns */
	double fp, fn;               /* over covered pixels; fn never rises, nor does fn + extra * fp */
	double price;                /* gain of the step that ends here, per vertex; falls from each amount to the next; of [0]: infinity; 0 only
	                              * of the last: it gains nothing and completes what is drawn where all of everything can be had */
};

struct lod_steps {
	struct lod_amount *amounts;  uint32_t count;     /* count >= 1 */
	double extra;                /* what a pixel too many weighs: one that is missing weighs 1 */
};

/* Amounts of a ladder from `from` to `to` vertices, both values that lod_ladder_floor returns, with steps->extra as it is. `amounts` has LOD_STEPS_MAX; *looked grows by
 * how many were compared. */
void lod_steps_make(struct lod_steps *steps, struct lod_amount *amounts, const struct eco_scene *scene, const struct eco_ladder *ladder,
	uint64_t from, uint64_t to, uint64_t *looked);

/* Errors at an amount that lod_ladder_floor returns. */
struct lod_amount lod_steps_amount(const struct eco_scene *scene, const struct eco_ladder *ladder, uint64_t vertices);

/* The hull of any amounts in ascending vertices, in place. */
void lod_steps_hull(struct lod_steps *steps);

/* In [0, count - 1]. A step is taken by all plants where its gain is above LOD_STEPS_BLUR times the price, by none where below 1 / that, and
 * between by a share that grows: so that a slot's amounts change little by little where a price does. */
static inline double lod_steps_error(const struct lod_steps *steps, const struct lod_amount *amount)
{
	return amount->fn + steps->extra * amount->fp;
}
#define LOD_STEPS_BLUR 1.25
double lod_steps_position(const struct lod_steps *steps, double price);

#endif
