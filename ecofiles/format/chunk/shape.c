/* Placing shapes in integers: axes have 24 bits behind the point, lengths times coordinates 4. */
#include "ecofiles/format/chunk/shape.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/format/chunk/chunk_rows.h"

static int64_t root_floor(int64_t v)
{
	int64_t r = (int64_t)sqrt((double)v);
	while (r * r > v)
		r--;
	while ((r + 1) * (r + 1) <= v)
		r++;
	return r;
}

/* Writes v's direction to `axis` and returns its length; v is not 0. */
static int64_t unit_of(const int64_t v[3], int64_t axis[3])
{
	int64_t length2 = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
	/* so that the root has 30 bits */
	uint32_t shift = ((uint32_t)__builtin_clzll((unsigned long long)length2) - 2) / 2;
	int64_t length = root_floor(length2 * ((int64_t)1 << 2 * shift)),
		inverse = ((int64_t)1 << 61) / length;
	for (int i = 0; i < 3; i++)
		axis[i] = (v[i] * ((int64_t)1 << shift) * inverse) >> (61 - ECO_AXIS_BITS);
	return length >> shift;
}

/* A direction on the unfolded octahedron: the middle square, turned by 45 degrees, is the upper half. */
static void way_of(const int32_t way[2], uint32_t bits, int64_t axis[3])
{
	int64_t one = (int64_t)2 << bits, x = 2 * (int64_t)way[0] + 1 - one,
		y = 2 * (int64_t)way[1] + 1 - one;
	int64_t ax = x < 0 ? -x : x, ay = y < 0 ? -y : y, z = one - ax - ay;
	if (z < 0) {
		x = x < 0 ? ay - one : one - ay;
		y = y < 0 ? ax - one : one - ax;
	}
	unit_of((int64_t[3]){ x, y, z }, axis);
}

/* A level direction across x; any, where x is upright. */
static void across(const int64_t x[3], int64_t y[3])
{
	if (x[0] == 0 && x[1] == 0)
		unit_of((int64_t[3]){ 0, 1, 0 }, y);
	else
		unit_of((int64_t[3]){ -x[1], x[0], 0 }, y);
}

static void cross(const int64_t a[3], const int64_t b[3], int64_t c[3])
{
	for (int i = 0; i < 3; i++)
		c[i] = (a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3]) >> ECO_AXIS_BITS;
}

int64_t eco_axes_first(const int64_t x[3], int64_t axis[3][3])
{
	if (x[0] || x[1] || x[2])
		return unit_of(x, axis[0]);
	memcpy(axis[0], (int64_t[3]){ (int64_t)1 << ECO_AXIS_BITS, 0, 0 }, sizeof axis[0]);
	return 0;
}

/* y is enlarged before its part along x is subtracted, and that is done twice: even where y is nearly
 * along x, the result is at right angles. */
void eco_axes_others(const int64_t *y, int64_t axis[3][3])
{
	int64_t rest[3] = { 0 }, any = y ? llabs(y[0]) | llabs(y[1]) | llabs(y[2]) : 0;
	for (int i = 0; i < 3 && any; i++)
		rest[i] = y[i] * ((int64_t)1 << (__builtin_clzll((unsigned long long)any) - 34));
	for (int pass = 0; pass < 2; pass++) {
		int64_t along = (rest[0] * axis[0][0] + rest[1] * axis[0][1] + rest[2] * axis[0][2])
			>> ECO_AXIS_BITS;
		for (int i = 0; i < 3; i++)
			rest[i] -= along * axis[0][i] >> ECO_AXIS_BITS;
	}
	if (rest[0] || rest[1] || rest[2])
		unit_of(rest, axis[1]);
	else
		across(axis[0], axis[1]);
	cross(axis[0], axis[1], axis[2]);
}

/* Rows are the shape's x, y and z axes. Roll goes around the square with corners on the axes, not the
 * circle. */
