/* Prediction of corners, in integers, so that all machines get the same corners. */
#include "ecofiles/format/chunk/chunk_corners.h"

#include <string.h>

#include "ecofiles/format/chunk/chunk_rows.h"
#include "ecofiles/format/chunk/shape.h"

#define SUM_MAX ((int64_t)1 << 30)
#define UNIT 1024                /* length of the bases that do not grow with the element */

/* Adds an edge as a base. Bases are edges, not vectors from corner 0: these are longer and would need
 * finer weights. */
static void add_edge(struct eco_frame *f, const int32_t *from, const int32_t *to)
{
	int32_t *base = f->base[f->bases++];
	for (int i = 0; i < 3; i++)
		base[i] = to[i] - from[i];
}

static void add_axis(struct eco_frame *f, const int64_t axis[3], int64_t length)
{
	int32_t *base = f->base[f->bases++];
	for (int i = 0; i < 3; i++)
		base[i] = (int32_t)(axis[i] * length >> ECO_AXIS_BITS);
}

uint32_t eco_corner_bases(uint32_t k)
{
	return k < 2 ? 0 : k == 2 ? 4 : k;
}

static void find_axes(struct eco_frame *f, const int32_t *at, uint32_t of)
{
	int64_t edge[3] = { 0 }, to[3];
	for (int i = 0; i < 3 && of > 1; i++) {
		edge[i] = (int64_t)at[3 + i] - at[i];
		to[i] = of > 2 ? (int64_t)at[6 + i] - at[i] : 0;
	}
	if (f->of < 2)
		f->length = eco_axes_first(edge, f->axis);
	eco_axes_others(of > 2 ? to : NULL, f->axis);
	f->of = of;
}

void eco_corner_frame(struct eco_frame *f, const int32_t *at, uint32_t k)
{
	if (f->of != (k < 3 ? k : 3))
		find_axes(f, at, k < 3 ? k : 3);
	f->bases = 0;
	for (uint32_t j = 1; j < k; j++)
		add_edge(f, at + 3 * j - 3, at + 3 * j);
	if (k > 1)
		add_axis(f, f->axis[2], f->length);
	if (k == 2) {
		add_axis(f, f->axis[1], f->length);
		add_axis(f, f->axis[1], UNIT);
	}
}

void eco_corner_guess(const struct eco_frame *f, const int32_t *weight, int64_t guess[3])
{
	int64_t sum[3];
	for (int i = 0; i < 3; i++) {
		sum[i] = 1 << (ECO_WEIGHT_BITS - 1);
		for (uint32_t j = 0; j < f->bases; j++)
			sum[i] += (int64_t)weight[j] * f->base[j][i];
		sum[i] >>= ECO_WEIGHT_BITS;
		sum[i] = sum[i] > SUM_MAX ? SUM_MAX : sum[i] < -SUM_MAX ? -SUM_MAX : sum[i];
	}
	for (int a = 0; a < 3; a++)
		guess[a] = (sum[0] * f->axis[a][0] + sum[1] * f->axis[a][1] + sum[2] * f->axis[a][2])
			>> ECO_AXIS_BITS;
}

bool eco_corner_place(const struct eco_frame *f, const int64_t guess[3], const int32_t miss[3],
	const int32_t *from, int32_t *at)
{
	int64_t along[3];
	along[0] = guess[0] + (int64_t)ECO_LATTICE_STEP * miss[0];
	for (int a = 1; a < 3; a++)
		along[a] = guess[a] + 2 * (int64_t)ECO_LATTICE_STEP * miss[a]
			+ ECO_LATTICE_STEP * (miss[0] & 1);
	for (int i = 0; i < 3; i++) {
		int64_t v = along[0] * f->axis[0][i] + along[1] * f->axis[1][i] + along[2] * f->axis[2][i];
		v = from[i] + ((v + ((int64_t)1 << (ECO_AXIS_BITS - 1))) >> ECO_AXIS_BITS);
		if (v > ECO_ROWS_VALUE_MAX || v < -ECO_ROWS_VALUE_MAX)
			return false;
		at[i] = (int32_t)v;
	}
	return true;
}
