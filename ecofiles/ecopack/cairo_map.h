/* Inside ecocairo.so, which draws the map of `ecopack map`: the picture and its legend (cairo_map.c); the
 * ground and plants, and shapes and texts on a canvas of cairo (cairo_land.c).
 *
 * Texts are the same everywhere: DejaVu Sans, without hinting, smoothed in gray. */
#pragma once

#include <cairo/cairo.h>

#include "ecofiles/ecopack/map.h"

/* ---- Shapes and texts ---- */

struct color { double r, g, b, a; };     /* 0 to 1, sRGB; a: 1 is opaque */
/* 0xRRGGBB */
#define COLOR(rgb) ((struct color){ ((rgb) >> 16 & 255) / 255.0, ((rgb) >> 8 & 255) / 255.0, \
	((rgb) & 255) / 255.0, 1 })

enum align { ALIGN_LEFT, ALIGN_CENTER, ALIGN_RIGHT };
struct style {
	double size;                 /* height of a line's letters, pixels */
	enum align align;            /* of x */
	bool bold;
	double room;                 /* > 0: greatest width; a longer text ends in ... */
	double turn;                 /* quarter turns, counter-clockwise, about x, y */
	struct color color;          /* a = 0: dark gray */
	struct color halo;           /* a > 0: a rim of this colour, which is legible on any ground */
};

/* White. Free it with cairo_destroy. */
cairo_t *canvas_new(uint32_t width, uint32_t height);
enum eco_code canvas_png(cairo_t *canvas, uint8_t **bytes, size_t *size, struct eco_error *error);

void canvas_box(cairo_t *canvas, double x, double y, double width, double height, struct color fill);
void canvas_frame(cairo_t *canvas, double x, double y, double width, double height, double line,
	struct color color);
void canvas_disc(cairo_t *canvas, double x, double y, double radius, struct color fill);
/* Joins `count` points, the last with the first. line 0: fills only. */
void canvas_outline(cairo_t *canvas, const double *points, uint32_t count, double line, struct color color,
	struct color fill);
/* Lines of one style: x0, y0, x1, y1 each. */
void canvas_lines(cairo_t *canvas, const double *ends, uint32_t count, double line, struct color color);
/* Lays sRGB pixels with straight alpha one to one. */
void canvas_pixels(cairo_t *canvas, double x, double y, uint32_t width, uint32_t height, const uint8_t *rgba);

/* Text is UTF-8; bad bytes are shown as ?. y is the base line. */
void canvas_text(cairo_t *canvas, double x, double y, const struct style *style, const char *text);
/* A text in lines of style->room pixels, `leading` apart, broken at spaces; returns the base line after the
 * last. */
double canvas_paragraph(cairo_t *canvas, double x, double y, double leading, const struct style *style,
	const char *text);

/* ---- The land ---- */

/* Colours of kinds, which people with any colour vision tell apart (Paul Tol, "muted"), and a gray for the
 * rest. */
extern const struct color kind_colors[MAP_COLORS + 1];
/* Classes count from 1; without one it is gray. */
struct color class_color(const struct map *m, uint32_t class);

/* Round numbers (1, 2 or 5 times a power of ten) from low to high, at most `most` of them (most >= 2). */
struct ticks { double first, step; uint32_t count; };
struct ticks ticks_between(double low, double high, uint32_t most);

#define AREAS_COLOR ((struct color){ 0.1, 0.25, 0.5, 0.8 })
#define LEFT_COLOR ((struct color){ 0.55, 0.55, 0.55, 0.8 })  /* of rows without a plant */
#define LEFT_PX 1.6              /* radius of their dots */
#define CLEAR_COLOR ((struct color){ 0.75, 0.2, 0.1, 0.55 })

void land_ground(struct map *m, cairo_t *canvas);          /* hillshade, and the image on it */
void land_plants(struct map *m, cairo_t *canvas);                /* dots or density; areas, outlines */
double land_radius(const struct map *m, double height_m);        /* pixels; height 0: not known */
