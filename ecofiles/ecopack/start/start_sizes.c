/* The sizes of a table's plants: which columns say them, in which units, and which rows have no plant. */
#include "ecofiles/ecopack/start/start.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <time.h>

#include "ecofiles/base/memory.h"
#include "ecofiles/base/text.h"
#include "ecofiles/import/places/inventory_text.h"

/* ---- Units ---- */

#define GAP 4.0                  /* between usual values and those of another unit */

/* The lower values decide over a column with values in two units, as metres and centimetres: shares of the rows. */
static const double lower[] = { 0.9, 0.75, 0.6 };

/* Outside America sizes are metric, if nothing says otherwise. */
static const char *system_of(const struct start *s, const char *beside)
{
	enum eco_region region = eco_region_of(s->place.degrees[0], s->place.degrees[1]);
	return beside || region == ECO_REGION_UNKNOWN || region == ECO_REGION_AMERICA ? beside : "m";
}

/* Leaves the unit NULL where it has to be asked for. A few values in another unit do not hide the right one. */
static void guess_unit(struct start_size *size, enum eco_quantity quantity, const char *name, const char *beside,
	struct eco_spread *spread)
{
	struct eco_size_numbers numbers = { eco_spread_quantile(spread, 0.5), eco_spread_quantile(spread, 0.98) };
	static const char *const says[] = { "height", "trunk", "trunk", "crown" };
	size->unit = eco_unit_guess(quantity, name, beside, &numbers);
	for (size_t i = 0; i < sizeof lower / sizeof *lower && !size->unit.unit && !size->unit.by_name; i++) {
		struct eco_size_numbers most = { eco_spread_quantile(spread, 0.5 * lower[i]),
			eco_spread_quantile(spread, lower[i]) };
		struct eco_unit_guess again = eco_unit_guess(quantity, name, beside ? beside : "m", &most);
		if (!again.unit || numbers.high < GAP * most.high)
			continue;
		size->unit = again;
		snprintf(size->unit.why, sizeof size->unit.why, "%.0f %% of them are below %.4g; some are up to %.4g, which is "
			"no %s in %s", 100 * lower[i], most.high, numbers.high, says[quantity], again.unit);
	}
}

static void measure(struct start *s, struct start_size *size, enum eco_quantity quantity,
	const char *given, const char *beside)
{
	const char *name = start_column(s, size->column);
	struct eco_spread spread = { 0 };
	double own_unit = 0;
	eco_table_spread(&s->table, size->column, &s->columns, &spread, &own_unit);
	bool any = spread.count > 0;
	size->share = (double)spread.seen / s->table.row_count;
	size->median = any ? eco_spread_quantile(&spread, 0.5) : 0;
	if (!any && own_unit == 0)
		size->column = ECO_NONE;         /* nothing in it */
	else if (given)
		size->unit = (struct eco_unit_guess){ .unit = given, .why = "as you say" };
	else if (own_unit > 0.5)
		size->unit = (struct eco_unit_guess){ .unit = "m", .why = "most values say theirs, which counts" };
	else
		guess_unit(size, quantity, name, system_of(s, beside), &spread);
	eco_spread_free(&spread);
}

static void ask_unit(const struct start *s, const struct start_size *size, const char *option)
{
	if (size->column != ECO_NONE && !size->unit.unit)
		eco_stop(ECO_BAD_INPUT, "%.120s: in which unit is \"%.40s\"? %s; say %s (one of " ECO_UNITS ")",
			s->options->table, start_column(s, size->column), size->unit.why, option);
}

static void say_size(struct start *s, const struct start_size *size, enum eco_role role,
	const char *column, const char *unit)
{
	char took[120], change[64];
	if (size->column == ECO_NONE)
		return;
	snprintf(took, sizeof took, "\"%.60s\" in %s", start_column(s, size->column), size->unit.unit);
	snprintf(change, sizeof change, "%s, %s", column, unit);
	start_guess(s, eco_role_names[role], took, change, "%s", size->unit.why);
}

