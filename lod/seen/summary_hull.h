/* The hull of a tile's summary, evaluated lazily: only points near a lambda that was asked for are computed.
 *
 * Samples are all points of the summary, half of them, a quarter, ..., one. Fewer points are taken to leave
 * more wrong. So an evaluated sample bounds what the smaller samples down to the next evaluated one can save,
 * and their vertices at lambda bound it too. A gap whose bound is worse than the best evaluated sample is
 * left alone (branch and bound). For most tiles two or three samples show that the summary does not pay at
 * lambda, or that the plants beat it whatever it saves.
 *
 *   lod_summary_hull_begin(&summary, &view, part, pixels, open, room, &gains)
 *   while (lod_summary_hull_gain_bound(&summary, lambda) > enough
 *                   && lod_summary_hull_refine(&summary, lambda))
 *           ;                                     summary.hull at lambda is that of all samples
 *   lod_summary_hull_complete(&summary)           at every lambda
 *
 * Errors are over the tile's weight_px, and lambda is divided by it. A pixel that a splat covers belongs to
 * the wrong plant (lod/seen/visibility.h), so the error before like plants is LOD_OWNER_WEIGHT for covered pixels,
 * times `pixels`, and 1 for missed ones. */
#pragma once

#include "ecofiles/format/pack.h"
#include "lod/seen/hull.h"

/* A summary as seen from a place. All lengths and areas are in pixels. */
struct lod_summary_view {
	double area;                 /* projected: half of the tile's leaf area; n of N points are splats of
	                              * area / n each */
	double covered;              /* by the tile's plants at full detail, each by itself */
	double box;                  /* of their crowns, gaps included; at least `covered` */
	double plants;               /* number of plants */
	double points;               /* N */
	double wide, high;           /* the tile in the picture, where splats fill each other's gaps; 0:
	                              * unknown */
	double weight_px;            /* wrong pixels where nothing is drawn; above 0 where wide and high are
	                              * known */
	double crowded;              /* share of the tile's part of the picture that its plants cover */
};

#define LOD_SUMMARY_HULL_SAMPLES_MAX 32u

struct lod_summary_hull {
	struct lod_summary_view view;
	double part;                 /* share of its points that belong to plants in view */
	double pixels;               /* pixels seen over weight_px: above 0, at most 1 */
	struct lod_hull_point *samples;  uint32_t count; /* without the empty one; in ascending vertices */
	uint32_t evaluated;          /* bit i: samples[i] is set; the last always is */
	/* of those, by how many come after: read at each lambda, so they lie together */
	double errors[LOD_SUMMARY_HULL_SAMPLES_MAX];
	struct lod_hull hull;        /* of the empty sample and the evaluated ones */
	uint64_t *gains;             /* counts evaluated samples */
};

/* Area of the first `vertices` points, over that of all leaves, with which the least is wrong. */
double lod_summary_hull_scale(const struct lod_summary_hull *summary, uint64_t vertices);

/* Number of samples for a summary of so many points, at least 1. */
uint32_t lod_summary_hull_count(double points);
/* `room` holds 2 * lod_summary_hull_count(view->points) + 1 hull points; the caller's, like `gains`. */
void lod_summary_hull_begin(struct lod_summary_hull *summary, const struct lod_summary_view *view,
	double part, double pixels, double open, struct lod_hull_point *room, uint64_t *gains);

/* Upper bound of what the summary saves at lambda: error saved less lambda * vertices. */
double lod_summary_hull_gain_bound(const struct lod_summary_hull *summary, double lambda);
/* Evaluates one sample more. False where the hull at lambda needs none. At lambda 0 all points are taken. */
bool lod_summary_hull_refine(struct lod_summary_hull *summary, double lambda);
void lod_summary_hull_complete(struct lod_summary_hull *summary);

/* Nothing is chosen above `high`; little is left to gain below `low`. Both may be 0. */
void lod_summary_hull_lambda_range(const struct lod_summary_hull *summary, double *high, double *low);
