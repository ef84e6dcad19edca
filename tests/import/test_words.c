/* Words and texts of inventories: tables of words, names of columns, numbers, sizes and their units. */
#include <glob.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/memory.h"
#include "ecofiles/base/text.h"
#include "ecofiles/generate/library.h"
#include "ecofiles/import/places/flora.h"
#include "ecofiles/import/places/words.h"
#include "ecofiles/import/places/inventory_text.h"
#include "ecofiles/import/places/size_units.h"
#include "ecofiles/import/places/table_columns.h"
#include "tests/support/cases.h"
#include "tests/support/files.h"
#include "tests/support/unit_test.h"

/* ---- Tables of words: each column is described, each row is whole, no word stands twice ---- */

#define FIELDS_MAX 64
#define say(t, format, ...) fail_msg("%s:%u: " format, (t)->path, (t)->line, ##__VA_ARGS__)

struct table {
	const char *path;
	unsigned line, rows, columns;
	char comments[8192], names[512], *name[FIELDS_MAX], first[ECO_WORDS_BYTES];
	char **seen; uint32_t seen_count, seen_capacity;     /* "key\tword" */
};

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
	char folded[ECO_WORDS_BYTES], entry[2 * ECO_WORDS_BYTES];
	bool of_sizes = strstr(t->path, "sizes.tsv") != NULL;
	for (char *word = strtok(list, phrases ? "|" : " "); word; word = strtok(NULL, phrases ? "|" : " ")) {
		if (of_sizes)
			eco_text_fold(word, folded, sizeof folded);
		else
			eco_words_of(word, folded, sizeof folded);
		if (strcmp(folded, word) != 0)
			say(t, "\"%s\" is to be written \"%s\"", word, folded);
		snprintf(entry, sizeof entry, "%s\t%s", key, word);
		eco_grow(&t->seen, &t->seen_capacity, t->seen_count, sizeof *t->seen);
		t->seen[t->seen_count++] = eco_copy_text(entry);
	}
}

static int compare_texts(const void *a, const void *b)
{
	return strcmp(*(const char *const *)a, *(const char *const *)b);
}

static void check_seen(struct table *t)
{
	if (t->seen_count)
		qsort(t->seen, t->seen_count, sizeof *t->seen, compare_texts);
	for (uint32_t i = 1; i < t->seen_count; i++)
		if (strcmp(t->seen[i - 1], t->seen[i]) == 0)
			say(t, "stands twice: %s", t->seen[i]);
	for (uint32_t i = 0; i < t->seen_count; i++)
		free(t->seen[i]);
	free(t->seen);
}

