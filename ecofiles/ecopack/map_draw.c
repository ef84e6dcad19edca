/* Plants from above. With room, each is a dot, larger the taller it is. Where dots would only hide each
 * other, the map shows density: a pixel has the mean colour of its plants, the fuller the more there are.
 * Dots are drawn tall ones first, so that the small ones stay visible. */
#include "ecofiles/ecopack/map.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/ecopack/progress.h"

#define BLOCK 8u                 /* side, in pixels, of the blocks that measure density */
#define DENSE 0.25               /* plants a pixel, in blocks with any plant: above, density is shown */
#define STRAY_SHARE 0.002        /* this share at each end may lie off the picture ... */
#define STRAY_FACTOR 5.0         /* ... if the picture can then be this much larger */
#define NAMED_MOST 12u           /* most outlines with a name */
#define RADIUS_LEAST 0.9
#define RADIUS_MOST 7.0

/* ---- The picture's view ---- */

static int by_double(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;
	return x < y ? -1 : x > y;
}

/* Bounds without the outermost plants, where that changes much: one place without its latitude must not
 * shrink a city to a dot. */
static enum eco_code leave_strays(struct map *m, struct map_bounds *b)
{
	uint64_t stride = m->points.count / 200000 + 1, count = (m->points.count + stride - 1) / stride;
	double *sorted = malloc((count + 1) * sizeof *sorted);
	struct map_bounds core = *b;
	if (!sorted)
		return map_no_memory(m);
	for (int k = 0; k < 2; k++) {
		for (uint64_t i = 0; i < count; i++)
			sorted[i] =
				(double)(k ? m->points.items[i * stride].y : m->points.items[i * stride].x);
		qsort(sorted, count, sizeof *sorted, by_double);
		uint64_t few = (uint64_t)(STRAY_SHARE * (double)count + 0.999);
		if (count < 20)
			few = 0;
		core.low[k] = sorted[few];
		core.high[k] = sorted[count - 1 - few];
		double spare = 0.2 * (core.high[k] - core.low[k]);
		core.low[k] = fmax(core.low[k] - spare, b->low[k]);
		core.high[k] = fmin(core.high[k] + spare, b->high[k]);
	}
	free(sorted);
	double whole = fmax(b->high[0] - b->low[0], b->high[1] - b->low[1]),
		inner = fmax(core.high[0] - core.low[0], core.high[1] - core.low[1]);
	if (inner > 0 && whole > STRAY_FACTOR * inner)
		*b = core;
	return ECO_OK;
}

static enum eco_code find_bounds(struct map *m, struct map_bounds *b)
{
	*b = MAP_NOTHING;
	for (uint64_t i = 0; i < m->points.count; i++)
		map_extend(b, (double)m->points.items[i].x, (double)m->points.items[i].y);
	enum eco_code code = m->points.count ? leave_strays(m, b) : ECO_OK;
	for (uint32_t i = 0; i < m->outline_count; i++)
		for (int k = 0; k < 4; k++)
			map_extend(b, m->outlines[i].corners[2 * k], m->outlines[i].corners[2 * k + 1]);
	for (uint32_t i = 0; i < 2 * m->areas.count; i++)
		map_extend(b, m->areas.ends[2 * (size_t)i], m->areas.ends[2 * (size_t)i + 1]);
	if (m->has_ground && map_is_empty(b)) {
		const struct eco_ground *g = &m->ground;
		map_extend(b, g->x_m, g->y_m);
		map_extend(b, g->x_m + (g->columns - 1) * g->step_x_m, g->y_m + (g->rows - 1) * g->step_y_m);
	}
	return code;
}

enum eco_code map_frame(struct map *m, uint32_t pixels)
{
	struct map_bounds b;
	enum eco_code code = find_bounds(m, &b);
	if (code)
		return code;
	if (map_is_empty(&b))
		return eco_fail(m->error, ECO_BAD_INPUT, "%s: there is nothing to show: no plant has a "
			"usable place (what was left out: see \"instances\")", m->sources.items[0].path);
	double side = fmax(fmax(b.high[0] - b.low[0], b.high[1] - b.low[1]), 1), spare = 0.03 * side;
	for (int k = 0; k < 2; k++) {            /* neither side is less than a third of the other */
		double middle = (b.low[k] + b.high[k]) / 2, half = fmax((b.high[k] - b.low[k]) / 2, side / 6)
			+ spare;
		m->view.low[k] = middle - half;
		m->view.high[k] = middle + half;
	}
	m->scale = pixels / (side + 2 * spare);
	m->width = floor((m->view.high[0] - m->view.low[0]) * m->scale);
	m->height = floor((m->view.high[1] - m->view.low[1]) * m->scale);
	return ECO_OK;
}

