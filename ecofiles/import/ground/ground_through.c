/* Ground for a scene without rasters: a least-squares plane through the feet of its plants, then grids twice
 * as fine each, until all stand, each of which adds the residuals of the feet (Lee, Wolberg, Shin 1997,
 * Scattered data interpolation with multilevel B-splines; of degree 1 here, on the triangles that are
 * drawn). Where no plant stands, the ground is that of the coarser grids. */
#include "ecofiles/import/ground/ground.h"

#include <math.h>
#include <stdlib.h>

#define LEVELS_MAX 9u
#define CELL_LEAST_M 0.25
#define STANDS_M 0.01
#define ROUNDS 4                     /* with one grid: feet that share a cell agree better each time */

struct foot { uint32_t sample[3]; double weight[3]; };      /* the corners of the triangle that it is on */

static struct foot foot_on(const struct eco_ground *g, const double at[2])
{
	double x = (at[0] - g->x_m) / g->step_x_m, y = (at[1] - g->y_m) / g->step_y_m;
	x = fmin(fmax(x, 0), g->columns - 1);
	y = fmin(fmax(y, 0), g->rows - 1);
	uint32_t column = x < g->columns - 1 ? (uint32_t)x : g->columns - 2,
		row = y < g->rows - 1 ? (uint32_t)y : g->rows - 2, sw = row * g->columns + column;
	double u = x - column, v = y - row;
	if (u >= v)
		return (struct foot){ { sw, sw + 1, sw + g->columns + 1 }, { 1 - u, u - v, v } };
	return (struct foot){ { sw, sw + g->columns, sw + g->columns + 1 }, { 1 - v, v - u, u } };
}

/* Moves the grid's samples towards the feet: each by the mean of what the feet around it ask for, weighted by
 * the squares of their shares. Returns the largest residual that there was. */
static double add_residuals(struct eco_ground *g, const struct eco_ground_feet *feet, double (*sums)[2])
{
	size_t samples = (size_t)g->columns * g->rows;
	double most = 0;
	for (size_t i = 0; i < samples; i++)
		sums[i][0] = sums[i][1] = 0;
	for (uint32_t i = 0; i < feet->count; i++) {
		struct foot f = foot_on(g, feet->at[i]);
		double residual = feet->at[i][2], squares = 0;
		for (int k = 0; k < 3; k++) {
			residual -= f.weight[k] * (double)g->height_m[f.sample[k]];
			squares += f.weight[k] * f.weight[k];
		}
		most = fmax(most, fabs(residual));
		for (int k = 0; k < 3; k++) {
			double square = f.weight[k] * f.weight[k];
			sums[f.sample[k]][0] += square * (f.weight[k] * residual / squares);
			sums[f.sample[k]][1] += square;
		}
	}
	for (size_t i = 0; i < samples; i++)
		if (sums[i][1] > 0)
			g->height_m[i] += (float)(sums[i][0] / sums[i][1]);
	return most;
}

/* Plane z = mean + slope . (at - middle). */
struct plane { double middle[2], mean, slope[2]; };

static struct plane plane_through(const struct eco_ground_feet *feet)
{
	struct plane p = { .mean = 0 };
	double xx = 0, xy = 0, yy = 0, xz = 0, yz = 0;
	for (uint32_t i = 0; i < feet->count; i++) {
		p.middle[0] += feet->at[i][0] / feet->count;
		p.middle[1] += feet->at[i][1] / feet->count;
		p.mean += feet->at[i][2] / feet->count;
	}
	for (uint32_t i = 0; i < feet->count; i++) {
		double x = feet->at[i][0] - p.middle[0], y = feet->at[i][1] - p.middle[1],
			z = feet->at[i][2] - p.mean;
		xx += x * x, xy += x * y, yy += y * y, xz += x * z, yz += y * z;
	}
	double determinant = xx * yy - xy * xy;
	if (determinant > 1e-6 * (xx + yy) * (xx + yy)) {
		p.slope[0] = (xz * yy - yz * xy) / determinant;
		p.slope[1] = (yz * xx - xz * xy) / determinant;
	} else if (xx + yy > 0) {        /* in a row: level across it */
		p.slope[0] = xz / (xx + yy);
		p.slope[1] = yz / (xx + yy);
	}
	return p;
}

