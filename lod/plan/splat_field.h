/* Expected cover of a coarse screen by splats of summaries (lod/plan/visibility.h).
 *
 * The points of a summary are drawn at random from leaves of its plants, so splats lie on crowns by chance,
 * independently of each other, and reach beyond them. Their area is spread over the crowns' boxes, and blurred
 * by a square of their size: so many layers of splats lie there in the mean, and a point is in none of them
 * with probability e^-layers (Poisson). Sizes half an octave apart have a screen each, the smallest none to
 * blur.
 *
 *   struct lod_splat_field field = { columns, rows, cell_x, cell_y };
 *   cells = lod_splat_field_of(&field, side)            to which layers of splats of that size are added
 *   layers = lod_splat_field_blur(&field)               the sum of all
 *   lod_splat_field_free(&field)
 */
#ifndef LOD_SPLAT_FIELD_H
#define LOD_SPLAT_FIELD_H

#include <stdint.h>

struct lod_splat_field {
	uint32_t columns, rows;
	double cell_x, cell_y;       /* pixels */
	float *sizes;                /* screens of cells, row by row; its own, like ... */
	double *sums;                /* ... these, of a row or a column and beyond its ends */
	uint32_t used;               /* bit i: size i has splats */
};

/* Cells of the size next to `side` pixels, at first 0; NULL without memory. */
float *lod_splat_field_of(struct lod_splat_field *field, double side);
/* Once, when all are added. NULL: none were. */
const float *lod_splat_field_blur(struct lod_splat_field *field);
void lod_splat_field_free(struct lod_splat_field *field);

#endif
