/* The land from above. The ground is lit from the north-west, as is usual on maps, and pale, so that plants
 * stand out. Each plant is a dot, larger the taller it is; tall ones are drawn first, so that
 * small ones stay visible. Dots that would hide each other are pale: where many stand, colours are
 * fuller. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/text.h"
#include "ecofiles/ecopack/cairo_map.h"

#define RELIEF 1.4               /* exaggeration of slopes */
#define FLAT 0.93                /* brightness of level ground */
#define PALE 0.6                 /* of the image's contrast is kept */
#define BLOCK 8u                 /* side, in pixels, of the blocks that measure density */
#define DENSE 0.25               /* plants a pixel, in blocks with any plant: above, dots are pale */
#define PALE_DOT 0.3
#define NAMED_MOST 12u           /* most outlines with a name */
#define RADIUS_LEAST 0.9
#define RADIUS_MOST 7.0

const struct color kind_colors[MAP_COLORS + 1] = { { 0.07, 0.47, 0.20, 1 }, { 0.80, 0.40, 0.47, 1 },
	{ 0.20, 0.13, 0.53, 1 }, { 0.87, 0.80, 0.47, 1 }, { 0.53, 0.80, 0.93, 1 }, { 0.53, 0.13, 0.33, 1 },
	{ 0.60, 0.60, 0.20, 1 }, { 0.27, 0.67, 0.60, 1 }, { 0.67, 0.27, 0.60, 1 }, { 0.45, 0.45, 0.45, 1 } };

struct color class_color(const struct map *m, uint32_t class)
{
	const struct eco_tint_legend *of = class ? &m->tints.classes[class - 1] : NULL;
	return of && !of->own ? (struct color){ of->rgb[0] / 255.0, of->rgb[1] / 255.0, of->rgb[2] / 255.0, 1 }
		: kind_colors[MAP_COLORS];
}

/* ---- Hillshade ---- */

struct grid { double *z; uint32_t columns, rows; };      /* NaN beyond the ground's border */

static void sample(struct map *m, struct grid *grid)
{
	grid->columns = (uint32_t)m->width + 1;
	grid->rows = (uint32_t)m->height + 1;
	size_t count = (size_t)grid->columns * grid->rows;
	m->low_m = INFINITY, m->high_m = -INFINITY;
	grid->z = eco_alloc(count, sizeof *grid->z);
	for (size_t i = 0; i < count; i++) {
		double x = m->view.low[0] + (double)(i % grid->columns) / m->scale,
			y = m->view.high[1] - (double)(i / grid->columns) / m->scale;
		if (!eco_ground_height(&m->ground, x, y, &grid->z[i]))
			grid->z[i] = NAN;
		m->low_m = fmin(m->low_m, grid->z[i]);
		m->high_m = fmax(m->high_m, grid->z[i]);
	}
}

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

static void shade(const struct map *m, const struct grid *grid, uint8_t *rgba)
{
	uint32_t width = (uint32_t)m->width;
	for (size_t i = 0; i < (size_t)width * (uint32_t)m->height; i++) {
		const double *z = grid->z ? grid->z + i / width * grid->columns + i % width : NULL;
		double east = z ? (z[1] - z[0]) * m->scale : NAN,
			north = z ? (z[0] - z[grid->columns]) * m->scale : NAN, light = 1;
		if (!isnan(east + north)) {
			uint8_t v = brightness(east, north);
			memcpy(rgba + 4 * i, (uint8_t[4]){ v, v, (uint8_t)(v * 0.965), 255 }, 4);
			light = v / (255 * FLAT);
		}
		if (m->image && m->image[4 * i + 3])
			lay_image(m->image + 4 * i, light, rgba + 4 * i);
	}
}

void land_ground(struct map *m, cairo_t *canvas)
{
	struct grid grid = { .z = NULL };
	if (!m->has_ground && !m->image)
		return;
	uint8_t *rgba = eco_alloc((size_t)m->width * (size_t)m->height, 4);
	if (m->has_ground)
		sample(m, &grid);
	shade(m, &grid, rgba);
	canvas_pixels(canvas, m->x, m->y, (uint32_t)m->width, (uint32_t)m->height, rgba);
	free(grid.z);
	free(rgba);
}