/* ---- Numbers of size classes ---- */

#define CLASSES_MOST 16u
#define CLASSES_LEAST_ROWS 8u

/* Whether each whole number of a column of few has one text beside it that is a size, "11-15 m". */
static bool are_classes(const struct start *s, uint32_t codes, uint32_t texts)
{
	uint32_t first[CLASSES_MOST], count = 0, sizes = 0, filled = 0;
	for (uint32_t row = 0; row < s->table.row_count; row++) {
		const char *code = eco_table_field(&s->table, row, codes), *text = eco_table_field(&s->table, row, texts);
		double number, unit_m;
		if (eco_text_is_missing(code) || eco_text_is_missing(text))
			continue;
		if (strspn(code, "0123456789") != strlen(code))
			return false;
		uint32_t i = 0;
		while (i < count && strcmp(eco_table_field(&s->table, first[i], codes), code) != 0)
			i++;
		if (i == CLASSES_MOST || (i < count && strcmp(eco_table_field(&s->table, first[i], texts), text) != 0))
			return false;
		if (i == count)
			first[count++] = row;
		enum eco_size_form form = eco_text_size(text, s->columns.decimal, &number, &unit_m);
		sizes += form == ECO_FORM_RANGE || form == ECO_FORM_OPEN;
		filled++;
	}
	return filled >= CLASSES_LEAST_ROWS && 2 * count <= filled && 10 * sizes >= 8 * filled;
}

/* Takes the texts of a column that holds numbers of classes. */
static void pass_codes(struct start *s, enum eco_role role)
{
	uint32_t *column = &s->columns.of[role];
	char took[120];
	for (uint32_t i = 0; *column != ECO_NONE && i < s->table.column_count; i++) {
		if (i == *column || !are_classes(s, *column, i))
			continue;
		snprintf(took, sizeof took, "\"%.60s\" holds numbers of classes", start_column(s, *column));
		start_guess(s, eco_role_names[role], took, "", "each has one text in \"%.60s\", which is taken",
			s->table.columns[i]);
		*column = i;
		return;
	}
}

/* ---- Diameters of crowns ---- */

#define ALIKE 0.2                /* a girth is pi times the diameter within this share, but for the unit */
#define ALIKE_ROWS 0.7           /* in so many rows */
#define ALIKE_LEAST 5u           /* rows that have both */

/* A diameter that does not follow from the girth beside it is no trunk's, but the crown's: "DIAMETRE_C". */
static void check_diameter(struct start *s)
{
	uint32_t *diameter = &s->columns.of[ECO_ROLE_DBH], *crown = &s->columns.of[ECO_ROLE_CROWN], both = 0, alike = 0;
	const uint32_t girth = s->columns.of[ECO_ROLE_GIRTH];
	char took[120];
	for (uint32_t row = 0; *diameter != ECO_NONE && girth != ECO_NONE && row < s->table.row_count; row++) {
		double d, g, unit_m;
		if (eco_text_size(eco_table_field(&s->table, row, *diameter), s->columns.decimal, &d, &unit_m) == ECO_FORM_NONE
				|| eco_text_size(eco_table_field(&s->table, row, girth), s->columns.decimal, &g, &unit_m)
				== ECO_FORM_NONE || !(d > 0 && g > 0))
			continue;
		double ratio = g / (M_PI * d);
		for (; ratio > 3; ratio /= 10) {}
		for (; ratio < 0.3; ratio *= 10) {}
		alike += ratio > 1 - ALIKE && ratio < 1 + ALIKE;
		both++;
	}
	if (both < ALIKE_LEAST || alike >= ALIKE_ROWS * both)
		return;
	snprintf(took, sizeof took, "\"%.60s\" is none of the trunk's", start_column(s, *diameter));
	start_guess(s, eco_role_names[ECO_ROLE_DBH], took, "--dbh-column", "it does not follow from the girth in \"%.60s\"",
		start_column(s, girth));
	*crown = *crown == ECO_NONE ? *diameter : *crown;
	*diameter = ECO_NONE;
}

