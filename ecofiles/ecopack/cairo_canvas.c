#include "ecofiles/ecopack/cairo_map.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/text.h"

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
