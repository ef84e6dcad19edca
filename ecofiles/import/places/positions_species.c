/* Species. An inventory has few different ones in many rows, so each text is matched with the keys once
 * and remembered. A limit bounds memory; texts beyond it are matched each time and not named among the
 * unknown ones. */
#include <stdlib.h>
#include <string.h>
#include <math.h>

#include "ecofiles/import/places/inventory_text.h"
#include "ecofiles/base/memory.h"
#include "ecofiles/base/random.h"
#include "ecofiles/format/model.h"
#include "ecofiles/import/places/positions_parts.h"

#define KNOWN_MAX 65536u             /* texts remembered */
#define SLOTS (2 * KNOWN_MAX)
#define TEXT_BYTES 256u              /* longest species, folded; longer ones are cut */

struct known { char *text; uint32_t key; uint64_t count, first_line; };      /* text as in the file */

struct pattern { char *text; uint32_t key, literal; };

struct eco_species_table {
	const struct eco_positions_spec *spec;
	struct known *known;         /* SLOTS, open addressing */
	uint32_t known_count;
	/* exact: ascending by text; wild: most literal characters first */
	struct pattern *exact, *wild;
	uint32_t exact_count, wild_count;
	struct eco_skipped *keys;    /* map_count + 1 */
};

static int compare_texts(const void *a, const void *b)
{
	return strcmp(((const struct pattern *)a)->text, ((const struct pattern *)b)->text);
}

static int compare_literals(const void *a, const void *b)
{
	const struct pattern *p = a, *q = b;
	if (p->literal != q->literal)
		return p->literal > q->literal ? -1 : 1;
	return p->key < q->key ? -1 : p->key > q->key;
}

static void fold_keys(struct eco_species_table *t)
{
	char folded[TEXT_BYTES];
	for (uint32_t i = 0; i < t->spec->map_count; i++) {
		const char *name = t->spec->map[i].name;
		bool wild = strchr(name, '*') != NULL;
		struct pattern *p = wild ? &t->wild[t->wild_count++] : &t->exact[t->exact_count++];
		size_t length = eco_text_fold(name, folded, sizeof folded);
		p->text = eco_copy_text(folded);
		p->key = i;
		p->literal = (uint32_t)length;
		for (const char *c = folded; *c != 0; c++)
			p->literal -= *c == '*';
	}
	qsort(t->exact, t->exact_count, sizeof *t->exact, compare_texts);
	qsort(t->wild, t->wild_count, sizeof *t->wild, compare_literals);
}

struct eco_species_table *eco_species_open(const struct eco_positions_spec *spec)
{
	struct eco_species_table *t = eco_alloc(1, sizeof *t);
	t->spec = spec;
	t->known = eco_alloc(SLOTS, sizeof *t->known);
	t->exact = eco_alloc(spec->map_count + 1u, sizeof *t->exact);
	t->wild = eco_alloc(spec->map_count + 1u, sizeof *t->wild);
	t->keys = eco_alloc(spec->map_count + 1u, sizeof *t->keys);
	fold_keys(t);
	return t;
}

static uint32_t match(const struct eco_species_table *t, const char *folded)
{
	const struct pattern wanted = { .text = (char *)folded };
	const struct pattern *exact = bsearch(&wanted, t->exact, t->exact_count, sizeof *t->exact,
		compare_texts);
	if (exact)
		return exact->key;
	for (uint32_t i = 0; i < t->wild_count; i++)
		if (eco_text_fits(folded, t->wild[i].text))
			return t->wild[i].key;
	return t->spec->map_count;
}

/* Keyed by the text as it is, so that a hit needs no folding. */
static struct known *slot_of(const struct eco_species_table *t, const char *text, size_t length)
{
	uint64_t hash = length;
	for (size_t i = 0; i < length; i++)
		hash = (hash ^ (unsigned char)text[i]) * 0x100000001b3u;
	uint32_t at = (uint32_t)(eco_random(0, hash) % SLOTS);
	while (t->known[at].text
			&& (strncmp(t->known[at].text, text, length) != 0 || t->known[at].text[length] != 0))
		at = at + 1 == SLOTS ? 0 : at + 1;
	return &t->known[at];
}

