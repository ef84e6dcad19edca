/* The hull of a tile's summary: of none of its points, and of all of them, a quarter, a sixteenth, ...
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

#define LOD_SUMMARY_HULL_POINTS_MAX 17

struct lod_summary_hull {
	struct lod_summary_view view;
	double part;                 /* share of its points that belong to plants in view */
	double pixels;               /* pixels seen over weight_px: above 0, at most 1 */
	struct lod_hull hull;
};

/* Area of the first `vertices` points, over that of all leaves, with which the least is wrong. */
double lod_summary_hull_scale(const struct lod_summary_hull *summary, uint64_t vertices);

/* At most so many points has the hull of a summary with so many; up to LOD_SUMMARY_HULL_POINTS_MAX. */
static inline uint32_t lod_summary_hull_count(uint32_t points)
{
	uint32_t count = 1;
	for (; points; points >>= LOD_SUMMARY_OCTAVES)
		count++;
	return count;
}

/* `room` is the caller's, for lod_summary_hull_count points, and must outlive the hull. */
void lod_summary_hull_make(struct lod_summary_hull *summary, const struct lod_summary_view *view, double part,
	double pixels, double open, struct lod_hull_point *room);