/* "open height quercus robur", and at most 13 values, none below the one before it. */
static void check_curve(const struct table *t, const char *name, const char *text)
{
	const char *plant = strchr(text, ' ') ? strchr(strchr(text, ' ') + 1, ' ') : NULL;
	if (strcmp(name, "curve") == 0) {
		if (!plant || (!eco_flora_of(plant + 1, NULL).genus && !is_one_of(plant + 1, eco_form_names, ECO_FORM_COUNT)))
			say(t, "no plant of genera.tsv in \"%s\"", text);
		return;
	}
	unsigned count = 0;
	double last = 0;
	for (char *end; *text; text = end, count++) {
		double value = strtod(text, &end);
		if (end == text || value < last)
			say(t, "not numbers that rise: \"%s\"", text);
		last = value;
	}
	if (count < 2 || count > 13)
		say(t, "%u values, not 2 to 13", count);
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
	if (strcmp(name, "form") == 0 && !is_one_of(text, eco_form_names + 1, ECO_FORM_COUNT - 1)
			&& !(strcmp(text, "-") == 0 && strstr(t->path, "growth.tsv")))
		say(t, "no form is \"%s\"", text);
	if (text[0] == '#' && (strlen(text) != 7 || strspn(text + 1, "0123456789abcdef") != 6))
		say(t, "no colour is \"%s\"", text);
	if (strcmp(name, "like") == 0 && !is_one_of(text, eco_form_names, ECO_FORM_COUNT))
		say(t, "no form is \"%s\"", text);
	if ((strcmp(name, "habit") == 0 || strcmp(name, "grown") == 0) && strcmp(text, "-") != 0 && !(eco_library_height(text) > 0))
		say(t, "no habit of habits.tsv is \"%s\"", text);
	if (strcmp(name, "leaf") == 0 && !strstr(t->path, "generate") && !is_one_of(text, (const char *const[]){ "evergreen", "deciduous", "-" }, 3))
		say(t, "no leaf is \"%s\"", text);
	if (strcmp(name, "where") == 0 && !is_one_of(text, (const char *const[]){ "all", "always", "whole", "alone", "america",
			"europe", "africa", "asia", "oceania", "for people" }, 9) && !strstr(t->path, "grids.tsv"))
		say(t, "no place is \"%s\"", text);
	if ((strcmp(name, "genus") == 0 || strcmp(name, "taxon") == 0) && !eco_flora_of(text, NULL).genus
			&& !is_one_of(text, eco_form_names, ECO_FORM_COUNT))
		say(t, "no genus of genera.tsv is \"%s\"", text);
	if (strcmp(name, "curve") == 0 || strcmp(name, "values") == 0)
		check_curve(t, name, text);
	if (is_one_of(name, (const char *const[]){ "words", "epithets" }, 2))
		check_list(t, key, text, false);
	if (is_one_of(name, (const char *const[]){ "names", "phrases", "cultivars" }, 3) && strcmp(text, "-") != 0)
		check_list(t, key, text, true);
}

/* Tables that are searched by halves are in the order of their bytes. */
static void check_order(struct table *t, const char *first)
{
	if (strstr(t->path, "genera.tsv") || strstr(t->path, "species.tsv") || strstr(t->path, "curves.tsv")) {
		if (strcmp(t->first, first) >= 0)
			say(t, "%s stands behind %s", first, t->first);
		snprintf(t->first, sizeof t->first, "%s", first);
	}
}

