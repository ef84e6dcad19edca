/* The canvas, a thin layer over cairo. The font is opened by its path, past the fonts and rules that a machine or user prefers,
 * hinting is off and smoothing is gray: so texts are the same everywhere. Only where that file is missing fontconfig is asked. */
#include "ecofiles/chart.h"

#include <assert.h>
#include <cairo/cairo-ft.h>
#include <cairo/cairo.h>
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define FONT "DejaVu Sans"
#define FONT_FOLDER "/usr/share/fonts/truetype/dejavu/"
#define TEXT_BYTES 1024u

struct eco_chart {
	cairo_surface_t *surface;
	cairo_t *cairo;
};

const struct eco_color eco_chart_colors[ECO_CHART_COLORS] = { { 0.07, 0.47, 0.20, 1 }, { 0.80, 0.40, 0.47, 1 }, { 0.20, 0.13, 0.53, 1 },
	{ 0.87, 0.80, 0.47, 1 }, { 0.53, 0.80, 0.93, 1 }, { 0.53, 0.13, 0.33, 1 }, { 0.60, 0.60, 0.20, 1 }, { 0.27, 0.67, 0.60, 1 },
	{ 0.67, 0.27, 0.60, 1 } };
const struct eco_color eco_chart_other = { 0.45, 0.45, 0.45, 1 };

enum eco_code eco_chart_new(struct eco_chart **chart, uint32_t width, uint32_t height, struct eco_error *error)
{
	*chart = NULL;
	if (!width || !height || width > ECO_CHART_SIDE_MAX || height > ECO_CHART_SIDE_MAX)
		return eco_fail(error, ECO_TOO_LARGE, "a picture of %u x %u pixels: sides must be 1 to %u", width, height, ECO_CHART_SIDE_MAX);
	struct eco_chart *c = calloc(1, sizeof *c);
	if (!c)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for a picture");
	c->surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, (int)width, (int)height);
	c->cairo = cairo_create(c->surface);
	if (cairo_surface_status(c->surface) || cairo_status(c->cairo)) {
		eco_chart_free(c);
		return eco_fail(error, ECO_NO_MEMORY, "no memory for a picture of %u x %u pixels", width, height);
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
	*chart = c;
	return ECO_OK;
}

void eco_chart_free(struct eco_chart *chart)
{
	if (!chart)
		return;
	cairo_destroy(chart->cairo);
	cairo_surface_destroy(chart->surface);
	free(chart);
}

static void ink(struct eco_chart *chart, struct eco_color color)
{
	cairo_set_source_rgba(chart->cairo, color.r, color.g, color.b, color.a);
}

/* ---- Shapes ---- */

void eco_chart_box(struct eco_chart *chart, double x, double y, double width, double height, struct eco_color fill)
{
	ink(chart, fill);
	cairo_rectangle(chart->cairo, x, y, width, height);
	cairo_fill(chart->cairo);
}

void eco_chart_frame(struct eco_chart *chart, double x, double y, double width, double height, double line, struct eco_color color)
{
	ink(chart, color);
	cairo_set_line_width(chart->cairo, line);
	cairo_rectangle(chart->cairo, x, y, width, height);
	cairo_stroke(chart->cairo);
}

void eco_chart_disc(struct eco_chart *chart, double x, double y, double radius, struct eco_color fill)
{
	ink(chart, fill);
	cairo_arc(chart->cairo, x, y, radius, 0, 2 * M_PI);
	cairo_fill(chart->cairo);
}

void eco_chart_path(struct eco_chart *chart, const struct eco_chart_path *path)
{
	for (uint32_t i = 0; i < path->count; i++)
		cairo_line_to(chart->cairo, path->points[2 * (size_t)i], path->points[2 * (size_t)i + 1]);
	if (path->closed)
		cairo_close_path(chart->cairo);
	if (path->fill.a > 0) {
		ink(chart, path->fill);
		cairo_fill_preserve(chart->cairo);
	}
	ink(chart, path->color);
	cairo_set_line_width(chart->cairo, path->line);
	if (path->line > 0)
		cairo_stroke(chart->cairo);
	cairo_new_path(chart->cairo);
}

