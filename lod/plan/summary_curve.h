/* The expected error of the first points of a tile's summary seen from a place: computed, not measured. */
#ifndef LOD_SUMMARY_CURVE_H
#define LOD_SUMMARY_CURVE_H

#include "ecofiles/format/pack.h"

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
	double crowded;              /* lod_summary_crowded of all these */
};
/* Share of the tile's part of the picture that its plants cover. */
double lod_summary_crowded(const struct lod_summary_view *view);
/* Error of the first n points, over covered pixels. Splats fall independently on what they stand for; n > 0
 */
struct eco_curve lod_summary_curve(const struct lod_summary_view *view, double n);

/* Pixels around the tile that the first n points cover, over weight_px. Plants and ground that hide the tile
 * need not hide these splats: large splats of a tile behind a hill stand out above it. 0 if wide and high are
 * unknown. */
double lod_summary_outside(const struct lod_summary_view *view, double n);

#endif