#define SLENDER_MOST 85.0        /* heights over diameters of trees in the open are far below, those of dense stands about it */
#define SLENDER_USUAL 60.0

/* Trunks too thin for their heights may be girths in another unit, by their numbers: said, and left to the user. */
static void doubt_diameter(struct start *s)
{
	struct eco_spread slender = { 0 };
	double unit_m, own_unit, height, trunk, height_m = 1;
	if (s->trunk_is_girth || s->trunk.column == ECO_NONE || s->height.column == ECO_NONE || s->trunk.unit.by_name)
		return;
	eco_unit_metres(s->trunk.unit.unit, &unit_m);
	eco_unit_metres(s->height.unit.unit, &height_m);
	for (uint32_t row = 0; row < s->table.row_count; row++)
		if (eco_text_size(eco_table_field(&s->table, row, s->height.column), s->columns.decimal, &height, &own_unit)
				!= ECO_FORM_NONE && eco_text_size(eco_table_field(&s->table, row, s->trunk.column), s->columns.decimal,
				&trunk, &own_unit) != ECO_FORM_NONE && height > 0 && trunk > 0)
			eco_spread_add(&slender, height * height_m / (trunk * unit_m));
	double is = eco_spread_quantile(&slender, 0.5), girth = is * unit_m / 0.01 * M_PI;
	if (slender.count >= ALIKE_LEAST && is > SLENDER_MOST && girth < SLENDER_USUAL)
		start_guess(s, "trunk diameter", "may be a girth", "--girth-column", "half of the plants are more than %.0f times as high as "
			"\"%.60s\" in %s; if it is a girth in cm, %.0f times", is, start_column(s, s->trunk.column), s->trunk.unit.unit, girth);
	eco_spread_free(&slender);
}

/* ---- Treetops of laser scans ---- */

#define TREETOP_LEAST_M 1.3
#define TREETOP_MOST_M 90.0

/* "Z", "z_max", "VALUE": words for the value of a canopy's height alone. */
static bool is_treetop(const char *name)
{
	char words[ECO_WORDS_BYTES], word[ECO_WORD_BYTES];
	eco_words_of(name, words, sizeof words);
	bool all = words[0] != 0 && strcmp(name, ECO_COLUMN_GEOMETRY) != 0;
	for (const char *at = words; all && eco_words_next(&at, word);)
		all = eco_words_have(eco_words_set("treetop"), word);
	return all;
}

/* Z of a table that says no species and no other size: heights above the ground, unless they are elevations. */
static void take_treetops(struct start *s)
{
	uint32_t z = 0, others = s->columns.of[ECO_ROLE_HEIGHT] & s->columns.of[ECO_ROLE_DBH]
		& s->columns.of[ECO_ROLE_GIRTH] & s->columns.of[ECO_ROLE_SPECIES] & s->columns.of[ECO_ROLE_AGE];
	struct eco_spread spread = { 0 };
	double own_unit;
	while (z < s->table.column_count && !is_treetop(s->table.columns[z]))
		z++;
	if (z == s->table.column_count)          /* then that of the points, the last column */
		z -= s->table.has_z;
	if (others != ECO_NONE || z == s->table.column_count)
		return;
	eco_table_spread(&s->table, z, &s->columns, &spread, &own_unit);
	double low = eco_spread_quantile(&spread, 0.02), high = eco_spread_quantile(&spread, 0.98);
	bool any = spread.count > 0;
	eco_spread_free(&spread);
	bool elevations = !(low >= TREETOP_LEAST_M && high <= TREETOP_MOST_M);
	if (!any || (elevations && strcmp(s->table.columns[z], ECO_COLUMN_GEOMETRY) == 0))
		return;
	if (elevations)
		eco_stop(ECO_BAD_INPUT, "%.150s: \"%.20s\" is between %.4g and %.4g: heights of trees, or elevations of "
			"treetops above the sea? Give --height-column %.20s and --height-unit if they are heights; else "
			"normalise the cloud, or remove the column", s->options->table, s->table.columns[z], low, high,
			s->table.columns[z]);
	s->columns.of[ECO_ROLE_HEIGHT] = z;
	s->height_is_z = true;
}

