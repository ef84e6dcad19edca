/* The ground in memory: a grid of heights under a scene, up to the horizon.
 *
 * Sample (c, r) is the height at x = x_m + place(c) * step_x_m, y = y_m + place(r) * step_y_m. Inside, places
 * are 0, 1, 2, ...: the centres of a raster's pixels. On each side the outermost `margin` samples belong to
 * no raster: from one to the next the step doubles, so that a few dozen reach the horizon (eco_ground_place).
 * A cell between four samples is two triangles along the diagonal from its south-west to its
 * north-east corner. Pictures and plants use the same triangles, so that nothing floats. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#define ECO_GROUND_MARGIN_MAX 24u

struct eco_ground {
	/* 2..ECO_GROUND_SIDE_MAX each, with both margins; at least 2 are inside */
	uint32_t columns, rows;
	uint32_t margin;             /* samples on each side, 0..ECO_GROUND_MARGIN_MAX */
	double x_m, y_m;             /* the south-west sample inside, metres from the scene's origin */
	double step_x_m, step_y_m;   /* > 0; inside */
	/* columns * rows, row by row from the south-west, minus the origin's z; owned */
	float *height_m;
	uint64_t filled;             /* samples missing in the rasters, filled from neighbours */
};

/* Place of sample i of `count` along an axis, in steps from the first one inside: i - margin inside;
 * 1, 3, 7, 15, ... steps beyond the first and the last one inside in the margins. */
int32_t eco_ground_place(uint32_t i, uint32_t count, uint32_t margin);
/* The sample at a place, or ECO_GROUND_SIDE_MAX where there is none. */
uint32_t eco_ground_sample_at(int32_t place, uint32_t count, uint32_t margin);

/* Height at (x, y) in *z, exactly on the triangles. False outside the rasters: then on the margin's
 * triangles, beyond them the height of their nearest point. */
bool eco_ground_height(const struct eco_ground *ground, double x, double y, double *z);
void eco_ground_free(struct eco_ground *ground);
