#include "ecofiles/import/places/table_values.h"

#include <ctype.h>
#include <jansson.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/array_grow.h"

struct reader {
	struct eco_table_values *values;
	uint32_t capacity;
	json_t *index;               /* text -> index in values */
};

static enum eco_code add(struct reader *r, const char *text, uint64_t line)
{
	const json_t *known = json_object_get(r->index, text);
	struct eco_table_values *v = r->values;
	if (known) {
		v->items[json_integer_value(known)].rows++;
		return ECO_OK;
	}
	if (v->count == ECO_TABLE_VALUES_MAX)
		return ECO_OK;
	if (!eco_array_grow(&v->items, &r->capacity, v->count, sizeof *v->items)
			|| json_object_set_new(r->index, text, json_integer(v->count)) != 0
			|| !(v->items[v->count].text = strdup(text)))
		return ECO_NO_MEMORY;
	v->items[v->count].rows = 1;
	v->items[v->count++].first_line = line;
	return ECO_OK;
}

static enum eco_code add_field(struct reader *r, const char *field, uint64_t line)
{
	while (isspace((unsigned char)*field))
		field++;
	size_t length = strlen(field);
	while (length > 0 && isspace((unsigned char)field[length - 1]))
		length--;
	char *text = strndup(field, length);
	enum eco_code code = text ? add(r, text, line) : ECO_NO_MEMORY;
	free(text);
	return code;
}

static int compare(const void *a, const void *b)
{
	const struct eco_table_value *p = a, *q = b;
	if (p->rows != q->rows)
		return p->rows > q->rows ? -1 : 1;
	return p->first_line < q->first_line ? -1 : p->first_line > q->first_line;
}

static enum eco_code read_rows(struct reader *r, struct eco_rows *rows, uint32_t column, const char *path,
	struct eco_error *error)
{
	for (;;) {
		bool more = false;
		enum eco_code code = rows->next(rows, &more, error);
		if (code || !more)
			return code;
		if (column < rows->field_count && add_field(r, rows->fields[column], rows->line) != ECO_OK)
			return eco_fail(error, ECO_NO_MEMORY, "%.200s: no memory for its values", path);
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
		code = read_rows(&r, rows, at, source->path, error);
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
