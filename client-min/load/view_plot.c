#include "client-min/load/view_plot.h"

#include <math.h>

#define WIDTH 720.0
#define HEIGHT 320.0
#define LEFT 70.0
#define RIGHT 16.0
#define TOP 50.0
#define BOTTOM 46.0

static const char *const colours[VIEW_PLOT_LINES_MAX] = { "#2b6e3f", "#b5651d", "#34598f", "#8a3a6b" };

struct axis { bool log; double low, high, from, to; };   /* values; pixels */

static bool axis_has(const struct axis *a, double value)
{
	return isfinite(value) && (!a->log || value > 0);
}

static double axis_at(const struct axis *a, double value)
{
	double t =
		a->log ? log(value / a->low) / log(a->high / a->low) : (value - a->low) / (a->high - a->low);
	return a->from + t * (a->to - a->from);
}

/* Linear axes begin at 0. */
static void axis_fit(struct axis *a, const struct view_plot *plot, bool y)
{
	a->low = INFINITY;
	a->high = -INFINITY;
	for (uint32_t l = 0; l < plot->count; l++)
		for (uint32_t i = 0; i < plot->lines[l].count; i++) {
			double value = (y ? plot->lines[l].y : plot->lines[l].x)[i];
			if (axis_has(a, value)) {
				a->low = fmin(a->low, value);
				a->high = fmax(a->high, value);
			}
		}
	if (!a->log)
		a->low = 0;
	if (!(a->low <= a->high))
		a->low = a->high = a->log;
	if (a->log && y) {
		a->low = pow(10, floor(log10(a->low)));
		a->high = pow(10, ceil(log10(a->high)));
	}
	if (a->high <= a->low)
		a->high = a->log ? 10 * a->low : a->low + 1;
}

/* Of a linear axis: 1, 2 or 5 times a power of ten, four to ten of them. */
static double step_of(const struct axis *a)
{
	double raw = (a->high - a->low) / 5, ten = pow(10, floor(log10(raw))), of = raw / ten;
	return ten * (of < 1.5 ? 1 : of < 3.5 ? 2 : of < 7.5 ? 5 : 10);
}

static void tick(FILE *out, const struct view_plot *plot, const struct axis *a, bool y, double value)
{
	char text[32];
	double at = axis_at(a, value);
	if (!y && plot->label_x)
		plot->label_x(text, sizeof text, value);
	else
		snprintf(text, sizeof text, "%g", value);
	if (y)
		fprintf(out, "<path d=\"M%g %.1fH%g\" class=\"g\"/><text x=\"%g\" y=\"%.1f\" class=\"e\">%s"
			"</text>\n", LEFT, at, WIDTH - RIGHT, LEFT - 6, at + 4, text);
	else
		fprintf(out, "<path d=\"M%.1f %gV%g\" class=\"g\"/><text x=\"%.1f\" y=\"%g\" class=\"m\">%s"
			"</text>\n", at, TOP, HEIGHT - BOTTOM, at, HEIGHT - BOTTOM + 16, text);
}

static void ticks(FILE *out, const struct view_plot *plot, const struct axis *a, bool y)
{
	double step = a->log ? pow(10, floor(log10(a->low))) : step_of(a);
	double value = a->log ? step : ceil(a->low / step) * step;
	for (; value <= a->high * 1.0001; value = a->log ? value * 10 : value + step)
		if (value >= a->low * 0.9999)
			tick(out, plot, a, y, value);
}

static void line(FILE *out, const struct view_plot_line *line, uint32_t number, const struct axis *x,
	const struct axis *y)
{
	bool pen = false;
	fprintf(out, "<path fill=\"none\" stroke=\"%s\" stroke-width=\"1.6\" d=\"", colours[number]);
	for (uint32_t i = 0; i < line->count; i++) {
		bool has = axis_has(x, line->x[i]) && axis_has(y, line->y[i]);
		if (has)
			fprintf(out, "%c%.1f %.1f", pen ? 'L' : 'M', axis_at(x, line->x[i]),
				axis_at(y, line->y[i]));
		pen = has;
	}
	fprintf(out, "\"/><text x=\"%g\" y=\"%g\" fill=\"%s\">%s</text>\n", LEFT + 130 * number,
		TOP - 10, colours[number], line->name);
}

void view_plot_write(FILE *out, const struct view_plot *plot)
{
	struct axis x = { plot->log_x, 0, 0, LEFT, WIDTH - RIGHT }, y = { plot->log_y, 0, 0, HEIGHT - BOTTOM,
		TOP };
	axis_fit(&x, plot, false);
	axis_fit(&y, plot, true);
	fprintf(out, "<svg viewBox=\"0 0 %g %g\" role=\"img\"><title>%s</title>\n", WIDTH, HEIGHT,
		plot->title);
	fprintf(out,
		"<text x=\"%g\" y=\"20\" class=\"t\">%s</text><text x=\"%g\" y=\"%g\" class=\"m\">%s</text>"
		"<text x=\"%g\" y=\"20\" class=\"e\">%s</text>\n",
		LEFT, plot->title, (LEFT + WIDTH - RIGHT) / 2, HEIGHT - 8, plot->x, WIDTH - RIGHT, plot->y);
	ticks(out, plot, &x, false);
	ticks(out, plot, &y, true);
	for (uint32_t i = 0; i < plot->count; i++)
		line(out, &plot->lines[i], i, &x, &y);
	fputs("</svg>\n", out);
}
