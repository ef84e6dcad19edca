/* The steps of a tile's summary, of which only those are computed that a price asks for.
 *
 * Amounts are all of its points, half of them, a quarter, ..., one, none. The fewer they are, the more they are taken to leave wrong. So an
 * amount that is known bounds what smaller ones can save, down to the next that is known, and the price of their vertices bounds it, too.
 * Where the best cannot be in such a gap, nothing in it is computed. Of most tiles two or three amounts show that points are not
 * worth their price, or that plants are better whatever points save.
 *
 *   lod_points_begin(&points, &view, part, pixels, extra, room, &gains)
 *   while (!enough(lod_points_most(&points, price)) && lod_points_step(&points, price))
 *           ;                                                   then points.steps are at that price what all of them would be
 *   lod_points_all(&points)                                     at any price
 *
 * Errors and savings are over what is seen of the tile, and prices are divided by that. What points cover counts as the wrong plant's
 * (lod/plan/visibility.h): `fn` of an amount is LOD_OWNER_WORTH of what they cover, and what they miss. Both are `pixels` of what it counts that
 * nothing is drawn (lod/plan/hull.h). */
#ifndef LOD_SUMMARY_HULL_H
#define LOD_SUMMARY_HULL_H

#include "lod/plan/hull.h"
#include "lod/plan/summary_curve.h"

#define LOD_POINTS_SAMPLES_MAX 32u

struct lod_points {
	struct lod_summary_view view;
	double part;                         /* of its points, those of plants in view */
	double pixels;                       /* of what nothing drawn counts, what is due to pixels: above 0, at most 1 */
	struct lod_amount *samples;  uint32_t count;     /* all but the first, of nothing; in ascending vertices */
	uint32_t known;                      /* bit i: samples[i] was computed; the last always is */
	struct lod_steps steps;              /* the hull of those, and of nothing */
	uint64_t *gains;                     /* counts those that were computed */
};

/* What points miss, of pixels; from an amount's fn. */
double lod_points_missed(const struct lod_points *points, double fn);

/* How many samples there are of a summary of so many points, at least 1. */
uint32_t lod_points_count(double points);
/* `room`: for 2 * lod_points_count(view->points) + 1 amounts; the caller's, like `gains`. */
void lod_points_begin(struct lod_points *points, const struct lod_summary_view *view, double part, double pixels, double extra,
	struct lod_amount *room, uint64_t *gains);

/* What is saved at most at a price, vertices paid. */
double lod_points_most(const struct lod_points *points, double price);
/* Computes one amount more. False: at that price no more are needed. At 0 all points are taken. */
bool lod_points_step(struct lod_points *points, double price);
void lod_points_all(struct lod_points *points);

/* Above the first price no amount is bought; below the second there is little left to gain. Both may be 0. */
void lod_points_prices(const struct lod_points *points, double *high, double *low);

#endif
