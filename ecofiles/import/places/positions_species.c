/* Species, sizes and levels of an inventory. It has few different species in many rows, so each text is
 * matched with the keys once and remembered. A limit bounds memory; texts beyond it are matched each time
 * and not named among the unknown ones. */
#include <stdlib.h>
#include <string.h>
#include <math.h>

#include "ecofiles/import/places/inventory_text.h"
#include "ecofiles/base/array_grow.h"
#include "ecofiles/base/memory.h"
#include "ecofiles/base/order.h"
#include "ecofiles/base/random.h"
#include "ecofiles/import/places/growth.h"
#include "ecofiles/import/places/positions_parts.h"

#define KNOWN_MAX 65536u             /* texts remembered */
#define TEXT_BYTES 256u              /* longest species, folded; longer ones are cut */

struct known { const char *text; uint32_t key; uint64_t count, first_line; struct eco_flora *flora; };

struct pattern { char *text; uint32_t key; size_t literal; };        /* literal: SIZE_MAX without "*" */

struct eco_species_table {
	const struct eco_positions_spec *spec;
	struct eco_string_pool texts;
	struct known *known;         /* one per text */
	uint32_t room;
	struct pattern *patterns;    /* the best first */
	struct eco_skipped *keys;    /* map_count + 1 */
};

ECO_ORDER_FALLING_TWO(compare_patterns, struct pattern, ->literal, ->key)

struct eco_species_table *eco_species_open(const struct eco_positions_spec *spec)
{
	struct eco_species_table *t = eco_alloc(1, sizeof *t);
	t->spec = spec;
	t->patterns = eco_alloc(spec->map_count, sizeof *t->patterns);
	t->keys = eco_alloc(spec->map_count + 1u, sizeof *t->keys);
	for (uint32_t i = 0; i < spec->map_count; i++) {
		char folded[TEXT_BYTES];
		size_t literal = eco_text_fold(spec->map[i].name, folded, sizeof folded);
		for (const char *c = folded; *c != 0; c++)
			literal -= *c == '*';
		t->patterns[i] = (struct pattern){ eco_copy_text(folded), i,
			strchr(spec->map[i].name, '*') ? literal : SIZE_MAX };
	}
	qsort(t->patterns, spec->map_count, sizeof *t->patterns, compare_patterns);
	return t;
}

static uint32_t match(const struct eco_species_table *t, const char *text)
{
	char folded[TEXT_BYTES];
	uint32_t i = 0;
	eco_text_fold(text, folded, sizeof folded);
	while (i < t->spec->map_count && !eco_text_fits(folded, t->patterns[i].text, 0))
		i++;
	return i < t->spec->map_count ? t->patterns[i].key : i;
}

uint32_t eco_species_find(struct eco_species_table *table, const char *text, uint64_t line)
{
	uint32_t key;
	if (table->texts.count < KNOWN_MAX) {
		uint32_t before = table->texts.count, number = eco_string_number(&table->texts, text);
		if (table->texts.count > before) {
			eco_grow(&table->known, &table->room, before, sizeof *table->known);
			table->known[number] = (struct known){ .text = table->texts.items[number],
				.key = match(table, text) };
		}
		struct known *known = &table->known[number];
		if (known->count++ == 0)
			known->first_line = line;
		key = known->key;
	} else {
		key = match(table, text);
	}
	struct eco_skipped *counter = &table->keys[key];
	if (counter->count++ == 0) {
		counter->first_line = line;
		strncpy(counter->first_text, text, sizeof counter->first_text - 1);
	}
	return key;
}

/* Only names that say a genus or a form grow by the tables. */
const struct eco_flora *eco_species_flora(struct eco_species_table *table, const char *text)
{
	const struct eco_flora_hint hint = { .spelling = true, .codes = table->spec->codes };
	uint32_t number = table->texts.count < KNOWN_MAX ? eco_string_number(&table->texts, text) : KNOWN_MAX;
	if (number >= table->texts.count || !table->known || table->known[number].text != table->texts.items[number])
		return NULL;
	struct known *known = &table->known[number];
	if (!known->flora) {
		known->flora = eco_alloc(1, sizeof *known->flora);
		*known->flora = eco_flora_of(text, &hint);
	}
	return known->flora->form != ECO_FORM_UNKNOWN && known->flora->form != ECO_FORM_NOTHING ? known->flora
		: NULL;
}

ECO_ORDER_FALLING_TWO(compare_known, struct known, ->count, ->first_line)