/* ---- Dots ---- */

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
static double density_of(struct map *m)
{
	uint32_t columns = (uint32_t)m->width / BLOCK + 1, rows = (uint32_t)m->height / BLOCK + 1, x, y;
	uint8_t *any = eco_alloc(columns, rows);
	uint64_t shown = 0, blocks = 0;
	for (uint64_t i = 0; i < m->points.count; i++)
		if (pixel_of(m, &m->points.items[i], &x, &y)) {
			any[(size_t)(y / BLOCK) * columns + x / BLOCK] = 1;
			shown++;
		}
	m->outside = m->points.count - shown;
	for (size_t i = 0; i < (size_t)columns * rows; i++)
		blocks += any[i];
	free(any);
	return blocks ? (double)shown / ((double)blocks * BLOCK * BLOCK) : 0;
}

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

double land_radius(const struct map *m, double height_m)
{
	double ratio = height_m > 0 && m->typical_m > 0 ? sqrt(height_m / m->typical_m) : 1;
	return fmin(fmax(m->dot * fmin(fmax(ratio, 0.5), 2.2), RADIUS_LEAST), 2 * RADIUS_MOST);
}

static void draw_dots(struct map *m, cairo_t *canvas, bool pale)
{
	qsort(m->points.items, m->points.count, sizeof *m->points.items, by_height);
	for (uint64_t i = 0; i < m->points.count; i++) {
		const struct map_point *p = &m->points.items[i];
		double x = map_x(m, (double)p->x), y = map_y(m, (double)p->y),
			radius = land_radius(m, (double)p->height_m);
		if (radius >= 2)
			canvas_disc(canvas, x, y, radius + 0.7, (struct color){ 1, 1, 1, 0.75 });
		struct color color = m->tints.class_count ? class_color(m, p->class) : kind_colors[m->kinds[p->kind].color];
		color.a = pale ? PALE_DOT : 1;
		canvas_disc(canvas, x, y, radius, color);
	}
}

/* ---- All ---- */

/* Turns `count` places in metres into pixels. */
static void to_pixels(const struct map *m, const double *metres, double *pixels, size_t count)
{
	for (size_t i = 0; i < count; i++) {
		pixels[2 * i] = map_x(m, metres[2 * i]);
		pixels[2 * i + 1] = map_y(m, metres[2 * i + 1]);
	}
}

static void draw_outlines(const struct map *m, cairo_t *canvas)
{
	struct style style = { .size = 11, .align = ALIGN_CENTER, .halo = { 1, 1, 1, 0.8 } };
	for (uint32_t i = 0; i < m->outline_count; i++) {
		double p[8];
		to_pixels(m, m->outlines[i].corners, p, 4);
		canvas_outline(canvas, p, 4, 1, COLOR(0x707070),
			(struct color){ 0.5, 0.5, 0.5, m->not_expanded ? 0.15 : 0 });
		if (m->outline_count <= NAMED_MOST)
			canvas_text(canvas, (p[0] + p[2] + p[4] + p[6]) / 4, (p[1] + p[3] + p[5] + p[7]) / 4,
				&style, m->outlines[i].name);
	}
}

static void draw_edges(const struct map *m, cairo_t *canvas, const struct map_edges *edges, double line,
	struct color color)
{
	double *ends = eco_alloc(edges->count, 4 * sizeof *ends);
	to_pixels(m, edges->ends, ends, 2 * (size_t)edges->count);
	canvas_lines(canvas, ends, edges->count, line, color);
	free(ends);
}

static void draw_left(const struct map *m, cairo_t *canvas)
{
	for (uint32_t i = 0; i < m->left_points.count; i++)
		canvas_disc(canvas, map_x(m, (double)m->left_points.items[i].x), map_y(m, (double)m->left_points.items[i].y), LEFT_PX,
			LEFT_COLOR);
}

void land_plants(struct map *m, cairo_t *canvas)
{
	double density = density_of(m);
	m->dot = density > 0 ? fmin(fmax(0.34 / sqrt(density), RADIUS_LEAST), RADIUS_MOST) : RADIUS_MOST;
	draw_left(m, canvas);
	draw_dots(m, canvas, density > DENSE);
	draw_edges(m, canvas, &m->clear_of, 2, CLEAR_COLOR);
	draw_edges(m, canvas, &m->areas, 1.2, AREAS_COLOR);
	draw_outlines(m, canvas);
}