/* ---- Crowns ---- */

/* The column whose name differs from `words` in one word alone, which is of the set; ECO_NONE: none. */
static uint32_t twin_of(const struct start *s, const char *words, const char *at, const char *set)
{
	const char *tail = at + strcspn(at, " ");
	for (uint32_t i = 0; i < s->table.column_count; i++) {
		char own[ECO_WORDS_BYTES], word[ECO_WORD_BYTES];
		const char *next = own + (at - words);
		eco_words_of(s->table.columns[i], own, sizeof own);
		if (strncmp(own, words, (size_t)(at - words)) == 0 && eco_words_next(&next, word) && eco_words_have(set, word)
				&& strcmp(next, tail) == 0)
			return i;
	}
	return ECO_NONE;
}

/* Radii in four directions, "crown_n", "crown_e", "crown_s", "crown_w", or widths in two, "crown_1_m", "crown_2_m". */
static void find_several(struct start *s)
{
	static const char *const sets[][ECO_CROWN_COLUMNS] = { { "n north nord norte noord", "e east ost est este oost",
		"s south sud sur zuid", "w west ouest oeste ovest" }, { "ns nsm nordsud norte 1 a max long longest major gross",
		"ew ewm ow we ostwest 2 b min short shortest minor klein" } };
	for (uint32_t i = 0; i < 2 * s->table.column_count && s->crown_columns == 0; i++) {
		const char *const *set = sets[i % 2];
		char words[ECO_WORDS_BYTES], word[ECO_WORD_BYTES], stem[ECO_WORDS_BYTES];
		eco_words_of(s->table.columns[i / 2], words, sizeof words);
		for (const char *at = words, *next = at; eco_words_next(&next, word) && s->crown_columns == 0; at = next + 1) {
			uint32_t count = 0;
			snprintf(stem, sizeof stem, "%.*s%s", (int)(at - words), words, next);
			if (!eco_words_have(set[0], word) || !((i % 2 == 0 && (eco_column_says(stem, "radius")
					|| eco_words_any(stem, "r cr"))) || eco_column_points(ECO_ROLE_CROWN, stem) >= ECO_COLUMN_ENOUGH))
				continue;
			for (; count < ECO_CROWN_COLUMNS && set[count]; count++)
				if ((s->crowns[count] = twin_of(s, words, at, set[count])) == ECO_NONE
						&& (s->crowns[count] = set[2] ? twin_of(s, words, at, "o") : ECO_NONE) == ECO_NONE)
					break;           /* "o" is the east in German, the west in French */
			bool all = count == ECO_CROWN_COLUMNS ? s->crowns[1] != s->crowns[3] : count == 2 && !set[2];
			s->crown_columns = all ? count : 0;
		}
	}
}

#define CROWN_AREA_M 60.0        /* wider polygons are stands, for a scatter */

/* "canopy_m2", "crown area"; "crown_dim2" is a second width. */
static bool says_area(const char *name)
{
	char words[ECO_WORDS_BYTES];
	eco_words_of(name, words, sizeof words);
	return eco_column_says(name, "area") || strstr(words, " m 2") || strstr(words, " ft 2") || strstr(name, "m\u00b2")
		|| strstr(name, "ft\u00b2") || eco_words_any(name, "sqm qm sqft sq");
}

