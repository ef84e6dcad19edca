/* ecopack map: shows where everything stands, before hours are spent on building. Reads a scene's
 * inventories as `ecopack make` does, so that a wrong column, zone or species map is seen at once, and so
 * are the rows left out. */
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "ecofiles/base/file_write.h"
#include "ecofiles/ecopack/command.h"
#include "ecofiles/ecopack/map.h"
#include "ecofiles/ecopack/progress.h"
#include "ecofiles/base/phrase.h"
#include "ecofiles/import/places/gis_files.h"

#define MARGIN 20.0
#define LEFT 62.0                /* room for texts beside and below the map */
#define BELOW 40.0
#define TITLE 58.0
#define LEGEND 380.0
#define LINE 19.0
#define LEFT_OUT_LINES 60u

static const struct eco_color gray = { 0.42, 0.42, 0.42, 1 }, pale = { 0.3, 0.3, 0.3, 0.16 },
	red = { 0.63, 0.19, 0.13, 1 };

/* ---- The grid ---- */

/* The fewest digits that tell the lines apart. */
static const char *coordinate_text(double value, double step, char text[32])
{
	int digits = 0;
	for (double s = step; s < 0.999 && digits < 6; s *= 10)
		digits++;
	snprintf(text, 32, "%.*f", digits, value + 0.0);
	return text;
}

static void draw_grid(struct map *m)
{
	const double *origin = m->sources.items[0].origin;
	struct eco_chart_style style = { .size = 11, .color = gray, .align = ECO_CHART_CENTER };
	char text[32];
	for (int k = 0; k < 2; k++) {
		double low = m->view.low[k] + origin[k], high = m->view.high[k] + origin[k],
			room = k ? m->height : m->width;
		struct eco_chart_ticks ticks = eco_chart_ticks(low, high, (uint32_t)fmax(room / 130, 2));
		for (uint32_t i = 0; i < ticks.count; i++) {
			double value = ticks.first + i * ticks.step;
			coordinate_text(value, ticks.step, text);
			if (k == 0) {
				double x = map_x(m, value - origin[0]);
				eco_chart_line(m->chart, x, m->y, x, m->y + m->height, 1, pale);
				eco_chart_line(m->chart, x, m->y + m->height, x, m->y + m->height + 5, 1,
					gray);
				eco_chart_text(m->chart, x, m->y + m->height + 18, &style, text);
			} else {
				double y = map_y(m, value - origin[1]);
				style.turn = 1;
				eco_chart_line(m->chart, m->x, y, m->x + m->width, y, 1, pale);
				eco_chart_line(m->chart, m->x - 5, y, m->x, y, 1, gray);
				eco_chart_text(m->chart, m->x - 9, y, &style, text);
			}
		}
	}
}

/* ---- The legend, written from a cursor that moves down ---- */

struct legend { struct map *m; double x, y; };

static void write_line(struct legend *l, const struct eco_chart_style *style, const char *text)
{
	eco_chart_text(l->m->chart, l->x, l->y, style, text);
	l->y += LINE;
}

static void write_heading(struct legend *l, const char *text)
{
	l->y += 10;
	write_line(l, &(struct eco_chart_style){ .size = 14, .bold = true }, text);
}

static void write_kind(struct legend *l, struct eco_color color, double height_m, const char *name,
	uint64_t count, const char *range)
{
	struct eco_chart_style style = { .size = 13, .room = LEGEND - 190 },
		right = { .size = 13, .align = ECO_CHART_RIGHT };
	struct eco_chart_style small = { .size = 11, .color = gray };
	char text[32];
	double radius = l->m->is_density ? 6 : fmin(fmax(map_radius(l->m, height_m), 3), 8);
	eco_chart_disc(l->m->chart, l->x + 8, l->y - 4.5, radius, color);
	eco_chart_text(l->m->chart, l->x + 22, l->y, &style, name);
	eco_chart_text(l->m->chart, l->x + LEGEND - 90, l->y, &right, eco_phrase_count(count, text));
	eco_chart_text(l->m->chart, l->x + LEGEND - 82, l->y, &small, range);
	l->y += LINE;
}