/* ---- The canvas ---- */

#define TEXT_BYTES 1024u

cairo_t *canvas_new(uint32_t width, uint32_t height)
{
	cairo_surface_t *surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, (int)width, (int)height);
	cairo_t *canvas = cairo_create(surface);
	cairo_surface_destroy(surface);
	if (cairo_status(canvas))
		eco_end("no memory for the map");
	cairo_font_options_t *options = cairo_font_options_create();
	cairo_font_options_set_antialias(options, CAIRO_ANTIALIAS_GRAY);
	cairo_font_options_set_hint_style(options, CAIRO_HINT_STYLE_NONE);
	cairo_font_options_set_hint_metrics(options, CAIRO_HINT_METRICS_OFF);
	cairo_set_font_options(canvas, options);
	cairo_font_options_destroy(options);
	cairo_set_source_rgb(canvas, 1, 1, 1);
	cairo_paint(canvas);
	cairo_set_line_join(canvas, CAIRO_LINE_JOIN_ROUND);
	return canvas;
}

static cairo_status_t append(void *ctx, const unsigned char *bytes, unsigned int size)
{
	return fwrite(bytes, 1, size, ctx) == size ? CAIRO_STATUS_SUCCESS : CAIRO_STATUS_WRITE_ERROR;
}

enum eco_code canvas_png(cairo_t *canvas, uint8_t **bytes, size_t *size, struct eco_error *error)
{
	char *all = NULL;
	FILE *memory = open_memstream(&all, size);
	cairo_status_t status = cairo_status(canvas);
	if (!status)
		status = memory ? cairo_surface_write_to_png_stream(cairo_get_target(canvas), append, memory)
			: CAIRO_STATUS_NO_MEMORY;
	if (memory && fclose(memory) != 0)
		status = CAIRO_STATUS_NO_MEMORY;
	*bytes = (uint8_t *)all;
	if (!status)
		return ECO_OK;
	free(all);
	*bytes = NULL;
	return eco_fail(error, status == CAIRO_STATUS_NO_MEMORY ? ECO_NO_MEMORY : ECO_IO,
		"the picture cannot be made: %s", cairo_status_to_string(status));
}

/* ---- Shapes ---- */

static void ink(cairo_t *canvas, struct color color)
{
	cairo_set_source_rgba(canvas, color.r, color.g, color.b, color.a);
}

void canvas_box(cairo_t *canvas, double x, double y, double width, double height, struct color fill)
{
	ink(canvas, fill);
	cairo_rectangle(canvas, x, y, width, height);
	cairo_fill(canvas);
}

void canvas_frame(cairo_t *canvas, double x, double y, double width, double height, double line,
	struct color color)
{
	ink(canvas, color);
	cairo_set_line_width(canvas, line);
	cairo_rectangle(canvas, x, y, width, height);
	cairo_stroke(canvas);
}

void canvas_disc(cairo_t *canvas, double x, double y, double radius, struct color fill)
{
	ink(canvas, fill);
	cairo_arc(canvas, x, y, radius, 0, 2 * M_PI);
	cairo_fill(canvas);
}

void canvas_outline(cairo_t *canvas, const double *points, uint32_t count, double line, struct color color,
	struct color fill)
{
	for (uint32_t i = 0; i < count; i++)
		cairo_line_to(canvas, points[2 * (size_t)i], points[2 * (size_t)i + 1]);
	cairo_close_path(canvas);
	ink(canvas, fill);
	cairo_fill_preserve(canvas);
	ink(canvas, color);
	cairo_set_line_width(canvas, line);
	if (line > 0)
		cairo_stroke(canvas);
	cairo_new_path(canvas);
}

void canvas_lines(cairo_t *canvas, const double *ends, uint32_t count, double line, struct color color)
{
	ink(canvas, color);
	cairo_set_line_width(canvas, line);
	for (uint32_t i = 0; i < count; i++, ends += 4) {
		cairo_move_to(canvas, ends[0], ends[1]);
		cairo_line_to(canvas, ends[2], ends[3]);
		if (i % 1024 == 1023)            /* cairo's time grows faster than a path's length */
			cairo_stroke(canvas);
	}
	cairo_stroke(canvas);
}