void eco_chart_lines(struct eco_chart *chart, const double *ends, uint32_t count, double line, struct eco_color color)
{
	ink(chart, color);
	cairo_set_line_width(chart->cairo, line);
	for (uint32_t i = 0; i < count; i++, ends += 4) {
		cairo_move_to(chart->cairo, ends[0], ends[1]);
		cairo_line_to(chart->cairo, ends[2], ends[3]);
		if (i % 1024 == 1023)            /* cairo's time grows faster than the length of a path */
			cairo_stroke(chart->cairo);
	}
	cairo_stroke(chart->cairo);
}

void eco_chart_line(struct eco_chart *chart, double x0, double y0, double x1, double y1, double line, struct eco_color color)
{
	eco_chart_lines(chart, (const double[4]){ x0, y0, x1, y1 }, 1, line, color);
}

void eco_chart_pixels(struct eco_chart *chart, double x, double y, uint32_t width, uint32_t height, const uint8_t *pixels, bool alpha)
{
	cairo_surface_t *picture = cairo_image_surface_create(alpha ? CAIRO_FORMAT_ARGB32 : CAIRO_FORMAT_RGB24, (int)width, (int)height);
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
		cairo_set_source_surface(chart->cairo, picture, x, y);
		cairo_pattern_set_filter(cairo_get_source(chart->cairo), CAIRO_FILTER_NEAREST);
		cairo_rectangle(chart->cairo, x, y, width, height);
		cairo_fill(chart->cairo);
	}
	cairo_surface_destroy(picture);
}

void eco_chart_clip(struct eco_chart *chart, double x, double y, double width, double height)
{
	cairo_save(chart->cairo);
	cairo_rectangle(chart->cairo, x, y, width, height);
	cairo_clip(chart->cairo);
}

void eco_chart_clip_off(struct eco_chart *chart)
{
	cairo_restore(chart->cairo);
}

/* ---- Texts ---- */

/* Bytes of the UTF-8 sequence at `s`; 0 if it is none (overlong, a surrogate, cut off) or a control character. */
static size_t sequence(const uint8_t *s)
{
	static const struct { uint8_t mask, lead; uint32_t least; } kinds[] = { { 0x80, 0, 0x20 }, { 0xe0, 0xc0, 0x80 }, { 0xf0, 0xe0, 0x800 },
		{ 0xf8, 0xf0, 0x10000 } };
	for (size_t n = 0; n < 4; n++) {
		if ((s[0] & kinds[n].mask) != kinds[n].lead)
			continue;
		uint32_t point = s[0] & (uint8_t)~kinds[n].mask;
		for (size_t i = 1; i <= n; i++) {
			if ((s[i] & 0xc0) != 0x80)
				return 0;
			point = point << 6 | (s[i] & 0x3f);
		}
		bool control = point == 0x7f || (point >= 0x80 && point < 0xa0) || (point >= 0xd800 && point < 0xe000) || point > 0x10ffff;
		return point < kinds[n].least || control ? 0 : n + 1;
	}
	return 0;
}

/* Whole characters of `text` that fit into TEXT_BYTES - 4. */
static void clean(const char *text, char out[TEXT_BYTES])
{
	size_t used = 0;
	for (const uint8_t *s = (const uint8_t *)text; *s && used + 8 < TEXT_BYTES;) {
		size_t bytes = sequence(s);
		if (bytes)
			memcpy(out + used, s, bytes);
		else
			out[used] = '?';
		used += bytes ? bytes : 1;
		s += bytes ? bytes : 1;
	}
	out[used] = 0;
}

/* Plain and bold; read once and kept, as cairo holds on to fonts of canvases that are gone. Written by open_fonts alone. */
static cairo_font_face_t *fonts[2];
static pthread_once_t fonts_once = PTHREAD_ONCE_INIT;

