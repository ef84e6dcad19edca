/* The ground from above: lit from the north-west, as is usual on maps, and pale, so that plants stand out.
 * Contour lines, by marching over triangles of cells of a few pixels, are drawn over the plants, which
 * would hide the shape of the land. */
#include "ecofiles/ecopack/map.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/ecopack/progress.h"
#include "ecofiles/base/array_grow.h"

#define CELL 3u                  /* pixels between samples of contour lines */
#define LINES_WANTED 14u
#define RELIEF 1.4               /* exaggeration of slopes */
#define FLAT 0.93                /* brightness of level ground */
#define PALE 0.6                 /* of the image's contrast is kept */

struct grid { double *z; uint32_t columns, rows; };      /* NaN beyond the ground's border */

static double height_at(const struct map *m, double px, double py)
{
	double x = m->view.low[0] + px / m->scale, y = m->view.high[1] - py / m->scale, z;
	return eco_ground_height(&m->ground, x, y, &z) ? z : NAN;
}

static bool sample(const struct map *m, struct grid *grid, double pixels)
{
	grid->columns = (uint32_t)ceil(m->width / pixels) + 1;
	grid->rows = (uint32_t)ceil(m->height / pixels) + 1;
	grid->z = malloc((size_t)grid->columns * grid->rows * sizeof *grid->z);
	for (uint32_t r = 0; grid->z && r < grid->rows; r++)
		for (uint32_t c = 0; c < grid->columns; c++)
			grid->z[(size_t)r * grid->columns + c] = height_at(m, c * pixels, r * pixels);
	return grid->z;
}

/* ---- Hillshade ---- */

static uint8_t brightness(double east, double north)
{
	/* sun in the north-west, 45 degrees high */
	double sun = (RELIEF * (east - north) * 0.5 + 0.7071067811865476)
		/ sqrt(1 + RELIEF * RELIEF * (east * east + north * north));
	double bright = FLAT + 0.55 * (sun - 0.7071067811865476);
	return (uint8_t)(255 * fmin(fmax(bright, 0.45), 1) + 0.5);
}

/* A pixel of the image, pale, in the ground's light, over what is there. */
static void lay_image(const uint8_t image[4], double light, uint8_t to[4])
{
	double alpha = image[3] / 255.0;
	for (int k = 0; k < 3; k++) {
		double pale = fmin(255, light * (255 - PALE * (255 - image[k])));
		to[k] = (uint8_t)(alpha * pale + (1 - alpha) * (to[3] ? to[k] : pale) + 0.5);
	}
	to[3] = image[3] > to[3] ? image[3] : to[3];
}

static enum eco_code draw_shade(struct map *m, const uint8_t *image)
{
	struct grid grid = { .z = NULL };
	uint32_t width = (uint32_t)m->width, height = (uint32_t)m->height;
	uint8_t *rgba = calloc((size_t)width * height, 4);
	if ((m->has_ground && !sample(m, &grid, 1)) || !rgba) {
		free(grid.z);
		free(rgba);
		return eco_fail(m->error, ECO_NO_MEMORY, "no memory for the ground's picture");
	}
	for (uint32_t y = 0; y < height; y++)
		for (uint32_t x = 0; x < width; x++) {
			const double *z = grid.z ? grid.z + (size_t)y * grid.columns + x : NULL;
			double east = z ? (z[1] - z[0]) * m->scale : NAN,
				north = z ? (z[0] - z[grid.columns]) * m->scale : NAN, light = 1;
			size_t at = 4 * ((size_t)y * width + x);
			if (!isnan(east + north)) {
				uint8_t v = brightness(east, north);
				memcpy(rgba + at, (uint8_t[4]){ v, v, (uint8_t)(v * 0.965), 255 }, 4);
				light = v / (255 * FLAT);
			}
			if (image && image[at + 3])
				lay_image(image + at, light, rgba + at);
		}
	eco_chart_pixels(m->chart, m->x, m->y, width, height, rgba, true);
	free(grid.z);
	free(rgba);
	return ECO_OK;
}

/* ---- Contour lines ---- */

struct lines { double *ends; uint32_t count, capacity; };

static bool add_line(struct lines *lines, const double ends[4])
{
	if (!eco_array_grow(&lines->ends, &lines->capacity, lines->count, 4 * sizeof *lines->ends))
		return false;
	for (int k = 0; k < 4; k++)
		lines->ends[4 * (size_t)lines->count + (size_t)k] = ends[k];
	lines->count++;
	return true;
}

/* The points where a level crosses one triangle's sides: two points or none. A corner at the level counts
 * as above. */