static void find_crowns(struct start *s)
{
	const char *beside = s->height.column != ECO_NONE ? s->height.unit.unit
		: s->trunk.column != ECO_NONE ? s->trunk.unit.unit : NULL;
	char took[160];
	find_several(s);
	s->crown.column = s->crown_columns > 0 ? s->crowns[0] : s->columns.of[ECO_ROLE_CROWN];
	s->crown_is_area = s->crown_columns == 0 && s->crown.column != ECO_NONE && says_area(s->table.columns[s->crown.column]);
	for (uint32_t i = 0; i < s->table.column_count && s->crown.column == ECO_NONE; i++) {
		s->crown_is_area = says_area(s->table.columns[i]) && eco_column_says(s->table.columns[i], "crown");
		s->crown.column = s->crown_is_area ? i : ECO_NONE;
	}
	if (s->table.crown_m > CROWN_AREA_M)
		eco_stop(ECO_BAD_INPUT, "%.150s: its rows are areas, half of them more than %.0f m wide: no crowns. A "
			"\"scatter\" of a scene fills areas with plants", s->options->table, s->table.crown_m);
	if (s->table.crown_m > 0) {
		snprintf(took, sizeof took, "polygons: half are more than %.3g m wide", s->table.crown_m);
		start_guess(s, "crowns", took, "\"crown_m\" in the scene", "each is taken for the crown of a plant in its "
			"middle");
	}
	if (s->crown.column == ECO_NONE)
		return;
	const char *name = start_column(s, s->crown.column);
	s->crown_is_radius = s->crown_columns == ECO_CROWN_COLUMNS || eco_column_says(name, "radius");
	const char *unit = eco_unit_of_name(name);
	measure(s, &s->crown, ECO_QUANTITY_CROWN, !s->crown_is_area ? NULL : unit ? unit : beside && strcmp(beside, "ft") == 0
		? "ft" : "m", beside);
	if (s->crown.column == ECO_NONE)
		return;
	if (s->crown_is_area)
		snprintf(s->crown.unit.why, sizeof s->crown.unit.why, "a disc of the area is taken");
	if (!s->crown.unit.unit)         /* a crown is no reason to stop */
		s->crown.unit = (struct eco_unit_guess){ .unit = beside && strcmp(beside, "in") != 0
			&& strcmp(beside, "ft") != 0 ? "m" : beside ? "ft" : "m", .why = "as other sizes" };
	snprintf(took, sizeof took, "\"%.60s\"%s, %s in %s", name, s->crown_columns > 0 ? " and other directions" : "",
		s->crown_is_area ? "an area, in squares" : s->crown_is_radius ? "a radius" : "a diameter", s->crown.unit.unit);
	start_guess(s, "crown", took, "\"crown_m\" in the scene", "%s", s->crown.unit.why);
}

/* A column of heights where crowns begin, or of live crown ratios. */
static void find_crown_base(struct start *s)
{
	s->crown_base = ECO_NONE;
	for (uint32_t i = 0; i < s->table.column_count && s->crown_base == ECO_NONE; i++) {
		const char *name = s->table.columns[i];
		bool crown = eco_column_says(name, "crown");
		s->base_is_ratio = eco_column_says(name, "crown ratio") || (crown && eco_column_says(name, "live"));
		if (s->base_is_ratio || eco_column_says(name, "crown base") || (crown && eco_column_says(name, "base")))
			s->crown_base = i;
	}
	if (s->crown_base == ECO_NONE)
		return;
	const char *name = s->table.columns[s->crown_base], *unit = eco_unit_of_name(name);
	char took[120];
	s->base_unit = unit ? unit : s->height.unit.unit ? s->height.unit.unit : "m";
	snprintf(took, sizeof took, "\"%.60s\"%s%s", name, s->base_is_ratio ? ", a ratio" : " in ",
		s->base_is_ratio ? "" : s->base_unit);
	start_guess(s, "crown base", took, "\"crown_base\" in the scene", "it chooses between variants, and plants of the library begin there");
}

/* ---- Ages ---- */