static const char *range_text(double low, double high, char text[32])
{
	text[0] = 0;
	if (low < high * 0.995)
		snprintf(text, 32, "%.3g to %.3g m", low, high);
	else if (low <= high)
		snprintf(text, 32, "%.3g m", high);
	return text;
}

static void write_others(struct legend *l)
{
	const struct map *m = l->m;
	struct map_kind others = { .low_m = INFINITY, .high_m = -INFINITY };
	char range[32], name[64];
	for (uint32_t i = 0; i < m->kind_count; i++) {
		const struct map_kind *kind = &m->kinds[i];
		if (!kind->count || kind->color < ECO_CHART_COLORS)
			continue;
		others.count += kind->count;
		others.low_m = fmin(others.low_m, kind->low_m);
		others.high_m = fmax(others.high_m, kind->high_m);
		snprintf(name, sizeof name, "%s", kind->name);
	}
	if (m->other_count > 1)
		snprintf(name, sizeof name, "%u other kinds", m->other_count);
	if (m->other_count)
		write_kind(l, eco_chart_other, (others.low_m + others.high_m) / 2, name, others.count,
			range_text(others.low_m, others.high_m, range));
}

/* Lists kinds without a plant: nothing refers to them, or only rows that are missing. */
static void write_unused(struct legend *l)
{
	const struct map *m = l->m;
	struct eco_chart_style style = { .size = 12, .color = red, .room = LEGEND };
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
		l->y = eco_chart_paragraph(m->chart, l->x, l->y, 16, &style, text) + 3;
}

static void write_kinds(struct legend *l)
{
	const struct map *m = l->m;
	char range[32];
	for (uint32_t color = 0; color < ECO_CHART_COLORS; color++)
		for (uint32_t i = 0; i < m->kind_count; i++) {
			const struct map_kind *kind = &m->kinds[i];
			if (kind->count && kind->color == color)
				write_kind(l, eco_chart_colors[color], (kind->low_m + kind->high_m) / 2,
					kind->name, kind->count,
					range_text(kind->low_m, kind->high_m, range));
		}
	write_others(l);
	write_unused(l);
}

static void write_edges(struct legend *l)
{
	const struct { const struct map_edges *edges; struct eco_color color; const char *says; } kinds[] = {
		{ &l->m->areas, { 0.1, 0.25, 0.5, 0.8 }, "areas of scattered plants" },
		{ &l->m->clear_of, { 0.75, 0.2, 0.1, 0.55 }, "what they keep clear of" } };
	struct eco_chart_style style = { .size = 12, .color = gray, .room = LEGEND };
	for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
		if (!kinds[i].edges->count)
			continue;
		eco_chart_line(l->m->chart, l->x, l->y - 4, l->x + 16, l->y - 4, 1.6, kinds[i].color);
		eco_chart_text(l->m->chart, l->x + 22, l->y, &style, kinds[i].says);
		l->y += LINE;
	}
}

static void write_density(struct legend *l)
{
	const struct map *m = l->m;
	struct eco_chart_style style = { .size = 12, .color = gray, .room = LEGEND };
	char text[120], a[32], b[32];
	if (!m->points.count)
		return;
	if (!m->is_density) {
		write_line(l, &style, m->typical_m > 0 ? "Dots are larger the taller the plant is."
			: "Heights are those of the models: not known here.");
		return;
	}
	double ramp = 120, side = 1 / m->scale;
	for (int i = 0; i < 24; i++)
		eco_chart_box(m->chart, l->x + i * ramp / 24, l->y - 10, ramp / 24 + 0.5, 12,
			(struct eco_color){ 0.07, 0.47, 0.2, 0.35 + 0.65 * (i + 0.5) / 24 });
	snprintf(text, sizeof text, "1 to %s+ plants on %s × %s", eco_phrase_count((uint64_t)m->densest, a),
		eco_chart_length_text(side, b), b);
	eco_chart_text(m->chart, l->x + ramp + 10, l->y, &style, text);
	l->y += LINE;
	write_line(l, &style, "Colours are the mean of what stands there.");
}

