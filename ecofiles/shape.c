/* Equal shapes among elements. Each element has a frame of its own (middle, normal, direction of its first far corner); in it, and
 * divided by its size, elements of one shape have the same corners up to what rounding did to them. Rounding did less to large ones,
 * so they are looked at first and become the shapes; any other joins the first shape that no corner of it is too far from. Whether
 * an element may be stored as a placed shape is then decided by placing it, with rounded turn, size and centre, and measuring. */
#include "ecofiles/shape.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/chunk_rows.h"

#define TURN_ROOM 1.25           /* rounded entries move corners by at most about so many times radius * 2^-turn_bits: sqrt(3 / 2) */

/* ---- Placing ---- */

static int64_t root_floor(int64_t v)
{
	int64_t r = (int64_t)sqrt((double)v);
	while (r * r > v)
		r--;
	while ((r + 1) * (r + 1) <= v)
		r++;
	return r;
}

/* The rotation in units of 2^(-2 * bits); false where the entries are longer than 1. In the textbook's matrix every product of two entries
 * is doubled: entries in units of sqrt(1/2) make that 1. */
static bool rotation_of(const struct eco_placing *p, uint32_t bits, int64_t m[9])
{
	int64_t q[4], one = (int64_t)1 << 2 * bits, rest = 2 * one;
	if (p->left > 3)
		return false;
	for (int i = 0, k = 0; i < 4; i++) {
		if (i == p->left)
			continue;
		q[i] = p->turn[k++];
		if (q[i] > (int64_t)1 << bits || q[i] < -((int64_t)1 << bits))
			return false;
		rest -= q[i] * q[i];
	}
	if (rest < 0)
		return false;
	q[p->left] = root_floor(rest);
	int64_t w = q[0], x = q[1], y = q[2], z = q[3];
	m[0] = one - (y * y + z * z);
	m[1] = x * y - w * z;
	m[2] = x * z + w * y;
	m[3] = x * y + w * z;
	m[4] = one - (x * x + z * z);
	m[5] = y * z - w * x;
	m[6] = x * z - w * y;
	m[7] = y * z + w * x;
	m[8] = one - (x * x + y * y);
	return true;
}

bool eco_shape_place(const struct eco_shapes *shapes, const struct eco_shape *shape, const struct eco_placing *p, int32_t *position)
{
	int64_t m[9], unit = (int64_t)1 << 2 * shapes->turn_bits;
	if (p->size < 1 || p->size > ECO_SHAPE_SIZE_MAX || !rotation_of(p, shapes->turn_bits, m))
		return false;
	for (int i = 0; i < 3; i++)
		if (p->center[i] > ECO_ROWS_VALUE_MAX || p->center[i] < -ECO_ROWS_VALUE_MAX)
			return false;
	for (uint32_t k = 0; k < shape->corners; k++)
		for (int i = 0; i < 3; i++) {
			int64_t v = 0;
			for (int j = 0; j < 3; j++)
				v += m[3 * i + j] * shape->position[3 * k + (uint32_t)j];
			/* below 2^12 * 3 * 3 * 2^28: rounded to a 16th of ECO_SHAPE_ONE before the size is multiplied in */
			v = (v * 16 + unit / 2) >> 2 * shapes->turn_bits;
			v = v * p->size * ((int64_t)1 << shapes->size_shift);
			v = (v + 8 * ECO_SHAPE_ONE) >> 16;
			v += (int64_t)p->center[i] * ((int64_t)1 << shapes->place_shift);
			if (v > ECO_ROWS_VALUE_MAX || v < -ECO_ROWS_VALUE_MAX)
				return false;
			position[3 * k + (uint32_t)i] = (int32_t)v;
		}
	return true;
}

/* ---- Frames ---- */

struct frame {
	double center[3], axis[3][3];        /* axes as rows */
	double radius;                       /* root mean square */
	double corner[3 * ECO_CORNERS_MAX];  /* in the frame, divided by the radius */
};

static double dot(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const double a[3], const double b[3], double c[3])
{
	c[0] = a[1] * b[2] - a[2] * b[1];
	c[1] = a[2] * b[0] - a[0] * b[2];
	c[2] = a[0] * b[1] - a[1] * b[0];
}

static bool make_unit(double v[3])
{
	double length = sqrt(dot(v, v));
	for (int i = 0; i < 3; i++)
		v[i] /= length > 0 ? length : 1;
	return length > 0;
}

/* The first corner that is nearly as far from the middle as any: which one rounding made the farthest does not matter. */
static uint32_t far_corner(const double (*from)[3], uint32_t corners)
{
	double most = 0;
	for (uint32_t k = 0; k < corners; k++)
		most = fmax(most, dot(from[k], from[k]));
	uint32_t k = 0;
	while (dot(from[k], from[k]) < 0.8 * most)
		k++;
	return k;
}