static void find_ages(struct start *s)
{
	const struct { enum eco_role role; const char *why; } ages[] = { { ECO_ROLE_AGE, "years" },
		{ ECO_ROLE_PLANTED, "the age is counted from it" } };
	time_t now = time(NULL);
	struct tm date;
	s->now = localtime_r(&now, &date) ? date.tm_year + 1900 : 2026;
	for (size_t i = 0; i < 2; i++) {
		char took[80];
		if (s->columns.of[ages[i].role] == ECO_NONE)
			continue;
		snprintf(took, sizeof took, "\"%.70s\"", start_column(s, s->columns.of[ages[i].role]));
		start_guess(s, eco_role_names[ages[i].role], took, "\"height_m\" in the scene", "%s; heights of plants that "
			"have no other size follow from it", ages[i].why);
	}
}

/* ---- Rows without a plant ---- */

#define GONE_MOST 0.9            /* a column that leaves out more rows says something else */
#define GONE_WORDS 5u            /* longer texts are remarks */

static unsigned word_count(const char *text)
{
	char words[ECO_WORDS_BYTES], word[ECO_WORD_BYTES];
	unsigned count = 0;
	eco_words_of(text, words, sizeof words);
	for (const char *at = words; eco_words_next(&at, word);)
		count++;
	return count;
}

/* Whether a text is one word of a set, "no" or "yes", or its number. */
static bool says(const char *text, const char *set, const char *number)
{
	char words[ECO_WORDS_BYTES];
	eco_words_of(text, words, sizeof words);
	return words[0] != 0 && (eco_words_have(eco_words_set(set), words) || strcmp(words, number) == 0);
}

/* A date, a year alone, or the number of a day in a workbook. */
static bool is_date(const char *text)
{
	size_t digits = strspn(text, "0123456789");
	bool day = digits == 5 && text[5] == 0 && text[0] >= '2' && text[0] <= '6';
	return !isnan(eco_text_year(text)) || day || (digits >= 1 && digits <= 2 && text[digits] != 0
		&& strchr("-./", text[digits]) && strpbrk(text + digits + 1, "-./"));
}

enum gone { STAYS, BY_STATUS, BY_PRESENCE, BY_DATE, BY_REMARK };

/* "Type", "tree type", "site type": words of plants, places and kinds alone. */
static bool is_type(const char *name)
{
	char words[ECO_WORDS_BYTES], word[ECO_WORD_BYTES];
	eco_words_of(name, words, sizeof words);
	bool type = eco_words_any(words, eco_words_set("kind"));
	for (const char *at = words; type && eco_words_next(&at, word);)
		type = eco_words_have(eco_words_set("kind"), word) || eco_words_have(eco_words_set("plant"), word);
	return type;
}

static enum gone kind_of(const char *name)
{
	if (eco_column_says(name, "removal"))
		return eco_words_any(name, eco_words_set("no date")) ? STAYS : BY_DATE;
	return eco_words_any(name, eco_words_set("present")) ? BY_PRESENCE : eco_column_says(name, "status") || is_type(name)
		? BY_STATUS : eco_words_any(name, eco_words_set("remark")) ? BY_REMARK : STAYS;
}

static bool is_gone(enum gone kind, const char *text)
{
	if (eco_text_is_missing(text))
		return false;
	if (kind == BY_PRESENCE)
		return says(text, "no", "0");
	if (kind == BY_DATE)
		return is_date(text) || says(text, "yes", "1");
	if (kind == BY_REMARK)                   /* a stump nearby is none of this row */
		return eco_flora_is_no_plant(text, true);
	return word_count(text) <= GONE_WORDS && eco_flora_is_no_plant(text, false);
}

/* "Dead" beside a species: the plant stands. */
static bool is_dead(enum gone kind, const char *text)
{
	return kind == BY_STATUS && !eco_text_is_missing(text) && word_count(text) <= GONE_WORDS
		&& !eco_flora_is_no_plant(text, false) && eco_flora_of(text, NULL).form == ECO_FORM_NOTHING;
}

