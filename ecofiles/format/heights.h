/* The ground in memory: a grid of heights under a scene.
 *
 * Sample (c, r) is the height at x = x_m + c * step_x_m, y = y_m + r * step_y_m, the centre of a raster's
 * pixel. A cell between four samples is two triangles along the diagonal from its south-west to its
 * north-east corner. Pictures and plants use the same triangles, so that nothing floats. */
#ifndef ECO_HEIGHTS_H
#define ECO_HEIGHTS_H

#include <stdbool.h>
#include <stdint.h>

struct eco_ground {
	uint32_t columns, rows;      /* 2..ECO_GROUND_SIDE_MAX each */
	double x_m, y_m;             /* the south-west sample, metres from the scene's origin */
	double step_x_m, step_y_m;   /* > 0 */
	/* columns * rows, row by row from the south-west, minus the origin's z; owned */
	float *height_m;
	uint64_t filled;             /* samples missing in the rasters, filled from neighbours */
};

/* Height at (x, y) in *z, exactly on the triangles. Outside the grid: false, and the height of the nearest
 * point of its border. */
bool eco_ground_height(const struct eco_ground *ground, double x, double y, double *z);
void eco_ground_free(struct eco_ground *ground);

#endif
