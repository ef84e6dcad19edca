/* Clusters of points, counted by squares of a grid. */
#ifndef ECO_CLUSTER_H
#define ECO_CLUSTER_H

#include <stdint.h>

struct eco_cluster { double middle[2]; uint32_t count; };  /* the mean of a square's points */

/* Sorts `points` (x, y; finite) by squares of that side, in the order of columns and then rows; writes a
 * crowd for each square that holds any, at most `count`. Returns how many. */
uint32_t eco_clusters_find(double (*points)[2], uint32_t count, double side, struct eco_cluster *out);
/* The cluster nearest to `at` among those at least half as large as the largest; NULL: there are none. */
const struct eco_cluster *eco_cluster_near(const struct eco_cluster *crowds, uint32_t count, const double at[2]);

#endif
