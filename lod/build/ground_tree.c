/* Building the tree. Errors are measured level by level over all samples, so the work is samples times
 * levels. A tile's error is raised to its children's, so that refining never meets a larger one. */
#include "lod/build/ground_tree.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/memory.h"

#define ROUNDING 16.0                /* a tile's error over the rounding of its heights */
#define SHIFT_MAX 12

struct level {
	uint32_t columns, rows;      /* tiles */
	float *error, *low, *high;
	uint8_t *shift;
};

/* The full grid and where its samples lie, in steps (heights.h). */
struct terrain { const struct eco_ground *ground; double *x, *y; };

struct cell {                    /* between four samples of a coarse level */
	const struct terrain *terrain;
	uint32_t x, y, width, height;    /* full-detail samples */
	double sw, se, nw, ne;
};

static double height(const struct eco_ground *g, uint32_t x, uint32_t y)
{
	return g->height_m[(size_t)y * g->columns + x];
}

/* The largest error of samples [first, end) of a row against a line that starts at z and rises by `slope` a
 * step. `at`: their places. */
static double row_error(const float *row, const double *at, uint32_t first, uint32_t end, double z,
	double slope)
{
	double most = 0;
	for (uint32_t i = first; i < end; i++) {
		double off = fabs((double)row[i] - (z + slope * (at[i] - at[0])));
		most = off > most ? off : most;
	}
	return most;
}

/* Between samples the two surfaces differ most where the cell's diagonal crosses the edges of full detail:
 * the sides of its cells, and their diagonals. A stretch of the diagonal within one of these cells, from t to
 * end, as shares of the whole. */
static double stretch_error(const struct cell *c, uint32_t x, uint32_t y, double t, double end)
{
	const struct eco_ground *g = c->terrain->ground;
	const double *at_x = c->terrain->x, *at_y = c->terrain->y;
	double sw = height(g, x, y), se = height(g, x + 1, y), nw = height(g, x, y + 1),
		ne = height(g, x + 1, y + 1);
	double dx = (at_x[c->x + c->width] - at_x[c->x]) / (at_x[x + 1] - at_x[x]),
		dy = (at_y[c->y + c->height] - at_y[c->y]) / (at_y[y + 1] - at_y[y]);
	double u0 = (at_x[c->x] - at_x[x]) / (at_x[x + 1] - at_x[x]),
		v0 = (at_y[c->y] - at_y[y]) / (at_y[y + 1] - at_y[y]);
	double cross = dx != dy ? (v0 - u0) / (dx - dy) : t, most = 0;
	for (int k = 0; k < 3; k++) {
		double s = k == 0 ? t : k == 1 ? end : cross > t && cross < end ? cross : t;
		double u = u0 + s * dx, v = v0 + s * dy;
		double z = u >= v ? sw + u * (se - sw) + v * (ne - se) : sw + v * (nw - sw) + u * (ne - nw);
		most = fmax(most, fabs(z - (c->sw + s * (c->ne - c->sw))));
	}
	return most;
}

static double diagonal_error(const struct cell *c)
{
	const double *at_x = c->terrain->x + c->x, *at_y = c->terrain->y + c->y;
	uint32_t x = 0, y = 0;
	double t = 0, most = 0;
	while (x < c->width && y < c->height) {
		double next_x = (at_x[x + 1] - at_x[0]) / (at_x[c->width] - at_x[0]),
			next_y = (at_y[y + 1] - at_y[0]) / (at_y[c->height] - at_y[0]),
			end = next_x < next_y ? next_x : next_y;
		most = fmax(most, stretch_error(c, c->x + x, c->y + y, t, end));
		x += next_x <= end;
		y += next_y <= end;
		t = end;
	}
	return most;
}

/* Square and inside the margins: its diagonal is made of those of full detail. */
static bool is_plain(const struct cell *c, double across, double up)
{
	return c->width == c->height && across <= c->width && up <= c->height;
}

static double cell_error(const struct cell *c)
{
	const struct eco_ground *g = c->terrain->ground;
	const double *at_x = c->terrain->x + c->x, *at_y = c->terrain->y + c->y;
	double most = 0, across = at_x[c->width] - at_x[0], up = at_y[c->height] - at_y[0];
	uint32_t split = 0;              /* from here on the south-east triangle */
	for (uint32_t j = 0; j <= c->height; j++) {
		const float *row = &g->height_m[(size_t)(c->y + j) * g->columns + c->x];
		double v = (at_y[j] - at_y[0]) / up;
		while (split < c->width && (at_x[split] - at_x[0]) * up < (at_y[j] - at_y[0]) * across)
			split++;
		double upper =
			row_error(row, at_x, 0, split, c->sw + v * (c->nw - c->sw), (c->ne - c->nw) / across);
		double lower = row_error(row, at_x, split, c->width + 1, c->sw + v * (c->ne - c->se),
			(c->se - c->sw) / across);
		most = fmax(most, fmax(upper, lower));
	}
	return is_plain(c, across, up) ? most : fmax(most, diagonal_error(c));
}

