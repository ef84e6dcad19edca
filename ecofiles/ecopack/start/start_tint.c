/* Colours by a column: which columns suit, and the one that is asked for. None is taken unasked, as a picture of trees
 * should first look like trees; a note names those that suit. */
#include "ecofiles/base/memory.h"
#include "ecofiles/base/text.h"
#include "ecofiles/ecopack/start/start.h"
#include "ecofiles/import/places/inventory_text.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define VALUES_MOST 40u          /* different ones in the rows looked at: more are names or remarks */
#define SHARE_LEAST 0.5          /* of the values that are stated must be in the palette */
#define NUMBERS_LEAST 0.9        /* of the values are numbers */
#define BREAKS 4u

struct seen { const char *values[VALUES_MOST]; uint32_t count; bool many; struct eco_spread numbers; uint32_t stated; };

static void look(const struct start *s, uint32_t column, struct seen *seen)
{
	*seen = (struct seen){ .count = 0 };
	for (uint32_t row = 0; row < s->table.row_count; row++) {
		const char *text = eco_table_field(&s->table, row, column);
		double number;
		uint32_t i = 0;
		if (eco_text_is_missing(text))
			continue;
		seen->stated++;
		if (eco_text_number(text, s->columns.decimal ? s->columns.decimal : '.', &number))
			eco_spread_add(&seen->numbers, number);
		while (i < seen->count && strcmp(seen->values[i], text) != 0)
			i++;
		seen->many |= i == VALUES_MOST;
		if (i == seen->count && i < VALUES_MOST)
			seen->values[seen->count++] = text;
	}
}

static bool has_numbers(const struct seen *seen)
{
	return seen->stated && (double)seen->numbers.seen >= NUMBERS_LEAST * seen->stated && seen->count > 2;
}

/* NULL: the values are no classes of a palette, and no owners. */
static const char *palette_of(const struct start *s, uint32_t column, const struct seen *seen)
{
	double share;
	const char *fitting = seen->many || has_numbers(seen) ? NULL : eco_tint_fitting(seen->values, seen->count, &share);
	if (fitting && share >= SHARE_LEAST)
		return fitting;
	if (column == s->columns.of[ECO_ROLE_AGE] && has_numbers(seen))
		return "age";
	return !seen->many && seen->count >= 2 && eco_words_any(s->table.columns[column], eco_words_set("owner"))
		? "owner" : NULL;
}

/* Numbers are divided so that classes have as many plants, at round numbers: years are not rounded to millennia. */
static json_t *breaks_json(struct seen *seen)
{
	json_t *breaks = json_array();
	double last = 0, step = 1, part = 1.0 / (BREAKS + 1);
	double span = eco_spread_quantile(&seen->numbers, 1 - part) - eco_spread_quantile(&seen->numbers, part);
	for (; 100 * step <= span; step *= 10) {}
	for (; 10 * step > span && step > 1e-3; step /= 10) {}
	for (uint32_t i = 1; i <= BREAKS; i++) {
		double at = floor(eco_spread_quantile(&seen->numbers, i * part) / step + 0.5) * step;
		if (json_array_size(breaks) == 0 || at > last)
			json_array_append_new(breaks, json_real(last = at));
	}
	return breaks;
}

static void take(struct start *s)
{
	const uint32_t column = s->tint_column;
	struct seen seen;
	char took[160];
	look(s, column, &seen);
	const char *palette = palette_of(s, column, &seen);
	bool numbers = has_numbers(&seen);
	palette = palette ? palette : numbers ? "age" : "owner";
	s->tint = json_pack("{s:s, s:s}", "column", s->table.columns[column], "palette", palette);
	if (numbers)
		json_object_set_new(s->tint, "breaks", breaks_json(&seen));
	eco_spread_free(&seen.numbers);
	snprintf(took, sizeof took, "\"%.60s\" in the colours of \"%s\"", s->table.columns[column], palette);
	start_guess(s, "tint", took, "\"tint\" in the scene", "%s", numbers ? "numbers, in classes of about as many rows"
		: strcmp(palette, "owner") == 0 ? "its values, the commonest first" : "its values are classes of this palette");
}

static void propose(struct start *s)
{
	char suit[200] = "", one[100];
	for (uint32_t i = 0; i < s->table.column_count; i++) {
		struct seen seen;
		look(s, i, &seen);
		const char *palette = i == s->columns.of[ECO_ROLE_SPECIES] ? NULL : palette_of(s, i, &seen);
		eco_spread_free(&seen.numbers);
		if (!palette)
			continue;
		snprintf(one, sizeof one, "\"%.60s\" (%s)", s->table.columns[i], palette);
		eco_phrase_add(suit, sizeof suit, one);
	}
	if (*suit)
		start_guess(s, "tint", "none", "--tint COLUMN", "plants keep their own colours; columns that could colour them: %s",
			suit);
}

void start_tint(struct start *s)
{
	if (s->tint_column != ECO_NONE)
		take(s);
	else
		propose(s);
}