static void check_row(struct table *t, char *line, bool *number)
{
	char *field[FIELDS_MAX] = { "", "" }, key[200];
	unsigned count = split(line, field);
	if (count != t->columns)
		say(t, "%u fields, %u are named: tabs part them", count, t->columns);
	/* a genus may share a common name with another; a column's word may speak for one role and against another */
	bool keyed = strstr(t->path, "names.tsv") || strstr(t->path, "growth.tsv");
	snprintf(key, sizeof key, "%s%s%s%s", field[0], field[1][0] == '-' && !keyed ? " (against)" : "",
		keyed ? field[1] : "", strstr(t->path, "/names.tsv") ? field[2] : "");
	check_order(t, field[0]);
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

static void check_table(const char *path, char *text)
{
	static struct table t;
	bool number[FIELDS_MAX] = { false };
	t = (struct table){ .path = path };
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
	check_seen(&t);
}

UNIT_TEST(tables_of_words_are_whole)
{
	glob_t found;
	assert_int_equal(glob("ecofiles/import/*/words/*.tsv", 0, NULL, &found), 0);
	assert_int_equal(glob("ecofiles/generate/words/*.tsv", GLOB_APPEND, NULL, &found), 0);
	assert_int_equal(glob("ecofiles/base/words/*.tsv", GLOB_APPEND, NULL, &found), 0);
	assert_true(found.gl_pathc >= 16);
	for (size_t i = 0; i < found.gl_pathc; i++) {
		size_t size;
		uint8_t *bytes = file_read(found.gl_pathv[i], &size);
		check_table(found.gl_pathv[i], (char *)bytes);
		free(bytes);
	}
	globfree(&found);
}

/* ---- Names of plants and of columns ---- */

UNIT_TEST(names_become_words)
{
	uint32_t count;
	const char *const (*pairs)[2] = cases_read("tests/import/cases/words.tsv", sizeof *pairs, &count);
	char words[ECO_WORDS_BYTES];
	for (size_t i = 0; i < count; i++) {
		assert_int_equal(eco_words_of(pairs[i][0], words, sizeof words), strlen(pairs[i][1]));
		assert_string_equal(words, pairs[i][1]);
	}
	for (size_t size = 1; size < 20; size++)             /* cut anywhere */
		assert_true(eco_words_of("abc d\u00e9fg 12 hij", words, size) < size);
}

/* ---- Texts of tables, as people write them in several countries ---- */

UNIT_TEST(case_and_spaces_do_not_count)
{
	static const char *const pairs[][2] = { { " Tilia  CORDATA ", "tilia cordata" },
		{ "ÄHRE Öl Über", "ähre öl über" }, { "ÉRABLE", "érable" },
		{ "ДУБ Ёлка", "дуб ёлка" }, { "ΔΡΥΣ", "δρυσ" }, { "ŠŽČ Łódź", "šžč łódź" },
		{ "a\u00a0\u2009b", "a b" }, { "×", "×" },
		{ "Quercus robur 'Fastigiata'", "quercus robur 'fastigiata'" } };
	char folded[64];
	for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++) {
		assert_int_equal(eco_text_fold(pairs[i][0], folded, sizeof folded), strlen(pairs[i][1]));
		assert_string_equal(folded, pairs[i][1]);
	}
	for (size_t size = 1; size < 12; size++) {
		memset(folded, 'x', sizeof folded);
		assert_true(eco_text_fold("Ä b ÜÖ  c", folded, size) < size && strlen(folded) < size
			&& folded[size] == 'x');
	}
}

UNIT_TEST(numbers_have_one_meaning_or_none)
{
	struct number_case { const char *text, *decimal, *number; };

	uint32_t count;
	const struct number_case *cases = cases_read("tests/import/cases/numbers.tsv", sizeof *cases, &count);
	for (const struct number_case *c = cases; c < cases + count; c++) {
		double number = NAN, wanted = cases_number(c->number);
		bool good = eco_text_number(c->text, c->decimal[0], &number);
		if (good == isnan(wanted) || (good && number != wanted))
			fail_msg("\"%s\" with '%s' is %g", c->text, c->decimal, good ? number : NAN);
	}
}

UNIT_TEST(a_sign_between_thousands_may_be_lone)
{
	static const struct { const char *text; char thousands; double number; } cases[] = { { "691,234", ',',
		691234 }, { "5,334,000", ',', 5334000 }, { "691,234.5", ',', 691234.5 }, { "-691.234", '.',
		-691234 }, { "5.334.000,25", '.', 5334000.25 }, { "691", ',', NAN }, { "691,23", ',', NAN },
		{ "0,512", ',', NAN }, { "1234,567", ',', NAN }, { "1,234,56", ',', NAN }, { "1.5,234", ',',
		NAN }, { "691,234", '.', NAN }, { ",234", ',', NAN }, { "1,234m", ',', NAN } };
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		double number = NAN;
		bool good = eco_text_grouped(cases[i].text, cases[i].thousands, &number);
		if (good == isnan(cases[i].number) || (good && number != cases[i].number))
			fail_msg("\"%s\" is %g", cases[i].text, good ? number : NAN);
	}
}