static void open_fonts(void)
{
	static const char *const files[2] = { FONT_FOLDER "DejaVuSans.ttf", FONT_FOLDER "DejaVuSans-Bold.ttf" };
	static FT_Library library;
	bool ready = FT_Init_FreeType(&library) == 0;
	for (int i = 0; i < 2; i++) {
		FT_Face face;
		if (ready && FT_New_Face(library, files[i], 0, &face) == 0)
			fonts[i] = cairo_ft_font_face_create_for_ft_face(face, FT_LOAD_NO_HINTING);
		else
			fonts[i] = cairo_toy_font_face_create(FONT, CAIRO_FONT_SLANT_NORMAL, i ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
	}
}

static void set_font(struct eco_chart *chart, const struct eco_chart_style *style)
{
	pthread_once(&fonts_once, open_fonts);
	cairo_set_font_face(chart->cairo, fonts[style->bold]);
	cairo_set_font_size(chart->cairo, style->size);
}

static double advance(struct eco_chart *chart, const char *text)
{
	cairo_text_extents_t extents;
	cairo_text_extents(chart->cairo, text, &extents);
	return extents.x_advance;
}

double eco_chart_text_width(struct eco_chart *chart, const struct eco_chart_style *style, const char *text)
{
	char cleaned[TEXT_BYTES];
	clean(text, cleaned);
	set_font(chart, style);
	return advance(chart, cleaned);
}

/* Takes characters off the end until text and ... fit. */
static void shorten(struct eco_chart *chart, char text[TEXT_BYTES], double room)
{
	size_t length = strlen(text);
	if (advance(chart, text) <= room)
		return;
	do {
		while (length > 0 && ((uint8_t)text[--length] & 0xc0) == 0x80)
			continue;
		strcpy(text + length, "…");
	} while (length > 0 && advance(chart, text) > room);
}

void eco_chart_text(struct eco_chart *chart, double x, double y, const struct eco_chart_style *style, const char *text)
{
	char cleaned[TEXT_BYTES];
	clean(text, cleaned);
	set_font(chart, style);
	if (style->room > 0)
		shorten(chart, cleaned, style->room);
	cairo_save(chart->cairo);
	cairo_translate(chart->cairo, x, y);
	cairo_rotate(chart->cairo, -style->turn * M_PI / 2);
	if (style->align != ECO_CHART_LEFT)
		cairo_translate(chart->cairo, -advance(chart, cleaned) / (style->align == ECO_CHART_CENTER ? 2 : 1), 0);
	cairo_move_to(chart->cairo, 0, 0);
	if (style->halo.a > 0) {
		cairo_text_path(chart->cairo, cleaned);
		ink(chart, style->halo);
		cairo_set_line_width(chart->cairo, style->size / 3.5);
		cairo_stroke(chart->cairo);
		cairo_move_to(chart->cairo, 0, 0);
	}
	ink(chart, style->color.a > 0 ? style->color : ECO_COLOR(0x303030));
	cairo_show_text(chart->cairo, cleaned);
	cairo_restore(chart->cairo);
	cairo_new_path(chart->cairo);
}

double eco_chart_paragraph(struct eco_chart *chart, double x, double y, double leading, const struct eco_chart_style *style,
	const char *text)
{
	char rest[TEXT_BYTES], *line = rest;
	clean(text, rest);
	set_font(chart, style);
	while (*line) {
		char *end = line + strlen(line), *space = NULL;
		for (char *c = line; c < end; c++) {
			if (*c != ' ')
				continue;
			*c = 0;
			bool fits = advance(chart, line) <= style->room;
			*c = ' ';
			if (!fits)
				break;
			space = c;
		}
		if (space && advance(chart, line) > style->room) {
			*space = 0;
			end = space + 1;
		}
		eco_chart_text(chart, x, y, style, line);
		y += leading;
		line = end;
	}
	return y;
}

/* ---- Numbers ---- */

static double power10(int exponent)
{
	double power = 1;
	for (int i = exponent; i > 0; i--)
		power *= 10;
	for (int i = exponent; i < 0; i++)
		power /= 10;
	return power;
}

double eco_chart_round_below(double value)
{
	int exponent = (int)floor(log10(value));
	double power = power10(exponent);
	if (power > value)
		power = power10(--exponent);
	double digit = value / power * (1 + 1e-12);
	return (digit >= 10 ? 10 : digit >= 5 ? 5 : digit >= 2 ? 2 : 1) * power;
}

struct eco_chart_ticks eco_chart_ticks(double low, double high, uint32_t most)
{
	assert(most >= 2);
	double extent = high - low;
	if (!(extent > 0) || !isfinite(extent))
		return (struct eco_chart_ticks){ low, 1, 1 };
	/* from a step that is too small to the first that is not: 1, 2, 5, 10 */
	for (double step = eco_chart_round_below(extent / most);;) {
		double first = ceil(low / step - 1e-9) * step, count = floor((high - first) / step + 1e-9) + 1;
		if (count <= most)
			return (struct eco_chart_ticks){ first + 0.0, step, count > 0 ? (uint32_t)count : 0 };
		double next = eco_chart_round_below(2.1 * step);
		step = next > 1.1 * step ? next : eco_chart_round_below(2.6 * step);
	}
}

const char *eco_chart_length_text(double metres, char text[32])
{
	static const struct { double metres; const char *name; } units[] = { { 1000, "km" }, { 1, "m" }, { 0.01, "cm" }, { 0.001, "mm" } };
	size_t u = 0;
	while (u < 3 && metres < units[u].metres * 0.9999)
		u++;
	snprintf(text, 32, "%.3g %s", metres / units[u].metres, units[u].name);
	return text;
}

/* ---- Files ---- */

static cairo_status_t append(void *ctx, const unsigned char *bytes, unsigned int size)
{
	return fwrite(bytes, 1, size, ctx) == size ? CAIRO_STATUS_SUCCESS : CAIRO_STATUS_WRITE_ERROR;
}

enum eco_code eco_chart_png(struct eco_chart *chart, struct eco_chart_file *file, struct eco_error *error)
{
	*file = (struct eco_chart_file){ NULL, 0 };
	char *bytes = NULL;
	FILE *memory = open_memstream(&bytes, &file->size);
	cairo_status_t status = cairo_status(chart->cairo);
	if (!status)
		status = memory ? cairo_surface_write_to_png_stream(chart->surface, append, memory) : CAIRO_STATUS_NO_MEMORY;
	if (memory && fclose(memory) != 0)
		status = CAIRO_STATUS_NO_MEMORY;
	if (status) {
		free(bytes);
		file->size = 0;
		return eco_fail(error, status == CAIRO_STATUS_NO_MEMORY ? ECO_NO_MEMORY : ECO_IO, "the picture cannot be made: %s",
			cairo_status_to_string(status));
	}
	file->bytes = (uint8_t *)bytes;
	return ECO_OK;
}

enum eco_code eco_chart_write(const struct eco_chart_file *file, const char *path, struct eco_error *error)
{
	char beside[4096];
	if (snprintf(beside, sizeof beside, "%s.tmp-%ld", path, (long)getpid()) >= (int)sizeof beside)
		return eco_fail(error, ECO_BAD_INPUT, "%.200s...: the path is too long", path);
	FILE *out = fopen(beside, "wb");
	bool good = out && fwrite(file->bytes, 1, file->size, out) == file->size;
	if (out && fclose(out) != 0)
		good = false;
	if (good && rename(beside, path) == 0)
		return ECO_OK;
	enum eco_code code = eco_fail(error, ECO_IO, "%.400s: %s", path, strerror(errno));
	if (out)
		unlink(beside);
	return code;
}

static enum eco_code check_folder(const char *path, struct eco_error *error)
{
	const char *slash = strrchr(path, '/');
	char folder[4096] = ".";
	if (slash)
		snprintf(folder, sizeof folder, "%.*s", slash == path ? 1 : (int)(slash - path), path);
	if (access(folder, W_OK | X_OK) != 0)
		return eco_fail(error, errno == ENOENT ? ECO_NOT_FOUND : ECO_IO, "%.300s: its folder %.150s: %s", path, folder, strerror(errno));
	return ECO_OK;
}

enum eco_code eco_chart_may_write(const char *path, struct eco_error *error)
{
	static const uint8_t png[8] = { 0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n' };
	uint8_t start[8];
	struct stat status;
	if (!*path || strlen(path) > 4000)
		return eco_fail(error, ECO_BAD_USAGE, "the name of the picture must have 1 to 4000 bytes");
	if (stat(path, &status) != 0)
		return errno == ENOENT ? check_folder(path, error) : eco_fail(error, ECO_IO, "%.400s: %s", path, strerror(errno));
	int fd = S_ISREG(status.st_mode) ? open(path, O_RDONLY | O_CLOEXEC) : -1;
	ssize_t got = fd >= 0 ? read(fd, start, sizeof start) : -1;
	if (fd >= 0)
		close(fd);
	if (got == 0 || (got == 8 && memcmp(start, png, 8) == 0))
		return check_folder(path, error);
	return eco_fail(error, ECO_BAD_INPUT, "%.400s is there and is no PNG; it is kept. Take another name", path);
}