static void write_left_out(struct legend *l)
{
	const struct map *m = l->m;
	char text[200], count[32];
	if (m->left_count)
		write_heading(l, "Read, and left out");
	for (uint32_t i = 0; i < m->left_count && i < LEFT_OUT_LINES; i++) {
		const struct map_left *left = &m->left[i];
		double indent = left->kind == MAP_FILE ? 0 : left->kind == MAP_OF_THESE ? 30 : 14,
			number = l->x + LEGEND - (indent > 14 ? 16 : 0);
		struct eco_chart_style style =
			{ .size = indent > 14 ? 11 : 12,
				.room = (left->count && indent > 0 ? LEGEND - 80 : LEGEND) - indent,
				.color = indent > 14 ? gray : (struct eco_color){ 0 } };
		struct eco_chart_style right = { .size = style.size, .align = ECO_CHART_RIGHT,
			.color = style.color };
		bool is_said = strncmp(left->text, "kept", 4) == 0;
		snprintf(text, sizeof text, "%s%s", left->kind == MAP_KEPT && !is_said ? "kept: " : "",
			left->text);
		if (left->count == 0) {
			l->y = eco_chart_paragraph(m->chart, l->x + indent, l->y, 15, &style, text) + 3;
			continue;
		}
		eco_chart_text(m->chart, l->x + indent, l->y, &style, text);
		if (left->count && indent > 0)
			eco_chart_text(m->chart, number, l->y, &right, eco_phrase_count(left->count, count));
		l->y += indent > 14 ? LINE - 3 : LINE;
	}
	if (m->left_count > LEFT_OUT_LINES) {
		snprintf(text, sizeof text, "... and %u more lines", m->left_count - LEFT_OUT_LINES);
		write_line(l, &(struct eco_chart_style){ .size = 12, .room = LEGEND }, text);
	}
}

/* Writes notes for a careful reader. */
static void write_notes(struct legend *l)
{
	const struct map *m = l->m;
	struct eco_chart_style style = { .size = 12, .color = red, .room = LEGEND };
	char text[200], count[32];
	const struct { uint64_t count; const char *says; } notes[] =
		{ { m->outside, "stand outside this picture, far from the rest" },
		{ m->off_ground, "stand beyond the ground's border" },
		{ m->not_expanded, "in nested files, shown as outlines only" } };
	for (size_t i = 0; i < sizeof notes / sizeof *notes; i++) {
		if (!notes[i].count)
			continue;
		snprintf(text, sizeof text, "%s plant%s %s", eco_phrase_count(notes[i].count, count),
			notes[i].count == 1 ? "" : "s", notes[i].says);
		l->y = eco_chart_paragraph(m->chart, l->x, l->y, 16, &style, text) + 3;
	}
}

static void write_place(struct legend *l)
{
	const struct map *m = l->m;
	const struct eco_source *s = &m->sources.items[0];
	struct eco_chart_style style = { .size = 12, .color = gray, .room = LEGEND };
	char text[300];
	write_heading(l, "Where");
	snprintf(text, sizeof text, "CRS: %.200s", s->crs ? s->crs : "none, plain metres");
	l->y = eco_chart_paragraph(m->chart, l->x, l->y, 16, &style, text) + 3;
	snprintf(text, sizeof text, "origin of the scene: %.10g, %.10g, %.10g", s->origin[0], s->origin[1],
		s->origin[2]);
	write_line(l, &style, text);
	if (m->has_ground && m->high_m >= m->low_m) {
		snprintf(text, sizeof text, "ground: %.1f to %.1f m", m->low_m + s->origin[2],
			m->high_m + s->origin[2]);
		if (m->contour_m > 0)
			snprintf(text + strlen(text), sizeof text - strlen(text), ", a line every %g m",
				m->contour_m);
		write_line(l, &style, text);
	}
	if (m->placements) {
		char a[32];
		snprintf(text, sizeof text, "%u nested file%s, placed %s time%s", m->sources.count - 1,
			m->sources.count == 2 ? "" : "s", eco_phrase_count(m->placements, a),
			m->placements == 1 ? "" : "s");
		write_line(l, &style, text);
	}
}

