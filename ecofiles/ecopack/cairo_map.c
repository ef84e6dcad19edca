/* ecocairo.so: the map's picture with its surroundings: grid, legend, bar and arrow. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "ecofiles/base/module.h"
#include "ecofiles/base/text.h"
#include "ecofiles/ecopack/cairo_map.h"
#include "ecofiles/import/land/drawing.h"

#define SIDE_MAX 16384.0
#define MARGIN 20.0
#define LEFT 62.0                /* room for texts beside and below the map */
#define BELOW 40.0
#define TITLE 58.0
#define LEGEND 380.0
#define LINE 19.0
#define LINES_MOST 60u

static const struct color gray = { 0.42, 0.42, 0.42, 1 }, pale = { 0.3, 0.3, 0.3, 0.16 };

/* ---- Numbers ---- */

/* The greatest of 1, 2 or 5 times a power of ten that is not above `value` (> 0). */
static double round_below(double value)
{
	double power = pow(10, floor(log10(value))), digit = value / power * (1 + 1e-12);
	return (digit >= 10 ? 10 : digit >= 5 ? 5 : digit >= 2 ? 2 : 1) * power;
}

struct ticks ticks_between(double low, double high, uint32_t most)
{
	double extent = high - low;
	if (!(extent > 0) || !isfinite(extent))
		return (struct ticks){ low, 1, 1 };
	/* from a step that is too small, up through 1, 2, 5, 10 */
	for (double step = round_below(extent / most);; step = round_below(2.6 * step)) {
		double first = ceil(low / step - 1e-9) * step,
		       count = floor((high - first) / step + 1e-9) + 1;
		if (count <= most)
			return (struct ticks){ first + 0.0, step, count > 0 ? (uint32_t)count : 0 };
	}
}

/* "250 m", "2 km", "5 cm" */
static const char *length_text(double metres, char text[32])
{
	static const struct { double metres; const char *name; } units[] =
		{ { 1000, "km" }, { 1, "m" }, { 0.01, "cm" }, { 0.001, "mm" } };
	size_t u = 0;
	while (u < 3 && metres < units[u].metres * 0.9999)
		u++;
	snprintf(text, 32, "%.3g %s", metres / units[u].metres, units[u].name);
	return text;
}

/* ---- The grid ---- */

/* One line of the grid, its tick and its coordinate, with the fewest digits that tell the lines apart. */
static void draw_line(const struct map *m, cairo_t *canvas, int axis, double value, double step)
{
	struct style style = { .size = 11, .color = gray, .align = ALIGN_CENTER, .turn = axis };
	double at = value - m->sources.items[0].origin[axis], x = map_x(m, at), y = map_y(m, at),
		right = m->x + m->width, bottom = m->y + m->height;
	const double across[2][4] = { { x, m->y, x, bottom }, { m->x, y, right, y } },
		tick[2][4] = { { x, bottom, x, bottom + 5 }, { m->x - 5, y, m->x, y } };
	int digits = 0;
	char text[32];
	for (double s = step; s < 0.999 && digits < 6; s *= 10)
		digits++;
	snprintf(text, sizeof text, "%.*f", digits, value + 0.0);
	canvas_lines(canvas, across[axis], 1, 1, pale);
	canvas_lines(canvas, tick[axis], 1, 1, gray);
	canvas_text(canvas, axis ? m->x - 9 : x, axis ? y : bottom + 18, &style, text);
}

static void draw_grid(const struct map *m, cairo_t *canvas)
{
	const double *origin = m->sources.items[0].origin;
	for (int k = 0; k < 2; k++) {
		struct ticks ticks = ticks_between(m->view.low[k] + origin[k], m->view.high[k] + origin[k],
			(uint32_t)fmax((k ? m->height : m->width) / 130, 2));
		for (uint32_t i = 0; i < ticks.count; i++)
			draw_line(m, canvas, k, ticks.first + i * ticks.step, ticks.step);
	}
}

