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

/* Puts in the texts of ${NAME}; `texts` are names and texts by turns. */
static char *expand(char *field, char *const *texts)
{
	char *name = strstr(field, "${"), *end = name ? strchr(name, '}') : NULL, *whole = NULL;
	if (!end)
		return field;
	*end = 0;
	for (; *texts && strcmp(*texts, name + 2) != 0; texts += 2)
		;
	if (!*texts || asprintf(&whole, "%.*s%s%s", (int)(name - field), field, texts[1], end + 1) < 0)
		eco_end("a table of cases has no such text");
	return whole;
}

static char *read_field(char *field, char *const *texts)
{
	for (char *next; (next = expand(field, texts)) != field;)
		field = next;
	if (strcmp(field, "\\N") == 0)
		return NULL;
	unescape(field);
	return field;
}

const void *cases_read(const char *path, size_t row_size, uint32_t *count)
{
	static struct { const char *path; char **fields; uint32_t count; } kept[TABLES_MAX];
	static uint32_t tables;
	for (uint32_t i = 0; i < tables; i++)
		if (strcmp(kept[i].path, path) == 0) {
			*count = kept[i].count;
			return kept[i].fields;
		}
	size_t size, columns = row_size / sizeof(char *), text_count = 0;
	uint32_t used = 0, capacity = 0;
	char **fields = NULL, *rest = (char *)file_read(path, &size), *line, *texts[2 * TEXTS_MAX + 2] = { NULL };
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
		for (char *field; (field = strsep(&line, "\t")); row++) {
			if (!named)
				continue;
			eco_grow(&fields, &capacity, used, sizeof *fields);
			fields[used++] = read_field(field, texts);
		}
		if (row && row != columns)
			eco_end("a row of a table of cases has other columns than its test");
		named |= row > 0;
	}
	if (tables == TABLES_MAX || !used)
		eco_end("a table of cases is empty, or one too many");
	*count = kept[tables].count = used / (uint32_t)columns;
	kept[tables].path = path;
	return kept[tables++].fields = fields;
}

size_t cases_bytes(const char *field) { return (size_t)(unescape((char *)(uintptr_t)field) - field); }

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
