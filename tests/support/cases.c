#include "tests/support/cases.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/memory.h"
#include "tests/support/files.h"

#define TEXTS_MAX 32
#define TABLES_MAX 32

/* Returns the bytes behind the last. */
static char *unescape(char *field)
{
	static const char letters[] = "n\nt\tr\r\\\\";
	char *to = field;
	for (char *at = field; *at; at++) {
		const char *letter = *at == '\\' && at[1] ? strchr(letters, at[1]) : NULL;
		if (letter) {
			*to++ = letter[1];
			at++;
		} else if (*at == '\\' && at[1] == 'x') {
			*to++ = (char)strtoul((char[]){ at[2], at[3], 0 }, NULL, 16);
			at += 3;
		} else {
			*to++ = *at;
		}
	}
	*to = 0;
	return to;
}

/* Puts in the texts of ${NAME}; `texts` are names and texts by turns. The line, or another that is allocated. */
static char *expand(char *line, char *const *texts)
{
	char *whole = line, *name, *end;
	while ((name = strstr(whole, "${")) && (end = strchr(name, '}'))) {
		char *const *of = texts, *before = whole;
		for (*end = 0; *of && strcmp(*of, name + 2) != 0; of += 2)
			;
		if (!*of || asprintf(&whole, "%.*s%s%s", (int)(name - before), before, of[1], end + 1) < 0)
			eco_end("a table of cases has no such text");
		if (before != line)
			free(before);
	}
	return whole;
}

static struct table { const char *path; char **fields; size_t *sizes; uint32_t used, count; void *rows; } kept[TABLES_MAX];
static uint32_t tables;

const void *cases_read(const char *path, size_t row_size, uint32_t *count)
{
	for (uint32_t i = 0; i < tables; i++)
		if (strcmp(kept[i].path, path) == 0) {
			*count = kept[i].count;
			return kept[i].fields;
		}
	size_t size, columns = row_size / sizeof(char *), text_count = 0;
	uint32_t capacity = 0, size_capacity = 0;
	struct table *t = &kept[tables];
	char *rest = (char *)file_read(path, &size), *line, *texts[2 * TEXTS_MAX + 2] = { NULL };
	if (tables == TABLES_MAX)
		eco_end("one table of cases too many");
	bool named = false;
	while ((line = strsep(&rest, "\n"))) {
		size_t row = 0;
		if (*line == '%' && text_count < 2 * TEXTS_MAX) {
			texts[text_count++] = strsep(&line, "\t") + 1;
			texts[text_count++] = line;
			continue;
		}
		if (!*line || *line == '#')
			continue;
		line = expand(line, texts);
		for (char *field; (field = strsep(&line, "\t")); row++) {
			bool is_null = strcmp(field, "\\N") == 0;
			if (!named)
				continue;
			eco_grow(&t->fields, &capacity, t->used, sizeof *t->fields);
			eco_grow(&t->sizes, &size_capacity, t->used, sizeof *t->sizes);
			t->sizes[t->used] = (size_t)(unescape(field) - field);
			t->fields[t->used++] = is_null ? NULL : field;
		}
		if (row != columns)
			eco_end("a row of a table of cases has other columns than its test");
		named = true;
	}
	if (!t->used)
		eco_end("a table of cases is empty");
	tables++;
	t->path = path;
	*count = t->count = t->used / (uint32_t)columns;
	return t->fields;
}

static enum eco_code code_named(const char *name)
{
	enum eco_code code = ECO_OK;
	while (code < ECO_CODE_COUNT && strcmp(eco_code_name(code), name) != 0)
		code++;
	if (code == ECO_CODE_COUNT)
		eco_end("a code of a table of cases is none");
	return code;
}

/* Writes a value of its own size, which is returned, or only returns that (to NULL). */
static size_t put_value(char type, const char *text, void *to)
{
	union { const char *s; double d; int i; uint32_t u; size_t z; uint8_t y; bool b; enum eco_code c; } value = { .s = text };
	static const char letters[] = "sdiuzybc";
	const size_t sizes[] = { sizeof value.s, sizeof value.d, sizeof value.i, sizeof value.u, sizeof value.z, 1, sizeof value.b,
		sizeof value.c };
	size_t size = sizes[strchr(letters, type) - letters];
	if (!to)
		return size;
	if (type == 'd')
		value.d = cases_number(text);
	else if (type == 'c')
		value.c = code_named(text);
	else if (type != 's') {
		char *end;
		value.z = strtoull(text, &end, 0);           /* little-endian */
		if (end == text || *end)
			eco_end("a number of a table of cases is none");
	}
	memcpy(to, &value, size);
	return size;
}

const void *cases_rows(const char *path, const char *types, size_t row_size, uint32_t *count)
{
	const char *const *fields = cases_read(path, strlen(types) * sizeof *fields, count);
	struct table *t = kept;
	while (t->path != path && strcmp(t->path, path) != 0)
		t++;
	if (t->rows)
		return t->rows;
	t->rows = eco_alloc(*count, row_size);
	for (uint32_t i = 0; i < *count; i++) {
		size_t at = 0;
		for (const char *type = types; *type; type++, fields++) {
			size_t size = put_value(*type, NULL, NULL);
			at = (at + size - 1) / size * size;
			at += put_value(*type, *fields, (char *)t->rows + i * row_size + at);
		}
		if (at > row_size)
			eco_end("a row of a table of cases is longer than its struct");
	}
	return t->rows;
}

size_t cases_size(const char *const *field)
{
	for (const struct table *t = kept; t < kept + tables; t++) {
		uintptr_t first = (uintptr_t)t->fields, at = (uintptr_t)field;
		if (at >= first && at < first + t->used * sizeof *t->fields)
			return t->sizes[(at - first) / sizeof *t->fields];
	}
	eco_end("a text is none of a table of cases");
}

void cases_write(const char *path, const char *folder)
{
	struct row { const char *file, *text; };
	uint32_t count;
	const struct row *rows = cases_read(path, sizeof *rows, &count);
	for (uint32_t i = 0; i < count; i++) {
		char to[600];
		snprintf(to, sizeof to, "%s/%s", folder, rows[i].file);
		file_write_text(to, rows[i].text);
	}
}

double cases_number(const char *text)
{
	char *end;
	double number = strtod(text, &end);
	if (end == text || *end)
		eco_end("a number of a table of cases is none");
	return number;
}

int cases_choice(const char *text, const char *const *names)
{
	int i = 0;
	while (names[i] && strcmp(names[i], text) != 0)
		i++;
	if (!names[i])
		eco_end("a choice of a table of cases is none");
	return i;
}
