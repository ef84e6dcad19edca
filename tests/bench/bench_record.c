/* The record of a section: paragraphs, figures, tables, plots and pictures (bench_state.h). */
#include <assert.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/text.h"
#include "ecofiles/format/image.h"
#include "tests/bench/bench_state.h"

#define PATH 1024

static void add_item(struct bench *bench, json_t *item) { json_array_append_new(bench->state->items, item); }

void bench_say(struct bench *bench, const char *format, ...)
{
	va_list args;
	va_start(args, format);
	char *text = bench_text(format, args);
	va_end(args);
	add_item(bench, json_pack("{s:s, s:s}", "kind", "say", "text", text));
	free(text);
}

void bench_head(struct bench *bench, const char *text)
{
	add_item(bench, json_pack("{s:s, s:s}", "kind", "head", "text", text));
}

void bench_left_out(struct bench *bench, const char *name)
{
	json_object_set_new(bench->state->left_out, name, json_true());
}

static json_t *number_or_null(double value) { return isfinite(value) ? json_real(value) : json_null(); }

void bench_key(struct bench *bench, const char *key, double value, const char *bar)
{
	json_array_append_new(bench->state->keys, json_pack("{s:s, s:o, s:s}", "key", key, "value",
		number_or_null(value), "bar", bar));
}

json_t *bench_reals(const double *values, uint32_t count)
{
	json_t *all = json_array();
	for (uint32_t i = 0; i < count; i++)
		json_array_append_new(all, number_or_null(values[i]));
	return all;
}

double bench_cell(const json_t *array, size_t i)
{
	const json_t *value = json_array_get(array, i);
	return json_is_number(value) ? json_number_value(value) : NAN;
}

void bench_cells(const json_t *array, double *values, uint32_t count)
{
	for (uint32_t i = 0; i < count; i++)
		values[i] = bench_cell(array, i);
}

static int ascending(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;
	return x < y ? -1 : x > y;
}

double bench_median(double *values, uint32_t count)
{
	qsort(values, count, sizeof *values, ascending);
	return count ? (values[(count - 1) / 2] + values[count / 2]) / 2 : NAN;
}

enum eco_code bench_plot(struct bench *bench, const struct bench_plot *plot, struct eco_error *error)
{
	json_t *all = json_array();
	(void)error;
	for (uint32_t i = 0; i < plot->series_count; i++) {
		const struct bench_series *s = &plot->series[i];
		json_array_append_new(all, json_pack("{s:s, s:o, s:o, s:b}", "name", s->name, "x",
			bench_reals(s->x, s->count), "y", bench_reals(s->y, s->count), "points",
			(int)s->points));
	}
	add_item(bench, json_pack("{s:s, s:s, s:s, s:s, s:s, s:b, s:b, s:o}", "kind", "plot", "name",
		plot->name, "title", plot->title, "x", plot->x, "y", plot->y, "log_x", (int)plot->log_x,
		"log_y", (int)plot->log_y, "series", all));
	return ECO_OK;
}

void bench_picture(struct bench *bench, const char *file, const char *caption)
{
	add_item(bench, json_pack("{s:s, s:s, s:s}", "kind", "picture", "file", file, "caption", caption));
}

enum eco_code bench_picture_write(struct bench *bench, const char *file, uint32_t width, uint32_t height,
	const uint8_t *rgb, struct eco_error *error)
{
	char path[PATH];
	uint8_t *png = NULL;
	size_t size;
	snprintf(path, sizeof path, "%s/%s", bench->out, file);
	enum eco_code code = eco_png_encode(&(struct eco_pixels){ width, height, 3, rgb }, &png, &size,
		error);
	if (!code)
		code = eco_file_write(path, png, size, error);
	free(png);
	return code;
}

