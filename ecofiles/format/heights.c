/* Heights between samples, by linear interpolation on the triangles of heights.h. */
#include "ecofiles/format/heights.h"

#include <math.h>
#include <stdlib.h>

/* A position on one axis as a cell and a share within it, clamped to the grid. */
static bool locate(double at, double first, double step, uint32_t count, uint32_t *cell, double *share)
{
	double place = (at - first) / step;
	bool inside = place >= 0 && place <= count - 1;
	if (!(place > 0))                    /* NaN too */
		place = 0;
	if (place > count - 1)
		place = count - 1;
	*cell = place < count - 1 ? (uint32_t)place : count - 2;
	*share = place - *cell;
	return inside;
}

bool eco_ground_height(const struct eco_ground *ground, double x, double y, double *z)
{
	uint32_t column, row;
	double u, v;
	bool inside = locate(x, ground->x_m, ground->step_x_m, ground->columns, &column, &u);
	inside &= locate(y, ground->y_m, ground->step_y_m, ground->rows, &row, &v);
	const float *south = &ground->height_m[(size_t)row * ground->columns + column],
		*north = south + ground->columns;
	double sw = south[0], ne = north[1];

	if (u >= v)                          /* below the diagonal: south-west, south-east, north-east */
		*z = sw + u * (south[1] - sw) + v * (ne - south[1]);
	else
		*z = sw + v * (north[0] - sw) + u * (ne - north[0]);
	return inside;
}

void eco_ground_free(struct eco_ground *ground)
{
	free(ground->height_m);
	*ground = (struct eco_ground){ .height_m = NULL };
}