static void count(struct eco_skipped *counter, const char *text, uint64_t line)
{
	if (counter->count++ > 0)
		return;
	counter->first_line = line;
	strncpy(counter->first_text, text, sizeof counter->first_text - 1);
}

uint32_t eco_species_find(struct eco_species_table *table, const char *text, uint64_t line)
{
	char folded[TEXT_BYTES];
	size_t length = strnlen(text, TEXT_BYTES - 1);
	struct known *slot = slot_of(table, text, length);
	uint32_t key;
	if (!slot->text) {
		eco_text_fold(text, folded, sizeof folded);
		key = match(table, folded);
		if (table->known_count < KNOWN_MAX) {
			slot->text = eco_copy_part(text, length);
			table->known_count++;
			slot->key = key;
			slot->first_line = line;
		}
	} else {
		key = slot->key;
	}
	if (slot->text && slot->count++ == 0)
		slot->first_line = line;
	count(&table->keys[key], text, line);
	return key;
}

/* Inserts into the list of the commonest: most first, of equals the earlier one. */
static void add_unknown(struct known *most, uint32_t *kinds, const struct known *known)
{
	uint32_t at = ECO_UNKNOWN_MOST;
	++*kinds;
	while (at > 0
			&& (most[at - 1].count < known->count
			|| (most[at - 1].count == known->count && most[at - 1].count > 0
		&& most[at - 1].first_line > known->first_line)))
		at--;
	if (at == ECO_UNKNOWN_MOST)
		return;
	memmove(most + at + 1, most + at, (ECO_UNKNOWN_MOST - 1 - at) * sizeof *most);
	most[at] = *known;
}

void eco_species_counted(const struct eco_species_table *table, struct eco_positions_counts *counts)
{
	struct known most[ECO_UNKNOWN_MOST] = { { .text = NULL } };
	counts->keys = table->keys;
	counts->unknown_species = 0;
	for (uint32_t i = 0; i < SLOTS; i++)
		if (table->known[i].count > 0 && table->known[i].key == table->spec->map_count
				&& !table->spec->fallback.name)
			add_unknown(most, &counts->unknown_species, &table->known[i]);
	for (uint32_t i = 0; i < ECO_UNKNOWN_MOST; i++) {
		counts->unknown[i] = (struct eco_skipped){ .count = most[i].count,
			.first_line = most[i].first_line };
		if (most[i].text)
			strncpy(counts->unknown[i].first_text, most[i].text,
				sizeof counts->unknown[i].first_text - 1);
	}
}

void eco_species_reset(struct eco_species_table *table)
{
	for (uint32_t i = 0; i < SLOTS; i++)
		table->known[i].count = 0;
	memset(table->keys, 0, (table->spec->map_count + 1u) * sizeof *table->keys);
}

void eco_species_close(struct eco_species_table *table)
{
	if (!table)
		return;
	for (uint32_t i = 0; table->known && i < SLOTS; i++)
		free(table->known[i].text);
	for (uint32_t i = 0; table->exact && i < table->exact_count; i++)
		free(table->exact[i].text);
	for (uint32_t i = 0; table->wild && i < table->wild_count; i++)
		free(table->wild[i].text);
	free(table->known);
	free(table->exact);
	free(table->wild);
	free(table->keys);
	free(table);
}

/* ---- Sizes ---- */

#define DBH_PLAUSIBLE_M 12.0

static double to_millimetres(double metres)
{
	return floor(metres * 1000 + 0.5) / 1000;
}

static const struct eco_allometry *rule_of(const struct eco_size *size, uint32_t plant)
{
	uint32_t low = 0, high = size->rule_count;
	while (low < high) {
		uint32_t middle = low + (high - low) / 2;
		if (size->rules[middle].plant == plant)
			return &size->rules[middle];
		if (size->rules[middle].plant < plant)
			low = middle + 1;
		else
			high = middle;
	}
	/* the rule of all other plants is the last: ECO_NONE is the greatest number */
	return size->rule_count > 0 && size->rules[size->rule_count - 1].plant == ECO_NONE
		? &size->rules[size->rule_count - 1] : NULL;
}