void canvas_pixels(cairo_t *canvas, double x, double y, uint32_t width, uint32_t height, const uint8_t *rgba)
{
	cairo_surface_t *picture = cairo_image_surface_create(CAIRO_FORMAT_ARGB32, (int)width, (int)height);
	uint8_t *to = cairo_image_surface_get_data(picture);
	size_t stride = (size_t)cairo_image_surface_get_stride(picture);
	cairo_surface_flush(picture);
	for (size_t i = 0; to && i < (size_t)width * height; i++, rgba += 4) {
		uint32_t a = rgba[3], packed = a << 24;
		for (int k = 0; k < 3; k++)
			packed |= (rgba[k] * a + 127) / 255 << (16 - 8 * k);
		memcpy(to + i / width * stride + 4 * (i % width), &packed, 4);
	}
	cairo_surface_mark_dirty(picture);
	cairo_set_source_surface(canvas, picture, x, y);
	cairo_pattern_set_filter(cairo_get_source(canvas), CAIRO_FILTER_NEAREST);
	cairo_rectangle(canvas, x, y, width, height);
	cairo_fill(canvas);
	cairo_surface_destroy(picture);
}

/* ---- Texts ---- */

static void clean(const char *text, char out[TEXT_BYTES])
{
	snprintf(out, TEXT_BYTES - 4, "%s", text);       /* room for shorten */
	eco_utf8_tame(out, "", '?');
	for (size_t left = strlen(out), bytes; left; out += bytes, left -= bytes)
		if (!(bytes = eco_utf8_bytes(out, left))) {
			*out = '?';
			bytes = 1;
		}
}

static void set_font(cairo_t *canvas, const struct style *style)
{
	cairo_select_font_face(canvas, "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL,
		style->bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
	cairo_set_font_size(canvas, style->size);
}

static double advance(cairo_t *canvas, const char *text)
{
	cairo_text_extents_t extents;
	cairo_text_extents(canvas, text, &extents);
	return extents.x_advance;
}

/* Removes characters from the end until text and ... fit. */
static void shorten(cairo_t *canvas, char text[TEXT_BYTES], double room)
{
	size_t length = strlen(text);
	if (advance(canvas, text) <= room)
		return;
	do {
		while (length > 0 && ((uint8_t)text[--length] & 0xc0) == 0x80)
			continue;
		strcpy(text + length, "…");
	} while (length > 0 && advance(canvas, text) > room);
}

void canvas_text(cairo_t *canvas, double x, double y, const struct style *style, const char *text)
{
	char cleaned[TEXT_BYTES];
	clean(text, cleaned);
	set_font(canvas, style);
	if (style->room > 0)
		shorten(canvas, cleaned, style->room);
	cairo_save(canvas);
	cairo_translate(canvas, x, y);
	cairo_rotate(canvas, -style->turn * M_PI / 2);
	if (style->align != ALIGN_LEFT)
		cairo_translate(canvas, -advance(canvas, cleaned) / (style->align == ALIGN_CENTER ? 2 : 1),
			0);
	cairo_move_to(canvas, 0, 0);
	if (style->halo.a > 0) {
		cairo_text_path(canvas, cleaned);
		ink(canvas, style->halo);
		cairo_set_line_width(canvas, style->size / 3.5);
		cairo_stroke(canvas);
		cairo_move_to(canvas, 0, 0);
	}
	ink(canvas, style->color.a > 0 ? style->color : COLOR(0x303030));
	cairo_show_text(canvas, cleaned);
	cairo_restore(canvas);
	cairo_new_path(canvas);
}

double canvas_paragraph(cairo_t *canvas, double x, double y, double leading, const struct style *style,
	const char *text)
{
	char rest[TEXT_BYTES], *line = rest;
	clean(text, rest);
	set_font(canvas, style);
	while (*line) {
		char *end = line + strlen(line), *space = NULL;
		for (char *c = line; c < end; c++) {
			if (*c != ' ')
				continue;
			*c = 0;
			bool fits = advance(canvas, line) <= style->room;
			*c = ' ';
			if (!fits)
				break;
			space = c;
		}
		if (space && advance(canvas, line) > style->room) {
			*space = 0;
			end = space + 1;
		}
		canvas_text(canvas, x, y, style, line);
		y += leading;
		line = end;
	}
	return y;
}
