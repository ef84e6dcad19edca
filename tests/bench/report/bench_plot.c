/* Plots: lines over a common axis, linear or logarithmic, and pictures; on the canvas that maps and sheets
 * are drawn on. */
#include <math.h>
#include <stdlib.h>

#include "ecofiles/base/file_write.h"
#include "ecofiles/ecopack/chart.h"
#include "tests/bench/bench.h"

#define WIDTH 960u
#define HEIGHT 600u
#define LEFT 84.0
#define RIGHT 24.0
#define TOP 48.0
#define BOTTOM 62.0
#define LEGEND_LINE 22.0
#define TICKS_MAX 64u

static const struct eco_color dark = { 0.15, 0.16, 0.14, 1 }, soft = { 0.42, 0.43, 0.40, 1 },
	grid = { 0.90, 0.90, 0.87, 1 };

/* ---- Axes ---- */

struct axis { bool log; double low, high, from, to; };   /* values; pixels */

static double axis_at(const struct axis *a, double value)
{
	double t = a->log ? (log10(value) - log10(a->low)) / (log10(a->high) - log10(a->low))
		: (value - a->low) / (a->high - a->low);
	return a->from + t * (a->to - a->from);
}

static bool axis_has(const struct axis *a, double value) { return isfinite(value) && (!a->log || value > 0); }

static void axis_fit(struct axis *a, const struct bench_plot *plot, bool y)
{
	a->low = INFINITY;
	a->high = -INFINITY;
	for (uint32_t s = 0; s < plot->series_count; s++)
		for (uint32_t i = 0; i < plot->series[s].count; i++) {
			double value = y ? plot->series[s].y[i] : plot->series[s].x[i];
			if (!axis_has(a, value))
				continue;
			a->low = fmin(a->low, value);
			a->high = fmax(a->high, value);
		}
	if (!(a->low <= a->high)) {
		a->low = a->log ? 1 : 0;
		a->high = a->log ? 10 : 1;
	}
	if (a->log) {
		double room = fmax(0.03, 0.04 * (log10(a->high) - log10(a->low)));
		a->low /= pow(10, room);
		a->high *= pow(10, room);
		return;
	}
	double span = a->high > a->low ? a->high - a->low : fmax(fabs(a->high), 1) * 0.1;
	if (a->low > 0 && a->low < 0.4 * a->high)
		a->low = 0;              /* where it costs little, zero is shown */
	else if (a->low != 0)
		a->low -= 0.05 * span;
	a->high += 0.05 * span;
}

/* Decades, and what lies between them where there are few. */
static uint32_t log_ticks(const struct axis *a, double ticks[TICKS_MAX])
{
	static const double within[3][5] = { { 1, 0 }, { 1, 3, 0 }, { 1, 2, 5, 0 } };
	double decades = log10(a->high / a->low);
	uint32_t count = 0, kind = decades > 5 ? 0 : decades > 2.5 ? 1 : 2;
	int step = decades > 10 ? (int)(decades / 8) + 1 : 1;
	for (int d = (int)floor(log10(a->low)); d <= (int)ceil(log10(a->high)); d += step)
		for (const double *w = within[kind]; *w; w++) {
			double value = *w * pow(10, d);
			if (value >= a->low * 0.9999 && value <= a->high * 1.0001 && count < TICKS_MAX)
				ticks[count++] = value;
		}
	return count;
}

static uint32_t axis_ticks(const struct axis *a, double ticks[TICKS_MAX])
{
	if (a->log) {
		uint32_t count = log_ticks(a, ticks);
		if (count >= 2)
			return count;
	}
	struct eco_chart_ticks t = eco_chart_ticks(a->low, a->high, 9);
	uint32_t count = 0;
	for (uint32_t i = 0; i < t.count && count < TICKS_MAX; i++) {
		double value = t.first + i * t.step;
		if (axis_has(a, value))
			ticks[count++] = fabs(value) < 1e-9 * t.step ? 0 : value;
	}
	return count;
}

static void tick_text(double value, char text[32])
{
	static const struct { double unit; const char *sign; } units[] =
		{ { 1e9, " G" }, { 1e6, " M" }, { 1e4, " k" } };
	for (size_t i = 0; i < sizeof units / sizeof *units; i++)
		if (fabs(value) >= units[i].unit) {
			double unit = units[i].unit == 1e4 ? 1e3 : units[i].unit;
			snprintf(text, 32, "%.4g%s", value / unit, units[i].sign);
			return;
		}
	snprintf(text, 32, "%.4g", value);
}