static double by_allometry(const struct eco_allometry *rule, double dbh_m)
{
	double grown = 1 - exp(-rule->rate * dbh_m * 1000);
	return 1.3 + (rule->max_m - 1.3) * (rule->shape == 1 ? grown : pow(grown, rule->shape));
}

static void remark(uint32_t *remarks, enum eco_skip kind, bool there)
{
	*remarks |= (uint32_t)there << kind;
}

double eco_size_read(const struct eco_size *size, const char *text, char decimal, uint32_t plant,
	double low_m, double high_m, uint32_t *remarks)
{
	const struct eco_allometry *rule = NULL;
	double number, unit_m, metres;
	if (size->kind == ECO_SIZE_NUMBER)
		return size->value_m;
	if (size->kind == ECO_SIZE_DBH && !(rule = rule_of(size, plant)))
		return NAN;
	enum eco_size_form form = eco_text_size(text, decimal, &number, &unit_m);
	remark(remarks, ECO_KEPT_UNREAD, form == ECO_FORM_NONE && !eco_text_is_missing(text));
	if (form == ECO_FORM_NONE || !(number > 0))
		return NAN;
	metres = number * (unit_m != 0 ? unit_m : size->unit_m) * size->factor;
	bool trunk_too_thick = rule && metres > DBH_PLAUSIBLE_M;
	if (rule)
		metres = by_allometry(rule, metres);
	metres = to_millimetres(metres);
	if (!(metres >= low_m && metres <= high_m)) {
		remark(remarks, ECO_KEPT_UNUSED, true);
		return NAN;
	}
	remark(remarks, ECO_KEPT_IMPLAUSIBLE, trunk_too_thick);
	remark(remarks, ECO_KEPT_RANGE, form == ECO_FORM_RANGE);
	remark(remarks, ECO_KEPT_OPEN, form == ECO_FORM_OPEN);
	remark(remarks, ECO_KEPT_OTHER_UNIT, unit_m != 0 && unit_m != size->unit_m);
	return metres;
}

#define BINS 30001u                  /* centimetres */
#define PLANTS_MAX 4096u

/* bin[cm]: first a count, then the class's height in cm */
struct plant_levels { uint32_t plant, *bin; };

struct eco_levels {
	struct plant_levels plants[PLANTS_MAX];
	uint32_t count;
};

struct eco_levels *eco_levels_open(void)
{
	return eco_alloc(1, sizeof(struct eco_levels));
}

static uint32_t centimetres(double height_m)
{
	return (uint32_t)(height_m * 100 + 0.5);
}

static const struct plant_levels *levels_of(const struct eco_levels *levels, uint32_t plant)
{
	for (uint32_t i = 0; i < levels->count; i++)
		if (levels->plants[i].plant == plant)
			return &levels->plants[i];
	return NULL;
}

enum eco_code eco_levels_count(struct eco_levels *levels, uint32_t plant, double height_m, const char *path,
	struct eco_error *error)
{
	const struct plant_levels *l = levels_of(levels, plant);
	if (!l) {
		if (levels->count == PLANTS_MAX)
			return eco_fail(error, ECO_TOO_LARGE, "%.200s: \"levels\" works for up to %u plants",
				path, PLANTS_MAX);
		levels->plants[levels->count] = (struct plant_levels){ plant, eco_alloc(BINS, sizeof *l->bin) };
		l = &levels->plants[levels->count++];
	}
	l->bin[centimetres(height_m)]++;
	return ECO_OK;
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
	const struct plant_levels *l = levels_of(levels, plant);
	uint32_t level = l ? l->bin[centimetres(height_m)] : 0;
	return level > 0 ? level / 100.0 : height_m;
}

void eco_levels_close(struct eco_levels *levels)
{
	for (uint32_t i = 0; levels && i < levels->count; i++)
		free(levels->plants[i].bin);
	free(levels);
}
