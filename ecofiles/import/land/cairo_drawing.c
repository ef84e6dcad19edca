/* ecocairo.so draws lines and areas on a square of the ground's picture. */
#include "ecofiles/import/land/drawing_parts.h"

#include <cairo/cairo.h>
#include <math.h>
#include <string.h>

#define SIDE ECO_GROUND_IMAGE_SIDE
#define BEYOND 8.0           /* pixels outside the square that still count */
#define FAR_PX 1e6           /* cairo has 24 bits for whole pixels */
#define CLEAR 0x485030u      /* of clear texels: about what clients show there, as they filter */

struct square { cairo_t *canvas; double low[2], texel_m; };

static void put(const struct square *s, const double at[2], bool first)
{
	double x = (at[0] - s->low[0]) / s->texel_m, y = SIDE - (at[1] - s->low[1]) / s->texel_m;
	x = fmin(fmax(x, -FAR_PX), FAR_PX);
	y = fmin(fmax(y, -FAR_PX), FAR_PX);
	(first ? cairo_move_to : cairo_line_to)(s->canvas, x, y);
}

/* On which sides of the square a corner lies. */
static unsigned sides(const struct square *s, const double at[2], double beyond_m)
{
	double side = SIDE * s->texel_m;
	return (unsigned)(at[0] < s->low[0] - beyond_m) | (unsigned)(at[0] > s->low[0] + side + beyond_m) << 1 |
		(unsigned)(at[1] < s->low[1] - beyond_m) << 2 | (unsigned)(at[1] > s->low[1] + side + beyond_m) << 3;
}

/* The path of rings or of lines, without most of what lies on one side of the square. A ring needs its corners there, but not
 * those of a run on one side, from the last corner that counts on; a line needs none. */
static void path_of(const struct square *s, const struct eco_edge *edges, uint32_t count, bool rings, double beyond_m)
{
	bool open = false;
	unsigned run = 0;                /* sides on which all corners since the last one lie */
	for (uint32_t i = 0; i < count; i++) {
		const struct eco_edge *e = &edges[i];
		bool begins = i == 0 || edges[i - 1].b[0] != e->a[0] || edges[i - 1].b[1] != e->a[1];
		bool goes_on = i + 1 < count && edges[i + 1].a[0] == e->b[0] && edges[i + 1].a[1] == e->b[1];
		if (begins || !open) {
			run = sides(s, e->a, beyond_m);
			if (rings || !(run & sides(s, e->b, beyond_m)))
				put(s, e->a, true);
		}
		run &= sides(s, e->b, beyond_m);
		open = rings || !run;
		if (!open || (rings && goes_on && run & sides(s, edges[i + 1].b, beyond_m)))
			continue;
		put(s, e->b, false);
		run = sides(s, e->b, beyond_m);
	}
}

static void paint_item(const struct square *s, const struct drawn_file *file, uint32_t index)
{
	const struct eco_area *area = &file->areas.items[index];
	const struct drawn *item = &file->items[index];
	const struct eco_edge *edges = file->areas.edges + area->edge_first;
	const double beyond_m = BEYOND * s->texel_m + item->width_m;
	for (int k = 0; k < 2; k++)
		if (area->high[k] + beyond_m < s->low[k] || area->low[k] - beyond_m > s->low[k] + SIDE * s->texel_m)
			return;
	cairo_set_source_rgba(s->canvas, item->rgb[0] / 255.0, item->rgb[1] / 255.0, item->rgb[2] / 255.0, item->cover);
	cairo_new_path(s->canvas);
	if (item->width_m > 0) {
		/* a road thinner than a texel is as faint as it is thin */
		path_of(s, edges + area->ring_edges, area->edge_count - area->ring_edges, false, beyond_m);
		cairo_set_line_width(s->canvas, item->width_m / s->texel_m);
		cairo_stroke(s->canvas);
		return;
	}
	path_of(s, edges, area->ring_edges, true, beyond_m);
	cairo_fill_preserve(s->canvas);
	cairo_set_line_width(s->canvas, 1);      /* else what lies below shines through between neighbours */
	cairo_stroke(s->canvas);
}

/* Texels to cairo's pixels, whose colours are multiplied by their alpha, and back. */
static void swap_in(const uint8_t *rgba, uint32_t *pixels)
{
	for (uint32_t i = 0; i < SIDE * SIDE; i++, rgba += 4) {
		pixels[i] = (uint32_t)rgba[3] << 24;
		for (int k = 0; k < 3; k++)
			pixels[i] |= (rgba[k] * (uint32_t)rgba[3] + 127) / 255 << (16 - 8 * k);
	}
}

static void swap_out(const uint32_t *pixels, uint8_t *rgba)
{
	for (uint32_t i = 0; i < SIDE * SIDE; i++, rgba += 4) {
		uint32_t alpha = pixels[i] >> 24;
		for (int k = 0; k < 3; k++) {
			uint32_t value = pixels[i] >> (16 - 8 * k) & 255;
			rgba[k] = (uint8_t)(alpha ? (255 * value + alpha / 2) / alpha : CLEAR >> (16 - 8 * k) & 255);
		}
		rgba[3] = (uint8_t)alpha;
	}
}

enum eco_code cairo_drawing_paint(const void *drawing, const double low[2], double texel_m, uint8_t *rgba,
	struct eco_error *error)
{
	const struct eco_drawing *d = drawing;
	cairo_surface_t *surface = cairo_image_surface_create(CAIRO_FORMAT_ARGB32, SIDE, SIDE);
	struct square s = { cairo_create(surface), { low[0], low[1] }, texel_m };
	uint32_t *pixels = (uint32_t *)(void *)cairo_image_surface_get_data(surface);  /* rows of 4 SIDE bytes */
	if (pixels) {
		swap_in(rgba, pixels);
		cairo_surface_mark_dirty(surface);
	}
	cairo_set_operator(s.canvas, CAIRO_OPERATOR_SOURCE);
	cairo_set_fill_rule(s.canvas, CAIRO_FILL_RULE_EVEN_ODD);
	cairo_set_line_join(s.canvas, CAIRO_LINE_JOIN_ROUND);
	cairo_set_line_cap(s.canvas, CAIRO_LINE_CAP_ROUND);
	for (uint32_t i = 0; i < d->count; i++)
		paint_item(&s, &d->files[d->order[i].file], d->order[i].area);
	cairo_surface_flush(surface);
	enum eco_code code = pixels && cairo_status(s.canvas) == CAIRO_STATUS_SUCCESS ? ECO_OK
		: eco_fail(error, ECO_TOO_LARGE, "the ground cannot be drawn: %s", cairo_status_to_string(cairo_status(s.canvas)));
	if (!code)
		swap_out(pixels, rgba);
	cairo_destroy(s.canvas);
	cairo_surface_destroy(surface);
	return code;
}