static void draw_axes(struct eco_chart *chart, const struct bench_plot *plot, const struct axis *x,
	const struct axis *y)
{
	double ticks[TICKS_MAX];
	char text[32];
	uint32_t count = axis_ticks(x, ticks);
	for (uint32_t i = 0; i < count; i++) {
		double at = axis_at(x, ticks[i]);
		tick_text(ticks[i], text);
		eco_chart_line(chart, at, y->from, at, y->to, 1, grid);
		eco_chart_text(chart, at, y->from + 20,
			&(struct eco_chart_style){ .size = 14, .align = ECO_CHART_CENTER, .color = soft },
			text);
	}
	count = axis_ticks(y, ticks);
	for (uint32_t i = 0; i < count; i++) {
		double at = axis_at(y, ticks[i]);
		tick_text(ticks[i], text);
		eco_chart_line(chart, x->from, at, x->to, at, 1, grid);
		eco_chart_text(chart, x->from - 8, at + 5,
			&(struct eco_chart_style){ .size = 14, .align = ECO_CHART_RIGHT, .color = soft },
			text);
	}
	eco_chart_line(chart, x->from, y->from, x->to, y->from, 1.2, soft);
	eco_chart_text(chart, 0.5 * (x->from + x->to), HEIGHT - 14,
		&(struct eco_chart_style){ .size = 16, .align = ECO_CHART_CENTER, .color = dark }, plot->x);
	eco_chart_text(chart, 22, 0.5 * (y->from + y->to),
		&(struct eco_chart_style){ .size = 16, .align = ECO_CHART_CENTER, .turn = 1, .color = dark },
		plot->y);
	eco_chart_text(chart, x->from, 28, &(struct eco_chart_style){ .size = 18, .bold = true, .color = dark,
		.room = WIDTH - LEFT - RIGHT }, plot->title);
}

/* ---- Series ---- */

static struct eco_color color_of(uint32_t series)
{
	return series < ECO_CHART_COLORS ? eco_chart_colors[series] : eco_chart_other;
}

static void draw_run(struct eco_chart *chart, const double *points, uint32_t count, struct eco_color color)
{
	if (count > 1)
		eco_chart_path(chart, &(struct eco_chart_path){ .points = points, .count = count, .line = 2.2,
			.color = color });
}

static enum eco_code draw_series(struct eco_chart *chart, const struct bench_series *series,
	struct eco_color color, const struct axis *x, const struct axis *y, struct eco_error *error)
{
	double *points = malloc(2 * ((size_t)series->count + 1) * sizeof *points);
	uint32_t run = 0;
	if (!points)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for a plot of %u points", series->count);
	for (uint32_t i = 0; i < series->count; i++) {
		if (!axis_has(x, series->x[i]) || !axis_has(y, series->y[i])) {
			draw_run(chart, points, run, color);
			run = 0;
			continue;
		}
		points[2 * run] = axis_at(x, series->x[i]);
		points[2 * run + 1] = axis_at(y, series->y[i]);
		if (series->points || series->count <= 40)
			eco_chart_disc(chart, points[2 * run], points[2 * run + 1], series->points ? 4 : 3,
				color);
		run = series->points ? 0 : run + 1;
	}
	draw_run(chart, points, run, color);
	free(points);
	return ECO_OK;
}

/* Names under the title, as many in a row as fit; returns where the plot may begin. */
static double draw_legend(struct eco_chart *chart, const struct bench_plot *plot)
{
	const struct eco_chart_style style = { .size = 15, .color = dark };
	double x = LEFT, y = TOP + 8;
	for (uint32_t s = 0; s < plot->series_count; s++) {
		double width = 30 + eco_chart_text_width(chart, &style, plot->series[s].name) + 18;
		if (x > LEFT && x + width > WIDTH - RIGHT) {
			x = LEFT;
			y += LEGEND_LINE;
		}
		if (plot->series[s].points)
			eco_chart_disc(chart, x + 12, y - 5, 4.5, color_of(s));
		else
			eco_chart_line(chart, x, y - 5, x + 24, y - 5, 3, color_of(s));
		eco_chart_text(chart, x + 30, y, &style, plot->series[s].name);
		x += width;
	}
	return y + 14;
}

static enum eco_code write_chart(struct bench *bench, struct eco_chart *chart, const char *file,
	struct eco_error *error)
{
	char path[1200];
	struct eco_chart_file png = { 0 };
	enum eco_code code = eco_chart_png(chart, &png, error);
	snprintf(path, sizeof path, "%s/%s", bench->out, file);
	if (!code)
		code = eco_file_write(path, png.bytes, png.size, error);
	free(png.bytes);
	return code;
}

enum eco_code bench_plot(struct bench *bench, const struct bench_plot *plot, struct eco_error *error)
{
	struct eco_chart *chart;
	struct axis x = { plot->log_x, 0, 0, LEFT, WIDTH - RIGHT },
		y = { plot->log_y, 0, 0, HEIGHT - BOTTOM, 0 };
	char file[128];
	enum eco_code code = eco_chart_new(&chart, WIDTH, HEIGHT, error);
	if (code)
		return code;
	axis_fit(&x, plot, false);
	axis_fit(&y, plot, true);
	y.to = draw_legend(chart, plot);
	draw_axes(chart, plot, &x, &y);
	for (uint32_t s = 0; s < plot->series_count && !code; s++)
		code = draw_series(chart, &plot->series[s], color_of(s), &x, &y, error);
	snprintf(file, sizeof file, "%s.png", plot->name);
	if (!code)
		code = write_chart(bench, chart, file, error);
	eco_chart_free(chart);
	if (!code)
		bench_picture(bench, file, plot->title);
	return code;
}

enum eco_code bench_picture_write(struct bench *bench, const char *file, uint32_t width, uint32_t height,
	const uint8_t *rgb, struct eco_error *error)
{
	struct eco_chart *chart;
	enum eco_code code = eco_chart_new(&chart, width, height, error);
	if (code)
		return code;
	eco_chart_pixels(chart, 0, 0, width, height, rgb, false);
	code = write_chart(bench, chart, file, error);
	eco_chart_free(chart);
	return code;
}