void eco_species_counted(const struct eco_species_table *table, struct eco_positions_counts *counts)
{
	struct known *unknown = eco_alloc(table->texts.count, sizeof *unknown);
	uint32_t count = 0;
	for (uint32_t i = 0; i < table->texts.count && !table->spec->fallback.name; i++)
		if (table->known[i].count > 0 && table->known[i].key == table->spec->map_count)
			unknown[count++] = table->known[i];
	qsort(unknown, count, sizeof *unknown, compare_known);
	counts->keys = table->keys;
	counts->unknown_species = count;
	for (uint32_t i = 0; i < ECO_UNKNOWN_MOST && i < count; i++) {
		struct eco_skipped *to = &counts->unknown[i];
		to->count = unknown[i].count;
		to->first_line = unknown[i].first_line;
		strncpy(to->first_text, unknown[i].text, sizeof to->first_text - 1);
	}
	free(unknown);
}

void eco_species_close(struct eco_species_table *table)
{
	if (!table)
		return;
	for (uint32_t i = 0; i < table->spec->map_count; i++)
		free(table->patterns[i].text);
	for (uint32_t i = 0; i < table->texts.count && table->known; i++)
		free(table->known[i].flora);
	eco_string_pool_free(&table->texts);
	eco_free(table->known, table->patterns, table->keys, table);
}

/* ---- Sizes ---- */

#define DBH_PLAUSIBLE_M 12.0

static double to_millimetres(double metres)
{
	return floor(metres * 1000 + 0.5) / 1000;
}

static const struct eco_allometry *rule_of(const struct eco_size *size, uint32_t plant)
{
	const struct eco_allometry *last = size->rules + size->rule_count;
	for (const struct eco_allometry *rule = size->rules; rule < last; rule++)
		if (rule->plant == plant
			|| rule->plant == ECO_NONE) /* this one is the last: for all other plants */
			return rule;
	return NULL;
}

/* By a trunk's diameter in mm, or an age in years. */
static double by_rule(const struct eco_allometry *rule, double from_m, double by)
{
	double grown = 1 - exp(-rule->rate * by);
	return from_m + (rule->max_m - from_m) * (rule->shape == 1 ? grown : pow(grown, rule->shape));
}

static double by_trunk(const struct eco_size *size, const struct eco_size_row *row, double dbh_m)
{
	const struct eco_allometry *rule = rule_of(size, row->plant);
	if (size->by_species && (row->plant_of.flora || !rule))
		return eco_growth_height(row->plant_of, dbh_m);
	return rule ? by_rule(rule, 1.3, 1000 * dbh_m) : NAN;
}

static double by_age(const struct eco_size *size, const struct eco_size_row *row, double years)
{
	const struct eco_allometry *rule = rule_of(size, row->plant);
	if (size->by_species && (row->plant_of.flora || !rule))
		return eco_growth_height_at(row->plant_of, years);
	return rule ? by_rule(rule, 1.5, years) : NAN;
}

/* Even between 1 - spread and 1 + spread, by the row's number. */
double eco_size_spread(const struct eco_size_row *row, double spread)
{
	double even = (double)(eco_random(row->seed ^ 0x5eedu, row->row) >> 40) / (double)(1u << 24);
	return 1 + spread * (2 * even - 1);
}

#define AGE_MOST 2000.0

static double read_age(const struct eco_size *size, const char *text, char decimal)
{
	double number, unit_m;
	if (size->kind == ECO_SIZE_YEAR)
		return size->now - eco_text_year(text);
	return eco_text_size(text, decimal, &number, &unit_m) != ECO_FORM_NONE && unit_m == 0 ? number : NAN;
}

/* The height of a plant of that age; NaN: none. */
static double read_aged(const struct eco_size *size, const char *text, char decimal,
	const struct eco_size_row *row, uint32_t *remarks)
{
	double years = read_age(size, text, decimal);
	bool good = years >= 0 && years <= AGE_MOST;
	*remarks |= (uint32_t)(!good && !eco_text_is_missing(text)) << ECO_KEPT_UNREAD;
	return good ? to_millimetres(by_age(size, row, years) * eco_size_spread(row, size->spread)) : NAN;
}

double eco_size_trunk(const struct eco_size *size, const char *text, char decimal)
{
	double number, unit_m;
	if (size->kind != ECO_SIZE_DBH || eco_text_size(text, decimal, &number, &unit_m) == ECO_FORM_NONE
			|| !(number > 0))
		return NAN;
	return number * (unit_m != 0 ? unit_m : size->unit_m) * size->factor;
}

static void remark(uint32_t *remarks, enum eco_skip kind, bool there)
{
	*remarks |= (uint32_t)there << kind;
}