static void draw_bar_and_arrow(struct legend *l)
{
	struct map *m = l->m;
	struct eco_chart_style style = { .size = 12 },
		north = { .size = 13, .bold = true, .align = ECO_CHART_CENTER };
	double length = eco_chart_round_below(200 / m->scale), wide = length * m->scale, x = l->x,
		y = l->y + 34;
	char text[32];
	for (int i = 0; i < 4; i++)
		eco_chart_box(m->chart, x + i * wide / 4, y - 6, wide / 4, 6, i % 2 ? ECO_COLOR(0xffffff)
			: ECO_COLOR(0x303030));
	eco_chart_frame(m->chart, x, y - 6, wide, 6, 1, ECO_COLOR(0x303030));
	eco_chart_text(m->chart, x + wide + 8, y, &style, eco_chart_length_text(length, text));
	x = l->x + LEGEND - 60;
	const double arrow[] = { x, y - 30, x + 8, y, x, y - 6, x - 8, y };
	eco_chart_path(m->chart, &(struct eco_chart_path){ .points = arrow, .count = 4, .closed = true,
		.fill = ECO_COLOR(0x303030) });
	eco_chart_text(m->chart, x, y + 15, &north, m->sources.items[0].crs ? "N" : "Y");
	l->y += 62;
}

/* Returns the y at its end. On a chart of one pixel it only measures. */
static double draw_legend(struct map *m, double x, double y)
{
	struct legend l = { m, x, y };
	char heading[80], count[32];
	uint32_t kinds = 0;
	for (uint32_t i = 0; i < m->kind_count; i++)
		kinds += m->kinds[i].count > 0;
	draw_bar_and_arrow(&l);
	snprintf(heading, sizeof heading, "%s plant%s of %u kind%s", eco_phrase_count(m->total, count),
		m->total == 1 ? "" : "s", kinds, kinds == 1 ? "" : "s");
	write_heading(&l, heading);
	write_kinds(&l);
	write_density(&l);
	write_edges(&l);
	write_notes(&l);
	write_left_out(&l);
	write_place(&l);
	return l.y;
}

/* ---- The picture ---- */

static enum eco_code measure_legend(struct map *m, double *height)
{
	enum eco_code code = eco_chart_new(&m->chart, 1, 1, m->error);
	if (code)
		return code;
	*height = draw_legend(m, 0, 0);
	eco_chart_free(m->chart);
	m->chart = NULL;
	return ECO_OK;
}

static enum eco_code draw_map(struct map *m)
{
	const char *name = m->sources.items[0].name;
	double legend = 0;
	m->x = MARGIN + LEFT;
	m->y = TITLE;
	/* measured with room to spare: some lines are known only after drawing */
	enum eco_code code = measure_legend(m, &legend);
	double height = fmax(TITLE + m->height + BELOW, TITLE + legend + 4 * LINE) + MARGIN;
	if (!code)
		code = eco_chart_new(&m->chart, (uint32_t)(m->x + m->width + MARGIN + LEGEND + MARGIN),
			(uint32_t)fmin(height, ECO_CHART_SIDE_MAX), m->error);
	if (code)
		return code;
	eco_chart_box(m->chart, m->x, m->y, m->width, m->height, ECO_COLOR(0xf4f4f2));
	eco_chart_clip(m->chart, m->x, m->y, m->width, m->height);
	code = map_draw_ground(m);
	if (code)
		return code;
	eco_chart_clip_off(m->chart);
	draw_grid(m);
	eco_chart_clip(m->chart, m->x, m->y, m->width, m->height);
	code = map_draw_places(m);
	if (!code)
		code = map_draw_contours(m);
	if (code)
		return code;
	eco_chart_clip_off(m->chart);
	eco_chart_frame(m->chart, m->x, m->y, m->width, m->height, 1.2, ECO_COLOR(0x505050));
	eco_chart_text(m->chart, m->x, TITLE - 20, &(struct eco_chart_style){ .size = 24, .bold = true },
		name);
	draw_legend(m, m->x + m->width + MARGIN, TITLE);
	return ECO_OK;
}

