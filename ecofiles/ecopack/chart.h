/* Pictures for people: a canvas for shapes, texts and pictures, saved as PNG. Used for maps and
 * plots.
 *
 *   eco_chart_new(&chart, width, height, &error);       white
 *   eco_chart_box, _line, _disc, _text, _pixels, ...    pixels from the top left; later covers earlier
 *   eco_chart_png(chart, &file, &error);                a whole PNG file in memory
 *   eco_file_write(path, file.bytes, file.size, &error);        file_write.h
 *   eco_chart_free(chart);
 *
 * Drawing never fails: shapes are clipped, and eco_chart_png reports a lack of memory. Texts are UTF-8
 * (bad bytes are shown as ?), in DejaVu Sans; numbers do not depend on the locale. cairo draws
 * (ecocairo.so, see module.h); one thread a canvas. */
#ifndef ECO_CHART_H
#define ECO_CHART_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "ecofiles/base/status.h"

#define ECO_CHART_SIDE_MAX 16384u

struct eco_color { double r, g, b, a; };         /* 0 to 1, sRGB; a: 1 is opaque */
/* 0xRRGGBB */
#define ECO_COLOR(rgb) ((struct eco_color){ ((rgb) >> 16 & 255) / 255.0, ((rgb) >> 8 & 255) / 255.0, \
	((rgb) & 255) / 255.0, 1 })

/* Nine colours that people with any colour vision tell apart (Paul Tol, "muted"), and a gray for the rest. */
#define ECO_CHART_COLORS 9u
extern const struct eco_color eco_chart_colors[ECO_CHART_COLORS], eco_chart_other;

struct eco_chart;

enum eco_code eco_chart_new(struct eco_chart **chart, uint32_t width, uint32_t height,
	struct eco_error *error);
void eco_chart_free(struct eco_chart *chart);    /* NULL is fine */

void eco_chart_box(struct eco_chart *chart, double x, double y, double width, double height,
	struct eco_color fill);
void eco_chart_frame(struct eco_chart *chart, double x, double y, double width, double height, double line,
	struct eco_color color);
void eco_chart_disc(struct eco_chart *chart, double x, double y, double radius, struct eco_color fill);
/* x, y of `count` points; closed: the last is joined to the first. fill.a 0: no fill. */
struct eco_chart_path { const double *points; uint32_t count; bool closed; double line;
	struct eco_color color, fill; };
void eco_chart_path(struct eco_chart *chart, const struct eco_chart_path *path);
void eco_chart_line(struct eco_chart *chart, double x0, double y0, double x1, double y1, double line,
	struct eco_color color);
/* Many lines of one style, faster than one by one: x0, y0, x1, y1 each. */
void eco_chart_lines(struct eco_chart *chart, const double *ends, uint32_t count, double line,
	struct eco_color color);
/* sRGB pixels without gaps; with `alpha` 4 bytes each (straight alpha), else 3. Drawn one to one. */
void eco_chart_pixels(struct eco_chart *chart, double x, double y, uint32_t width, uint32_t height,
	const uint8_t *pixels, bool alpha);
/* Clips later drawing to the box, until eco_chart_clip_off. */
void eco_chart_clip(struct eco_chart *chart, double x, double y, double width, double height);
void eco_chart_clip_off(struct eco_chart *chart);

enum eco_chart_align { ECO_CHART_LEFT, ECO_CHART_CENTER, ECO_CHART_RIGHT };
struct eco_chart_style {
	double size;                 /* height of a line's letters, pixels */
	enum eco_chart_align align;  /* of x */
	bool bold;
	double room;                 /* > 0: greatest width; a longer text ends in ... */
	double turn;                 /* quarter turns, counter-clockwise, about x, y */
	struct eco_color color;      /* a = 0: dark gray */
	struct eco_color halo;       /* a > 0: a rim of this colour, which is legible on any ground */
};
/* y is the base line. */
void eco_chart_text(struct eco_chart *chart, double x, double y, const struct eco_chart_style *style,
	const char *text);
double eco_chart_text_width(struct eco_chart *chart, const struct eco_chart_style *style, const char *text);
/* A long text in lines of style->room pixels, `leading` apart, broken at spaces; returns the base line
 * after the last. */
double eco_chart_paragraph(struct eco_chart *chart, double x, double y, double leading,
	const struct eco_chart_style *style, const char *text);

/* Round numbers (1, 2 or 5 times a power of ten) from low to high, at most `most` of them (most >= 2):
 * first, step, count. */
struct eco_chart_ticks { double first, step; uint32_t count; };
struct eco_chart_ticks eco_chart_ticks(double low, double high, uint32_t most);
/* The greatest round number not above `value` (> 0). */
double eco_chart_round_below(double value);

/* "250 m", "2 km", "5 cm" */
const char *eco_chart_length_text(double metres, char text[32]);

struct eco_chart_file { uint8_t *bytes; size_t size; };  /* owned: free(bytes) */
enum eco_code eco_chart_png(struct eco_chart *chart, struct eco_chart_file *file, struct eco_error *error);
/* Whether a picture may be written at `path`: its folder exists, and the path is free, a PNG or an empty
 * file. Call it before the work begins. */
enum eco_code eco_chart_may_write(const char *path, struct eco_error *error);

#endif
