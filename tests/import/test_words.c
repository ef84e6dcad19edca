/* The tables of words: each column is described, each row is whole, no word stands twice. A fault is told with file
 * and line, for people who add a word. */
#include <glob.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/text.h"
#include "ecofiles/import/model/import_file.h"
#include "ecofiles/import/places/flora.h"
#include "ecofiles/import/places/inventory_text.h"
#include "ecofiles/import/places/table_columns.h"
#include "ecofiles/import/places/words.h"
#include "tests/support/unit_test.h"

#define FIELDS_MAX 8
#define SEEN_BYTES 65536

struct table {
	const char *path;
	unsigned line, rows, columns;
	char comments[4096], names[512], *name[FIELDS_MAX];
	char seen[SEEN_BYTES];       /* "\nkey\tword\n..." */
	char fault[400];             /* the first */
};

__attribute__((format(printf, 2, 3))) static void say(struct table *t, const char *format, ...)
{
	va_list arguments;
	if (t->fault[0])
		return;
	int used = snprintf(t->fault, sizeof t->fault, "%s:%u: ", t->path, t->line);
	va_start(arguments, format);
	vsnprintf(t->fault + used, sizeof t->fault - (size_t)used, format, arguments);
	va_end(arguments);
}

static unsigned split(char *text, char **field)
{
	unsigned count = 0;
	for (char *next = text; next && count < FIELDS_MAX; text = next) {
		next = strchr(text, '\t');
		if (next)
			*next++ = 0;
		field[count++] = text;
	}
	return count;
}

static bool is_one_of(const char *text, const char *const *names, size_t count)
{
	for (size_t i = 0; i < count; i++)
		if (strcmp(text, names[i]) == 0)
			return true;
	return false;
}

/* A list of words, or of phrases with bars between; none of them may be in another row of that key. */
static void check_list(struct table *t, const char *key, char *list, bool phrases)
{
	char folded[ECO_WORDS_BYTES], entry[ECO_WORDS_BYTES];
	for (char *word = strtok(list, phrases ? "|" : " "); word; word = strtok(NULL, phrases ? "|" : " ")) {
		if (phrases)
			eco_text_fold(word, folded, sizeof folded);
		else
			eco_words_of(word, folded, sizeof folded);
		if (strcmp(folded, word) != 0)
			say(t, "\"%s\" is to be written \"%s\"", word, folded);
		snprintf(entry, sizeof entry, "\n%s\t%s\n", key, word);
		if (strstr(t->seen, entry))
			say(t, "\"%s\" stands twice for %s", word, key);
		strncat(t->seen, entry + 1, sizeof t->seen - strlen(t->seen) - 1);
	}
}

static void check_field(struct table *t, const char *name, char *text, const char *key, bool number)
{
	char *end;
	if (*text == 0 || text[0] == ' ' || text[strlen(text) - 1] == ' ')
		say(t, "%s: empty, or with spaces around it", name);
	if (number && (strtod(text, &end), *end != 0))
		say(t, "%s: \"%s\" is no number", name, text);
	if (strcmp(name, "role") == 0 && !is_one_of(text, eco_role_names, ECO_ROLE_COUNT))
		say(t, "no role is \"%s\"", text);
	if (strcmp(name, "form") == 0 && !is_one_of(text, eco_form_names + 1, ECO_FORM_COUNT - 1))
		say(t, "no form is \"%s\"", text);
	if (is_one_of(name, (const char *const[]){ "words", "names", "epithets", "phrases" }, 4))
		check_list(t, key, text, strcmp(name, "phrases") == 0);
}

static void check_row(struct table *t, char *line, bool *number)
{
	char *field[FIELDS_MAX] = { "", "" }, key[200];
	unsigned count = split(line, field);
	if (count != t->columns)
		say(t, "%u fields, %u are named: tabs part them", count, t->columns);
	/* a genus may share a common name with another; a column's word may speak for one role and against another */
	snprintf(key, sizeof key, "%s%s", field[0], field[1][0] == '-' ? " (against)" : "");
	for (unsigned i = 0; i < count && count == t->columns; i++) {
		char *end;
		number[i] |= t->rows == 0 && *field[i] && (strtod(field[i], &end), *end == 0);
		check_field(t, t->name[i], field[i], key, number[i]);
	}
	t->rows++;
}

static void check_names(struct table *t, const char *line)
{
	char described[64];
	snprintf(t->names, sizeof t->names, "%s", line);
	t->columns = split(t->names, t->name);
	for (unsigned i = 0; i < t->columns; i++) {
		snprintf(described, sizeof described, " %s", t->name[i]);
		const char *at = strstr(t->comments, described);
		while (at && !strchr(",:", at[strlen(described)]))
			at = strstr(at + 1, described);
		if (!at)
			say(t, "no comment says what %s is: \"# %s: ...\"", t->name[i], t->name[i]);
	}
}

static const char *fault_of(const char *path, char *text)
{
	static struct table t;
	bool number[FIELDS_MAX] = { false };
	t = (struct table){ .path = path, .seen = "\n" };
	for (char *line = text, *next; line && *line; line = next) {
		next = strchr(line, '\n');
		if (next)
			*next++ = 0;
		t.line++;
		if (!eco_utf8_valid(line, strlen(line)) || strchr(line, '\r'))
			say(&t, "not UTF-8 with line ends of Unix");
		else if (*line == '#')
			strncat(t.comments, line, sizeof t.comments - strlen(t.comments) - 1);
		else if (t.columns == 0)
			check_names(&t, line);
		else
			check_row(&t, line, number);
	}
	return t.fault;
}

UNIT_TEST(tables_of_words_are_whole)
{
	glob_t found;
	char pattern[100];
	snprintf(pattern, sizeof pattern, "%s/*.tsv", "ecofiles/import/places/words");
	assert_int_equal(glob(pattern, 0, NULL, &found), 0);
	assert_true(found.gl_pathc >= 9);
	for (size_t i = 0; i < found.gl_pathc; i++) {
		size_t size;
		uint8_t *bytes = NULL;
		struct eco_error error = { .code = ECO_OK };
		assert_ok(eco_file_read(found.gl_pathv[i], 1 << 20, &bytes, &size, &error), error);
		assert_string_equal(fault_of(found.gl_pathv[i], (char *)bytes), "");
		free(bytes);
	}
	globfree(&found);
}
