/* Shapes of ground: missing samples filled, ground beyond the rasters, and ground without rasters. */
#include "ecofiles/base/memory.h"
#include "ecofiles/import/ground/ground.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- Filling ----
 * Missing samples grow in from the known ones, one ring a round. A round uses only samples known before
 * it, so its values are written once all of them are computed. Rings from several sides leave creases
 * where they meet; sweeps outwards and inwards again, each sample becoming the mean of its neighbours,
 * level them. A sample in the queue is infinite until its ring has values. */

#define SWEEPS_MAX 64u
#define SWEPT_MAX ((size_t)1 << 28)  /* samples in all sweeps: a few seconds */

struct fill {
	struct eco_ground *ground;
	uint32_t *queue; size_t end; /* indices of samples, ring after ring */
	float *values;               /* of one ring */
};

/* Runs the body for sample i and each of its up to eight neighbours. */
#define EACH_NEIGHBOUR(g, i, k) \
	for (size_t row_ = (i) / (g)->columns, y_ = row_ > 0 ? row_ - 1 : 0; \
	y_ <= row_ + 1 && y_ < (g)->rows; y_++) \
		for (size_t column_ = (i) % (g)->columns, x_ = column_ > 0 ? column_ - 1 : 0, k; \
			x_ <= column_ + 1 && x_ < (g)->columns && (k = y_ * (g)->columns + x_, true); x_++)

static void queue_missing_neighbours(struct fill *f, size_t i)
{
	EACH_NEIGHBOUR(f->ground, i, k)
		if (isnan(f->ground->height_m[k])) {
			f->ground->height_m[k] = INFINITY;
			f->queue[f->end++] = (uint32_t)k;
		}
}

static float neighbour_mean(const struct eco_ground *g, size_t i)
{
	double sum = 0;
	int count = 0;
	EACH_NEIGHBOUR(g, i, k)
		if (isfinite(g->height_m[k])) {
			sum += (double)g->height_m[k];
			count++;
		}
	return (float)(sum / count);
}

static void grow_rings(struct fill *f)
{
	struct eco_ground *g = f->ground;
	size_t count = (size_t)g->columns * g->rows, begin = 0;
	for (size_t i = 0; i < count; i++)
		if (isfinite(g->height_m[i]))
			queue_missing_neighbours(f, i);
	while (begin < f->end) {
		size_t last = f->end;
		for (size_t k = begin; k < last; k++)
			f->values[k - begin] = neighbour_mean(g, f->queue[k]);
		for (size_t k = begin; k < last; k++)
			g->height_m[f->queue[k]] = f->values[k - begin];
		for (; begin < last; begin++)
			queue_missing_neighbours(f, f->queue[begin]);
	}
}

static void level(struct fill *f)
{
	struct eco_ground *g = f->ground;
	size_t sweeps = SWEPT_MAX / f->end < SWEEPS_MAX ? SWEPT_MAX / f->end : SWEEPS_MAX;
	for (size_t sweep = 0; sweep < sweeps; sweep++)
		for (size_t k = 0; k < f->end; k++) {
			size_t i = f->queue[sweep % 2 ? k : f->end - 1 - k];
			g->height_m[i] = neighbour_mean(g, i);
		}
}

enum eco_code eco_ground_fill(struct eco_ground *ground, struct eco_error *error)
{
	size_t count = (size_t)ground->columns * ground->rows, missing = 0;
	struct fill f = { .ground = ground };
	for (size_t i = 0; i < count; i++)
		missing += isnan(ground->height_m[i]);
	ground->filled = missing;
	if (missing == 0)
		return ECO_OK;
	if (missing == count)
		return eco_fail(error, ECO_BAD_INPUT, "it holds no height at all, only NODATA");
	f.queue = eco_alloc(missing, sizeof *f.queue);
	f.values = eco_alloc(missing, sizeof *f.values);
	grow_rings(&f);
	level(&f);
	free(f.queue);
	free(f.values);
	return ECO_OK;
}

/* ---- Beyond the border ----
 * Ground beyond the rasters. Ring by ring outwards, each about twice as far from the border as the one
 * before, the border's heights are smoothed along it, as widely as the ring is far, and drawn to their mean:
 * a ridge that the border cuts ends in a rounded hill, and not in a wall or in furrows to the horizon. */

#define REACH_M 131072.0             /* from a tower of 1 km the horizon is 113 km away */
#define REACH_EXTENTS 4.0            /* and, for views from above, times the ground's width */

struct margin {
	const struct eco_ground *inside;
	double *profile, *next; /* heights along the border, counter-clockwise from its south-west corner */
	uint32_t length;             /* samples of the border */
	double mean, fade_m;
};

static uint32_t margin_of(const struct eco_ground *g)
{
	double step = fmin(g->step_x_m, g->step_y_m), width = g->step_x_m * (g->columns - 1),
	       depth = g->step_y_m * (g->rows - 1), reach = fmax(REACH_M, REACH_EXTENTS * fmax(width, depth));
	uint32_t margin = 1;
	while (margin < ECO_GROUND_MARGIN_MAX && step * ((1 << margin) - 1) < reach)
		margin++;
	return margin;
}

/* The number of sample (x, y) along the border. */
static uint32_t along_border(const struct eco_ground *g, uint32_t x, uint32_t y)
{
	uint32_t east = g->columns - 1, north = g->rows - 1;
	if (y == 0)
		return x;
	if (x == east)
		return east + y;
	return y == north ? east + north + (east - x) : 2 * east + north + (north - y);
}

