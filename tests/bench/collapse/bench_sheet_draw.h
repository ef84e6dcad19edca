/* A picture of a plant of a pack with light and textures, as the planner draws it with so many vertices. */
#ifndef BENCH_SHEET_DRAW_H
#define BENCH_SHEET_DRAW_H

#include "ecofiles/ecopack/export/plant_view.h"

/* rgb: the view's raster, 3 bytes a pixel. Sets the vertices drawn, and Q against full detail. */
enum eco_code bench_sheet_draw(struct plant_view *view, uint64_t vertices, uint8_t *rgb, uint64_t *drawn,
	double *q, struct eco_error *error);

#endif
