/* An even selection of a table's rows, and the different values of a column. */
#include "ecofiles/base/memory.h"
#include "ecofiles/import/places/table_columns.h"

#include <ctype.h>
#include <jansson.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/format/model.h"

static void drop_row(struct eco_table *t, uint32_t row)
{
	for (uint32_t i = 0; i < t->column_count; i++)
		free(t->fields[(size_t)row * t->column_count + i]);
}

/* Every second row leaves. */
static void thin(struct eco_table *t)
{
	for (uint32_t row = 0; row < t->row_count; row++) {
		if (row % 2 == 1) {
			drop_row(t, row);
			continue;
		}
		memmove(t->fields + (size_t)(row / 2) * t->column_count,
			t->fields + (size_t)row * t->column_count, t->column_count * sizeof *t->fields);
		memmove(t->places[row / 2], t->places[row], sizeof *t->places);
	}
	t->row_count = (t->row_count + 1) / 2;
}

static void keep_row(struct eco_table *t, const struct eco_rows *rows)
{
	char **fields = t->fields + (size_t)t->row_count * t->column_count;
	for (uint32_t i = 0; i < t->column_count; i++)
		fields[i] = eco_copy_text(i < rows->field_count ? rows->fields[i] : "");
	for (int k = 0; k < 2; k++)
		t->places[t->row_count][k] = rows->place.kind == ECO_PLACE_POINT ? rows->place.at[k] : NAN;
	t->row_count++;
}

static void begin(struct eco_table *t, const struct eco_rows *rows)
{
	t->has_geometry = rows->has_geometry;
	t->degrees_doubted = rows->degrees_doubted;
	t->crs = rows->crs ? eco_copy_text(rows->crs) : NULL;
	t->columns = eco_alloc(rows->column_count + 1u, sizeof *t->columns);
	t->fields = eco_alloc((size_t)ECO_TABLE_ROWS * (rows->column_count + 1u), sizeof *t->fields);
	t->places = eco_alloc(ECO_TABLE_ROWS, sizeof *t->places);
	for (; t->column_count < rows->column_count; t->column_count++)
		t->columns[t->column_count] = eco_copy_text(rows->columns[t->column_count]);
}

static enum eco_code read_rows(struct eco_table *t, struct eco_rows *rows, struct eco_error *error)
{
	for (uint64_t stride = 1;; t->rows++) {
		bool more = false;
		enum eco_code code = rows->next(rows, &more, error);
		if (code || !more)
			return code;
		if (t->row_count == ECO_TABLE_ROWS) {
			thin(t);
			stride *= 2;
		}
		if (t->rows % stride == 0)
			keep_row(t, rows);
	}
}

enum eco_code eco_table_read(struct eco_table *table, const struct eco_rows_source *source,
	struct eco_error *error)
{
	struct eco_rows *rows = NULL;
	*table = (struct eco_table){ .path = eco_copy_text(source->path) };
	enum eco_code code = eco_rows_open(&rows, source, error);
	if (!code) {
		begin(table, rows);
		code = read_rows(table, rows, error);
	}
	if (!code && table->rows == 0)
		code = eco_fail(error, ECO_BAD_INPUT, "%.300s: it has no rows", source->path);
	for (uint32_t i = 0; rows && i < rows->note_count; i++)
		table->notes[table->note_count++] = eco_copy_text(rows->notes[i]);
	eco_rows_close(rows);
	if (code)
		eco_table_free(table);
	return code;
}

void eco_table_free(struct eco_table *table)
{
	for (uint32_t row = 0; row < table->row_count; row++)
		drop_row(table, row);
	for (uint32_t i = 0; i < table->column_count; i++)
		free(table->columns[i]);
	for (uint32_t i = 0; i < table->note_count; i++)
		free(table->notes[i]);
	free(table->columns);
	free(table->fields);
	free(table->places);
	free(table->crs);
	free(table->path);
	*table = (struct eco_table){ .path = NULL };
}

struct reader {
	struct eco_table_values *values;
	uint32_t capacity;
	json_t *index;               /* text -> index in values */
};

static void add(struct reader *r, const char *text, uint64_t line)
{
	const json_t *known = json_object_get(r->index, text);
	struct eco_table_values *v = r->values;
	if (known) {
		v->items[json_integer_value(known)].rows++;
	} else if (v->count < ECO_TABLE_VALUES_MAX && json_object_set_new(r->index, text, json_integer(v->count)) == 0) {
		eco_grow(&v->items, &r->capacity, v->count, sizeof *v->items);
		v->items[v->count++] = (struct eco_table_value){ .text = eco_copy_text(text), .rows = 1,
			.first_line = line };
	}
}

static void add_field(struct reader *r, const char *field, uint64_t line)
{
	while (isspace((unsigned char)*field))
		field++;
	size_t length = strlen(field);
	while (length > 0 && isspace((unsigned char)field[length - 1]))
		length--;
	char *text = eco_copy_part(field, length);
	add(r, text, line);
	free(text);
}

static int compare(const void *a, const void *b)
{
	const struct eco_table_value *p = a, *q = b;
	if (p->rows != q->rows)
		return p->rows > q->rows ? -1 : 1;
	return p->first_line < q->first_line ? -1 : p->first_line > q->first_line;
}

static enum eco_code read_values(struct reader *r, struct eco_rows *rows, uint32_t column,
	struct eco_error *error)
{
	for (;;) {
		bool more = false;
		enum eco_code code = rows->next(rows, &more, error);
		if (code || !more)
			return code;
		if (column < rows->field_count)
			add_field(r, rows->fields[column], rows->line);
	}
}

enum eco_code eco_table_values_read(struct eco_table_values *values, const struct eco_rows_source *source,
	const char *column, struct eco_error *error)
{
	struct eco_rows_source wanted = *source;
	struct eco_rows *rows = NULL;
	uint32_t at = 0;
	*values = (struct eco_table_values){ .items = NULL };
	wanted.wanted = &column;
	wanted.wanted_count = 1;
	enum eco_code code = eco_rows_open(&rows, &wanted, error);
	struct reader r = { .values = values, .index = json_object() };
	if (!code)
		code = eco_rows_find_column(rows, source->path, column, &at, error);
	if (!code)
		code = read_values(&r, rows, at, error);
	eco_rows_close(rows);
	json_decref(r.index);
	if (code)
		eco_table_values_free(values);
	else
		qsort(values->items, values->count, sizeof *values->items, compare);
	return code;
}

void eco_table_values_free(struct eco_table_values *values)
{
	for (uint32_t i = 0; i < values->count; i++)
		free(values->items[i].text);
	free(values->items);
	*values = (struct eco_table_values){ .items = NULL };
}