/* ---- Colours ---- */

static struct eco_color color_of(const struct map *m, uint32_t kind)
{
	uint32_t color = m->kinds[kind].color;
	return color < ECO_CHART_COLORS ? eco_chart_colors[color] : eco_chart_other;
}

/* ---- Density ---- */

static bool pixel_of(const struct map *m, const struct map_point *p, uint32_t *x, uint32_t *y)
{
	double px = ((double)p->x - m->view.low[0]) * m->scale,
		py = (m->view.high[1] - (double)p->y) * m->scale;
	if (!(px >= 0 && py >= 0 && px < m->width && py < m->height))
		return false;
	*x = (uint32_t)px;
	*y = (uint32_t)py;
	return true;
}

/* Plants a pixel, over the blocks with any plant. */
static enum eco_code look_at_density(struct map *m, double *density)
{
	uint32_t columns = (uint32_t)m->width / BLOCK + 1, rows = (uint32_t)m->height / BLOCK + 1;
	uint8_t *any = calloc(columns, rows);
	uint64_t shown = 0, blocks = 0;
	if (!any)
		return map_no_memory(m);
	m->outside = 0;
	for (uint64_t i = 0; i < m->points.count; i++) {
		uint32_t x, y;
		if (pixel_of(m, &m->points.items[i], &x, &y)) {
			any[(size_t)(y / BLOCK) * columns + x / BLOCK] = 1;
			shown++;
		} else
			m->outside++;
	}
	for (size_t i = 0; i < (size_t)columns * rows; i++)
		blocks += any[i];
	free(any);
	*density = blocks ? (double)shown / ((double)blocks * BLOCK * BLOCK) : 0;
	return ECO_OK;
}

struct tally { float count, rgb[3]; };

/* The density that only one in two hundred pixels with plants exceeds: a few heaps must not make the rest
 * pale. */
static double dense_end(const struct tally *tally, size_t pixels)
{
	static const uint32_t most = 4096;
	uint64_t *counts = calloc(most + 1, sizeof *counts), occupied = 0, above = 0;
	uint32_t end = most;
	for (size_t i = 0; counts && i < pixels; i++)
		if (tally[i].count > 0) {
			counts[tally[i].count < (float)most ? (uint32_t)tally[i].count : most]++;
			occupied++;
		}
	while (counts && end > 1 && (above += counts[end]) <= occupied / 200)
		end--;
	free(counts);
	return end;
}

static enum eco_code draw_density(struct map *m)
{
	uint32_t width = (uint32_t)m->width, height = (uint32_t)m->height;
	struct tally *tally = calloc((size_t)width * height, sizeof *tally);
	uint8_t *rgba = calloc((size_t)width * height, 4);
	for (uint64_t i = 0; i < m->points.count && tally && rgba; i++) {
		uint32_t x, y;
		if (!pixel_of(m, &m->points.items[i], &x, &y))
			continue;
		struct tally *t = &tally[(size_t)y * width + x];
		struct eco_color c = color_of(m, m->points.items[i].kind);
		t->count++;
		t->rgb[0] += (float)c.r, t->rgb[1] += (float)c.g, t->rgb[2] += (float)c.b;
	}
	if (tally)
		m->densest = dense_end(tally, (size_t)width * height);
	for (size_t i = 0; i < (size_t)width * height && tally && rgba; i++) {
		if (!(tally[i].count > 0))
			continue;
		for (int k = 0; k < 3; k++)
			rgba[4 * i + (size_t)k] = (uint8_t)(255 * tally[i].rgb[k] / tally[i].count + 0.5f);
		rgba[4 * i + 3] =
			(uint8_t)(255
			* (0.35 + 0.65 * fmin(log(1 + (double)tally[i].count) / log(1 + m->densest), 1)));
	}
	if (tally && rgba)
		eco_chart_pixels(m->chart, m->x, m->y, width, height, rgba, true);
	bool good = tally && rgba;
	free(tally);
	free(rgba);
	return good ? ECO_OK : map_no_memory(m);
}

