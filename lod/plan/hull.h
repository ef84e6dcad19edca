/* The steps of a ladder that are worth taking, in falling gain per vertex: the lower convex hull of its error over its vertices. A step
 * that only becomes worth it together with the next is taken together with it. They depend on no view: a slot's steps are
 * its ladder's, times what a wrong pixel of it weighs.
 *
 * Nor do they depend on what a pixel too many weighs, which differs from slot to slot and changes as a camera moves: if each weight had a hull of
 * its own, all plants of a slot would change at once where one gives way to the next. So hull points are those on the hulls of the least weight
 * and of the greatest. A step's gain is linear in the weight; being convex at both ends, they are in between.
 *
 *   n = lod_hull_sample(hull points, &way, from, to)               hull points[0] is `from`; hull point i has error hull points[i].fp + hull points[i].fn
 *   lod_hull_reduce(&steps, spread)                              those that are worth it at steps.extra, in place
 *   lod_hull_complete(&steps, to)
 *   x = lod_hull_position(&steps, lambda, near)                 how far up at that lambda of a vertex: hull points[floor(x)], and the next for a
 *                                                               share of x - floor(x) of the plants */
#ifndef LOD_HULL_H
#define LOD_HULL_H

#include "lod/ladder.h"
#include "lod/plan/visibility.h"

#define LOD_HULL_POINTS_MAX 97u        /* with the last */
#define LOD_FP_WEIGHT_LEAST LOD_OWNER_WEIGHT          /* weights of pixels too many; the greatest is 1 */

/* What it counts besides its pixels that nothing of a plant's foliage is drawn: as much again, as a tree without leaves is another tree. Else thin
 * crowns, in which coarse leaves cover more gaps than leaves, stay bare until there are vertices for fine ones. Wrong pixels in
 * thousands of four views of an outdoor scene at 30,000 to 1,000,000 vertices with 0, .5 and 1: 333, 330, 331; at .5 some crowns have
 * their leaves and not yet their flowers. */
#define LOD_ABSENT_WEIGHT 1.0

struct lod_hull_point {
	uint64_t vertices;           /* a value that lod_ladder_floor returns */
	double fp, fn;               /* over covered pixels; fn never rises, nor does fn + extra * fp; of nothing, with lod_hull_absent */
	float above_fp, above_fn;    /* the same seen from above: only what a picture is expected to be depends on them */
	double fn_slope, fp_slope;   /* what the step that ends here saves of each, per vertex */
};

struct lod_hull {
	struct lod_hull_point *points;  uint32_t count;     /* count >= 1 */
	double fp_weight;                /* what a pixel too many weighs: one that is missing weighs 1 */
};

/* Amounts of a ladder from `from` to `to` vertices, both values that lod_way_floor returns; their number, at most LOD_HULL_POINTS_MAX - 1. */
uint32_t lod_hull_sample(struct lod_hull_point points[LOD_HULL_POINTS_MAX], const struct lod_way *way, uint64_t from, uint64_t to);

/* What is wrong, besides its pixels, where nothing of it is drawn. */
double lod_hull_absent(const struct eco_ladder *ladder);
/* Errors at an hull point that lod_way_floor returns. */
struct lod_hull_point lod_hull_point_at(const struct lod_way *way, uint64_t vertices);

/* The hull of any hull points in ascending vertices, in place, with steps->extra as it is; of two steps whose lambdas are not `spread` times
 * apart one is made. A hull of a hull at another weight is one at both, and between. */
void lod_hull_reduce(struct lod_hull *hull, double ratio);
#define LOD_HULL_SLOPE_RATIO 1.25    /* of ladders: where a curve is nearly straight, a step between does not save more, but more plants
                                  * change as a camera moves */
/* All there is, for who can have everything: `to` as the last hull point. Needs room for one more. */
void lod_hull_complete(struct lod_hull *hull, uint64_t to);

/* Gain of the step that ends at hull points[i], per vertex; falls from each hull point to the next; of [0]: infinity; 0 only of the last: it gains nothing
 * and completes what is drawn where all of everything can be had. */
static inline double lod_hull_slope(const struct lod_hull *hull, uint32_t i)
{
	return hull->points[i].fn_slope + hull->fp_weight * hull->points[i].fp_slope;
}

/* In [0, count - 1]. A step is taken by all plants where its gain is above LOD_HULL_BLUR times the lambda, by none where below 1 / that, and
 * between by a share that grows: so that a slot's hull points change little by little where a lambda does. */
static inline double lod_hull_error(const struct lod_hull *hull, const struct lod_hull_point *point)
{
	return point->fn + hull->fp_weight * point->fp;
}
#define LOD_HULL_BLUR 1.25
/* It is looked for from `near` on, any such position: lambdas that follow each other lie close together. */
double lod_hull_position(const struct lod_hull *hull, double lambda, double near);

#endif
