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

static struct table { const char *path; char **fields; size_t *sizes; uint32_t used, count; } kept[TABLES_MAX];
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

size_t cases_size(const char *const *field)
{
	for (const struct table *t = kept; t < kept + tables; t++) {
		uintptr_t first = (uintptr_t)t->fields, at = (uintptr_t)field;
		if (at >= first && at < first + t->used * sizeof *t->fields)
			return t->sizes[(at - first) / sizeof *t->fields];
	}
	eco_end("a text is none of a table of cases");
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