double eco_size_read(const struct eco_size *size, const char *text, char decimal,
	const struct eco_size_row *row, double low_m, double high_m, uint32_t *remarks)
{
	double number, unit_m, metres;
	bool trunk = size->kind == ECO_SIZE_DBH;
	if (size->kind == ECO_SIZE_NUMBER)
		return size->value_m;
	if (size->kind == ECO_SIZE_AGE || size->kind == ECO_SIZE_YEAR)
		return read_aged(size, text, decimal, row, remarks);
	if (trunk && isnan(by_trunk(size, row, 0.1)))
		return NAN;
	enum eco_size_form form = (trunk ? eco_text_size : eco_text_width)(text, decimal, &number, &unit_m);
	remark(remarks, ECO_KEPT_UNREAD, form == ECO_FORM_NONE && !eco_text_is_missing(text));
	if (form == ECO_FORM_NONE || !(number > 0))
		return NAN;
	metres = number * (unit_m != 0 ? unit_m : size->unit_m) * size->factor;
	if (size->is_area)                   /* the radius of a disc of as many square units */
		metres = sqrt(number / M_PI) * size->unit_m;
	if (trunk && metres > DBH_PLAUSIBLE_M) {
		remark(remarks, ECO_KEPT_UNUSED, true);
		return NAN;
	}
	if (trunk)
		metres = by_trunk(size, row, metres) * eco_size_spread(row, size->spread);
	metres = to_millimetres(metres);
	if (!(metres >= low_m && metres <= high_m)) {
		remark(remarks, ECO_KEPT_UNUSED, true);
		return NAN;
	}
	remark(remarks, ECO_KEPT_STEMS, form == ECO_FORM_STEMS);
	remark(remarks, ECO_KEPT_RANGE, form == ECO_FORM_RANGE);
	remark(remarks, ECO_KEPT_OPEN, form == ECO_FORM_OPEN);
	remark(remarks, ECO_KEPT_OTHER_UNIT, unit_m != 0 && unit_m != size->unit_m);
	return metres;
}

/* ---- Levels ---- */

#define BINS 30001u                  /* centimetres */

static uint32_t centimetres(double height_m)
{
	return (uint32_t)(height_m * 100 + 0.5);
}

static uint32_t *bins_of(const struct eco_levels *levels, uint32_t plant)
{
	for (uint32_t i = 0; i < levels->count; i++)
		if (levels->plants[i].plant == plant)
			return levels->plants[i].bin;
	return NULL;
}

void eco_levels_count(struct eco_levels *levels, uint32_t plant, double height_m)
{
	uint32_t *bin = bins_of(levels, plant);
	if (!bin) {
		eco_grow(&levels->plants, &levels->room, levels->count, sizeof *levels->plants);
		bin = eco_alloc(BINS, sizeof *bin);
		levels->plants[levels->count++] = (struct eco_plant_levels){ plant, bin };
	}
	bin[centimetres(height_m)]++;
}

/* Replaces the counts of [first, end) by the mean height there. */
static void average(uint32_t *bin, uint32_t first, uint32_t end)
{
	uint64_t sum = 0, members = 0, mean;
	for (uint32_t i = first; i < end; i++) {
		sum += (uint64_t)bin[i] * i;
		members += bin[i];
	}
	mean = members > 0 ? (sum + members / 2) / members : 0;
	for (uint32_t i = first; i < end; i++)
		bin[i] = (uint32_t)mean;
}

static void make_levels(uint32_t *bin, uint32_t levels)
{
	uint32_t low = 0, high = BINS - 1, first;
	while (low < BINS - 1 && bin[low] == 0)
		low++;
	while (high > low && bin[high] == 0)
		high--;
	first = low;
	for (uint32_t i = 1; i <= levels; i++) {
		uint32_t end = i == levels ? high + 1
			: (uint32_t)(low * pow((double)high / low, (double)i / levels) + 0.5);
		if (end <= first)
			continue;
		average(bin, first, end);
		first = end;
	}
}

void eco_levels_make(struct eco_levels *levels, uint32_t count)
{
	for (uint32_t i = 0; i < levels->count; i++)
		make_levels(levels->plants[i].bin, count);
}

double eco_levels_height(const struct eco_levels *levels, uint32_t plant, double height_m)
{
	const uint32_t *bin = bins_of(levels, plant);
	uint32_t level = bin ? bin[centimetres(height_m)] : 0;
	return level > 0 ? level / 100.0 : height_m;
}

void eco_levels_free(struct eco_levels *levels)
{
	for (uint32_t i = 0; i < levels->count; i++)
		free(levels->plants[i].bin);
	free(levels->plants);
}
