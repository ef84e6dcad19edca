/* Shapes of splats: moments of points, orthogonal half axes, and the codes that are stored. */
#include <math.h>
#include <string.h>

#include "lod/build/splat/splat_state.h"

#define SWEEPS 12

/* One rotation of Jacobi's method: makes a[p][q] zero, if it is not as good as zero. */
static void rotate(double a[3][3], double v[3][3], int p, int q)
{
	if (!(fabs(a[p][q]) > 1e-15 * (fabs(a[p][p]) + fabs(a[q][q]))))
		return;
	double theta = (a[q][q] - a[p][p]) / (2 * a[p][q]),
		t = (theta < 0 ? -1 : 1) / (fabs(theta) + sqrt(theta * theta + 1)),
		c = 1 / sqrt(t * t + 1), s = t * c;
	for (int k = 0; k < 3; k++) {
		double x = a[k][p], y = a[k][q];
		a[k][p] = c * x - s * y;
		a[k][q] = s * x + c * y;
	}
	for (int k = 0; k < 3; k++) {
		double x = a[p][k], y = a[q][k];
		a[p][k] = c * x - s * y;
		a[q][k] = s * x + c * y;
	}
	for (int k = 0; k < 3; k++) {
		double x = v[p][k], y = v[q][k];
		v[p][k] = c * x - s * y;
		v[q][k] = s * x + c * y;
	}
}

void splat_eigen(const double matrix[3][3], double value[3], double vector[3][3])
{
	double a[3][3], v[3][3] = { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } };
	int order[3] = { 0, 1, 2 };
	memcpy(a, matrix, sizeof a);
	for (int i = 0; i < SWEEPS; i++) {
		rotate(a, v, 0, 1);
		rotate(a, v, 0, 2);
		rotate(a, v, 1, 2);
	}
	for (int i = 0; i < 2; i++)
		for (int k = 0; k < 2 - i; k++)
			if (a[order[k]][order[k]] < a[order[k + 1]][order[k + 1]]) {
				int swap = order[k];
				order[k] = order[k + 1];
				order[k + 1] = swap;
			}
	for (int i = 0; i < 3; i++) {
		value[i] = a[order[i]][order[i]];
		memcpy(vector[i], v[order[i]], sizeof vector[i]);
	}
}

void splat_moments(const float (*point)[3], uint32_t count, double mean[3], double value[3],
	double vector[3][3])
{
	double square[3][3] = { { 0 } };
	memset(mean, 0, 3 * sizeof *mean);
	for (uint32_t i = 0; i < count; i++)
		for (int k = 0; k < 3; k++)
			mean[k] += point[i][k];
	for (int k = 0; k < 3 && count; k++)
		mean[k] /= count;
	for (uint32_t i = 0; i < count; i++)
		for (int k = 0; k < 3; k++)
			for (int j = 0; j < 3; j++)
				square[k][j] += (point[i][k] - mean[k]) * (point[i][j] - mean[j]) / count;
	splat_eigen((const double (*)[3])square, value, vector);
}

void splat_sort_along(float (*point)[3], uint32_t count, struct lod_arena *arena)
{
	double mean[3], value[3], vector[3][3];
	const struct lod_arena_piece *mark = arena->last;
	struct lod_keyed *keyed = lod_arena_take(arena, count, sizeof *keyed);
	float (*copy)[3] = lod_arena_take(arena, count, sizeof *copy);
	splat_moments((const float (*)[3])point, count, mean, value, vector);
	memcpy(copy, point, count * sizeof *copy);
	for (uint32_t i = 0; i < count; i++)
		keyed[i] = (struct lod_keyed){ lod_sort_key(copy[i][0] * vector[0][0]
			+ copy[i][1] * vector[0][1] + copy[i][2] * vector[0][2]), i };
	lod_sort(arena, keyed, count);
	for (uint32_t i = 0; i < count; i++)
		memcpy(point[i], copy[keyed[i].value], sizeof *copy);
	lod_arena_release(arena, mark);
}

void splat_orthogonal(struct splat_params *splat)
{
	double square[3][3], value[3], vector[3][3];
	const float *axes = splat->v + SPLAT_AXES;
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			square[i][j] = (double)axes[i] * axes[j] + (double)axes[3 + i] * axes[3 + j]
				+ (double)axes[6 + i] * axes[6 + j];
	splat_eigen(square, value, vector);
	for (int k = 0; k < 3; k++) {
		double length = value[k] > 0 ? sqrt(value[k]) : 0;
		for (int i = 0; i < 3; i++)
			splat->v[SPLAT_AXES + 3 * k + i] = (float)(length * vector[k][i]);
	}
}

void splat_inverse(const struct splat_params *splat, double least, double inverse[3][3])
{
	struct splat_params straight = *splat;
	splat_orthogonal(&straight);
	memset(inverse, 0, 9 * sizeof inverse[0][0]);
	for (int k = 0; k < 3; k++) {
		const float *half = straight.v + SPLAT_AXES + 3 * k;
		double square = (double)half[0] * half[0] + (double)half[1] * half[1]
			+ (double)half[2] * half[2], wide = square > least * least ? square : least * least;
		/* a turn of length 1, where the axis has one */
		for (int i = 0; i < 3; i++)
			for (int j = 0; j < 3; j++)
				inverse[i][j] += square > 0 ? half[i] * (double)half[j] / square / wide : 0;
	}
}

static int32_t nearest(double at)
{
	double low = floor(at + 0.5);
	return !(low >= 0) ? 0 : low > LOD_SPLAT_GRID - 1 ? LOD_SPLAT_GRID - 1 : (int32_t)low;
}

void splat_store(struct lod_splat *out, const struct splat_params *splat, const struct lod_splats *splats)
{
	struct splat_params straight = *splat;
	splat_orthogonal(&straight);
	for (int k = 0; k < 3; k++) {
		double metres = splats->center[k] + splats->radius * (double)splat->v[k];
		out->at[k] = nearest((metres - splats->origin[k]) / splats->step);
		out->center[k] = (float)(splats->origin[k] + out->at[k] * splats->step);
		for (int i = 0; i < 3; i++)
			out->shape.half[k][i] = (float)splats->radius * straight.v[SPLAT_AXES + 3 * k + i];
	}
	out->shape.opacity = splat->v[SPLAT_OPACITY];
	eco_splat_write(out->code, &out->shape, splats->unit);
	eco_splat_read(&out->shape, out->code, splats->unit);
}

void splat_restore(struct splat_params *out, const struct lod_splat *splat, const struct lod_splats *splats)
{
	float to_radius = (float)(1 / splats->radius);
	for (int k = 0; k < 3; k++) {
		out->v[k] = (float)((splats->origin[k] + splat->at[k] * splats->step - splats->center[k])
			/ splats->radius);
		for (int i = 0; i < 3; i++)
			out->v[SPLAT_AXES + 3 * k + i] = to_radius * splat->shape.half[k][i];
	}
	out->v[SPLAT_OPACITY] = splat->shape.opacity;
}
