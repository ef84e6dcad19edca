/* ecocairo.so: canvases of cairo. Texts are the same everywhere: the font is opened by its path, not by
 * the fonts and rules that a machine or user prefers, hinting is off and smoothing is gray. fontconfig is
 * asked only if that file is missing. */
#include <cairo/cairo-ft.h>
#include <cairo/cairo.h>
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/ecopack/chart.h"
#include "ecofiles/base/module.h"
#include "ecofiles/base/utf8.h"

#define FONT "DejaVu Sans"
#define FONT_FOLDER "/usr/share/fonts/truetype/dejavu/"
#define TEXT_BYTES 1024u

struct eco_canvas {
	cairo_surface_t *surface;
	cairo_t *cairo;
};

static void canvas_free(struct eco_canvas *canvas)
{
	if (!canvas)
		return;
	cairo_destroy(canvas->cairo);
	cairo_surface_destroy(canvas->surface);
	free(canvas);
}

static enum eco_code canvas_new(struct eco_canvas **canvas, uint32_t width, uint32_t height,
	struct eco_error *error)
{
	struct eco_canvas *c = calloc(1, sizeof *c);
	*canvas = NULL;
	if (!c)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for a picture");
	c->surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, (int)width, (int)height);
	c->cairo = cairo_create(c->surface);
	if (cairo_surface_status(c->surface) || cairo_status(c->cairo)) {
		canvas_free(c);
		return eco_fail(error, ECO_NO_MEMORY, "no memory for a picture of %u x %u pixels", width,
			height);
	}
	cairo_font_options_t *options = cairo_font_options_create();
	cairo_font_options_set_antialias(options, CAIRO_ANTIALIAS_GRAY);
	cairo_font_options_set_hint_style(options, CAIRO_HINT_STYLE_NONE);
	cairo_font_options_set_hint_metrics(options, CAIRO_HINT_METRICS_OFF);
	cairo_set_font_options(c->cairo, options);
	cairo_font_options_destroy(options);
	cairo_set_source_rgb(c->cairo, 1, 1, 1);
	cairo_paint(c->cairo);
	cairo_set_line_join(c->cairo, CAIRO_LINE_JOIN_ROUND);
	*canvas = c;
	return ECO_OK;
}

static void ink(struct eco_canvas *canvas, struct eco_color color)
{
	cairo_set_source_rgba(canvas->cairo, color.r, color.g, color.b, color.a);
}

/* ---- Shapes ---- */

static void draw_box(struct eco_canvas *canvas, double x, double y, double width, double height,
	struct eco_color fill)
{
	ink(canvas, fill);
	cairo_rectangle(canvas->cairo, x, y, width, height);
	cairo_fill(canvas->cairo);
}

static void draw_frame(struct eco_canvas *canvas, double x, double y, double width, double height,
	double line, struct eco_color color)
{
	ink(canvas, color);
	cairo_set_line_width(canvas->cairo, line);
	cairo_rectangle(canvas->cairo, x, y, width, height);
	cairo_stroke(canvas->cairo);
}

static void draw_disc(struct eco_canvas *canvas, double x, double y, double radius, struct eco_color fill)
{
	ink(canvas, fill);
	cairo_arc(canvas->cairo, x, y, radius, 0, 2 * M_PI);
	cairo_fill(canvas->cairo);
}

static void draw_path(struct eco_canvas *canvas, const struct eco_chart_path *path)
{
	for (uint32_t i = 0; i < path->count; i++)
		cairo_line_to(canvas->cairo, path->points[2 * (size_t)i], path->points[2 * (size_t)i + 1]);
	if (path->closed)
		cairo_close_path(canvas->cairo);
	if (path->fill.a > 0) {
		ink(canvas, path->fill);
		cairo_fill_preserve(canvas->cairo);
	}
	ink(canvas, path->color);
	cairo_set_line_width(canvas->cairo, path->line);
	if (path->line > 0)
		cairo_stroke(canvas->cairo);
	cairo_new_path(canvas->cairo);
}

