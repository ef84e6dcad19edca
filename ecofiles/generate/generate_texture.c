/* Textures of leaves: four cells of a picture, from shade leaves to sun leaves, each with what one card shows: a leaf, a
 * twig with leaves, a branch with twigs. Silhouettes are cut out by alpha; a leaf has a midrib, side veins, a little
 * unevenness. Pixels outside a leaf keep the leaf's colour, so that filtering gives no dark fringe. */
#include "ecofiles/generate/generate_plants.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/memory.h"
#include "ecofiles/format/image.h"

/* A cell of an image twice as wide. It shows the rectangle of that width and height above (left_at, 0). */
struct canvas {
	uint8_t *rgba;
	uint32_t size, left, top;
	double left_at, width, height;
};

struct stroke {                      /* a leaf: x right, y up */
	double x, y, way_x, way_y;   /* foot and unit direction */
	double length, width;
	double strip;                /* 0 an ovate outline, 1 one as wide at both ends */
	double teeth, lobes, skew;   /* depth of the saw at the edge, in half widths; their number and lean */
	uint8_t rgb[3];
};

/* Half width at the share v of the way from foot to tip, at most 1. */
static double outline(double v, double strip)
{
	return v <= 0 || v >= 1 ? 0
				: sqrt(v) * (1 - v) / 0.3849 * (1 - strip) +
			strip * gen_clamp(6 * fmin(v, 1 - v), 0, 1);
}

static double fraction(double v) { return v - floor(v); }

/* A grain that looks random but is arithmetic: the same on every machine. */
static double grain(uint32_t x, uint32_t y)
{
	uint32_t h = x * 0x9E3779B1u ^ y * 0x85EBCA77u;
	h ^= h >> 15;
	h *= 0x2C1B3C6Du;
	h ^= h >> 13;
	return (h & 0xFFFF) / 65536.0;
}

static void paint_pixel(struct canvas *canvas, uint32_t column, uint32_t row, const uint8_t rgb[3], double light)
{
	uint8_t *p =
		canvas->rgba + 4 * ((size_t)(canvas->top + row) * 2 * canvas->size + canvas->left + column);
	for (int c = 0; c < 3; c++)
		p[c] = (uint8_t)gen_clamp(rgb[c] * light + 0.5, 0, 255);
	p[3] = 255;
}

/* Pixels that may be within `reach` of a place: first and end of columns and rows. */
struct window { uint32_t column, columns, row, rows; };
static struct window window_of(const struct canvas *c, double x, double y, double reach)
{
	double across = c->size / c->width, down = c->size / c->height;
	return (struct window){ (uint32_t)gen_clamp((x - reach - c->left_at) * across - 1, 0, c->size),
		(uint32_t)gen_clamp((x + reach - c->left_at) * across + 2, 0, c->size),
		(uint32_t)gen_clamp((c->height - y - reach) * down - 1, 0, c->size),
		(uint32_t)gen_clamp((c->height - y + reach) * down + 2, 0, c->size) };
}

static double x_of(const struct canvas *c, uint32_t column) { return (column + 0.5) / c->size * c->width + c->left_at; }
static double y_of(const struct canvas *c, uint32_t row) { return (1 - (row + 0.5) / c->size) * c->height; }

static void paint_leaf(struct canvas *canvas, const struct stroke *s)
{
	struct window w = window_of(canvas, s->x, s->y, s->length + s->width);
	for (uint32_t row = w.row; row < w.rows; row++) {
		for (uint32_t column = w.column; column < w.columns; column++) {
			double x = x_of(canvas, column) - s->x, y = y_of(canvas, row) - s->y;
			double v = (x * s->way_x + y * s->way_y) / s->length,
			       u = (x * s->way_y - y * s->way_x) / (0.5 * s->width);
			double edge = outline(v, s->strip) *
				(1 - s->teeth * fraction(v * s->lobes - s->skew * fabs(u)));
			if (!(fabs(u) <= edge))
				continue;
			double vein = fraction((v - 0.22 * fabs(u)) * 7.5),
			       light = 0.94 + 0.10 * grain(column / 2, row / 2);
			if (fabs(u) < 0.07 * (1.1 - v))
				light *= 1.30;
			else if (vein < 0.10)
				light *= 1.14;
			else
				light *= 0.96 + 0.08 * fabs(u);
			paint_pixel(canvas, column, row, s->rgb, light);
		}
	}
}

static void paint_stalk(struct canvas *canvas, const double from[2], const double to[2], double width,
	const uint8_t wood[3])
{
	double dx = to[0] - from[0], dy = to[1] - from[1], square = dx * dx + dy * dy;
	for (uint32_t row = 0; row < canvas->size; row++) {
		for (uint32_t column = 0; column < canvas->size; column++) {
			double x = x_of(canvas, column) - from[0], y = y_of(canvas, row) - from[1];
			double t = gen_clamp((x * dx + y * dy) / square, 0, 1), ex = x - t * dx,
			       ey = y - t * dy;
			if (ex * ex + ey * ey < 0.25 * width * width)
				paint_pixel(canvas, column, row, wood, 0.9 + 0.2 * grain(column, row));
		}
	}
}

