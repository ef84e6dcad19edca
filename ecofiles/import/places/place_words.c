#include "ecofiles/import/places/place_words.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "build/words/crs_names.table"
#include "ecofiles/format/model.h"
#include "ecofiles/import/places/inventory_text.h"
#include "ecofiles/import/places/table_values.h"

/* Words of a column's name that a CRS's name may have, too: without the axis and the unit. A letter behind a
 * number is a zone's half, "32 n". */
static void hint_of(const char *name, char *hint, size_t size)
{
	char words[ECO_WORDS_BYTES], word[ECO_WORD_BYTES];
	bool after_number = false;
	size_t used = 0;
	eco_words_of(name, words, sizeof words);
	hint[0] = 0;
	for (const char *at = words; eco_words_next(&at, word);) {
		bool half = after_number && (strcmp(word, "n") == 0 || strcmp(word, "s") == 0);
		after_number = word[0] >= '0' && word[0] <= '9';
		if ((half || !eco_words_have(eco_words_set("axis"), word)) && used + strlen(word) + 2 < size)
			used += (size_t)snprintf(hint + used, size - used, "%s%s", used > 0 ? " " : "", word);
	}
}

bool eco_place_hint(const char *const names[2], char hint[ECO_WORDS_BYTES])
{
	char other[ECO_WORDS_BYTES];
	if (!names[0] || !names[1])
		return false;
	hint_of(names[0], hint, ECO_WORDS_BYTES);
	hint_of(names[1], other, sizeof other);
	if (strcmp(hint, other) != 0 || hint[0] == 0)
		return false;
	for (size_t i = 0; i < sizeof crs_names_rows / sizeof *crs_names_rows; i++)
		if (strcmp(hint, crs_names_rows[i].brief) == 0)
			snprintf(hint, ECO_WORDS_BYTES, "%s", crs_names_rows[i].name);
	return true;
}

/* ---- A column of zones ---- */

enum kind { NO_ZONES, ZONES, UTM_ZONES, CODES };

static enum kind kind_of(const char *name)
{
	char words[ECO_WORDS_BYTES], word[ECO_WORD_BYTES];
	bool utm = false, zone = false, code = false, other = false;
	eco_words_of(name, words, sizeof words);
	for (const char *at = words; eco_words_next(&at, word);) {
		bool is_utm = eco_words_have(eco_words_set("utm"), word);
		bool is_zone = eco_words_have(eco_words_set("zone"), word);
		bool is_code = eco_words_have(eco_words_set("crs"), word);
		utm |= is_utm;
		zone |= is_zone;
		code |= is_code;
		other |= !is_utm && !is_zone && !is_code && !eco_words_have(eco_words_set("number"), word);
	}
	if (other || (!zone && !code))
		return NO_ZONES;
	return code ? CODES : utm ? UTM_ZONES : ZONES;
}

/* A letter behind the number is a half, or a band of 8 degrees from C at 80 south to X. */
static bool read_half(const char *text, enum eco_zone_half *half)
{
	text += strspn(text, " ");
	*half = ECO_HALF_OPEN;
	if (*text == 0)
		return true;
	if (strcmp(text, "s") == 0)
		*half = ECO_HALF_S;
	else if (strcmp(text, "south") == 0 || (text[1] == 0 && strchr("cdefghjklm", *text)))
		*half = ECO_HALF_SOUTH;
	else if (strcmp(text, "north") == 0 || (text[1] == 0 && strchr("npqrtuvwx", *text)))
		*half = ECO_HALF_NORTH;
	return *half != ECO_HALF_OPEN;
}

static bool read_zone(const char *text, enum kind kind, struct eco_zone *zone)
{
	char folded[24], *end;
	const char *at = folded;
	*zone = (struct eco_zone){ .number = 0 };
	if (eco_text_fold(text, folded, sizeof folded) + 1 >= sizeof folded)
		return false;
	bool code = strncmp(at, "epsg:", 5) == 0;
	at += code ? 5 : 0;
	for (size_t i = 0; i < 2; i++)
		if (strncmp(at, i ? "zone" : "utm", i ? 4 : 3) == 0)
			at += i ? 4 : 3, at += strspn(at, " ");
	if (strspn(at, "0123456789") == 0 || strlen(at) > 9)
		return false;
	uint32_t number = (uint32_t)strtoul(at, &end, 10);
	if ((code || kind == CODES) && *end == 0)
		zone->epsg = number;
	else
		zone->number = number;
	return zone->epsg > 1000 || (zone->number >= 1 && zone->number <= 60 && read_half(end, &zone->half));
}

static bool are_same(const struct eco_zone *a, const struct eco_zone *b)
{
	return a->epsg == b->epsg && a->number == b->number && a->half == b->half;
}

/* Whether each filled text of a column is a zone. */
static bool are_zones(const struct eco_table_values *values, enum kind kind, bool utm,
	struct eco_zones *zones)
{
	bool any = false;
	for (uint32_t i = 0; i < values->count; i++) {
		const char *text = values->items[i].text;
		struct eco_zone zone;
		if (eco_text_is_missing(text))
			continue;
		if (!read_zone(text, kind, &zone) || (kind == ZONES && !utm && !zone.epsg && !zone.half))
			return false;
		if (!any)
			zones->zone = zone;
		if (!any || (zones->other[0] == 0 && !are_same(&zone, &zones->zone)))
			snprintf(any ? zones->other : zones->first, sizeof zones->first, "%.23s", text);
		any = true;
	}
	return any;
}

enum eco_code eco_zones_find(const struct eco_table *table, const struct eco_rows_source *source, bool utm,
	struct eco_zones *zones, struct eco_error *error)
{
	bool found = false;
	for (uint32_t i = 0; i < table->column_count && !found; i++) {
		enum kind kind = kind_of(table->columns[i]);
		struct eco_table_values values = { .items = NULL };
		enum eco_code code = kind == NO_ZONES ? ECO_OK
			: eco_table_values_read(&values, source, table->columns[i], error);
		if (code)
			return code;
		*zones = (struct eco_zones){ .column = i };
		found = are_zones(&values, kind, utm, zones);
		eco_table_values_free(&values);
	}
	if (!found)
		*zones = (struct eco_zones){ .column = ECO_NONE };
	return ECO_OK;
}
