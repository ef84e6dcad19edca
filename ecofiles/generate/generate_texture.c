/* Painted leaves for cards, four to a texture, from shade leaves to sun leaves: a silhouette cut out by
 * alpha, a midrib, side veins, a little unevenness. Pixels outside a leaf keep the leaf's colour, so that
 * filtering gives no dark fringe. */
#include "ecofiles/base/memory.h"
#include "ecofiles/generate/generate_plants.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/format/image.h"

struct canvas { uint8_t *rgba; uint32_t size, left, top; };     /* a square of an image twice as wide */

struct stroke {                  /* a leaf in texture space: x right, y up, both in [0, 1] */
	double x, y, way_x, way_y;   /* foot and unit direction */
	double length, width;
	double teeth;                /* depth of the saw at the edge, in half widths */
	uint8_t rgb[3];
};

/* Half width at the share v of the way from foot to tip, at most 1. */
static double outline(double v)
{
	return v <= 0 || v >= 1 ? 0 : sqrt(v) * (1 - v) / 0.3849;
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

static void paint_pixel(struct canvas *canvas, uint32_t column, uint32_t row, const uint8_t rgb[3],
	double light)
{
	uint8_t *p = canvas->rgba + 4 * ((size_t)(canvas->top + row) * 2 * canvas->size + canvas->left
		+ column);
	for (int c = 0; c < 3; c++)
		p[c] = (uint8_t)gen_clamp(rgb[c] * light + 0.5, 0, 255);
	p[3] = 255;
}

static void paint_leaf(struct canvas *canvas, const struct stroke *s)
{
	for (uint32_t row = 0; row < canvas->size; row++) {
		for (uint32_t column = 0; column < canvas->size; column++) {
			double x = (column + 0.5) / canvas->size - s->x,
				y = 1 - (row + 0.5) / canvas->size - s->y;
			double v = (x * s->way_x + y * s->way_y) / s->length,
				u = (x * s->way_y - y * s->way_x) / (0.5 * s->width);
			double edge = outline(v) * (1 - s->teeth * fraction(v * 11 - 0.5 * fabs(u)));
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

static void paint_stalk(struct canvas *canvas, double x0, double y0, double x1, double y1, double width)
{
	const uint8_t wood[3] = { 92, 74, 50 };
	double dx = x1 - x0, dy = y1 - y0, square = dx * dx + dy * dy;
	for (uint32_t row = 0; row < canvas->size; row++) {
		for (uint32_t column = 0; column < canvas->size; column++) {
			double x = (column + 0.5) / canvas->size - x0,
				y = 1 - (row + 0.5) / canvas->size - y0;
			double t = gen_clamp((x * dx + y * dy) / square, 0, 1), ex = x - t * dx,
				ey = y - t * dy;
			if (ex * ex + ey * ey < 0.25 * width * width)
				paint_pixel(canvas, column, row, wood, 0.9 + 0.2 * grain(column, row));
		}
	}
}

/* Leaf colours, from inside a crown to its top. */
static const uint8_t leaf_rgb[4][3] = { { 58, 84, 38 }, { 82, 116, 48 }, { 110, 146, 60 }, { 140, 172, 78 } };

static void paint_single(struct canvas *canvas, uint32_t shade)
{
	struct stroke s = { .x = 0.5, .y = 0.03, .way_y = 1, .length = 0.96, .width = 0.92, .teeth = 0.10 };
	memcpy(s.rgb, leaf_rgb[shade], sizeof s.rgb);
	paint_leaf(canvas, &s);
	paint_stalk(canvas, 0.5, 0, 0.5, 0.08, 0.035);
}

/* A twig with nine leaves, lower ones first. */
static void paint_spray(struct canvas *canvas, uint32_t shade)
{
	paint_stalk(canvas, 0.5, 0, 0.5, 0.72, 0.022);
	for (uint32_t i = 0; i < 9; i++) {
		double t = i / 8.0, side = i == 8 ? 0 : i % 2 ? 1 : -1,
			light = 0.88 + 0.24 * grain(i, 7 + shade);
		struct gen_v3 way = gen_unit(gen_v3(side * (1.05 - 0.45 * t), 0.42 + 0.35 * t, 0));
		struct stroke s = { .x = 0.5, .y = 0.08 + 0.60 * t, .way_x = way.x, .way_y = way.y,
			.length = i == 8 ? 0.33 : 0.44 - 0.06 * t, .width = 0.27, .teeth = 0.16 };
		for (int c = 0; c < 3; c++)
			s.rgb[c] = (uint8_t)gen_clamp(leaf_rgb[shade][c] * light, 0, 255);
		paint_leaf(canvas, &s);
	}
}

/* A branch with nine twigs of nine small leaves: much of the card is empty. */
static void paint_branch(struct canvas *canvas, uint32_t shade)
{
	paint_stalk(canvas, 0.5, 0, 0.5, 0.84, 0.016);
	for (uint32_t i = 0; i < 81; i++) {
		uint32_t twig = i / 9, place = i % 9;
		double side = twig == 8 ? 0 : twig % 2 ? 1 : -1, foot = 0.12 + 0.075 * twig,
			t = (place + 1) / 9.0,
			leans = place == 8 ? 0 : place % 2 ? 1 : -1, light = 0.8 + 0.4 * grain(i, 31 + shade),
			reach = twig == 8 ? 0.2 : 0.44 - 0.025 * twig;
		struct gen_v3 out = gen_unit(gen_v3(side, 0.35 + 0.08 * twig, 0)),
			way = gen_unit(gen_v3(out.x - 0.9 * leans * out.y, out.y + 0.9 * leans * out.x, 0));
		if (!place)
			paint_stalk(canvas, 0.5, foot, 0.5 + reach * out.x, foot + reach * out.y, 0.009);
		struct stroke s = { .x = 0.5 + reach * t * out.x, .y = foot + reach * t * out.y,
			.way_x = way.x, .way_y = way.y, .length = 0.072, .width = 0.03 };
		for (int c = 0; c < 3; c++)
			s.rgb[c] = (uint8_t)gen_clamp(leaf_rgb[shade][c] * light, 0, 255);
		paint_leaf(canvas, &s);
	}
}

static const struct painting { const char *name; uint32_t size;
	void (*paint)(struct canvas *canvas, uint32_t shade); } paintings[] = {
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
	struct canvas canvas = { eco_alloc((size_t)side * side, 4), painting->size, 0, 0 };
	for (uint32_t shade = 0; shade < 4; shade++) {
		canvas.left = shade % 2 * painting->size;
		canvas.top = (1 - shade / 2) * painting->size;
		for (uint32_t i = 0; i < painting->size * painting->size; i++) {
			paint_pixel(&canvas, i % painting->size, i / painting->size, leaf_rgb[shade], 1);
			canvas.rgba[4 * ((size_t)(canvas.top + i / painting->size) * side + canvas.left
				+ i % painting->size) + 3] = 0;
		}
		painting->paint(&canvas, shade);
	}
	eco_check(eco_png_write(&(struct eco_pixels){ side, side, 4, canvas.rgba }, path, error));
	free(canvas.rgba);
}