static bool cross_triangle(const double x[3], const double y[3], const double z[3], double level,
	double ends[4])
{
	int found = 0;
	for (int i = 0; i < 3 && found < 2; i++) {
		int j = (i + 1) % 3;
		if ((z[i] >= level) == (z[j] >= level))
			continue;
		double t = (level - z[i]) / (z[j] - z[i]);
		ends[2 * found] = x[i] + t * (x[j] - x[i]);
		ends[2 * found + 1] = y[i] + t * (y[j] - y[i]);
		found++;
	}
	return found == 2;
}

static bool cross_cell(const struct map *m, const struct grid *grid, uint32_t c, uint32_t r,
	struct lines kinds[2])
{
	static const uint32_t corner[2][3][2] = { { { 0, 0 }, { 1, 0 }, { 1, 1 } },
		{ { 0, 0 }, { 1, 1 }, { 0, 1 } } };
	for (int half = 0; half < 2; half++) {
		double x[3], y[3], z[3], ends[4];
		for (int i = 0; i < 3; i++) {
			uint32_t column = c + corner[half][i][0], row = r + corner[half][i][1];
			x[i] = m->x + (double)CELL * column;
			y[i] = m->y + (double)CELL * row;
			z[i] = grid->z[(size_t)row * grid->columns + column];
		}
		double low = fmin(fmin(z[0], z[1]), z[2]), high = fmax(fmax(z[0], z[1]), z[2]);
		if (isnan(z[0] + z[1] + z[2]))
			continue;
		for (double n = ceil(low / m->contour_m); n * m->contour_m <= high; n++)
			if (cross_triangle(x, y, z, n * m->contour_m, ends)
					&& !add_line(&kinds[fmod(n, 5) == 0], ends))
				return false;
	}
	return true;
}

/* Labels the first thick lines along the middle of the map, not too close to each other. */
static void name_lines(struct map *m, const struct grid *grid, double base)
{
	struct eco_chart_style style = { .size = 11, .align = ECO_CHART_CENTER, .color = ECO_COLOR(0x5c4524),
		.halo = { 0.97, 0.97, 0.94, 0.9 } };
	uint32_t middle = grid->columns / 2;
	double step = 5 * m->contour_m, last = -1e9;
	for (uint32_t r = 1; r + 1 < grid->rows; r++) {
		double a = grid->z[(size_t)(r - 1) * grid->columns + middle],
			b = grid->z[(size_t)r * grid->columns + middle];
		double level = floor(fmax(a, b) / step) * step, y = m->y + CELL * (double)r;
		if (isnan(a + b) || level < fmin(a, b) || y - last < 60 || y < m->y + 20)
			continue;
		char text[32];
		snprintf(text, sizeof text, "%.6g", level + base + 0.0);
		eco_chart_text(m->chart, m->x + CELL * (double)middle, y + 4, &style, text);
		last = y;
	}
}

static enum eco_code draw_contours(struct map *m)
{
	struct grid grid;
	struct lines kinds[2] = { { 0 } };
	bool good = sample(m, &grid, CELL);
	m->low_m = INFINITY, m->high_m = -INFINITY;
	for (size_t i = 0; good && i < (size_t)grid.columns * grid.rows; i++)
		if (!isnan(grid.z[i])) {
			m->low_m = fmin(m->low_m, grid.z[i]);
			m->high_m = fmax(m->high_m, grid.z[i]);
		}
	m->contour_m = m->high_m > m->low_m ? eco_chart_ticks(m->low_m, m->high_m, LINES_WANTED).step : 0;
	for (uint32_t r = 0; r + 1 < grid.rows && good && m->contour_m > 0; r++)
		for (uint32_t c = 0; c + 1 < grid.columns && good; c++)
			good = cross_cell(m, &grid, c, r, kinds);
	if (good) {
		eco_chart_lines(m->chart, kinds[0].ends, kinds[0].count, 0.8,
			(struct eco_color){ 0.36, 0.27, 0.14, 0.55 });
		eco_chart_lines(m->chart, kinds[1].ends, kinds[1].count, 1.5,
			(struct eco_color){ 0.36, 0.27, 0.14, 0.65 });
		if (m->contour_m > 0)
			name_lines(m, &grid, m->sources.items[0].origin[2]);
	}
	free(grid.z);
	free(kinds[0].ends);
	free(kinds[1].ends);
	return good ? ECO_OK : eco_fail(m->error, ECO_NO_MEMORY, "no memory for contour lines");
}

enum eco_code map_draw_ground(struct map *m)
{
	uint8_t *image;
	enum eco_code code = map_read_image(m, &image);
	if (code || (!m->has_ground && !image))
		return code;
	code = main_progress("drawing", "ground", 0.2) ? draw_shade(m, image)
		: eco_fail(m->error, ECO_INTERRUPTED, "interrupted");
	free(image);
	return code;
}

enum eco_code map_draw_contours(struct map *m)
{
	return m->has_ground ? draw_contours(m) : ECO_OK;
}