/* ---- Dots ---- */

static int by_height(const void *a, const void *b)
{
	const struct map_point *x = a, *y = b;
	if (x->height_m != y->height_m)
		return x->height_m > y->height_m ? -1 : 1;
	if (x->kind != y->kind)
		return x->kind < y->kind ? -1 : 1;
	if (x->x != y->x)
		return x->x < y->x ? -1 : 1;
	return x->y < y->y ? -1 : x->y > y->y;
}

double map_radius(const struct map *m, double height_m)
{
	double ratio = height_m > 0 && m->typical_m > 0 ? sqrt(height_m / m->typical_m) : 1;
	return fmin(fmax(m->dot * fmin(fmax(ratio, 0.5), 2.2), RADIUS_LEAST), 2 * RADIUS_MOST);
}

static void draw_dots(struct map *m)
{
	qsort(m->points.items, m->points.count, sizeof *m->points.items, by_height);
	for (uint64_t i = 0; i < m->points.count; i++) {
		const struct map_point *p = &m->points.items[i];
		double x = map_x(m, (double)p->x), y = map_y(m, (double)p->y),
			radius = map_radius(m, (double)p->height_m);
		if (radius >= 2)
			eco_chart_disc(m->chart, x, y, radius + 0.7, (struct eco_color){ 1, 1, 1, 0.75 });
		eco_chart_disc(m->chart, x, y, radius, color_of(m, p->kind));
	}
}

/* ---- All ---- */

static void draw_outlines(struct map *m)
{
	struct eco_chart_style style = { .size = 11, .align = ECO_CHART_CENTER, .halo = { 1, 1, 1, 0.8 } };
	for (uint32_t i = 0; i < m->outline_count; i++) {
		double points[8], x = 0, y = 0;
		for (int k = 0; k < 4; k++) {
			x += points[2 * k] = map_x(m, m->outlines[i].corners[2 * k]);
			y += points[2 * k + 1] = map_y(m, m->outlines[i].corners[2 * k + 1]);
		}
		eco_chart_path(m->chart, &(struct eco_chart_path){ .points = points, .count = 4,
			.closed = true, .line = 1, .color = ECO_COLOR(0x707070),
			.fill = { 0.5, 0.5, 0.5, m->not_expanded ? 0.15 : 0 } });
		if (m->outline_count <= NAMED_MOST)
			eco_chart_text(m->chart, x / 4, y / 4, &style, m->outlines[i].name);
	}
}

static enum eco_code draw_edges(struct map *m, const struct map_edges *edges, double line,
	struct eco_color color)
{
	double *ends = malloc(4 * (size_t)edges->count * sizeof *ends + 1);
	if (!ends)
		return map_no_memory(m);
	for (size_t i = 0; i < 2 * (size_t)edges->count; i++) {
		ends[2 * i] = map_x(m, edges->ends[2 * i]);
		ends[2 * i + 1] = map_y(m, edges->ends[2 * i + 1]);
	}
	eco_chart_lines(m->chart, ends, edges->count, line, color);
	free(ends);
	return ECO_OK;
}

enum eco_code map_draw_places(struct map *m)
{
	double density = 0;
	if (!main_progress("drawing", "plants", 0.5))
		return eco_fail(m->error, ECO_INTERRUPTED, "interrupted");
	enum eco_code code = look_at_density(m, &density);
	m->is_density = density > DENSE;
	m->dot = density > 0 ? fmin(fmax(0.34 / sqrt(density), RADIUS_LEAST), RADIUS_MOST) : RADIUS_MOST;
	if (!code && m->is_density)
		code = draw_density(m);
	else if (!code)
		draw_dots(m);
	if (!code)
		code = draw_edges(m, &m->clear_of, 2, (struct eco_color){ 0.75, 0.2, 0.1, 0.55 });
	if (!code)
		code = draw_edges(m, &m->areas, 1.2, (struct eco_color){ 0.1, 0.25, 0.5, 0.8 });
	if (!code)
		draw_outlines(m);
	return code;
}
