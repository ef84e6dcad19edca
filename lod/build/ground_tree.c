/* Building the tree. Errors are measured level by level over all samples, so the work is samples times
 * levels. A tile's error is raised to its children's, so that refining never meets a larger one. */
#include "lod/build/ground_tree.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define ROUNDING 16.0                /* a tile's error over the rounding of its heights */
#define SHIFT_MAX 12

struct level {
	uint32_t columns, rows;      /* tiles */
	float *error, *low, *high;
	uint8_t *shift;
};

struct cell {                    /* between four samples of a coarse level */
	const struct eco_ground *ground;
	uint32_t x, y, width, height;    /* full-detail samples */
	double sw, se, nw, ne;
};

static double height(const struct eco_ground *g, uint32_t x, uint32_t y)
{
	return g->height_m[(size_t)y * g->columns + x];
}

/* The largest error of columns [first, end) of a row against a line that starts at z and rises by `slope` a
 * column. */
static double row_error(const float *row, uint32_t first, uint32_t end, double z, double slope)
{
	double most = 0;
	for (uint32_t i = first; i < end; i++) {
		double off = fabs((double)row[i] - (z + slope * i));
		most = off > most ? off : most;
	}
	return most;
}

/* The diagonal of a cell that is not square crosses those of full detail between samples. */
static double diagonal_error(const struct cell *c, uint32_t part, uint32_t parts)
{
	double t = (double)part / parts, x = c->x + t * c->width, y = c->y + t * c->height, z;
	struct eco_ground unit = *c->ground;
	unit.x_m = unit.y_m = 0;
	unit.step_x_m = unit.step_y_m = 1;
	eco_ground_height(&unit, x, y, &z);
	return fabs(z - (c->sw + t * (c->ne - c->sw)));
}

static double cell_error(const struct cell *c)
{
	double most = 0, width = c->width, height = c->height;
	for (uint32_t j = 0; j <= c->height; j++) {
		const float *row = &c->ground->height_m[(size_t)(c->y + j) * c->ground->columns + c->x];
		/* From here on the south-east triangle. */
		uint32_t split = (uint32_t)(((uint64_t)j * c->width + c->height - 1) / c->height);
		double v = j / height;
		double upper = row_error(row, 0, split, c->sw + v * (c->nw - c->sw), (c->ne - c->nw) / width);
		double lower = row_error(row, split, c->width + 1, c->sw + v * (c->ne - c->se),
			(c->se - c->sw) / width);

		most = fmax(most, fmax(upper, lower));
	}
	if (c->width == c->height)
		return most;
	uint32_t parts[3] = { c->width, c->height, c->width > c->height ? c->width - c->height
		: c->height - c->width };
	for (int k = 0; k < 3; k++)
		for (uint32_t i = 1; i < parts[k]; i++)
			most = fmax(most, diagonal_error(c, i, parts[k]));
	return most;
}

static double tile_error(const struct eco_ground *g, uint8_t level, uint32_t column, uint32_t row)
{
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
			struct cell cell = { g, x0, y0, x1 - x0, y1 - y0, height(g, x0, y0),
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

static void measure_coarse(const struct eco_ground *g, double step_m, struct level *l,
	const struct level *finer, uint8_t level, uint32_t i)
{
	uint32_t column = i % l->columns, row = i / l->columns;
	double error = tile_error(g, level, column, row);
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

static bool measure(struct level *levels, uint8_t count, const struct eco_ground *g, double step_m)
{
	for (uint8_t n = 0; n < count; n++) {
		struct level *l = &levels[n];
		uint32_t side = ECO_GROUND_CELLS << n, tiles;
		l->columns = (g->columns - 2) / side + 1;
		l->rows = (g->rows - 2) / side + 1;
		tiles = l->columns * l->rows;
		l->error = calloc(3 * (size_t)tiles, sizeof *l->error);
		l->shift = calloc(tiles, 1);
		if (!l->error || !l->shift)
			return false;
		l->low = l->error + tiles;
		l->high = l->low + tiles;
		for (uint32_t i = 0; i < tiles; i++) {
			if (n == 0)
				measure_finest(g, l, i);
			else
				measure_coarse(g, step_m, l, &levels[n - 1], n, i);
		}
	}
	return true;
}

/* Level by level from the root, children consecutive, as the pack requires. */
static bool gather(struct lod_ground_tree *tree, const struct level *levels, uint8_t root, double least_m)
{
	size_t most = 0;
	for (uint8_t n = 0; n <= root; n++)
		most += (size_t)levels[n].columns * levels[n].rows;
	tree->tiles = calloc(most, sizeof *tree->tiles);
	tree->shifts = calloc(most, 1);
	if (!tree->tiles || !tree->shifts)
		return false;
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
		if (t->level == 0 || (double)t->error_m <= least_m)
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
	return true;
}

void lod_ground_tree_free(struct lod_ground_tree *tree)
{
	free(tree->tiles);
	free(tree->shifts);
	*tree = (struct lod_ground_tree){ .tiles = NULL };
}

enum eco_code lod_ground_build(struct lod_ground_tree *tree, const struct eco_ground *ground, double step_m,
	double least_m, struct eco_error *error)
{
	struct level levels[ECO_GROUND_LEVELS] = { { .columns = 0 } };
	uint8_t root = eco_ground_root_level(ground->columns, ground->rows);
	bool good;
	assert(ground->columns >= 2 && ground->rows >= 2);
	*tree = (struct lod_ground_tree){ .tiles = NULL };
	if (ground->columns > ECO_GROUND_SIDE_MAX || ground->rows > ECO_GROUND_SIDE_MAX)
		return eco_fail(error, ECO_TOO_LARGE, "ground of %u x %u samples, at most %u a side are kept",
			ground->columns, ground->rows, ECO_GROUND_SIDE_MAX);
	good = measure(levels, (uint8_t)(root + 1), ground, step_m) && gather(tree, levels, root, least_m);
	for (uint8_t n = 0; n <= root; n++) {
		free(levels[n].error);
		free(levels[n].shift);
	}
	if (good)
		return ECO_OK;
	lod_ground_tree_free(tree);
	return eco_fail(error, ECO_NO_MEMORY, "no memory for tiles of ground");
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

enum eco_code lod_ground_elements(struct eco_elements *e, const struct eco_ground *ground,
	const struct eco_ground_tile *tile, uint8_t shift, double low_m, double step_m,
	struct eco_error *error)
{
	struct eco_ground_span x, y;
	uint32_t count;
	int32_t *out;
	eco_ground_spans(&x, &y, tile, ground->columns, ground->rows);
	count = x.count * y.count;
	*e = (struct eco_elements){ .element_count = count, .corner_count = count, .primitive_count = count,
		.corners = malloc(count),
		.position = malloc(3 * sizeof(int32_t) * count) };
	if (!e->corners || !e->position) {
		eco_elements_free(e);
		return eco_fail(error, ECO_NO_MEMORY, "no memory for %u samples of ground", count);
	}
	memset(e->corners, 1, count);
	out = e->position;
	for (uint32_t r = 0; r < y.count; r++)
		for (uint32_t c = 0; c < x.count; c++) {
			uint32_t column = eco_ground_span_at(&x, c), row = eco_ground_span_at(&y, r);
			int32_t z = (int32_t)floor((height(ground, column, row) - low_m) / step_m + 0.5);
			*out++ = (int32_t)column;
			*out++ = (int32_t)row;
			*out++ = on_border(&x, c) || on_border(&y, r) ? z : rounded(z, shift);
		}
	return ECO_OK;
}
