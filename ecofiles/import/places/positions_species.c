/* Species. An inventory has few different ones in many rows, so each text is matched with the keys once
 * and remembered. A limit bounds memory; texts beyond it are matched each time and not named among the
 * unknown ones. */
#include <stdlib.h>
#include <string.h>

#include "ecofiles/import/places/inventory_text.h"
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

static bool fold_keys(struct eco_species_table *t)
{
	char folded[TEXT_BYTES];
	for (uint32_t i = 0; i < t->spec->map_count; i++) {
		const char *name = t->spec->map[i].name;
		bool wild = strchr(name, '*') != NULL;
		struct pattern *p = wild ? &t->wild[t->wild_count++] : &t->exact[t->exact_count++];
		size_t length = eco_text_fold(name, folded, sizeof folded);
		p->text = strdup(folded);
		p->key = i;
		p->literal = (uint32_t)length;
		for (const char *c = folded; *c != 0; c++)
			p->literal -= *c == '*';
		if (!p->text)
			return false;
	}
	qsort(t->exact, t->exact_count, sizeof *t->exact, compare_texts);
	qsort(t->wild, t->wild_count, sizeof *t->wild, compare_literals);
	return true;
}

struct eco_species_table *eco_species_open(const struct eco_positions_spec *spec)
{
	struct eco_species_table *t = calloc(1, sizeof *t);
	if (!t)
		return NULL;
	t->spec = spec;
	t->known = calloc(SLOTS, sizeof *t->known);
	t->exact = calloc(spec->map_count + 1u, sizeof *t->exact);
	t->wild = calloc(spec->map_count + 1u, sizeof *t->wild);
	t->keys = calloc(spec->map_count + 1u, sizeof *t->keys);
	if (!t->known || !t->exact || !t->wild || !t->keys || !fold_keys(t)) {
		eco_species_close(t);
		return NULL;
	}
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
		if (table->known_count < KNOWN_MAX && (slot->text = strndup(text, length))) {
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