/* Whether a row of the table's selection is gone, or one of the others may be. A type's rare values are not searched
 * for. */
static bool may_leave_out(const struct start *s, uint32_t column, enum gone kind)
{
	for (uint32_t row = 0; row < s->table.row_count; row++)
		if (is_gone(kind, eco_table_field(&s->table, row, column)) || is_dead(kind, eco_table_field(&s->table, row, column)))
			return true;
	return s->table.rows > s->table.row_count && !is_type(s->table.columns[column]);
}

/* Adds the values of a column that say that no plant stands there. */
static void add_gone(struct start *s, uint32_t column, enum gone kind)
{
	struct eco_table_values values;
	const char *name = s->table.columns[column];
	char names[160] = "", dead[100] = "", took[200], number[32];
	uint64_t rows = 0, all = 0, dead_rows = 0;
	eco_check(eco_table_values_read(&values, &s->source, &name, 1, s->error));
	json_t *gone = json_array(), *standing = json_array();
	for (uint32_t i = 0; i < values.count; i++) {
		bool fits = strlen(values.items[i].text) <= 200 && json_array_size(gone) + json_array_size(standing) < 4096;
		all += values.items[i].rows;
		if (is_dead(kind, values.items[i].text)) {
			eco_phrase_add(dead, sizeof dead, values.items[i].text);
			dead_rows += values.items[i].rows;
			if (fits)
				json_array_append_new(standing, json_string(values.items[i].text));
		}
		if (!is_gone(kind, values.items[i].text))
			continue;
		rows += values.items[i].rows;
		eco_phrase_add(names, sizeof names, values.items[i].text);
		if (fits)
			json_array_append_new(gone, json_string(values.items[i].text));
	}
	if (rows > 0 && (double)rows <= GONE_MOST * (double)all) {
		json_object_set(s->skip, name, gone);
		snprintf(took, sizeof took, "%s row%s where \"%.60s\" is %.80s", eco_phrase_count(rows, number),
			rows == 1 ? "" : "s", name, kind == BY_DATE ? "a date" : names);
		start_guess(s, "left out", took, "\"skip\" in the scene", "no plant stands there");
	}
	if (dead_rows > 0) {
		snprintf(took, sizeof took, "%s row%s where \"%.60s\" is %.60s", eco_phrase_count(dead_rows, number),
			dead_rows == 1 ? "" : "s", name, dead);
		start_guess(s, "dead", took, "\"instead\" in the scene", "they stand as dead trees; \"skip\" leaves them out");
		json_object_set(s->dead, name, standing);
		s->dead_rows += dead_rows;
	}
	json_decref(gone);
	json_decref(standing);
	eco_table_values_free(&values);
}

static bool says_plant(const char *text)
{
	struct eco_flora flora = eco_flora_of(text, NULL);
	return flora.genus || (flora.form != ECO_FORM_UNKNOWN && flora.form != ECO_FORM_NOTHING);
}

static uint32_t column_of(const struct start *s, const char *name)
{
	uint32_t i = 0;
	while (i < s->table.column_count && strcmp(s->table.columns[i], name) != 0)
		i++;
	return i < s->table.column_count ? i : ECO_NONE;
}

/* Whether a layer, or a block on it, names plants. */
static bool is_layer_of_plants(const struct start *s, uint32_t layers, const char *layer)
{
	bool plants = says_plant(layer);
	for (uint32_t row = 0; row < s->table.row_count && !plants; row++)
		plants = strcmp(eco_table_field(&s->table, row, layers), layer) == 0
			&& says_plant(eco_table_field(&s->table, row, s->columns.of[ECO_ROLE_SPECIES]));
	return plants;
}

