/* The place of a plant in a city's model: the reference point of an implicit geometry, moved as its matrix
 * says; else the middle of the lowest part of its geometry. The middle of the whole would follow a crown that
 * leans over a street. */
#include "ecofiles/import/places/rows/rows_citygml.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/array_grow.h"

#define FOOT_SHARE 0.05          /* of a geometry's height that counts as its foot */
#define FOOT_LEAST_M 0.01

void eco_citygml_shape_begin(struct eco_citygml_shape *shape)
{
	shape->count = 0;
	shape->has_reference = shape->has_matrix = false;
}

static bool add_point(struct eco_citygml_shape *shape, const double at[3])
{
	if (shape->count == ECO_CITYGML_POINTS_MAX
			|| !eco_array_grow(&shape->points, &shape->capacity, shape->count, sizeof *shape->points))
		return false;
	memcpy(shape->points[shape->count++], at, sizeof *shape->points);
	return true;
}

/* The next number of a list; separators are spaces and commas. */
static bool next_number(const char **at, double *number)
{
	char *end;
	*at += strspn(*at, " \t\r\n,");
	if (**at == 0)
		return false;
	*number = strtod(*at, &end);
	if (end == *at || !isfinite(*number))
		return false;
	*at = end;
	return true;
}

static uint32_t count_numbers(const char *text)
{
	uint32_t count = 0;
	double number;
	while (next_number(&text, &number))
		count++;
	return count;
}

bool eco_citygml_shape_read(struct eco_citygml_shape *shape, const char *text, int dimension, bool reference)
{
	uint32_t count = count_numbers(text), each = dimension == 2 || dimension == 3 ? (uint32_t)dimension
		: count % 3 == 0 ? 3 : 2;
	bool good = true;
	for (uint32_t i = 0; good && i + each <= count; i += each) {
		double point[3] = { 0, 0, NAN };
		for (uint32_t k = 0; k < each; k++)
			next_number(&text, &point[k]);
		if (!reference) {
			good = add_point(shape, point);
		} else if (!shape->has_reference) {
			memcpy(shape->reference, point, sizeof point);
			shape->has_reference = true;
		}
	}
	return good;
}

void eco_citygml_shape_matrix(struct eco_citygml_shape *shape, const char *text)
{
	int count = 0;
	while (count < 16 && next_number(&text, &shape->matrix[count]))
		count++;
	shape->has_matrix = count == 16;
}

/* The middle of a trunk's foot, or of the lower edges of crossed pictures. */
static void find_foot(const struct eco_citygml_shape *shape, double foot[3])
{
	double least = INFINITY, most = -INFINITY, low[2] = { INFINITY, INFINITY },
		high[2] = { -INFINITY, -INFINITY };
	for (uint32_t i = 0; i < shape->count; i++) {
		least = fmin(least, shape->points[i][2]);
		most = fmax(most, shape->points[i][2]);
	}
	for (uint32_t i = 0; i < shape->count; i++) {
		if (shape->points[i][2] > least + fmax(FOOT_SHARE * (most - least), FOOT_LEAST_M))
			continue;
		for (int k = 0; k < 2; k++) {
			low[k] = fmin(low[k], shape->points[i][k]);
			high[k] = fmax(high[k], shape->points[i][k]);
		}
	}
	for (int k = 0; k < 2; k++)
		foot[k] = low[k] + (high[k] - low[k]) / 2;
	foot[2] = isfinite(least) ? least : NAN;
}

/* A matrix that does not turn says nothing of the yaw: writers fill in the identity. */
static void place_implicit(const struct eco_citygml_shape *shape, double at[3], double *yaw_deg)
{
	const double *m = shape->matrix;
	memcpy(at, shape->reference, sizeof shape->reference);
	if (!shape->has_matrix)
		return;
	for (int k = 0; k < 3; k++)
		at[k] += m[4 * k + 3];
	if (fabs(m[4]) > 1e-9 || m[0] < 0)
		*yaw_deg = atan2(m[4], m[0]) * (180 / 3.14159265358979323846);
}

bool eco_citygml_shape_place(const struct eco_citygml_shape *shape, double at[3], double *yaw_deg)
{
	if (shape->has_reference)
		place_implicit(shape, at, yaw_deg);
	else if (shape->count > 0)
		find_foot(shape, at);
	return shape->has_reference || shape->count > 0;
}