static void take_profile(struct margin *m)
{
	const struct eco_ground *g = m->inside;
	double sum = 0;
	for (uint32_t y = 0; y < g->rows; y++)
		for (uint32_t x = 0; x < g->columns; x += y % (g->rows - 1) ? g->columns - 1 : 1)
			m->profile[along_border(g, x, y)] = (double)g->height_m[(size_t)y * g->columns + x];
	for (uint32_t i = 0; i < m->length; i++)
		sum += m->profile[i];
	m->mean = sum / m->length;
}

static void smooth(struct margin *m, uint32_t distance)
{
	for (uint32_t i = 0; i < m->length; i++)
		m->next[i] = (m->profile[(i + m->length - distance) % m->length] + 2 * m->profile[i]
			+ m->profile[(i + distance) % m->length]) / 4;
	double *profile = m->next;
	m->next = m->profile;
	m->profile = profile;
}

static uint32_t clamped(uint32_t i, uint32_t margin, uint32_t count)
{
	return i < margin ? 0 : i - margin < count ? i - margin : count - 1;
}

/* The samples of ring k, from 1: a rectangle. */
static void fill_ring(const struct margin *m, struct eco_ground *g, uint32_t k, double share)
{
	uint32_t low = g->margin - k, east = g->columns - 1 - low, north = g->rows - 1 - low;
	for (uint32_t y = low; y <= north; y++)
		for (uint32_t x = low; x <= east; x += y == low || y == north ? 1 : east - low) {
			uint32_t i = along_border(m->inside, clamped(x, g->margin, m->inside->columns),
				clamped(y, g->margin, m->inside->rows));
			g->height_m[(size_t)y * g->columns + x] =
				(float)(m->mean + (m->profile[i] - m->mean) * share);
		}
}

static void fill_rings(struct margin *m, struct eco_ground *g)
{
	double step = fmax(g->step_x_m, g->step_y_m);
	for (uint32_t k = 1; k <= g->margin; k++) {
		uint32_t width = 1u << (k - 1);
		double far = step * ((1 << k) - 1) / m->fade_m;
		if (width < m->length / 2)
			smooth(m, width);
		fill_ring(m, g, k, k < g->margin ? 1 / (1 + far * far) : 0);
	}
}

void eco_ground_extend(struct eco_ground *ground)
{
	const struct eco_ground inside = *ground;
	struct eco_ground g = inside;
	struct margin m = { .inside = &inside, .length = 2 * (inside.columns + inside.rows) - 4,
		.fade_m = (inside.step_x_m * inside.columns + inside.step_y_m * inside.rows) / 4 };
	g.margin = margin_of(&inside);
	g.columns += 2 * g.margin;
	g.rows += 2 * g.margin;
	g.height_m = eco_alloc((size_t)g.columns * g.rows, sizeof *g.height_m);
	double *profiles = eco_alloc(2 * m.length, sizeof *profiles);
	m.profile = profiles;
	m.next = profiles + m.length;
	take_profile(&m);
	for (uint32_t y = 0; y < inside.rows; y++)
		memcpy(g.height_m + (size_t)(y + g.margin) * g.columns + g.margin,
			inside.height_m + (size_t)y * inside.columns, inside.columns * sizeof *g.height_m);
	fill_rings(&m, &g);
	free(profiles);
	eco_ground_free(ground);
	*ground = g;
}

/* ---- Through plants ----
 * Ground for a scene without rasters: a least-squares plane through the feet of its plants, then grids twice
 * as fine each, until all stand; each adds the residuals of the feet (Lee, Wolberg, Shin 1997,
 * Scattered data interpolation with multilevel B-splines; of degree 1 here, on the triangles that are
 * drawn). Without plants the ground is that of the coarser grids. */

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
static void set_cells(struct eco_ground *g, const double size[2], uint32_t columns, uint32_t rows)
{
	struct eco_ground finer = *g;
	finer.columns = columns + 1;
	finer.rows = rows + 1;
	finer.step_x_m = size[0] / columns;
	finer.step_y_m = size[1] / rows;
	finer.height_m = eco_alloc((size_t)finer.columns * finer.rows, sizeof *finer.height_m);
	for (uint32_t i = 0; i < finer.columns * finer.rows; i++) {
		double z = 0;
		eco_ground_height(g, g->x_m + i % finer.columns * finer.step_x_m,
			g->y_m + i / finer.columns * finer.step_y_m, &z);
		finer.height_m[i] = (float)z;
	}
	eco_ground_free(g);
	*g = finer;
}

static void fit(struct eco_ground *g, const struct eco_ground_feet *feet, const double size[2])
{
	uint32_t less[2] = { octaves(size[1], size[0]), octaves(size[0], size[1]) };
	double longest = fmax(size[0], size[1]), (*sums)[2] = NULL;
	for (uint32_t level = 1; level <= LEVELS_MAX && !all_stand(g, feet); level++) {
		uint32_t columns = cells_at(level, less[0]), rows = cells_at(level, less[1]);
		if (ldexp(longest, -(int)level) < CELL_LEAST_M)
			break;
		sums = eco_realloc(sums, (size_t)(columns + 1) * (rows + 1), sizeof *sums);
		set_cells(g, size, columns, rows);
		for (int round = 0; round < ROUNDS && add_residuals(g, feet, sums) > STANDS_M / 2;
			round++)
			;
	}
	free(sums);
}

void eco_ground_through(struct eco_ground *ground, const struct eco_ground_feet *feet)
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
		.height_m = eco_alloc(4, sizeof(float)) };
	for (int i = 0; i < 4; i++)
		ground->height_m[i] = (float)(plane.mean
			+ plane.slope[0] * (low[0] + i % 2 * size[0] - plane.middle[0])
			+ plane.slope[1] * (low[1] + i / 2 * size[1] - plane.middle[1]));
	fit(ground, feet, size);
}
