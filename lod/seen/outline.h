/* Outline of an upright ellipsoid in a picture, in perspective: exact wherever the eye is.
 *
 *   lod_outline_make(&outline, &eye, from_eye, across, up);
 *   lod_outline_row(&outline, &eye, y, &low, &high)         its interval in a row of the picture
 *
 * Lengths in the picture are those of the image plane at distance 1, to the right and up. An ellipsoid in front
 * of the eye's plane has an ellipse: its dual conic, as in lod/splat.h. Here it is in doubles, and its area is a
 * sum of squares, so a needle keeps its area. An ellipsoid that reaches the eye's plane has no ellipse. The rays
 * that meet it in front of the eye form a convex cone, and a row of the picture cuts an interval out of the cone.
 * Only + - * / and square roots, so that the same numbers give the same outline on every machine. */
#pragma once

#include "lod/eye.h"

struct lod_outline {
	bool around;                 /* it reaches the eye's plane: no ellipse */
	bool inside;                 /* the eye is in it */
	double x, y;                 /* centre of the ellipse */
	double wide, high;           /* half its extents; all 0 where it is behind the eye */
	double lean, half;           /* a row at y + v high has its middle at x + lean v high, and half its length is
	                              * half sqrt(1 - v^2) */
	double middle[3], size[3];   /* around: from the eye, and half axes */
};

/* `across` and `up`: half axes, at least 0. */
void lod_outline_make(struct lod_outline *outline, const struct lod_eye *eye, const double from_eye[3],
	double across, double up);
/* False where the row is empty; ends may be infinite where it is around. */
bool lod_outline_row(const struct lod_outline *outline, const struct lod_eye *eye, double y, double *low,
	double *high);
/* Length of a ray in it. */
double lod_outline_way(const struct lod_outline *outline, const struct lod_eye *eye, double x, double y);
/* Area of the ellipse; 0 where it is around. */
double lod_outline_area(const struct lod_outline *outline);