static void draw_lines(struct eco_canvas *canvas, const double *ends, uint32_t count, double line,
	struct eco_color color)
{
	ink(canvas, color);
	cairo_set_line_width(canvas->cairo, line);
	for (uint32_t i = 0; i < count; i++, ends += 4) {
		cairo_move_to(canvas->cairo, ends[0], ends[1]);
		cairo_line_to(canvas->cairo, ends[2], ends[3]);
		if (i % 1024 == 1023)            /* cairo's time grows faster than a path's length */
			cairo_stroke(canvas->cairo);
	}
	cairo_stroke(canvas->cairo);
}

static void draw_pixels(struct eco_canvas *canvas, double x, double y, uint32_t width, uint32_t height,
	const uint8_t *pixels, bool alpha)
{
	cairo_surface_t *picture = cairo_image_surface_create(alpha ? CAIRO_FORMAT_ARGB32
		: CAIRO_FORMAT_RGB24, (int)width, (int)height);
	uint8_t *to = cairo_image_surface_get_data(picture);
	if (to) {
		size_t stride = (size_t)cairo_image_surface_get_stride(picture);
		cairo_surface_flush(picture);
		for (uint32_t row = 0; row < height; row++)
			for (uint32_t column = 0; column < width; column++, pixels += alpha ? 4 : 3) {
				uint32_t a = alpha ? pixels[3] : 255, packed = a << 24;
				for (int k = 0; k < 3; k++)
					packed |= (pixels[k] * a + 127) / 255 << (16 - 8 * k);
				memcpy(to + row * stride + 4 * (size_t)column, &packed, 4);
			}
		cairo_surface_mark_dirty(picture);
		cairo_set_source_surface(canvas->cairo, picture, x, y);
		cairo_pattern_set_filter(cairo_get_source(canvas->cairo), CAIRO_FILTER_NEAREST);
		cairo_rectangle(canvas->cairo, x, y, width, height);
		cairo_fill(canvas->cairo);
	}
	cairo_surface_destroy(picture);
}

static void draw_clip(struct eco_canvas *canvas, double x, double y, double width, double height)
{
	cairo_save(canvas->cairo);
	cairo_rectangle(canvas->cairo, x, y, width, height);
	cairo_clip(canvas->cairo);
}

static void draw_clip_off(struct eco_canvas *canvas)
{
	cairo_restore(canvas->cairo);
}

/* ---- Texts ---- */

/* The whole characters of `text` that fit into TEXT_BYTES - 4. */
static void clean(const char *text, char out[TEXT_BYTES])
{
	size_t used = 0;
	for (const char *s = text, *end = text + strlen(text); s < end && used + 8 < TEXT_BYTES;) {
		size_t left = (size_t)(end - s), control = eco_utf8_control(s, left);
		size_t bytes = control ? 0 : eco_utf8_bytes(s, left);
		if (bytes)
			memcpy(out + used, s, bytes);
		else
			out[used] = '?';
		used += bytes ? bytes : 1;
		s += control ? control : bytes ? bytes : 1;
	}
	out[used] = 0;
}

/* Plain and bold; read once and kept, as cairo refers to fonts after their canvases are gone. Only
 * open_fonts writes here. */
static cairo_font_face_t *fonts[2];
static pthread_once_t fonts_once = PTHREAD_ONCE_INIT;

