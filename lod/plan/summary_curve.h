/* What a tile's summary is worth from a place: the expected error of its first points, computed, not measured. */
#ifndef LOD_SUMMARY_CURVE_H
#define LOD_SUMMARY_CURVE_H

#include "ecofiles/format/pack.h"

/* What a summary looks like from a place. All in pixels. */
struct lod_summary_view {
	double area;                 /* projected: half of the tile's leaf area. n of N points are splats of area / n each */
	double covered;              /* by the tile's plants at full detail, each for itself */
	double box;                  /* of their crowns, gaps and all; at least `covered` */
	double plants;               /* how many */
	double points;               /* N */
	double wide, high;           /* of the tile in the picture, where its splats fill each other's gaps; 0: not known */
	double weight_px;                /* what it counts that nothing of it is drawn; above 0 where wide and high are known */
};
/* Expected error of the first n points, over covered pixels: splats fall on what they stand for, independent of each other. n > 0. */
struct eco_curve lod_summary_curve(const struct lod_summary_view *view, double n);

/* Pixels around the tile that the first n points cover, over its worth. What hides the tile need not hide them: large splats of a tile behind a hill
 * stand out above the hill. 0 where the tile's part of the picture is not known. */
double lod_summary_outside(const struct lod_summary_view *view, double n);

#endif
