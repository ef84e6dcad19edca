/* Polygons to triangles, and clusters of points. */
#pragma once

#include <stdint.h>

/* ---- Polygons to triangles ---- */

#define ECO_POLYGON_CORNERS_MAX 65536u

/* Splits a polygon of n >= 3 corners (3 coordinates each, about planar, convex or not) into exactly n - 2
 * triangles. triangles receives 3 (n - 2) indices of corners. A polygon that overlaps itself is covered as
 * well as possible; parts without area give triangles without area. `scratch` holds n indices.
 * Deterministic: only + - * and comparisons of doubles. */
void eco_polygon_split(const double *corners, uint32_t n, uint32_t *scratch, uint32_t *triangles);

/* ---- Clusters of points, counted by squares of a grid ---- */

struct eco_cluster { double middle[2]; uint32_t count; };  /* the mean of a square's points */

/* Sorts `points` (x, y; finite) by squares of that side, in the order of columns and then rows; writes a
 * crowd for each square that holds any, at most `count`. Returns how many. */
uint32_t eco_clusters_find(double (*points)[2], uint32_t count, double side, struct eco_cluster *out);
/* The cluster nearest to `at` among those at least half as large as the largest; NULL: there are none. */
const struct eco_cluster *eco_cluster_near(const struct eco_cluster *crowds, uint32_t count, const double at[2]);