static bool frame_of(struct frame *f, const int32_t *exact, uint32_t corners)
{
	double from[ECO_CORNERS_MAX][3], sum = 0, fan[3];
	memset(f, 0, sizeof *f);
	for (uint32_t k = 0; k < corners; k++)
		for (int i = 0; i < 3; i++)
			f->center[i] += (double)exact[3 * k + (uint32_t)i] / corners;
	for (uint32_t k = 0; k < corners; k++) {
		for (int i = 0; i < 3; i++)
			from[k][i] = exact[3 * k + (uint32_t)i] - f->center[i];
		sum += dot(from[k], from[k]);
	}
	f->radius = sqrt(sum / corners);
	for (uint32_t k = 0; k < corners; k++) {
		cross(from[k], from[(k + 1) % corners], fan);
		for (int i = 0; i < 3; i++)
			f->axis[2][i] += fan[i];
	}
	if (f->radius < 1 || !make_unit(f->axis[2]))
		return false;
	const double *far = from[far_corner((const double (*)[3])from, corners)];
	double up = dot(far, f->axis[2]);
	for (int i = 0; i < 3; i++)
		f->axis[0][i] = far[i] - up * f->axis[2][i];
	if (!make_unit(f->axis[0]))
		return false;
	cross(f->axis[2], f->axis[0], f->axis[1]);
	for (uint32_t k = 0; k < corners; k++)
		for (int i = 0; i < 3; i++)
			f->corner[3 * k + (uint32_t)i] = dot(from[k], f->axis[i]) / f->radius;
	return true;
}

/* ---- Fitting ---- */

/* The quaternion (w, x, y, z) of the rotation whose columns are the frame's axes (Shepperd 1978: the largest entry first). */
static uint8_t quaternion_of(const double a[3][3], double q[4])
{
	/* m[i][j] = a[j][i] */
	double trace[4] = { a[0][0] + a[1][1] + a[2][2], a[0][0], a[1][1], a[2][2] };
	uint8_t largest = 0;
	for (uint8_t i = 1; i < 4; i++)
		if (trace[i] > trace[largest])
			largest = i;
	double wx = a[1][2] - a[2][1], wy = a[2][0] - a[0][2], wz = a[0][1] - a[1][0];
	double xy = a[1][0] + a[0][1], xz = a[2][0] + a[0][2], yz = a[2][1] + a[1][2];
	double d = largest == 0 ? 1 + trace[0] : 1 + 2 * trace[largest] - trace[0];
	const double rows[4][4] = { { d, wx, wy, wz }, { wx, d, xy, xz }, { wy, xy, d, yz }, { wz, xz, yz, d } };
	double length = 0;
	for (int i = 0; i < 4; i++)
		length += rows[largest][i] * rows[largest][i];
	length = sqrt(length);
	for (int i = 0; i < 4; i++)
		q[i] = rows[largest][i] / length;
	return largest;
}

static int32_t nearest(double v)
{
	return (int32_t)floor(v + 0.5);
}

/* What rounding to the coarse grid can move a corner by, squared. */
static double room_of(uint32_t coarse_shift)
{
	double half = (double)(1u << coarse_shift) / 2;
	return 3 * half * half;
}

static bool fit_frame(const struct eco_shapes *shapes, const struct eco_shape *shape, const struct frame *f, const int32_t *exact,
	uint32_t coarse_shift, struct eco_placing *p)
{
	double q[4];
	int32_t at[3 * ECO_CORNERS_MAX];
	*p = (struct eco_placing){ .left = quaternion_of(f->axis, q) };
	for (int i = 0, k = 0; i < 4; i++)
		if (i != p->left)
			p->turn[k++] = nearest(ldexp(q[i] * 1.4142135623730951, shapes->turn_bits));
	p->size = nearest(ldexp(f->radius, -shapes->size_shift));
	p->size = p->size < 1 ? 1 : p->size;
	if (p->size > ECO_SHAPE_SIZE_MAX)
		return false;
	for (int i = 0; i < 3; i++)
		p->center[i] = nearest(ldexp(f->center[i], -shapes->place_shift));
	if (!eco_shape_place(shapes, shape, p, at))
		return false;
	double worst = 0;
	for (uint32_t k = 0; k < shape->corners; k++) {
		double d2 = 0;
		for (int i = 0; i < 3; i++) {
			double d = (double)at[3 * k + (uint32_t)i] - exact[3 * k + (uint32_t)i];
			d2 += d * d;
		}
		worst = fmax(worst, d2);
	}
	return worst <= room_of(coarse_shift);
}

bool eco_shape_fit(const struct eco_shapes *shapes, const struct eco_shape *shape, const int32_t *exact, uint32_t coarse_shift,
	struct eco_placing *placing)
{
	struct frame f;
	return frame_of(&f, exact, shape->corners) && fit_frame(shapes, shape, &f, exact, coarse_shift, placing);
}