/* ---- The legend, written from a cursor that moves down ---- */

struct legend { const struct map *m; cairo_t *canvas; double x, y; };

static const struct style plain = { .size = 12, .color = { 0.42, 0.42, 0.42, 1 }, .room = LEGEND },
	warning = { .size = 12, .color = { 0.63, 0.19, 0.13, 1 }, .room = LEGEND };

static void write_line(struct legend *l, const struct style *style, const char *text)
{
	canvas_text(l->canvas, l->x, l->y, style, text);
	l->y += LINE;
}

static void write_paragraph(struct legend *l, const struct style *style, const char *text)
{
	l->y = canvas_paragraph(l->canvas, l->x, l->y, 16, style, text) + 3;
}

static void write_heading(struct legend *l, const char *text)
{
	l->y += 10;
	write_line(l, &(struct style){ .size = 14, .bold = true }, text);
}

static void write_kind(struct legend *l, const struct map_kind *kind, const char *name)
{
	struct style style = { .size = 13, .room = LEGEND - 190 },
		     right = { .size = 13, .align = ALIGN_RIGHT }, small = { .size = 11, .color = gray };
	char text[32];
	double radius = fmin(fmax(land_radius(l->m, (kind->low_m + kind->high_m) / 2), 3), 8);
	canvas_disc(l->canvas, l->x + 8, l->y - 4.5, radius, l->m->tints.class_count ? class_color(l->m, 0) : kind_colors[kind->color]);
	canvas_text(l->canvas, l->x + 22, l->y, &style, name);
	canvas_text(l->canvas, l->x + LEGEND - 90, l->y, &right, eco_phrase_count(kind->count, text));
	canvas_text(l->canvas, l->x + LEGEND - 82, l->y, &small, map_range_text(kind, text));
	l->y += LINE;
}

static void write_others(struct legend *l)
{
	const struct map *m = l->m;
	struct map_kind others = { .low_m = INFINITY, .high_m = -INFINITY, .color = MAP_COLORS };
	for (uint32_t i = 0; i < m->kind_count; i++) {
		const struct map_kind *kind = &m->kinds[i];
		if (!kind->count || kind->color < MAP_COLORS)
			continue;
		others.count += kind->count;
		others.low_m = fmin(others.low_m, kind->low_m);
		others.high_m = fmax(others.high_m, kind->high_m);
		memcpy(others.name, kind->name, sizeof others.name);
	}
	if (m->other_count > 1)
		snprintf(others.name, sizeof others.name, "%u other kinds", m->other_count);
	if (m->other_count)
		write_kind(l, &others, others.name);
}

/* Lists kinds without a plant: nothing refers to them, or only rows that are missing. */
static void write_unused(struct legend *l)
{
	const struct map *m = l->m;
	char text[300] = "";
	size_t used = 0;
	uint32_t unused = 0;
	for (uint32_t i = 0; i < m->kind_count; i++)
		if (!m->kinds[i].count && unused++ < 5)
			used += (size_t)snprintf(text + used, sizeof text - used, "%s%.40s",
				used ? ", " : "nowhere: ", m->kinds[i].name);
	if (unused > 5)
		snprintf(text + used, sizeof text - used, " and %u more", unused - 5);
	if (unused)
		write_paragraph(l, &warning, text);
}

static void write_kinds(struct legend *l)
{
	const struct map *m = l->m;
	for (uint32_t color = 0; color < MAP_COLORS; color++)
		for (uint32_t i = 0; i < m->kind_count; i++)
			if (m->kinds[i].count && m->kinds[i].color == color)
				write_kind(l, &m->kinds[i], m->kinds[i].name);
	write_others(l);
	write_unused(l);
}