static double tile_error(const struct terrain *terrain, uint8_t level, uint32_t column, uint32_t row)
{
	const struct eco_ground *g = terrain->ground;
	struct eco_ground_tile tile = { .level = level, .column = column, .row = row };
	struct eco_ground_span x, y;
	double most = 0;
	eco_ground_spans(&x, &y, &tile, g->columns, g->rows);
	for (uint32_t j = 0; j + 1 < y.inner; j++)
		for (uint32_t i = 0; i + 1 < x.inner; i++) {
			uint32_t x0 = eco_ground_span_at(&x, x.before + i),
				x1 = eco_ground_span_at(&x, x.before + i + 1);
			uint32_t y0 = eco_ground_span_at(&y, y.before + j),
				y1 = eco_ground_span_at(&y, y.before + j + 1);
			struct cell cell = { terrain, x0, y0, x1 - x0, y1 - y0, height(g, x0, y0),
				height(g, x1, y0), height(g, x0, y1), height(g, x1, y1) };
			most = fmax(most, cell_error(&cell));
		}
	return most;
}

/* Never below v: a conversion to float rounds to the nearest. */
static float rounded_up(double v)
{
	float f = (float)v;
	return f < v ? nextafterf(f, INFINITY) : f;
}

static void measure_finest(const struct eco_ground *g, struct level *l, uint32_t i)
{
	struct eco_ground_tile tile = { .column = i % l->columns, .row = i / l->columns };
	struct eco_ground_span x, y;
	eco_ground_spans(&x, &y, &tile, g->columns, g->rows);
	l->low[i] = INFINITY;
	l->high[i] = -INFINITY;
	for (uint32_t r = y.low; r <= y.high; r++)
		for (uint32_t c = x.low; c <= x.high; c++) {
			float z = g->height_m[(size_t)r * g->columns + c];
			l->low[i] = z < l->low[i] ? z : l->low[i];
			l->high[i] = z > l->high[i] ? z : l->high[i];
		}
}

static uint8_t shift_for(double error, double step_m)
{
	uint8_t shift = 0;
	while (shift < SHIFT_MAX && ldexp(step_m, shift + 1) * ROUNDING <= error)
		shift++;
	return shift;
}

static void measure_coarse(const struct terrain *terrain, double step_m, struct level *l,
	const struct level *finer, uint8_t level, uint32_t i)
{
	uint32_t column = i % l->columns, row = i / l->columns;
	double error = tile_error(terrain, level, column, row);
	l->shift[i] = shift_for(error, step_m);
	l->error[i] = rounded_up(l->shift[i] > 0 ? error + ldexp(step_m, l->shift[i] - 1) : error);
	l->low[i] = INFINITY;
	l->high[i] = -INFINITY;
	for (uint32_t r = 2 * row; r < 2 * row + 2 && r < finer->rows; r++)
		for (uint32_t c = 2 * column; c < 2 * column + 2 && c < finer->columns; c++) {
			uint32_t k = r * finer->columns + c;
			l->error[i] = fmaxf(l->error[i], finer->error[k]);
			l->low[i] = fminf(l->low[i], finer->low[k]);
			l->high[i] = fmaxf(l->high[i], finer->high[k]);
		}
}

static void measure(struct level *levels, uint8_t count, const struct terrain *terrain, double step_m)
{
	const struct eco_ground *g = terrain->ground;
	for (uint8_t n = 0; n < count; n++) {
		struct level *l = &levels[n];
		uint32_t side = ECO_GROUND_CELLS << n, tiles;
		l->columns = (g->columns - 2) / side + 1;
		l->rows = (g->rows - 2) / side + 1;
		tiles = l->columns * l->rows;
		l->error = eco_alloc(3 * (size_t)tiles, sizeof *l->error);
		l->shift = eco_alloc(tiles, 1);
		l->low = l->error + tiles;
		l->high = l->low + tiles;
		for (uint32_t i = 0; i < tiles; i++) {
			if (n == 0)
				measure_finest(g, l, i);
			else
				measure_coarse(terrain, step_m, l, &levels[n - 1], n, i);
		}
	}
}

