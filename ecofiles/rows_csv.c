/* CSV, one byte at a time through stdio's buffer: a row is collected in one growing block, fields are offsets into it. */
#include "ecofiles/rows.h"

#include <errno.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct csv {
	struct eco_rows rows;
	FILE *file;
	char *path, separator;
	char *text;
	size_t used, capacity;
	size_t *start;               /* of each field in text */
	uint64_t line;               /* of the next byte */
};

static enum eco_code put(struct csv *csv, char c, struct eco_error *error)
{
	if (csv->used == csv->capacity) {
		size_t capacity = csv->capacity == 0 ? 4096 : csv->capacity * 2;
		char *grown;

		if (csv->used >= ECO_ROW_BYTES_MAX)
			return eco_fail(error, ECO_TOO_LARGE, "%.300s:%llu: a row of more than %u bytes; is a quote not closed?", csv->path,
				(unsigned long long)csv->rows.line, ECO_ROW_BYTES_MAX);
		grown = realloc(csv->text, capacity);
		if (grown == NULL)
			return eco_fail(error, ECO_NO_MEMORY, "%.300s: out of memory", csv->path);
		csv->text = grown;
		csv->capacity = capacity;
	}
	csv->text[csv->used++] = c;
	return ECO_OK;
}

static int get(struct csv *csv)
{
	int c = getc_unlocked(csv->file);

	csv->line += c == '\n';
	return c;
}

static int peek(struct csv *csv)
{
	int c = getc_unlocked(csv->file);

	ungetc(c, csv->file);
	return c;
}

static enum eco_code begin_field(struct csv *csv, struct eco_error *error)
{
	if (csv->rows.field_count == ECO_COLUMNS_MAX)
		return eco_fail(error, ECO_TOO_LARGE, "%.300s:%llu: a row of more than %u fields", csv->path, (unsigned long long)csv->rows.line,
			ECO_COLUMNS_MAX);
	csv->start[csv->rows.field_count++] = csv->used;
	return ECO_OK;
}

/* One field; *c is the byte after it: separator, '\n' or EOF. */
static enum eco_code read_field(struct csv *csv, int *c, struct eco_error *error)
{
	bool quoted = false;
	enum eco_code code = begin_field(csv, error);

	*c = get(csv);
	if (*c == '"') {
		quoted = true;
		*c = get(csv);
	}
	for (; code == ECO_OK && *c != EOF; *c = get(csv)) {
		if (*c == 0)
			return eco_fail(error, ECO_BAD_INPUT, "%.300s:%llu: a zero byte; the file is not plain text (a spreadsheet, UTF-16?), save it as CSV in UTF-8", csv->path,
				(unsigned long long)csv->line);
		if (quoted && *c == '"') {
			if (peek(csv) == '"')
				code = put(csv, (char)get(csv), error);
			else
				quoted = false;
			continue;
		}
		if (!quoted && (*c == csv->separator || *c == '\n'))
			break;
		if (!quoted && *c == '\r' && peek(csv) == '\n')
			continue;
		code = put(csv, (char)*c, error);
	}
	if (code == ECO_OK && quoted)
		return eco_fail(error, ECO_DAMAGED, "%.300s:%llu: a quoted field of the row that begins here does not end", csv->path,
			(unsigned long long)csv->rows.line);
	return code == ECO_OK ? put(csv, 0, error) : code;
}

static enum eco_code read_row(struct csv *csv, bool *more, struct eco_error *error)
{
	int c = '\n';

	csv->used = 0;
	csv->rows.field_count = 0;
	while ((c = peek(csv)) == '\n' || c == '\r')
		get(csv);
	*more = c != EOF;
	csv->rows.line = csv->line;
	while (*more) {
		enum eco_code code = read_field(csv, &c, error);

		if (code != ECO_OK)
			return code;
		if (c != csv->separator)
			break;
	}
	if (ferror(csv->file))
		return eco_fail(error, ECO_IO, "%.300s: %s", csv->path, strerror(errno));
	for (uint32_t i = 0; i < csv->rows.field_count; i++)
		csv->rows.fields[i] = csv->text + csv->start[i];
	return ECO_OK;
}