/* Cells along an axis at a level: 2^level along the longer one; `less`: octaves by which this is shorter. */
static uint32_t cells_at(uint32_t level, uint32_t less) { return level > less ? 1u << (level - less) : 1; }

static uint32_t octaves(double a, double b)
{
	uint32_t n = 0;
	while (n < LEVELS_MAX && b > 0 && a >= 2 * b)
		n++, b *= 2;
	return n;
}

static bool all_stand(const struct eco_ground *g, const struct eco_ground_feet *feet)
{
	for (uint32_t i = 0; i < feet->count; i++) {
		double z;
		eco_ground_height(g, feet->at[i][0], feet->at[i][1], &z);
		if (fabs(feet->at[i][2] - z) > STANDS_M)
			return false;
	}
	return true;
}

/* The same surface on another grid; frees the old one. */
static bool set_cells(struct eco_ground *g, const double size[2], uint32_t columns, uint32_t rows)
{
	struct eco_ground finer = *g;
	finer.columns = columns + 1;
	finer.rows = rows + 1;
	finer.step_x_m = size[0] / columns;
	finer.step_y_m = size[1] / rows;
	finer.height_m = malloc((size_t)finer.columns * finer.rows * sizeof *finer.height_m);
	for (uint32_t i = 0; finer.height_m && i < finer.columns * finer.rows; i++) {
		double z = 0;
		eco_ground_height(g, g->x_m + i % finer.columns * finer.step_x_m,
			g->y_m + i / finer.columns * finer.step_y_m, &z);
		finer.height_m[i] = (float)z;
	}
	eco_ground_free(g);
	*g = finer;
	return g->height_m;
}

static bool fit(struct eco_ground *g, const struct eco_ground_feet *feet, const double size[2])
{
	uint32_t less[2] = { octaves(size[1], size[0]), octaves(size[0], size[1]) };
	double longest = fmax(size[0], size[1]), (*sums)[2] = NULL;
	bool good = true;
	for (uint32_t level = 1; good && level <= LEVELS_MAX && !all_stand(g, feet); level++) {
		uint32_t columns = cells_at(level, less[0]), rows = cells_at(level, less[1]);
		if (ldexp(longest, -(int)level) < CELL_LEAST_M)
			break;
		free(sums);
		sums = malloc(sizeof *sums * (columns + 1) * (rows + 1));
		good = sums && set_cells(g, size, columns, rows);
		for (int round = 0; good && round < ROUNDS && add_residuals(g, feet, sums) > STANDS_M / 2;
			round++)
			;
	}
	free(sums);
	return good;
}

enum eco_code eco_ground_through(struct eco_ground *ground, const struct eco_ground_feet *feet,
	struct eco_error *error)
{
	struct plane plane = plane_through(feet);
	double low[2], size[2];
	for (int i = 0; i < 2; i++) {
		size[i] = fmax(feet->high[i] - feet->low[i], 1);
		low[i] = (feet->low[i] + feet->high[i] - size[i]) / 2;
	}
	*ground = (struct eco_ground){ .columns = 2,
		.rows = 2,
		.x_m = low[0],
		.y_m = low[1],
		.step_x_m = size[0],
		.step_y_m = size[1],
		.height_m = malloc(4 * sizeof(float)) };
	for (int i = 0; ground->height_m && i < 4; i++)
		ground->height_m[i] = (float)(plane.mean
			+ plane.slope[0] * (low[0] + i % 2 * size[0] - plane.middle[0])
			+ plane.slope[1] * (low[1] + i / 2 * size[1] - plane.middle[1]));
	if (ground->height_m && fit(ground, feet, size))
		return ECO_OK;
	eco_ground_free(ground);
	return eco_fail(error, ECO_NO_MEMORY, "no memory for the ground under %u plants", feet->count);
}
