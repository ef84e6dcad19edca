/* The parts of charts that need no canvas: numbers, colours, files. Canvases come from ecocairo.so, loaded
 * with the first. */
#include "ecofiles/ecopack/chart.h"

#include <assert.h>
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

#include "ecofiles/base/module.h"
#include "ecofiles/base/phrase.h"

struct eco_chart {
	const struct eco_cairo_module *cairo;
	struct eco_canvas *canvas;
};

const struct eco_color eco_chart_colors[ECO_CHART_COLORS] =
	{ { 0.07, 0.47, 0.20, 1 }, { 0.80, 0.40, 0.47, 1 }, { 0.20, 0.13, 0.53, 1 },
	{ 0.87, 0.80, 0.47, 1 }, { 0.53, 0.80, 0.93, 1 }, { 0.53, 0.13, 0.33, 1 }, { 0.60, 0.60, 0.20, 1 },
	{ 0.27, 0.67, 0.60, 1 },
	{ 0.67, 0.27, 0.60, 1 } };
const struct eco_color eco_chart_other = { 0.45, 0.45, 0.45, 1 };

enum eco_code eco_chart_new(struct eco_chart **chart, uint32_t width, uint32_t height,
	struct eco_error *error)
{
	*chart = NULL;
	if (!width || !height || width > ECO_CHART_SIDE_MAX || height > ECO_CHART_SIDE_MAX)
		return eco_fail(error, ECO_TOO_LARGE, "a picture of %u x %u pixels: sides must be 1 to %u",
			width, height, ECO_CHART_SIDE_MAX);
	struct eco_chart *c = calloc(1, sizeof *c);
	if (!c)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for a picture");
	c->cairo = eco_module(ECO_MODULE_CAIRO, error);
	enum eco_code code = c->cairo ? c->cairo->open(&c->canvas, width, height, error) : ECO_NOT_FOUND;
	if (code)
		free(c);
	else
		*chart = c;
	return code;
}

void eco_chart_free(struct eco_chart *chart)
{
	if (chart)
		chart->cairo->close(chart->canvas);
	free(chart);
}

/* ---- Drawing ---- */

void eco_chart_box(struct eco_chart *chart, double x, double y, double width, double height,
	struct eco_color fill)
{
	chart->cairo->box(chart->canvas, x, y, width, height, fill);
}

void eco_chart_frame(struct eco_chart *chart, double x, double y, double width, double height, double line,
	struct eco_color color)
{
	chart->cairo->frame(chart->canvas, x, y, width, height, line, color);
}

void eco_chart_disc(struct eco_chart *chart, double x, double y, double radius, struct eco_color fill)
{
	chart->cairo->disc(chart->canvas, x, y, radius, fill);
}

void eco_chart_path(struct eco_chart *chart, const struct eco_chart_path *path)
{
	chart->cairo->path(chart->canvas, path);
}

void eco_chart_lines(struct eco_chart *chart, const double *ends, uint32_t count, double line,
	struct eco_color color)
{
	chart->cairo->lines(chart->canvas, ends, count, line, color);
}

void eco_chart_line(struct eco_chart *chart, double x0, double y0, double x1, double y1, double line,
	struct eco_color color)
{
	eco_chart_lines(chart, (const double[4]){ x0, y0, x1, y1 }, 1, line, color);
}

void eco_chart_pixels(struct eco_chart *chart, double x, double y, uint32_t width, uint32_t height,
	const uint8_t *pixels, bool alpha)
{
	chart->cairo->pixels(chart->canvas, x, y, width, height, pixels, alpha);
}

void eco_chart_clip(struct eco_chart *chart, double x, double y, double width, double height)
{
	chart->cairo->clip(chart->canvas, x, y, width, height);
}

void eco_chart_clip_off(struct eco_chart *chart)
{
	chart->cairo->clip_off(chart->canvas);
}

void eco_chart_text(struct eco_chart *chart, double x, double y, const struct eco_chart_style *style,
	const char *text)
{
	chart->cairo->text(chart->canvas, x, y, style, text);
}

double eco_chart_text_width(struct eco_chart *chart, const struct eco_chart_style *style, const char *text)
{
	return chart->cairo->text_width(chart->canvas, style, text);
}

double eco_chart_paragraph(struct eco_chart *chart, double x, double y, double leading,
	const struct eco_chart_style *style, const char *text)
{
	return chart->cairo->paragraph(chart->canvas, x, y, leading, style, text);
}

enum eco_code eco_chart_png(struct eco_chart *chart, struct eco_chart_file *file, struct eco_error *error)
{
	return chart->cairo->png(chart->canvas, file, error);
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
	/* from a step that is too small, up through 1, 2, 5, 10 */
	for (double step = eco_chart_round_below(extent / most);;) {
		double first = ceil(low / step - 1e-9) * step, count = floor((high - first) / step + 1e-9)
			+ 1;
		if (count <= most)
			return (struct eco_chart_ticks){ first + 0.0, step, count > 0 ? (uint32_t)count : 0 };
		double next = eco_chart_round_below(2.1 * step);
		step = next > 1.1 * step ? next : eco_chart_round_below(2.6 * step);
	}
}

const char *eco_chart_length_text(double metres, char text[32])
{
	static const struct { double metres; const char *name; } units[] =
		{ { 1000, "km" }, { 1, "m" }, { 0.01, "cm" }, { 0.001, "mm" } };
	size_t u = 0;
	while (u < 3 && metres < units[u].metres * 0.9999)
		u++;
	snprintf(text, 32, "%.3g %s", metres / units[u].metres, units[u].name);
	return text;
}

/* ---- Files ---- */

static enum eco_code check_folder(const char *path, struct eco_error *error)
{
	const char *slash = strrchr(path, '/');
	char folder[4096] = ".";
	if (slash)
		snprintf(folder, sizeof folder, "%.*s", slash == path ? 1 : (int)(slash - path), path);
	if (access(folder, W_OK | X_OK) != 0)
		return eco_fail(error, errno == ENOENT ? ECO_NOT_FOUND : ECO_IO,
			"%.200s: its folder %.130s: %s%s", path, folder, strerror(errno),
			eco_advice_write(errno));
	return ECO_OK;
}

/* Whether a name says PNG, or nothing. */
static bool names_png(const char *path)
{
	const char *dot = strrchr(eco_path_last(path), '.');
	return !dot || strcasecmp(dot, ".png") == 0;
}

enum eco_code eco_chart_may_write(const char *path, struct eco_error *error)
{
	static const uint8_t png[8] = { 0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n' };
	uint8_t start[8];
	struct stat status;
	if (!*path || strlen(path) > 4000)
		return eco_fail(error, ECO_BAD_USAGE, "the name of the picture must have 1 to 4000 bytes");
	bool there = stat(path, &status) == 0;
	if (!there && !names_png(path))
		return eco_fail(error, ECO_BAD_USAGE, "%.350s: pictures are PNG, so let its name end in "
			".png (ecopack map also writes .gpkg and .geojson)", path);
	if (!there)
		return errno == ENOENT ? check_folder(path, error)
			: eco_fail_write(error, path, errno);
	int fd = S_ISREG(status.st_mode) ? open(path, O_RDONLY | O_CLOEXEC) : -1;
	ssize_t got = fd >= 0 ? read(fd, start, sizeof start) : -1;
	if (fd >= 0)
		close(fd);
	if (got == 0 || (got == 8 && memcmp(start, png, 8) == 0))
		return check_folder(path, error);
	return eco_fail(error, ECO_BAD_INPUT, "%.400s is there and is no PNG; it is kept. Take another name",
		path);
}