/* ---- Finding ---- */

static double distance2(const struct eco_shape *s, const struct frame *f)
{
	double worst = 0;
	for (uint32_t k = 0; k < s->corners; k++) {
		double d2 = 0;
		for (uint32_t i = 0; i < 3; i++) {
			double d = f->corner[3 * k + i] - (double)s->position[3 * k + i] / ECO_SHAPE_ONE;
			d2 += d * d;
		}
		worst = fmax(worst, d2);
	}
	return worst * f->radius * f->radius;
}

struct by_radius { double radius; uint32_t element; };

static int compare_radius(const void *left, const void *right)
{
	const struct by_radius *a = left, *b = right;
	if (a->radius != b->radius)
		return a->radius > b->radius ? -1 : 1;
	return a->element < b->element ? -1 : a->element > b->element;
}

static bool same_uv(const struct eco_shape *s, const int32_t *uv)
{
	return uv == NULL || memcmp(s->uv, uv, 2 * sizeof *uv * s->corners) == 0;
}

static uint32_t match(struct eco_shapes *shapes, const struct frame *f, uint32_t corners, const int32_t *uv, double room)
{
	uint32_t s = 0;
	while (s < shapes->count && (shapes->items[s].corners != corners || !same_uv(&shapes->items[s], uv)
			|| distance2(&shapes->items[s], f) > room))
		s++;
	if (s < shapes->count)
		return s;
	if (s == ECO_SHAPES_MAX)
		return ECO_SHAPE_NONE;
	struct eco_shape *made = &shapes->items[shapes->count++];
	*made = (struct eco_shape){ .corners = (uint8_t)corners };
	for (uint32_t k = 0; k < 3 * corners; k++)
		made->position[k] = nearest(f->corner[k] * ECO_SHAPE_ONE);
	if (uv)
		memcpy(made->uv, uv, 2 * sizeof *uv * corners);
	return s;
}

/* Leaves out shapes of few elements and numbers the others anew. */
static void keep_used(struct eco_shapes *shapes, uint32_t *of, uint32_t count, uint32_t uses)
{
	uint32_t used[ECO_SHAPES_MAX] = { 0 }, number[ECO_SHAPES_MAX], kept = 0;
	for (uint32_t i = 0; i < count; i++)
		if (of[i] != ECO_SHAPE_NONE)
			used[of[i]]++;
	for (uint32_t s = 0; s < shapes->count; s++) {
		number[s] = used[s] >= uses ? kept : ECO_SHAPE_NONE;
		if (used[s] >= uses)
			shapes->items[kept++] = shapes->items[s];
	}
	for (uint32_t i = 0; i < count; i++)
		of[i] = of[i] == ECO_SHAPE_NONE ? ECO_SHAPE_NONE : number[of[i]];
	shapes->count = kept;
}

bool eco_shapes_find(struct eco_shapes *shapes, const struct eco_shapes_input *in, uint32_t uses, uint32_t *of)
{
	uint32_t count = in->end - in->first;
	const struct eco_elements *e = in->elements;
	struct frame *frames = malloc(count * sizeof *frames);
	struct by_radius *by = malloc(count * sizeof *by);
	*shapes = (struct eco_shapes){ .items = calloc(ECO_SHAPES_MAX, sizeof *shapes->items), .place_shift = (uint8_t)(in->coarse_shift - 1),
		.size_shift = (uint8_t)(in->coarse_shift - 1) };
	bool good = frames && by && shapes->items;
	for (uint32_t i = 0; good && i < count; i++) {
		bool has = frame_of(&frames[i], e->exact + 3 * in->at[i], e->corners[in->first + i]);
		by[i] = (struct by_radius){ has ? frames[i].radius : 0, i };
		of[i] = ECO_SHAPE_NONE;
	}
	if (good) {
		qsort(by, count, sizeof *by, compare_radius);
		double typical = by[count / 8].radius, half = (double)(1u << in->coarse_shift) / 2;
		while (shapes->turn_bits < ECO_SHAPE_TURN_BITS_MAX && ldexp(typical * TURN_ROOM, -shapes->turn_bits) > half)
			shapes->turn_bits++;
		shapes->turn_bits += shapes->turn_bits < ECO_SHAPE_TURN_BITS_MAX;
		for (uint32_t i = 0; i < count && by[i].radius > 0; i++) {
			uint32_t k = by[i].element;
			of[k] = match(shapes, &frames[k], e->corners[in->first + k], e->uv ? e->uv + 2 * in->at[k] : NULL,
				room_of(in->coarse_shift) / 4);
		}
		keep_used(shapes, of, count, uses);
	}
	free(frames);
	free(by);
	if (!good)
		eco_shapes_free(shapes);
	return good;
}

void eco_shapes_free(struct eco_shapes *shapes)
{
	free(shapes->items);
	*shapes = (struct eco_shapes){ 0 };
}