/* Classes of tints, which the points are coloured by. */
static void write_classes(struct legend *l)
{
	const struct eco_tints *tints = &l->m->tints;
	struct style style = { .size = 13, .room = LEGEND - 190 }, right = { .size = 13, .align = ALIGN_RIGHT };
	char text[32];
	for (uint32_t i = 0; i < tints->class_count; i++) {
		const struct eco_tint_legend *class = &tints->classes[i];
		if (i == 0 || strcmp(class->column, tints->classes[i - 1].column) != 0)
			write_heading(l, class->column);
		canvas_disc(l->canvas, l->x + 8, l->y - 4.5, 6, class_color(l->m, i + 1));
		canvas_text(l->canvas, l->x + 22, l->y, &style, class->name);
		canvas_text(l->canvas, l->x + LEGEND - 90, l->y, &right, eco_phrase_count(class->plants, text));
		l->y += LINE;
	}
}

static void write_edges(struct legend *l, const struct map_edges *edges, struct color color, const char *says)
{
	if (!edges->count)
		return;
	canvas_lines(l->canvas, (const double[4]){ l->x, l->y - 4, l->x + 16, l->y - 4 }, 1, 1.6, color);
	canvas_text(l->canvas, l->x + 22, l->y, &plain, says);
	l->y += LINE;
}

/* The lines of the report, below what the marks of rows without a plant say. */
static void write_lines(struct legend *l)
{
	const struct map *m = l->m;
	char text[64];
	if (m->line_count)
		write_heading(l, "Read, and left out");
	if (m->left_points.count) {
		canvas_disc(l->canvas, l->x + 8, l->y - 4.5, LEFT_PX, LEFT_COLOR);
		canvas_text(l->canvas, l->x + 22, l->y, &plain, "where rows without a plant are");
		l->y += LINE;
	}
	for (uint32_t i = 0; i < m->line_count && i < LINES_MOST; i++)
		write_paragraph(l, &plain, m->lines[i].text + strspn(m->lines[i].text, " "));
	if (m->line_count > LINES_MOST) {
		snprintf(text, sizeof text, "... and %u more lines", m->line_count - LINES_MOST);
		write_line(l, &plain, text);
	}
}

/* Writes notes for a careful reader. */
static void write_notes(struct legend *l)
{
	const struct map *m = l->m;
	char text[200], count[32];
	const struct { uint64_t count; const char *says; } notes[] =
		{ { m->outside, "stand outside this picture, far from the rest" },
		{ m->off_ground, "stand beyond the ground's border" },
		{ m->not_expanded, "in nested files, shown as outlines only" } };
	for (size_t i = 0; i < sizeof notes / sizeof *notes; i++) {
		snprintf(text, sizeof text, "%s plant%s %s", eco_phrase_count(notes[i].count, count),
			notes[i].count == 1 ? "" : "s", notes[i].says);
		if (notes[i].count)
			write_paragraph(l, &warning, text);
	}
}

static void write_place(struct legend *l)
{
	const struct map *m = l->m;
	const struct eco_source *s = &m->sources.items[0];
	char text[300], count[32];
	write_heading(l, "Where");
	snprintf(text, sizeof text, "CRS: %.200s", s->crs ? s->crs : "none, plain metres");
	write_paragraph(l, &plain, text);
	snprintf(text, sizeof text, "origin of the scene: %.10g, %.10g, %.10g", s->origin[0], s->origin[1],
		s->origin[2]);
	write_line(l, &plain, text);
	if (m->has_ground && m->high_m >= m->low_m) {
		snprintf(text, sizeof text, "ground: %.1f to %.1f m", m->low_m + s->origin[2], m->high_m + s->origin[2]);
		write_line(l, &plain, text);
	}
	if (m->placements) {
		snprintf(text, sizeof text, "%u nested file%s, placed %s time%s", m->sources.count - 1,
			m->sources.count == 2 ? "" : "s", eco_phrase_count(m->placements, count),
			m->placements == 1 ? "" : "s");
		write_line(l, &plain, text);
	}
}