enum eco_code map_write(struct map *m, const char *path, uint32_t pixels)
{
	struct eco_chart_file file = { 0 };
	enum eco_code code = map_frame(m, pixels);
	if (!code)
		code = draw_map(m);
	if (!code && !main_progress("writing", NULL, 1))
		code = eco_fail(m->error, ECO_INTERRUPTED, "interrupted");
	if (!code)
		code = eco_chart_png(m->chart, &file, m->error);
	if (!code)
		code = eco_file_write(path, file.bytes, file.size, m->error);
	free(file.bytes);
	return code;
}

/* Prints the legend's content to a terminal. */
static void print_map(const struct map *m, const char *path)
{
	char range[32];
	printf("%s: %" PRIu64 " plant%s\n", path, m->total, m->total == 1 ? "" : "s");
	for (uint32_t i = 0; i < m->kind_count; i++)
		printf("  %-24s %10" PRIu64 "  %s\n", m->kinds[i].name, m->kinds[i].count,
			range_text(m->kinds[i].low_m, m->kinds[i].high_m, range));
	if (m->outside)
		printf("%" PRIu64 " stand outside the picture, far from the rest\n", m->outside);
	if (m->off_ground)
		printf("%" PRIu64 " stand beyond the ground's border\n", m->off_ground);
}

static struct { const char *scene, *output; uint64_t pixels; } given;

static enum eco_code run_map(int argc, char **argv, struct eco_error *error)
{
	struct map m = { .error = error };
	memset(&given, 0, sizeof given);
	given.pixels = 1200;
	enum eco_code code = main_read(&main_command_map, argc, argv, error);
	bool table = !code && eco_points_knows(given.output);
	if (!code && table && access(given.output, F_OK) == 0)
		code = eco_fail(error, ECO_BAD_USAGE,
			"%s is there and may be somebody's inventory; it is kept. "
			"Take another name", given.output);
	else if (!code && !table)
		code = eco_chart_may_write(given.output, error);
	if (!code)
		code = map_gather(&m, given.scene);
	if (!code)
		code = table ? map_write_table(&m, given.output)
			: map_write(&m, given.output, (uint32_t)given.pixels);
	main_progress_end();
	if (!code && !main_is_quiet)
		print_map(&m, given.output);
	map_free(&m);
	return code;
}

static const struct eco_option options[] = {
	{ "the scene file", 0, ECO_OPTION_INPUT, "SCENE.json", &given.scene, .is_required = true },
	{ "output", 'o', ECO_OPTION_TEXT, "MAP", &given.output, .is_required = true,
		.help = "a PNG; or a table of all plants, with species, heights, files, rows and lines: .gpkg "
		"in the scene's CRS, .geojson in longitude and latitude; it appears complete or not at all" },
	{ "size", 0, ECO_OPTION_COUNT, "PX", &given.pixels, 200, 8000,
		.help = "longer side of the map without its legend, 200 to 8000; 1200 if not given" },
		{ 0 } };

const struct main_command main_command_map = { { "ecopack map",
	"SCENE.json -o MAP.png|MAP.gpkg|MAP.geojson [--size PX]",
	"Draws where everything stands, without building models, and says what was left out.", options,
	main_common, NULL, NULL }, run_map };
