/* Ground for hand-made scenes: a grid of heights from a function, as tiles, and the samples of each. */
#pragma once

#include <math.h>
#include <stdlib.h>

#include "lod/build/ground_tree.h"
#include "lod/ground_choice.h"

#define GROUND_TILES_STEP_M 0.0078125
#define GROUND_TILES_LOW_M (-4096.0)     /* below all heights */

/* columns, rows: with the margins. */
static inline struct eco_ground ground_make_wide(uint32_t columns, uint32_t rows, uint32_t margin, double x_m,
	double y_m, double step_m, double (*height)(double x, double y))
{
	struct eco_ground g = { .columns = columns,
		.rows = rows,
		.margin = margin,
		.x_m = x_m,
		.y_m = y_m,
		.step_x_m = step_m,
		.step_y_m = step_m,
		.height_m = malloc((size_t)columns * rows * sizeof(float)) };
	for (uint32_t r = 0; r < rows; r++)
		for (uint32_t c = 0; c < columns; c++)
			g.height_m[(size_t)r * columns + c] =
				(float)(floor(height(x_m + eco_ground_place(c, columns, margin) * step_m,
				y_m + eco_ground_place(r, rows, margin) * step_m) / GROUND_TILES_STEP_M
				+ 0.5) * GROUND_TILES_STEP_M);
	return g;
}

static inline struct eco_ground ground_make(uint32_t columns, uint32_t rows, double x_m, double y_m,
	double step_m, double (*height)(double x, double y))
{
	return ground_make_wide(columns, rows, 0, x_m, y_m, step_m, height);
}

static inline struct eco_list ground_list(const struct eco_ground *g, const struct eco_ground_tile *tile)
{
	struct eco_ground_span x, y;
	eco_ground_spans(&x, &y, tile, g->columns, g->rows);
	return (struct eco_list){ .kind = ECO_LIST_GROUND, .coder = ECO_CODER_ROWS, .level = tile->level,
		.owner = ECO_NONE,
		.image = ECO_NONE, .partner = ECO_NONE, .grid_origin = { g->x_m, g->y_m, GROUND_TILES_LOW_M },
		.grid_step = { g->step_x_m, g->step_y_m, GROUND_TILES_STEP_M }, .columns = x.count,
		.primitive_count = x.count * y.count,
		.element_count = x.count * y.count, .chunk_count = 1 };
}

static inline struct eco_elements ground_elements(const struct eco_ground *g,
	const struct eco_ground_tile *tile, uint8_t shift)
{
	struct eco_elements e;
	lod_ground_elements(&e, g, tile, shift, GROUND_TILES_LOW_M, GROUND_TILES_STEP_M);
	return e;
}
