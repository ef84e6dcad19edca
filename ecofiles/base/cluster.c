#include "ecofiles/base/cluster.h"

#include <math.h>
#include <stdlib.h>

static int compare_cells(const double a[2], const double b[2], double side)
{
	for (int k = 0; k < 2; k++) {
		double cell_a = floor(a[k] / side), cell_b = floor(b[k] / side);
		if (cell_a != cell_b)
			return cell_a < cell_b ? -1 : 1;
	}
	return 0;
}

static int by_cell(const void *a, const void *b, void *side)
{
	return compare_cells(a, b, *(const double *)side);
}

uint32_t eco_clusters_find(double (*points)[2], uint32_t count, double side, struct eco_cluster *out)
{
	uint32_t crowds = 0;
	qsort_r(points, count, sizeof *points, by_cell, &side);
	for (uint32_t i = 0, end; i < count; i = end) {
		struct eco_cluster *crowd = &out[crowds++];
		*crowd = (struct eco_cluster){ .count = 0 };
		for (end = i; end < count && compare_cells(points[i], points[end], side) == 0; end++) {
			crowd->count++;
			for (int k = 0; k < 2; k++)
				crowd->middle[k] += (points[end][k] - crowd->middle[k]) / crowd->count;
		}
	}
	return crowds;
}

const struct eco_cluster *eco_cluster_near(const struct eco_cluster *crowds, uint32_t count, const double at[2])
{
	const struct eco_cluster *nearest = NULL;
	uint32_t most = 0;
	double least = INFINITY;
	for (uint32_t i = 0; i < count; i++)
		most = crowds[i].count > most ? crowds[i].count : most;
	for (uint32_t i = 0; i < count; i++) {
		double away = hypot(crowds[i].middle[0] - at[0], crowds[i].middle[1] - at[1]);
		if (crowds[i].count >= most - most / 2 && away < least) {
			least = away;
			nearest = &crowds[i];
		}
	}
	return nearest;
}