/* Benches and lamps of a plan: blocks on layers that name no plant, where others do. */
static void find_things(struct start *s)
{
	uint32_t layers = column_of(s, "Layer"), species = s->columns.of[ECO_ROLE_SPECIES];
	struct eco_table_values values;
	const char *name = "Layer";
	char took[200], names[160] = "";
	if (layers == ECO_NONE || layers == species || species == ECO_NONE || column_of(s, "BlockName") == ECO_NONE)
		return;
	eco_check(eco_table_values_read(&values, &s->source, &name, 1, s->error));
	json_t *things = json_array();
	for (uint32_t i = 0; i < values.count && i < 4096; i++) {
		if (is_layer_of_plants(s, layers, values.items[i].text))
			continue;
		json_array_append_new(things, json_string(values.items[i].text));
		eco_phrase_add(names, sizeof names, values.items[i].text);
	}
	if (json_array_size(things) > 0 && json_array_size(things) < values.count) {
		json_object_set(s->skip, name, things);
		snprintf(took, sizeof took, "what is on %.150s", names);
		start_guess(s, "left out", took, "\"skip\" in the scene", "neither these layers nor blocks on them name plants");
	}
	json_decref(things);
	eco_table_values_free(&values);
}

static void find_gone(struct start *s)
{
	s->skip = json_object();
	s->dead = json_object();
	find_things(s);
	for (uint32_t i = 0; i < s->table.column_count; i++) {
		enum gone kind = kind_of(s->table.columns[i]);
		if (kind != STAYS && i != s->tint_column && i != s->columns.of[ECO_ROLE_SPECIES] && may_leave_out(s, i, kind))
			add_gone(s, i, kind);
	}
}

/* ---- All ---- */

/* Whether trunks are needed: where heights are missing. */
void start_sizes(struct start *s)
{
	const struct start_options *o = s->options;
	s->height.column = s->trunk.column = s->crown.column = ECO_NONE;
	take_treetops(s);
	for (int role = ECO_ROLE_HEIGHT; role <= ECO_ROLE_CROWN; role++)
		pass_codes(s, (enum eco_role)role);
	if (!o->dbh && !o->girth)
		check_diameter(s);
	s->height.column = s->columns.of[ECO_ROLE_HEIGHT];
	s->trunk_is_girth = s->columns.of[ECO_ROLE_DBH] == ECO_NONE;
	s->trunk.column = s->columns.of[s->trunk_is_girth ? ECO_ROLE_GIRTH : ECO_ROLE_DBH];
	enum eco_quantity trunk = s->trunk_is_girth ? ECO_QUANTITY_GIRTH : ECO_QUANTITY_DBH;
	if (s->height_is_z)
		s->height.unit = (struct eco_unit_guess){ .unit = "m", .why = "the table has no other size; Z of 1 to 90 "
			"is taken for the height above the ground, as of a normalised cloud" };
	else if (s->height.column != ECO_NONE)
		measure(s, &s->height, ECO_QUANTITY_HEIGHT, o->height_unit, o->dbh_unit ? o->dbh_unit
			: eco_unit_of_name(start_column(s, s->trunk.column)));
	if (s->trunk.column != ECO_NONE)
		measure(s, &s->trunk, trunk, o->dbh_unit, s->height.column != ECO_NONE
			? s->height.unit.unit : NULL);
	if (s->height.column != ECO_NONE && !s->height.unit.unit && s->trunk.column != ECO_NONE)
		measure(s, &s->height, ECO_QUANTITY_HEIGHT, NULL, s->trunk.unit.unit);
	ask_unit(s, &s->height, "--height-unit");
	ask_unit(s, &s->trunk, "--dbh-unit");
	say_size(s, &s->height, ECO_ROLE_HEIGHT, "--height-column", "--height-unit");
	say_size(s, &s->trunk, s->trunk_is_girth ? ECO_ROLE_GIRTH : ECO_ROLE_DBH, "--dbh-column", "--dbh-unit");
	doubt_diameter(s);
	find_crowns(s);
	find_crown_base(s);
	find_ages(s);
	find_gone(s);
}