/* Level by level from the root, children consecutive, as the pack requires. */
static void gather(struct lod_ground_tree *tree, const struct level *levels, uint8_t root, double least_m)
{
	size_t most = 0;
	for (uint8_t n = 0; n <= root; n++)
		most += (size_t)levels[n].columns * levels[n].rows;
	tree->tiles = eco_alloc(most, sizeof *tree->tiles);
	tree->shifts = eco_alloc(most, 1);
	tree->tiles[0].level = root;
	tree->count = 1;
	for (uint32_t i = 0; i < tree->count; i++) {
		struct eco_ground_tile *t = &tree->tiles[i];
		const struct level *l = &levels[t->level], *finer = l - 1;
		uint32_t at = t->row * l->columns + t->column;
		t->error_m = l->error[at];
		t->low_m = l->low[at];
		t->high_m = l->high[at];
		tree->shifts[i] = l->shift[at];
		/* a coarser one could not be split where it touches tiles of level 0 */
		bool may_end = t->level <= ECO_GROUND_APART_MAX;
		if (t->level == 0 || (may_end && (double)t->error_m <= least_m))
			continue;
		t->child_first = tree->count;
		for (uint32_t quarter = 0; quarter < 4; quarter++) {
			uint32_t column = 2 * t->column + quarter % 2, row = 2 * t->row + quarter / 2;
			if (column >= finer->columns || row >= finer->rows)
				continue;
			tree->tiles[tree->count++] =
				(struct eco_ground_tile){ .level = (uint8_t)(t->level - 1), .column = column,
				.row = row };
			t->child_count++;
		}
	}
}

void lod_ground_tree_free(struct lod_ground_tree *tree)
{
	free(tree->tiles);
	free(tree->shifts);
	*tree = (struct lod_ground_tree){ .tiles = NULL };
}

static double *places(uint32_t count, uint32_t margin)
{
	double *at = eco_alloc(count, sizeof *at);
	for (uint32_t i = 0; i < count; i++)
		at[i] = eco_ground_place(i, count, margin);
	return at;
}

enum eco_code lod_ground_build(struct lod_ground_tree *tree, const struct eco_ground *ground, double step_m,
	double least_m, struct eco_error *error)
{
	struct level levels[ECO_GROUND_LEVELS] = { { .columns = 0 } };
	uint8_t root = eco_ground_root_level(ground->columns, ground->rows);
	assert(ground->columns >= 2 && ground->rows >= 2);
	*tree = (struct lod_ground_tree){ .tiles = NULL };
	if (ground->columns > ECO_GROUND_SIDE_MAX || ground->rows > ECO_GROUND_SIDE_MAX)
		return eco_fail(error, ECO_TOO_LARGE, "ground of %u x %u samples, at most %u a side are kept",
			ground->columns, ground->rows, ECO_GROUND_SIDE_MAX);
	struct terrain terrain = { ground, places(ground->columns, ground->margin),
		places(ground->rows, ground->margin) };
	measure(levels, (uint8_t)(root + 1), &terrain, step_m);
	gather(tree, levels, root, least_m);
	free(terrain.x);
	free(terrain.y);
	for (uint8_t n = 0; n <= root; n++) {
		free(levels[n].error);
		free(levels[n].shift);
	}
	return ECO_OK;
}

/* The first or last of the covered samples, which other tiles share. */
static bool on_border(const struct eco_ground_span *s, uint32_t i)
{
	return i == s->before || i == s->before + s->inner - 1;
}

static int32_t rounded(int32_t z, uint8_t shift)
{
	int32_t unit = 1 << shift;
	return (z + unit / 2) / unit * unit;     /* heights are counted from the lowest: z >= 0 */
}

void lod_ground_elements(struct eco_elements *e, const struct eco_ground *ground,
	const struct eco_ground_tile *tile, uint8_t shift, double low_m, double step_m)
{
	struct eco_ground_span x, y;
	uint32_t count;
	int32_t *out;
	eco_ground_spans(&x, &y, tile, ground->columns, ground->rows);
	count = x.count * y.count;
	*e = (struct eco_elements){ .element_count = count, .corner_count = count, .primitive_count = count,
		.corners = eco_alloc(count, 1), .position = eco_alloc(count, 3 * sizeof(int32_t)) };
	memset(e->corners, 1, count);
	out = e->position;
	for (uint32_t r = 0; r < y.count; r++)
		for (uint32_t c = 0; c < x.count; c++) {
			uint32_t column = eco_ground_span_at(&x, c), row = eco_ground_span_at(&y, r);
			int32_t z = (int32_t)floor((height(ground, column, row) - low_m) / step_m + 0.5);
			*out++ = eco_ground_place(column, ground->columns, ground->margin);
			*out++ = eco_ground_place(row, ground->rows, ground->margin);
			*out++ = on_border(&x, c) || on_border(&y, r) ? z : rounded(z, shift);
		}
}