static void shade(uint8_t to[3], const uint8_t rgb[3], double light)
{
	for (int c = 0; c < 3; c++)
		to[c] = (uint8_t)gen_clamp(rgb[c] * light, 0, 255);
}

/* ---- Cards of the example scenes ---- */

/* Leaf colours, from inside a crown to its top. */
static const uint8_t leaf_rgb[4][3] = { { 58, 84, 38 }, { 82, 116, 48 }, { 110, 146, 60 }, { 140, 172, 78 } };
static const uint8_t wood_rgb[3] = { 92, 74, 50 };

static void paint_single(struct canvas *canvas, uint32_t cell)
{
	struct stroke s = { .x = 0.5, .y = 0.03, .way_y = 1, .length = 0.96, .width = 0.92, .teeth = 0.10,
		.lobes = 11, .skew = 0.5 };
	memcpy(s.rgb, leaf_rgb[cell], sizeof s.rgb);
	paint_leaf(canvas, &s);
	paint_stalk(canvas, (double[]){ 0.5, 0 }, (double[]){ 0.5, 0.08 }, 0.035, wood_rgb);
}

/* A twig with nine leaves, lower ones first. */
static void paint_spray(struct canvas *canvas, uint32_t cell)
{
	paint_stalk(canvas, (double[]){ 0.5, 0 }, (double[]){ 0.5, 0.72 }, 0.022, wood_rgb);
	for (uint32_t i = 0; i < 9; i++) {
		double t = i / 8.0, side = i == 8 ? 0 : i % 2 ? 1 : -1, light = 0.88 + 0.24 * grain(i, 7 + cell);
		struct gen_v3 way = gen_unit(gen_v3(side * (1.05 - 0.45 * t), 0.42 + 0.35 * t, 0));
		struct stroke s = { .x = 0.5, .y = 0.08 + 0.60 * t, .way_x = way.x, .way_y = way.y,
			.length = i == 8 ? 0.33 : 0.44 - 0.06 * t, .width = 0.27, .teeth = 0.16, .lobes = 11,
			.skew = 0.5 };
		shade(s.rgb, leaf_rgb[cell], light);
		paint_leaf(canvas, &s);
	}
}

/* A branch with nine twigs of nine small leaves: much of the card is empty. */
static void paint_branch(struct canvas *canvas, uint32_t cell)
{
	paint_stalk(canvas, (double[]){ 0.5, 0 }, (double[]){ 0.5, 0.84 }, 0.016, wood_rgb);
	for (uint32_t i = 0; i < 81; i++) {
		uint32_t twig = i / 9, place = i % 9;
		double side = twig == 8 ? 0 : twig % 2 ? 1 : -1, foot = 0.12 + 0.075 * twig,
		       t = (place + 1) / 9.0, leans = place == 8 ? 0 : place % 2 ? 1 : -1,
		       light = 0.8 + 0.4 * grain(i, 31 + cell), reach = twig == 8 ? 0.2 : 0.44 - 0.025 * twig;
		struct gen_v3 out = gen_unit(gen_v3(side, 0.35 + 0.08 * twig, 0)),
			      way = gen_unit(
				      gen_v3(out.x - 0.9 * leans * out.y, out.y + 0.9 * leans * out.x, 0));
		if (!place)
			paint_stalk(canvas, (double[]){ 0.5, foot },
				(double[]){ 0.5 + reach * out.x, foot + reach * out.y }, 0.009, wood_rgb);
		struct stroke s = { .x = 0.5 + reach * t * out.x, .y = foot + reach * t * out.y, .way_x = way.x,
			.way_y = way.y, .length = 0.072, .width = 0.03 };
		shade(s.rgb, leaf_rgb[cell], light);
		paint_leaf(canvas, &s);
	}
}

/* ---- Sprays of the library ---- */

#define TWIG_DEG 52.0
#define LEAF_DEG 50.0
#define TWIG_GAP 0.6  /* between twigs along the branch, in leaves */
#define STALK 0.1    /* of a leaf, of its length */
#define FOOT 0.25     /* of the branch below its first twig */

/* Between leaves along a twig. */
static double gap_of(const struct gen_spray *s) { return fmax(0.55 * s->slim, 0.12); }
static double twig_length(const struct gen_spray *s) { return gap_of(s) * (s->leaves - 0.5); }

/* Foot and way of twig number i; the last one goes on along the branch. */
static void twig_of(const struct gen_spray *s, uint32_t i, double foot[2], struct gen_v3 *way)
{
	double side = i + 1 == s->twigs ? 0 : i % 2 ? 1 : -1;
	foot[0] = 0;
	foot[1] = s->twigs > 1 ? FOOT + TWIG_GAP * i : 0;
	*way = side != 0 ? gen_turned(gen_v3(0, 1, 0), gen_v3(0, 0, -side), TWIG_DEG) : gen_v3(0, 1, 0);
}

