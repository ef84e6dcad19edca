/* Heights between samples, by linear interpolation on the triangles of heights.h. */
#include "ecofiles/format/heights.h"

#include <stdlib.h>

#include "ecofiles/format/pack.h"

int32_t eco_ground_place(uint32_t i, uint32_t count, uint32_t margin)
{
	int32_t last = (int32_t)(count - 1 - 2 * margin), at = (int32_t)i - (int32_t)margin;
	if (at < 0)
		return 1 - (1 << -at);
	return at <= last ? at : last - 1 + (1 << (at - last));
}

uint32_t eco_ground_sample_at(int32_t place, uint32_t count, uint32_t margin)
{
	uint32_t last = count - 1 - 2 * margin;
	if (place >= 0 && (uint32_t)place <= last)
		return margin + (uint32_t)place;
	for (uint32_t k = 0; k < margin; k++)
		if (place == eco_ground_place(k, count, margin))
			return k;
		else if (place == eco_ground_place(count - 1 - k, count, margin))
			return count - 1 - k;
	return ECO_GROUND_SIDE_MAX;
}

/* The cell of the margin in which something lies so many steps beyond the border: its number from there. */
static uint32_t margin_cell(double beyond, uint32_t margin)
{
	uint32_t cell = 0;
	while (cell + 1 < margin && beyond >= (2u << cell) - 1)
		cell++;
	return cell;
}

/* A position on one axis as a cell and a share within it, clamped to the grid. */
static bool locate(double at, double first, double step, uint32_t count, uint32_t margin, uint32_t *cell,
	double *share)
{
	double place = (at - first) / step, last = count - 1 - 2 * margin;
	bool inside = place >= 0 && place <= last;
	if (margin > 0 && place < 0)
		*cell = margin - 1 - margin_cell(-place, margin);
	else if (margin > 0 && place > last)
		*cell = count - 1 - margin + margin_cell(place - last, margin);
	else
		*cell = margin + (place > 0 ? place < last ? (uint32_t)place : (uint32_t)last - 1 : 0);
	double low = eco_ground_place(*cell, count, margin),
		within = (place - low) / (eco_ground_place(*cell + 1, count, margin) - low);
	*share = within > 0 ? within < 1 ? within : 1 : 0;       /* NaN: 0 */
	return inside;
}

bool eco_ground_height(const struct eco_ground *ground, double x, double y, double *z)
{
	uint32_t column, row;
	double u, v;
	bool inside = locate(x, ground->x_m, ground->step_x_m, ground->columns, ground->margin, &column, &u);
	inside &= locate(y, ground->y_m, ground->step_y_m, ground->rows, ground->margin, &row, &v);
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
