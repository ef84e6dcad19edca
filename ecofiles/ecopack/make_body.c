/* The sizes of a built plant: its bounds, how wide its crown is, and where that begins. Splats stand around
 * the bounds, and may lie a little beyond. */
#include "ecofiles/ecopack/make.h"

#include <math.h>
#include <stdlib.h>

#include "ecofiles/base/memory.h"

typedef void on_element(void *ctx, const double (*corners)[3], uint32_t n);

/* Calls on(ctx, corners, n) for each element, or for those of the model itself, not of simpler forms; corners in metres. */
static void each_element(const struct make_plant *plant, bool finest, on_element *on, void *ctx)
{
	for (uint32_t i = 0; i < plant->built.list_count; i++) {
		const struct eco_list *list = &plant->built.lists[i].list;
		const struct eco_elements *e = &plant->built.lists[i].elements;
		const int32_t *position = e->position;
		if ((list->attributes & ECO_ATTR_SPLAT) || (finest && list->coder == ECO_CODER_FORM))
			continue;
		for (uint32_t k = 0; k < e->element_count; k++) {
			double corners[ECO_CORNERS_MAX][3];
			for (uint32_t c = 0; c < e->corners[k]; c++, position += 3)
				for (int axis = 0; axis < 3; axis++)
					corners[c][axis] = list->grid_origin[axis] +
						list->grid_step[axis] * position[axis];
			on(ctx, (const double(*)[3])corners, e->corners[k]);
		}
	}
}

#define CELLS 128u /* across a plant from above */
#define GAP 8u     /* cells: gaps of twice as many are filled */

struct above {
	uint8_t covered[CELLS][CELLS];
	double cell_m;
};

/* Marks the cells below a triangle, by points as far apart as a cell is wide. */
static void above_triangle(struct above *above, const double a[3], const double b[3], const double c[3])
{
	const double u[2] = { b[0] - a[0], b[1] - a[1] }, v[2] = { c[0] - a[0], c[1] - a[1] };
	double longest = sqrt(fmax(u[0] * u[0] + u[1] * u[1], v[0] * v[0] + v[1] * v[1]));
	uint32_t steps = (uint32_t)(longest / above->cell_m) + 1;
	for (uint32_t i = 0; i <= steps; i++)
		for (uint32_t k = 0; i + k <= steps; k++) {
			double s = (double)i / steps, t = (double)k / steps;
			double x = (a[0] + s * u[0] + t * v[0]) / above->cell_m + CELLS / 2.0,
			       y = (a[1] + s * u[1] + t * v[1]) / above->cell_m + CELLS / 2.0;
			if (x >= GAP && y >= GAP && x < CELLS - GAP && y < CELLS - GAP)
				above->covered[(uint32_t)y][(uint32_t)x] = 1;
		}
}

static void above_element(void *above, const double (*corners)[3], uint32_t n)
{
	for (uint32_t c = 0; c + 2 < n || c == 0; c++)
		above_triangle(above, corners[0], corners[n > 1 ? c + 1 : 0], corners[n > 2 ? c + 2 : n - 1]);
}

/* Along a row or a column: covers what has a covered cell within GAP, or keeps what has none else. */
static void above_pass(uint8_t *line, size_t stride, bool grow)
{
	uint8_t old[CELLS];
	uint32_t count = 0;
	for (uint32_t i = 0; i < CELLS; i++)
		old[i] = line[i * stride];
	for (uint32_t i = 0; i < GAP; i++)
		count += old[i];
	for (uint32_t i = 0; i < CELLS; i++) {
		count += i + GAP < CELLS ? old[i + GAP] : 0;
		line[i * stride] = grow ? count > 0 : count == 2 * GAP + 1;
		count -= i >= GAP ? old[i - GAP] : 0;
	}
}

/* The radius of the disc that covers as much as the crown does from above, gaps filled: crowns measured from the air are such
 * areas. The mean of two or four widths across is a little more. A card on edge is as wide as its half. */
static double crown_radius(const struct make_plant *plant)
{
	struct above *above = eco_alloc(1, sizeof *above);
	uint32_t cells = 0;
	above->cell_m = 2 * plant->reach / (CELLS - 2 * GAP);
	each_element(plant, true, above_element, above);
	for (int pass = 0; pass < 4; pass++)
		for (uint32_t i = 0; i < CELLS; i++)
			above_pass(pass % 2 ? &above->covered[0][i] : above->covered[i], pass % 2 ? CELLS : 1,
				pass < 2);
	for (uint32_t i = 0; i < CELLS * CELLS; i++)
		cells += above->covered[i / CELLS][i % CELLS];
	/* the cells of an outline reach half a cell beyond it */
	double radius = above->cell_m * (sqrt(cells / M_PI) - 0.5);
	free(above);
	return fmax(radius, plant->reach / 4);
}

#define SLICES 64u
#define LOWEST 0.02 /* share of the crown's corners below its base: single twigs */

struct slices {
	double height_m, far, slice[SLICES], all;
};

static void slices_element(void *ctx, const double (*corners)[3], uint32_t n)
{
	struct slices *s = ctx;
	for (uint32_t c = 0; c < n; c++) {
		const double *at = corners[c];
		if (at[0] * at[0] + at[1] * at[1] < s->far || !(at[2] >= 0 && at[2] < s->height_m))
			continue;
		s->slice[(uint32_t)(at[2] / s->height_m * SLICES)]++;
		s->all++;
	}
}

/* The crown base: below it no corners, or single ones, are farther from the stem than a third of its radius. */
static double crown_base(const struct make_plant *plant)
{
	struct slices s = { .height_m = (double)plant->built.plant.height_m,
		.far = plant->crown * plant->crown / 9 };
	uint32_t k = 0;
	each_element(plant, true, slices_element, &s);
	for (double below = s.slice[0]; k < SLICES - 1 && below <= LOWEST * s.all; below += s.slice[k])
		k++;
	return (double)k / SLICES;
}

struct bounds {
	double square, low, high;
};

static void bounds_element(void *ctx, const double (*corners)[3], uint32_t n)
{
	struct bounds *b = ctx;
	for (uint32_t c = 0; c < n; c++) {
		b->square = fmax(b->square, corners[c][0] * corners[c][0] + corners[c][1] * corners[c][1]);
		b->low = fmin(b->low, corners[c][2]);
		b->high = fmax(b->high, corners[c][2]);
	}
}

void make_body(struct make_plant *plant)
{
	struct bounds b = { 0 };
	double wide = 0;
	each_element(plant, false, bounds_element, &b);
	for (uint32_t i = 0; i < plant->built.list_count; i++)
		wide = fmax(wide,
			fmax(plant->built.lists[i].list.grid_step[0],
				plant->built.lists[i].list.grid_step[2]));
	plant->reach = sqrt(b.square) + wide;
	plant->low = b.low - wide;
	plant->high = b.high + wide;
	plant->crown = crown_radius(plant);
	plant->base = crown_base(plant);
}
