/* Box filters by sums of rows and columns: see lod/plan/splat_field.h. */
#include "lod/plan/splat_field.h"

#include <math.h>
#include <stdlib.h>

#include "lod/plan/visibility.h"

#define SIZES 16                 /* from a cell on */
#define SIZES_PER_OCTAVE 2

static size_t cells_of(const struct lod_splat_field *field) { return (size_t)field->columns * field->rows; }

/* Side of a size's splats, over that of a cell. */
static double width_of(int size)
{
	return ldexp(size % SIZES_PER_OCTAVE ? 1.41421356237309504880 : 1, size / SIZES_PER_OCTAVE);
}

float *lod_splat_field_of(struct lod_splat_field *field, double side)
{
	double cells = side / field->cell_x;
	int size = (int)(fmax(0, 2 * lod_octaves(cells)) * SIZES_PER_OCTAVE + 0.5);
	size = size < SIZES ? size : SIZES - 1;
	if (!field->sizes) {
		uint32_t most = field->columns > field->rows ? field->columns : field->rows;
		field->sums = malloc(3 * (most + 1) * sizeof *field->sums);
		field->sizes = field->sums ? calloc(SIZES * cells_of(field), sizeof *field->sizes) : NULL;
		if (!field->sizes)
			return NULL;
	}
	field->used |= 1u << size;
	return field->sizes + (size_t)size * cells_of(field);
}

/* Each becomes the mean of what is within half of `width` around its middle: between sums up to there, which lie
 * as far between two whole cells for all. */
static void blur_line(double *sums, float *line, uint32_t count, uint32_t step, double width)
{
	double reach = fmin(0.5 + 0.5 * width, count), each = 1 / width;
	uint32_t whole = (uint32_t)reach;
	double part = reach - whole, sum = 0;
	for (uint32_t i = 0; i <= whole; i++)
		sums[i] = 0;
	for (uint32_t i = 0; i < count; i++)
		sums[whole + i + 1] = sum += (double)line[i * step];
	for (uint32_t i = 0; i <= whole; i++)
		sums[whole + count + 1 + i] = sum;
	for (uint32_t i = 0; sum > 0 && i < count; i++) {
		const double *low = sums + i, *high = low + 2 * (size_t)whole;
		line[i * step] = (float)(each * (high[0] + part * (high[1] - high[0])
			- low[1] + part * (low[1] - low[0])));
	}
}

static void blur_size(struct lod_splat_field *field, int size)
{
	float *cells = field->sizes + (size_t)size * cells_of(field);
	double width = width_of(size), height = width * field->cell_x / field->cell_y;
	for (uint32_t r = 0; r < field->rows; r++)
		blur_line(field->sums, cells + (size_t)r * field->columns, field->columns, 1, width);
	for (uint32_t c = 0; c < field->columns; c++)
		blur_line(field->sums, cells + c, field->rows, field->columns, height);
	for (size_t i = 0; i < cells_of(field); i++)
		field->sizes[i] += cells[i];
}

const float *lod_splat_field_blur(struct lod_splat_field *field)
{
	for (int size = 1; size < SIZES; size++)
		if (field->used >> size & 1)
			blur_size(field, size);
	return field->used ? field->sizes : NULL;
}

void lod_splat_field_free(struct lod_splat_field *field)
{
	free(field->sizes);
	free(field->sums);
	*field = (struct lod_splat_field){ 0 };
}
