#include "client-min/load/view_page.h"

#include <math.h>
#include <stdlib.h>

#include "client-min/load/view_plot.h"
#include "ecofiles/base/file_write.h"

#define POINTS 120u              /* of a distribution */
#define SLICES 60u               /* of the run's time */

static void write_text(FILE *out, const char *text)
{
	for (; *text; text++)
		switch (*text) {
		case '<': fputs("&lt;", out); break;
		case '>': fputs("&gt;", out); break;
		case '&': fputs("&amp;", out); break;
		default: fputc(*text, out);
		}
}

/* ---- Times by the share of answers that took no longer ---- */

static void share_label(char *text, size_t size, double one_in)
{
	snprintf(text, size, "%.6g %%", 100 * (1 - 1 / one_in));
}

/* x: one answer in x takes longer. */
static bool distribution(const struct view_load_summary *s, int kind, double *x, double *y, uint32_t *count)
{
	struct view_column column;
	if (!view_answers_column(&s->report->answers, &view_columns[kind], VIEW_GROUP_ALL, &column))
		return false;
	double most = fmax(column.count, 10);
	for (uint32_t i = 0; i < POINTS; i++) {
		x[i] = pow(most, (double)i / (POINTS - 1));
		y[i] = view_quantile(column.values, column.count, 1 - 1 / x[i]);
	}
	*count = column.count ? POINTS : 0;
	view_column_free(&column);
	return true;
}

static bool write_distribution(const struct view_load_summary *s, FILE *out)
{
	static const int kinds[] = { VIEW_COLUMN_LATENCY, VIEW_COLUMN_SERVICE, VIEW_COLUMN_FIRST_BYTE,
		VIEW_COLUMN_PICTURE };
	double x[4][POINTS], y[4][POINTS];
	struct view_plot plot = { .title = "Time by the share of answers that took no longer",
		.x = "share of answers", .y = "ms", .log_x = true, .log_y = true, .count = 4,
		.label_x = share_label };
	for (uint32_t i = 0; i < 4; i++) {
		struct view_plot_line *line = &plot.lines[i];
		*line = (struct view_plot_line){ view_columns[kinds[i]].title, x[i], y[i], 0 };
		if (!distribution(s, kinds[i], x[i], y[i], &line->count))
			return false;
	}
	view_plot_write(out, &plot);
	return true;
}

/* ---- What happened when ---- */

struct slice { float *latency; uint32_t count, failures; uint64_t bytes; };

static int by_value(const void *a, const void *b)
{
	float x = *(const float *)a, y = *(const float *)b;
	return x < y ? -1 : x > y;
}

static void write_slices(const struct slice slices[SLICES], double seconds, FILE *out)
{
	double x[SLICES], p50[SLICES], p99[SLICES], most[SLICES], rate[SLICES], failures[SLICES], mb[SLICES];
	for (uint32_t i = 0; i < SLICES; i++) {
		const struct slice *slice = &slices[i];
		double width = seconds / SLICES;
		x[i] = (i + 0.5) * width;
		p50[i] = view_quantile(slice->latency, slice->count, 0.5);
		p99[i] = view_quantile(slice->latency, slice->count, 0.99);
		most[i] = view_quantile(slice->latency, slice->count, 1);
		rate[i] = slice->count / width;
		failures[i] = slice->failures / width;
		mb[i] = (double)slice->bytes / width / 1e6;
	}
	view_plot_write(out, &(struct view_plot){ .title = "Latency of what was due then", .x = "seconds",
		.y = "ms", .log_y = true, .count = 3, .lines = { { "p50", x, p50, SLICES },
		{ "p99", x, p99, SLICES }, { "max", x, most, SLICES } } });
	view_plot_write(out, &(struct view_plot){ .title = "Answers a second, by when they were due",
		.x = "seconds", .y = "/s", .count = 2, .lines = { { "answers", x, rate, SLICES },
		{ "failures", x, failures, SLICES } } });
	view_plot_write(out, &(struct view_plot){ .title = "Megabytes a second, by when they were due",
		.x = "seconds", .y = "MB/s", .count = 1, .lines = { { "of all clients", x, mb, SLICES } } });
}

/* The answers are in the order in which they were due. */
static bool write_course(const struct view_load_summary *s, FILE *out)
{
	const struct view_answers *answers = &s->report->answers;
	struct slice slices[SLICES] = { { 0 } };
	float *latency = malloc((answers->count + 1) * sizeof *latency);
	if (!latency)
		return false;
	for (uint32_t i = 0; i < answers->count; i++) {
		const struct view_answer *a = &answers->items[i];
		double at = a->due_ms / 1e3 / s->report->seconds * SLICES;
		struct slice *slice = &slices[at < 0 ? 0 : at < SLICES ? (uint32_t)at : SLICES - 1];
		if (!slice->latency)
			slice->latency = latency + i;
		slice->latency[slice->count++] = a->done_ms;
		slice->failures += a->outcome != VIEW_ANSWERED;
		slice->bytes += a->bytes;
	}
	for (uint32_t i = 0; i < SLICES; i++)
		if (slices[i].count)
			qsort(slices[i].latency, slices[i].count, sizeof *latency, by_value);
	write_slices(slices, s->report->seconds, out);
	free(latency);
	return true;
}

/* ---- The page ---- */

static enum eco_code write_figures(const struct view_load_summary *s, FILE *out, struct eco_error *error)
{
	char *text = NULL;
	size_t size = 0;
	FILE *figures = open_memstream(&text, &size);
	enum eco_code code = figures ? view_load_print(s, figures, error)
		: eco_fail(error, ECO_NO_MEMORY, "no memory for a report");
	if (figures && fclose(figures) && !code)
		code = eco_fail(error, ECO_NO_MEMORY, "no memory for a report");
	if (!code) {
		fputs("<pre>", out);
		write_text(out, text);
		fputs("</pre>\n", out);
	}
	free(text);
	return code;
}

enum eco_code view_page_write(const struct view_load_summary *s, const char *path, struct eco_error *error)
{
	static const char head[] =
		"<!doctype html><html lang=\"en\"><meta charset=\"utf-8\"><title>ecoload</title>"
		"<style>body{font:15px/1.5 system-ui,sans-serif;margin:2rem auto;max-width:1500px;"
		"padding:0 1rem;color:#222;background:#fafaf7}svg{width:48%;min-width:420px;font-size:12px}"
		"svg path.g{stroke:#ddd}svg text.e{text-anchor:end}svg text.m{text-anchor:middle}"
		"svg text.t{font-weight:600}pre{font-size:13px;white-space:pre-wrap}</style>\n";
	char *text = NULL;
	size_t size = 0;
	FILE *out = open_memstream(&text, &size);
	if (!out)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for a page");
	fprintf(out, "%s<h1>", head);
	write_text(out, s->options->url);
	fputs("</h1>\n", out);
	enum eco_code code = write_figures(s, out, error);
	bool good = code || (write_distribution(s, out) && write_course(s, out));
	fputs("</html>\n", out);
	good = !fclose(out) && good;
	if (!code)
		code = good ? eco_file_write(path, text, size, error)
			: eco_fail(error, ECO_NO_MEMORY, "no memory for a page");
	free(text);
	return code;
}