static void axes_of(const struct eco_shapes *s, const struct eco_placing *p, int64_t axis[3][3])
{
	int64_t level[3], up[3], step = (int64_t)1 << s->roll_bits, part = p->roll & (step - 1), turn[3];
	way_of(p->way, s->way_bits, axis[0]);
	across(axis[0], level);
	cross(axis[0], level, up);
	unit_of((int64_t[3]){ step - part, part, 0 }, turn);
	int quarter = (int)(p->roll >> s->roll_bits);
	int64_t c = quarter == 0 ? turn[0] : quarter == 1 ? -turn[1] : quarter == 2 ? -turn[0] : turn[1];
	int64_t sine = quarter == 0 ? turn[1] : quarter == 1 ? turn[0] : quarter == 2 ? -turn[1] : -turn[0];
	for (int i = 0; i < 3; i++) {
		axis[1][i] = (level[i] * c + up[i] * sine) >> ECO_AXIS_BITS;
		axis[2][i] = (up[i] * c - level[i] * sine) >> ECO_AXIS_BITS;
	}
}

bool eco_shape_axes(const struct eco_shapes *s, const struct eco_placing *p, int64_t axis[3][3])
{
	int32_t ways = (int32_t)2 << s->way_bits, rolls = (int32_t)4 << s->roll_bits;
	if (p->way[0] < 0 || p->way[0] >= ways || p->way[1] < 0 || p->way[1] >= ways || p->roll < 0
			|| p->roll >= rolls)
		return false;
	axes_of(s, p, axis);
	return true;
}

bool eco_shape_offset(const struct eco_shapes *s, const struct eco_shape *shape, const struct eco_placing *p,
	int64_t axis[3][3], int32_t *offset)
{
	int64_t size[3];
	for (int i = 0; i < 3; i++) {
		if (p->size[i] > ECO_SHAPE_SIZE_MAX || p->size[i] < -ECO_SHAPE_SIZE_MAX)
			return false;
		size[i] = (int64_t)p->size[i] * ((int64_t)1 << s->size_shift[i]);
	}
	if (s->stretch == ECO_STRETCH_NONE)
		size[1] = size[0];
	if (s->stretch == ECO_STRETCH_NONE || s->stretch == ECO_STRETCH_WIDTH)
		size[2] = size[0];
	if (s->stretch == ECO_STRETCH_LENGTH)
		size[2] = size[1];
	for (uint32_t k = 0; k < shape->corners; k++) {
		int64_t along[3];
		for (uint32_t j = 0; j < 3; j++)
			/* below 2^33: sizes are below 2^28 */
			along[j] = (shape->position[3 * k + j] * size[j]) >> 8;
		for (uint32_t i = 0; i < 3; i++) {
			int64_t v = along[0] * axis[0][i] + along[1] * axis[1][i] + along[2] * axis[2][i];
			v = (v + ((int64_t)1 << (ECO_AXIS_BITS + 3))) >> (ECO_AXIS_BITS + 4);
			if (v > 2 * ECO_ROWS_VALUE_MAX || v < -2 * ECO_ROWS_VALUE_MAX)
				return false;
			offset[3 * k + i] = (int32_t)v;
		}
	}
	return true;
}

bool eco_shape_turn(const struct eco_shapes *s, const struct eco_shape *shape, const struct eco_placing *p,
	int32_t *offset)
{
	int64_t axis[3][3];
	return eco_shape_axes(s, p, axis) && eco_shape_offset(s, shape, p, axis, offset);
}

bool eco_shape_place(const struct eco_shapes *s, const struct eco_placing *p, const int32_t *offset,
	uint32_t corners, int32_t *position)
{
	for (uint32_t i = 0; i < 3 * corners; i++) {
		int64_t v = offset[i] + (int64_t)p->center[i % 3] * ((int64_t)1 << s->place_shift);
		if (v > ECO_ROWS_VALUE_MAX || v < -ECO_ROWS_VALUE_MAX)
			return false;
		position[i] = (int32_t)v;
	}
	return true;
}

void eco_shapes_free(struct eco_shapes *shapes)
{
	free(shapes->items);
	*shapes = (struct eco_shapes){ 0 };
}