void gen_spray_layout(struct gen_spray *s, uint32_t leaves, uint32_t of_leaf)
{
	double root = sqrt(leaves), reach;
	s->leaves = of_leaf > 1 ? of_leaf : leaves <= 9 ? leaves : (uint32_t)(root + 0.5);
	s->twigs = (leaves + s->leaves - 1) / s->leaves;
	reach = twig_length(s) + 1;
	s->height = s->twigs > 1 ? FOOT + TWIG_GAP * (s->twigs - 1) + reach : reach;
	/* half: the tip of a twig, or of a leaf */
	s->width = 2 * (s->twigs > 1 ? 0.79 * reach + 0.25 : 0.77 + 0.3 * s->slim);
}

static void paint_twig(struct canvas *canvas, const struct gen_spray *s, uint32_t twig, uint32_t cell)
{
	double foot[2];
	struct gen_v3 out, pole = gen_v3(0, 0, 1);
	twig_of(s, twig, foot, &out);
	paint_stalk(canvas, foot,
		(double[]){ foot[0] + twig_length(s) * out.x, foot[1] + twig_length(s) * out.y }, fmax(0.03, 1.3 * s->width / canvas->size), s->wood);
	for (uint32_t i = 0; i < s->leaves; i++) {
		uint32_t number = twig * s->leaves + i;
		bool last = i + 1 == s->leaves;
		double at = gap_of(s) * (i + 0.5), size = 0.84 + 0.22 * grain(number, 3 + cell);
		struct gen_v3 way = gen_turned(out, pole,
			last ? 0 : (i % 2 ? 1 : -1) * (LEAF_DEG + 24 * (grain(number, 17 + cell) - 0.5)));
		struct stroke leaf = { .x = foot[0] + at * out.x + STALK * way.x, .y = foot[1] + at * out.y + STALK * way.y, .way_x = way.x,
			.way_y = way.y, .length = size, .width = s->slim * size, .strip = s->strip, .teeth = s->teeth,
			.lobes = s->lobes, .skew = s->skew };
		shade(leaf.rgb, s->rgb[cell], 1 + s->uneven * (2 * grain(number, 31 + cell) - 1));
		paint_leaf(canvas, &leaf);
	}
}

static void clear(struct canvas *canvas, const uint8_t rgb[3], uint32_t cell)
{
	canvas->left = cell % 2 * canvas->size;
	canvas->top = (1 - cell / 2) * canvas->size;
	for (uint32_t i = 0; i < canvas->size * canvas->size; i++) {
		uint32_t column = i % canvas->size, row = i / canvas->size;
		paint_pixel(canvas, column, row, rgb, 1);
		canvas->rgba[4 * ((size_t)(canvas->top + row) * 2 * canvas->size + canvas->left + column) + 3] = 0;
	}
}

void gen_spray_paint(struct eco_image *image, const struct gen_spray *s)
{
	struct canvas canvas = { .size = GEN_SPRAY_SIDE / 2, .left_at = -0.5 * s->width, .width = s->width,
		.height = s->height };
	canvas.rgba = eco_alloc((size_t)GEN_SPRAY_SIDE * GEN_SPRAY_SIDE, 4);
	for (uint32_t cell = 0; cell < 4; cell++) {
		clear(&canvas, s->rgb[cell], cell);
		if (s->twigs > 1)
			paint_stalk(&canvas, (double[]){ 0, 0 },
				(double[]){ 0, FOOT + TWIG_GAP * (s->twigs - 1) }, fmax(0.05, 1.6 * s->width / canvas.size), s->wood);
		for (uint32_t twig = 0; twig < s->twigs; twig++)
			paint_twig(&canvas, s, twig, cell);
	}
	*image = (struct eco_image){ GEN_SPRAY_SIDE, GEN_SPRAY_SIDE, canvas.rgba };
}

/* ---- Files ---- */

static const struct painting { const char *name; uint32_t size;
	void (*paint)(struct canvas *canvas, uint32_t cell); } paintings[] = {
	{ "leaf.png", 64, paint_single },
	{ "spray.png", 128, paint_spray },
	{ "branch.png", 128, paint_branch },
};

void gen_texture_write(const char *folder, const char *name, struct eco_error *error)
{
	const struct painting *painting = paintings;
	while (strcmp(painting->name, name) != 0)
		painting++;
	char path[4096];
	if (snprintf(path, sizeof path, "%s/%s", folder, name) >= (int)sizeof path)
		eco_stop(ECO_BAD_INPUT, "%s: path too long", folder);
	uint32_t side = 2 * painting->size;
	struct canvas canvas = { eco_alloc((size_t)side * side, 4), painting->size, 0, 0, 0, 1, 1 };
	for (uint32_t cell = 0; cell < 4; cell++) {
		clear(&canvas, leaf_rgb[cell], cell);
		painting->paint(&canvas, cell);
	}
	eco_check(eco_png_write(&(struct eco_pixels){ side, side, 4, canvas.rgba }, path, error));
	free(canvas.rgba);
}
