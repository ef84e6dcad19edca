/* The steps of a tile's summary, of which only those are computed that a lambda asks for.
 *
 * Amounts are all of its points, half of them, a quarter, ..., one, none. The fewer they are, the more they are taken to leave wrong. So an
 * hull point that is known bounds what smaller ones can save, down to the next that is known, and the lambda of their vertices bounds it, too.
 * Where the best cannot be in such a gap, nothing in it is computed. Of most tiles two or three hull points show that points are not
 * worth their lambda, or that plants are better whatever points save.
 *
 *   lod_summary_hull_begin(&points, &view, part, pixels, extra, room, &gains)
 *   while (!enough(lod_summary_hull_gain_most(&points, lambda)) && lod_summary_hull_refine(&points, lambda))
 *           ;                                                   then points.steps are at that lambda what all of them would be
 *   lod_summary_hull_complete(&points)                                     at any lambda
 *
 * Errors and savings are over what is seen of the tile, and lambdas are divided by that. What points cover counts as the wrong plant's
 * (lod/plan/visibility.h): `fn` of an hull point is LOD_OWNER_WEIGHT of what they cover, and what they miss. Both are `pixels` of what it counts that
 * nothing is drawn (lod/plan/hull.h). */
#ifndef LOD_SUMMARY_HULL_H
#define LOD_SUMMARY_HULL_H

#include "lod/plan/hull.h"
#include "lod/plan/summary_curve.h"

#define LOD_SUMMARY_HULL_SAMPLES_MAX 32u

struct lod_summary_hull {
	struct lod_summary_view view;
	double part;                         /* of its points, those of plants in view */
	double pixels;                       /* of what nothing drawn counts, what is due to pixels: above 0, at most 1 */
	struct lod_hull_point *samples;  uint32_t count;     /* all but the first, of nothing; in ascending vertices */
	uint32_t evaluated;                      /* bit i: samples[i] was computed; the last always is */
	struct lod_hull hull;              /* the hull of those, and of nothing */
	uint64_t *gains;                     /* counts those that were computed */
};

/* What points miss, of pixels; from an hull point's fn. */
double lod_summary_hull_missed(const struct lod_summary_hull *summary, double fn);

/* How many samples there are of a summary of so many points, at least 1. */
uint32_t lod_summary_hull_count(double points);
/* `room`: for 2 * lod_summary_hull_count(view->points) + 1 hull points; the caller's, like `gains`. */
void lod_summary_hull_begin(struct lod_summary_hull *summary, const struct lod_summary_view *view, double part, double pixels, double fp_weight,
	struct lod_hull_point *room, uint64_t *gains);

/* What is saved at most at a lambda, vertices paid. */
double lod_summary_hull_gain_bound(const struct lod_summary_hull *summary, double lambda);
/* Computes one hull point more. False: at that lambda no more are needed. At 0 all points are taken. */
bool lod_summary_hull_refine(struct lod_summary_hull *summary, double lambda);
void lod_summary_hull_complete(struct lod_summary_hull *summary);

/* Above the first lambda no hull point is bought; below the second there is little left to gain. Both may be 0. */
void lod_summary_hull_lambda_range(const struct lod_summary_hull *summary, double *high, double *low);

#endif