static enum eco_code next(struct eco_rows *rows, bool *more, struct eco_error *error)
{
	enum eco_code code = read_row((struct csv *)rows, more, error);

	rows->row += code == ECO_OK && *more;
	return code;
}

static void close_csv(struct eco_rows *rows)
{
	struct csv *csv = (struct csv *)rows;

	for (uint32_t i = 0; i < rows->column_count; i++)
		free(rows->columns[i]);
	free(rows->columns);
	free(rows->fields);
	free(csv->start);
	free(csv->text);
	free(csv->path);
	if (csv->file != NULL)
		fclose(csv->file);
	free(csv);
}

/* Without the spaces around it, malloc'ed. */
static char *trimmed(const char *name)
{
	size_t size;

	name += strspn(name, " \t\r");
	size = strlen(name);
	while (size > 0 && strchr(" \t\r", name[size - 1]) != NULL)
		size--;
	return strndup(name, size);
}

static enum eco_code read_header(struct csv *csv, struct eco_error *error)
{
	bool more;
	enum eco_code code;
	int c = peek(csv);

	if (c == 0xef) {                     /* a byte order mark in UTF-8 */
		char mark[3];

		if (fread(mark, 1, 3, csv->file) != 3 || memcmp(mark, "\xef\xbb\xbf", 3) != 0)
			rewind(csv->file);
	}
	code = read_row(csv, &more, error);
	if (code == ECO_OK && !more)
		return eco_fail(error, ECO_BAD_INPUT, "%.300s: an empty file; its first row must name the columns", csv->path);
	for (uint32_t i = 0; code == ECO_OK && i < csv->rows.field_count; i++) {
		csv->rows.columns[i] = trimmed(csv->rows.fields[i]);
		if (csv->rows.columns[i] == NULL)
			return eco_fail(error, ECO_NO_MEMORY, "%.300s: out of memory", csv->path);
		csv->rows.column_count++;
	}
	return code;
}

enum eco_code eco_rows_open_csv(struct eco_rows **rows, const char *path, char separator, struct eco_error *error)
{
	struct csv *csv = calloc(1, sizeof *csv);
	enum eco_code code;

	_Static_assert(offsetof(struct csv, rows) == 0, "struct eco_rows is the start of struct csv");
	*rows = NULL;
	if (csv == NULL)
		return eco_fail(error, ECO_NO_MEMORY, "%.300s: out of memory", path);
	csv->rows.next = next;
	csv->rows.close = close_csv;
	csv->separator = separator != 0 ? separator : ',';
	csv->line = 1;
	csv->path = strdup(path);
	csv->rows.columns = calloc(ECO_COLUMNS_MAX, sizeof *csv->rows.columns);
	csv->rows.fields = calloc(ECO_COLUMNS_MAX, sizeof *csv->rows.fields);
	csv->start = calloc(ECO_COLUMNS_MAX, sizeof *csv->start);
	if (csv->path == NULL || csv->rows.columns == NULL || csv->rows.fields == NULL || csv->start == NULL)
		code = eco_fail(error, ECO_NO_MEMORY, "%.300s: out of memory", path);
	else if ((csv->file = fopen(path, "rb")) == NULL)
		code = eco_fail(error, errno == ENOENT ? ECO_NOT_FOUND : ECO_IO, "%s: %s", path, strerror(errno));
	else
		code = read_header(csv, error);
	if (code == ECO_OK)
		*rows = &csv->rows;
	else
		close_csv(&csv->rows);
	return code;
}

enum eco_code eco_rows_open(struct eco_rows **rows, const struct eco_positions_spec *spec, struct eco_error *error)
{
	return eco_rows_open_csv(rows, spec->path, spec->separator, error);
}

void eco_rows_close(struct eco_rows *rows)
{
	if (rows != NULL)
		rows->close(rows);
}
