/* Polygons to triangles. */
#ifndef ECO_POLYGON_H
#define ECO_POLYGON_H

#include <stdint.h>

#define ECO_POLYGON_CORNERS_MAX 65536u

/* Splits a polygon of n >= 3 corners (3 coordinates each, about planar, convex or not) into exactly n - 2
 * triangles. triangles receives 3 (n - 2) indices of corners. A polygon that overlaps itself is covered as
 * well as possible; parts without area give triangles without area. `scratch` holds n indices.
 * Deterministic: only + - * and comparisons of doubles. */
void eco_polygon_split(const double *corners, uint32_t n, uint32_t *scratch, uint32_t *triangles);

#endif
