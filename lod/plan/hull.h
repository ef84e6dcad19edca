/* The steps of a ladder that are worth taking, in falling gain per vertex: the lower convex hull of its error over its vertices. A step
 * that only becomes worth it together with the next is taken together with it. They depend on no view: a slot's steps are
 * its ladder's, times what a wrong pixel of it weighs.
 *
 * Nor do they depend on what a pixel too many weighs, which differs from slot to slot and changes as a camera moves: if each weight had a hull of
 * its own, all plants of a slot would change at once where one gives way to the next. So amounts are those on the hulls of the least weight
 * and of the greatest. A step's gain is linear in the weight; being convex at both ends, they are in between.
 *
 *   n = lod_steps_sample(amounts, &way, from, to)               amounts[0] is `from`; amount i has error amounts[i].fp + amounts[i].fn
 *   lod_steps_hull(&steps, spread)                              those that are worth it at steps.extra, in place
 *   lod_steps_complete(&steps, to)
 *   x = lod_steps_position(&steps, price, near)                 how far up at that price of a vertex: amounts[floor(x)], and the next for a
 *                                                               share of x - floor(x) of the plants */
#ifndef LOD_HULL_H
#define LOD_HULL_H

#include "lod/ladder.h"
#include "lod/plan/visibility.h"

#define LOD_STEPS_MAX 97u        /* with the last */
#define LOD_EXTRA_LEAST LOD_OWNER_WORTH          /* weights of pixels too many; the greatest is 1 */

/* What it counts besides its pixels that nothing of a plant's foliage is drawn: as much again, as a tree without leaves is another tree. Else thin
 * crowns, in which coarse leaves cover more gaps than leaves, stay bare until there are vertices for fine ones. Wrong pixels in
 * thousands of four views of an outdoor scene at 30,000 to 1,000,000 vertices with 0, .5 and 1: 333, 330, 331; at .5 some crowns have
 * their leaves and not yet their flowers. */
#define LOD_ABSENT_WORTH 1.0

struct lod_amount {
	uint64_t vertices;           /* a value that lod_ladder_floor returns */
	double fp, fn;               /* over covered pixels; fn never rises, nor does fn + extra * fp; of nothing, with lod_steps_absent */
	float above_fp, above_fn;    /* the same seen from above: only what a picture is expected to be depends on them */
	double fn_price, fp_price;   /* what the step that ends here saves of each, per vertex */
};

struct lod_steps {
	struct lod_amount *amounts;  uint32_t count;     /* count >= 1 */
	double extra;                /* what a pixel too many weighs: one that is missing weighs 1 */
};

/* Amounts of a ladder from `from` to `to` vertices, both values that lod_way_floor returns; their number, at most LOD_STEPS_MAX - 1. */
uint32_t lod_steps_sample(struct lod_amount amounts[LOD_STEPS_MAX], const struct lod_way *way, uint64_t from, uint64_t to);

/* What is wrong, besides its pixels, where nothing of it is drawn. */
double lod_steps_absent(const struct eco_ladder *ladder);
/* Errors at an amount that lod_way_floor returns. */
struct lod_amount lod_steps_amount(const struct lod_way *way, uint64_t vertices);

/* The hull of any amounts in ascending vertices, in place, with steps->extra as it is; of two steps whose prices are not `spread` times
 * apart one is made. A hull of a hull at another weight is one at both, and between. */
void lod_steps_hull(struct lod_steps *steps, double spread);
#define LOD_STEPS_SPREAD 1.25    /* of ladders: where a curve is nearly straight, a step between does not save more, but more plants
                                  * change as a camera moves */
/* All there is, for who can have everything: `to` as the last amount. Needs room for one more. */
void lod_steps_complete(struct lod_steps *steps, uint64_t to);

/* Gain of the step that ends at amounts[i], per vertex; falls from each amount to the next; of [0]: infinity; 0 only of the last: it gains nothing
 * and completes what is drawn where all of everything can be had. */
static inline double lod_steps_price(const struct lod_steps *steps, uint32_t i)
{
	return steps->amounts[i].fn_price + steps->extra * steps->amounts[i].fp_price;
}

/* In [0, count - 1]. A step is taken by all plants where its gain is above LOD_STEPS_BLUR times the price, by none where below 1 / that, and
 * between by a share that grows: so that a slot's amounts change little by little where a price does. */
static inline double lod_steps_error(const struct lod_steps *steps, const struct lod_amount *amount)
{
	return amount->fn + steps->extra * amount->fp;
}
#define LOD_STEPS_BLUR 1.25
/* It is looked for from `near` on, any such position: prices that follow each other lie close together. */
double lod_steps_position(const struct lod_steps *steps, double price, double near);

#endif