enum eco_code bench_pictures_write(struct bench *bench, const char *file, uint32_t width, uint32_t height,
	const uint8_t *const *rgb, uint32_t count, struct eco_error *error)
{
	size_t row = 3 * (size_t)width;
	uint8_t *all = malloc(row * count * height + 1);
	if (!all)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for a picture");
	for (size_t i = 0; i < (size_t)height * count; i++)
		memcpy(all + i * row, rgb[i % count] + i / count * row, row);
	enum eco_code code = bench_picture_write(bench, file, count * width, height, all, error);
	free(all);
	return code;
}

/* ---- Tables ---- */

struct bench_table {
	struct bench *bench;
	const char *name, *columns;
	json_t *rows;
	uint32_t commas;
	const struct bench_column *described;
	uint32_t described_count;
};

static uint32_t commas_of(const char *text)
{
	uint32_t count = 0;
	for (; *text; text++)
		count += *text == ',';
	return count;
}

struct bench_table *bench_table_open(struct bench *bench, const char *name, const char *columns, bool show)
{
	struct bench_table *table = calloc(1, sizeof *table);
	if (!table)
		abort();
	json_t *item = json_pack("{s:s, s:s, s:s, s:b, s:[]}", "kind", "table", "name", name, "columns",
		columns, "show", (int)show, "rows");
	*table = (struct bench_table){ bench, json_string_value(json_object_get(item, "name")),
		json_string_value(json_object_get(item, "columns")), json_object_get(item, "rows"),
		commas_of(columns), NULL, 0 };
	/* in the report where it was opened */
	add_item(bench, item);
	return table;
}

void bench_table_row(struct bench_table *table, const char *format, ...)
{
	va_list args;
	va_start(args, format);
	char *text = bench_text(format, args);
	va_end(args);
	assert(commas_of(text) == table->commas);
	json_array_append_new(table->rows, json_string(text));
	free(text);
}

struct bench_table *bench_table_described(struct bench *bench, const char *name, const char *first,
	const struct bench_column *columns, uint32_t count, bool show)
{
	char heads[1024];
	size_t used = (size_t)snprintf(heads, sizeof heads, "%s", first);
	for (uint32_t i = 0; i < count; i++)
		used += (size_t)snprintf(heads + used, sizeof heads - used, ",%s", columns[i].head);
	struct bench_table *table = bench_table_open(bench, name, heads, show);
	table->described = columns;
	table->described_count = count;
	return table;
}

void bench_table_values(struct bench_table *table, const double *values, const char *format, ...)
{
	char cells[1024];
	va_list args;
	va_start(args, format);
	size_t used = (size_t)vsnprintf(cells, sizeof cells, format, args);
	va_end(args);
	for (uint32_t i = 0; i < table->described_count; i++)
		used += (size_t)snprintf(cells + used, sizeof cells - used, ",%.*f",
			(int)table->described[i].decimals, values[i]);
	bench_table_row(table, "%s", cells);
}

/* Names in cells come from files. */
static void write_cells(FILE *out, const char *row)
{
	for (;; row++) {
		char *cell = strndup(row, strcspn(row, ",")), *end = NULL;
		if (cell && (strtod(cell, &end), *end == 0))
			fputs(cell, out);
		else if (cell)
			eco_csv_write_text(out, cell);
		free(cell);
		row += strcspn(row, ",");
		fputc(*row == 0 ? '\n' : ',', out);
		if (*row == 0)
			return;
	}
}

void bench_table_close(struct bench_table *table)
{
	char path[PATH], *bytes = NULL;
	size_t size = 0, i;
	struct eco_error error = { 0 };
	json_t *row;
	FILE *out = open_memstream(&bytes, &size);
	if (!out)
		abort();
	fprintf(out, "%s\n", table->columns);
	json_array_foreach(table->rows, i, row)
		write_cells(out, json_string_value(row));
	fclose(out);
	snprintf(path, sizeof path, "%s/%s.csv", table->bench->out, table->name);
	if (eco_file_write(path, bytes, size, &error))
		bench_note(table->bench, "%s", error.text);
	free(bytes);
	free(table);
}