UNIT_TEST(sizes_are_numbers_ranges_and_bounds)
{
	struct size_case { const char *text, *decimal, *form, *number, *unit_m; };

	static const char *const forms[] = { "none", "exact", "range", "open", "stems", NULL };
	uint32_t count;
	const struct size_case *cases = cases_read("tests/import/cases/sizes.tsv", sizeof *cases, &count);
	for (const struct size_case *c = cases; c < cases + count; c++) {
		double number = 0, unit_m = 0;
		enum eco_size_form form = eco_text_size(c->text, c->decimal[0], &number, &unit_m);
		if ((int)form != cases_choice(c->form, forms)
				|| (form != ECO_FORM_NONE && (fabs(number - cases_number(c->number)) > 1e-12
				|| fabs(unit_m - cases_number(c->unit_m)) > 1e-12)))
			fail_msg("\"%s\" is of form %d, %g in units of %g m", c->text, form, number, unit_m);
	}
}

UNIT_TEST(widths_are_means_and_years_stand_in_dates)
{
	static const struct { const char *text; double width, year; } cases[] = { { "6 x 8 m", 7, NAN }, { "6×8", 7, NAN },
		{ "6/8", 7, NAN }, { "7", 7, NAN }, { "1987", 1987, 1987 }, { "12.04.1987", NAN, 1987 }, { "19870412", 19870412, 1987 },
		{ "1987-04-12T00:00:00Z", NAN, 1987 }, { "545184000000", 545184000000, 1987 }, { "昭和62年", NAN, 1987 },
		{ "S62", NAN, 1987 }, { "19870412093000", 19870412093000, 1987 }, { "15041987", 15041987, NAN },
		{ "M500", NAN, NAN }, { "t99999999999", NAN, NAN }, { "20012345", 20012345, NAN }, { "12", 12, NAN }, { "Spring", NAN, NAN } };
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		double width, unit_m, year = eco_text_year(cases[i].text);
		bool good = eco_text_width(cases[i].text, '.', &width, &unit_m) != ECO_FORM_NONE;
		if (good == isnan(cases[i].width) || (good && width != cases[i].width)
				|| isnan(year) != isnan(cases[i].year) || (!isnan(year) && year != cases[i].year))
			fail_msg("\"%s\" is a width of %g, the year %g", cases[i].text, good ? width : NAN, year);
	}
}

/* ---- Units of heights and trunks, by names and by how numbers spread ---- */

UNIT_TEST(a_spread_has_the_quantiles_of_its_stream)
{
	struct eco_spread spread = { 0 };
	assert_true(isnan(eco_spread_quantile(&spread, 0.5)));
	for (int i = 0; i < 100000; i++)
		eco_spread_add(&spread, (i * 7919) % 100000);
	assert_int_equal(spread.seen, 100000);
	assert_true(spread.count <= ECO_SPREAD_KEPT);
	assert_true(fabs(eco_spread_quantile(&spread, 0.5) - 50000) < 1500);
	assert_true(fabs(eco_spread_quantile(&spread, 0.98) - 98000) < 1000);
	eco_spread_free(&spread);
}

struct unit_case { const char *quantity, *name, *beside, *middle, *high, *unit; };

UNIT_TEST(units_are_those_of_plants_or_asked_for)
{
	static const char *const quantities[] = { "height", "dbh", "girth", NULL };
	static const enum eco_quantity quantity_of[] = { ECO_QUANTITY_HEIGHT, ECO_QUANTITY_DBH, ECO_QUANTITY_GIRTH };
	uint32_t count;
	const struct unit_case *cases = cases_read("tests/import/cases/units.tsv", sizeof *cases, &count);
	for (const struct unit_case *c = cases; c < cases + count; c++) {
		const struct eco_size_numbers numbers = { cases_number(c->middle), cases_number(c->high) };
		struct eco_unit_guess guess = eco_unit_guess(quantity_of[cases_choice(c->quantity, quantities)], c->name,
			c->beside, &numbers);
		const char *unit = guess.unit ? guess.unit : "?", *wanted = c->unit ? c->unit : "?";
		if (strcmp(unit, wanted) != 0 || guess.why[0] == 0 || (!guess.unit && !guess.other))
			fail_msg("%s of %s, %s: %s, not %s (%s)", c->name, c->middle, c->high, unit, wanted, guess.why);
	}
}