static void draw_bar_and_arrow(struct legend *l)
{
	struct style style = { .size = 12 }, north = { .size = 13, .bold = true, .align = ALIGN_CENTER };
	double length = round_below(200 / l->m->scale), wide = length * l->m->scale, x = l->x, y = l->y + 34;
	char text[32];
	for (int i = 0; i < 4; i++)
		canvas_box(l->canvas, x + i * wide / 4, y - 6, wide / 4, 6, i % 2 ? COLOR(0xffffff)
			: COLOR(0x303030));
	canvas_frame(l->canvas, x, y - 6, wide, 6, 1, COLOR(0x303030));
	canvas_text(l->canvas, x + wide + 8, y, &style, length_text(length, text));
	x = l->x + LEGEND - 60;
	const double arrow[] = { x, y - 30, x + 8, y, x, y - 6, x - 8, y };
	canvas_outline(l->canvas, arrow, 4, 0, COLOR(0), COLOR(0x303030));
	canvas_text(l->canvas, x, y + 15, &north, l->m->sources.items[0].crs ? "N" : "Y");
	l->y += 62;
}

/* Returns the y at its end. On a canvas of one pixel it only measures. */
static double draw_legend(const struct map *m, cairo_t *canvas, double x, double y)
{
	struct legend l = { m, canvas, x, y };
	char heading[80], count[32];
	uint32_t kinds = 0;
	for (uint32_t i = 0; i < m->kind_count; i++)
		kinds += m->kinds[i].count > 0;
	draw_bar_and_arrow(&l);
	snprintf(heading, sizeof heading, "%s plant%s of %u kind%s", eco_phrase_count(m->total, count),
		m->total == 1 ? "" : "s", kinds, kinds == 1 ? "" : "s");
	write_heading(&l, heading);
	write_kinds(&l);
	write_classes(&l);
	if (m->points.count)
		write_line(&l, &plain, m->typical_m > 0 ? "Dots are larger the taller the plant is."
			: "Heights are those of the models: not known here.");
	write_edges(&l, &m->areas, AREAS_COLOR, "areas of scattered plants");
	write_edges(&l, &m->clear_of, CLEAR_COLOR, "what they keep clear of");
	write_notes(&l);
	write_lines(&l);
	write_place(&l);
	return l.y;
}

/* ---- The picture ---- */

static void draw(struct map *m, cairo_t *canvas)
{
	canvas_box(canvas, m->x, m->y, m->width, m->height, COLOR(0xf4f4f2));
	land_ground(m, canvas);
	draw_grid(m, canvas);
	cairo_save(canvas);
	cairo_rectangle(canvas, m->x, m->y, m->width, m->height);
	cairo_clip(canvas);
	land_plants(m, canvas);
	cairo_restore(canvas);
	canvas_frame(canvas, m->x, m->y, m->width, m->height, 1.2, COLOR(0x505050));
	canvas_text(canvas, m->x, TITLE - 20, &(struct style){ .size = 24, .bold = true },
		m->sources.items[0].name);
	draw_legend(m, canvas, m->x + m->width + MARGIN, TITLE);
}

static enum eco_code map_png(struct map *m, uint8_t **png, size_t *size)
{
	cairo_t *small = canvas_new(1, 1);
	m->x = MARGIN + LEFT;
	m->y = TITLE;
	/* measured with room to spare: some lines are known only after drawing */
	double legend = draw_legend(m, small, 0, 0) + TITLE + 4 * LINE;
	cairo_t *canvas = canvas_new((uint32_t)(m->x + m->width + MARGIN + LEGEND + MARGIN),
		(uint32_t)fmin(fmax(TITLE + m->height + BELOW, legend) + MARGIN, SIDE_MAX));
	draw(m, canvas);
	enum eco_code code = canvas_png(canvas, png, size, m->error);
	cairo_destroy(small);
	cairo_destroy(canvas);
	return code;
}

extern const struct eco_cairo_module eco_cairo_module;
ECO_MODULE_EXPORT const struct eco_cairo_module eco_cairo_module = { .version = ECO_MODULE_VERSION,
	.map_png = map_png, .drawing_paint = cairo_drawing_paint };