static void open_fonts(void)
{
	static const char *const files[2] = { FONT_FOLDER "DejaVuSans.ttf", FONT_FOLDER
		"DejaVuSans-Bold.ttf" };
	static FT_Library library;
	bool ready = FT_Init_FreeType(&library) == 0;
	for (int i = 0; i < 2; i++) {
		FT_Face face;
		if (ready && FT_New_Face(library, files[i], 0, &face) == 0)
			fonts[i] = cairo_ft_font_face_create_for_ft_face(face, FT_LOAD_NO_HINTING);
		else
			fonts[i] = cairo_toy_font_face_create(FONT, CAIRO_FONT_SLANT_NORMAL,
				i ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
	}
}

static void set_font(struct eco_canvas *canvas, const struct eco_chart_style *style)
{
	pthread_once(&fonts_once, open_fonts);
	cairo_set_font_face(canvas->cairo, fonts[style->bold]);
	cairo_set_font_size(canvas->cairo, style->size);
}

static double advance(struct eco_canvas *canvas, const char *text)
{
	cairo_text_extents_t extents;
	cairo_text_extents(canvas->cairo, text, &extents);
	return extents.x_advance;
}

static double text_width(struct eco_canvas *canvas, const struct eco_chart_style *style, const char *text)
{
	char cleaned[TEXT_BYTES];
	clean(text, cleaned);
	set_font(canvas, style);
	return advance(canvas, cleaned);
}

/* Removes characters from the end until text and ... fit. */
static void shorten(struct eco_canvas *canvas, char text[TEXT_BYTES], double room)
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

static void draw_text(struct eco_canvas *canvas, double x, double y, const struct eco_chart_style *style,
	const char *text)
{
	char cleaned[TEXT_BYTES];
	clean(text, cleaned);
	set_font(canvas, style);
	if (style->room > 0)
		shorten(canvas, cleaned, style->room);
	cairo_save(canvas->cairo);
	cairo_translate(canvas->cairo, x, y);
	cairo_rotate(canvas->cairo, -style->turn * M_PI / 2);
	if (style->align != ECO_CHART_LEFT)
		cairo_translate(canvas->cairo,
			-advance(canvas, cleaned) / (style->align == ECO_CHART_CENTER ? 2 : 1), 0);
	cairo_move_to(canvas->cairo, 0, 0);
	if (style->halo.a > 0) {
		cairo_text_path(canvas->cairo, cleaned);
		ink(canvas, style->halo);
		cairo_set_line_width(canvas->cairo, style->size / 3.5);
		cairo_stroke(canvas->cairo);
		cairo_move_to(canvas->cairo, 0, 0);
	}
	ink(canvas, style->color.a > 0 ? style->color : ECO_COLOR(0x303030));
	cairo_show_text(canvas->cairo, cleaned);
	cairo_restore(canvas->cairo);
	cairo_new_path(canvas->cairo);
}

static double draw_paragraph(struct eco_canvas *canvas, double x, double y, double leading,
	const struct eco_chart_style *style, const char *text)
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
		draw_text(canvas, x, y, style, line);
		y += leading;
		line = end;
	}
	return y;
}

/* ---- A file ---- */

static cairo_status_t append(void *ctx, const unsigned char *bytes, unsigned int size)
{
	return fwrite(bytes, 1, size, ctx) == size ? CAIRO_STATUS_SUCCESS : CAIRO_STATUS_WRITE_ERROR;
}

static enum eco_code encode_png(struct eco_canvas *canvas, struct eco_chart_file *file,
	struct eco_error *error)
{
	*file = (struct eco_chart_file){ NULL, 0 };
	char *bytes = NULL;
	FILE *memory = open_memstream(&bytes, &file->size);
	cairo_status_t status = cairo_status(canvas->cairo);
	if (!status)
		status = memory ? cairo_surface_write_to_png_stream(canvas->surface, append, memory)
			: CAIRO_STATUS_NO_MEMORY;
	if (memory && fclose(memory) != 0)
		status = CAIRO_STATUS_NO_MEMORY;
	if (status) {
		free(bytes);
		file->size = 0;
		return eco_fail(error, status == CAIRO_STATUS_NO_MEMORY ? ECO_NO_MEMORY : ECO_IO,
			"the picture cannot be made: %s", cairo_status_to_string(status));
	}
	file->bytes = (uint8_t *)bytes;
	return ECO_OK;
}

extern const struct eco_cairo_module eco_cairo_module;
ECO_MODULE_EXPORT const struct eco_cairo_module eco_cairo_module = {
	.version = ECO_MODULE_VERSION, .open = canvas_new, .close = canvas_free, .box = draw_box,
		.frame = draw_frame, .disc = draw_disc,
	.path = draw_path, .lines = draw_lines, .pixels = draw_pixels, .clip = draw_clip,
	.clip_off = draw_clip_off, .text = draw_text,
	.text_width = text_width, .paragraph = draw_paragraph, .png = encode_png,
};
