/* Rows of inventories on their way into the pack: a block is coded as soon as it is full, so that only one is
 * held as rows. */
#include "ecofiles/base/memory.h"
#include "ecofiles/ecopack/make.h"
#include "ecofiles/ecopack/run.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- Species ---- */

/* The species that each plant of the pack stands for, and how many plants of the scene have each: for a
 * legend, which cannot look at every plant. A nested file counts once. */

#define SAID_MOST 32u    /* species of a plant that META names */
#define PLANT_DIGITS 8u

struct make_species {
	struct eco_string_pool pairs; /* plant, as hexadecimal digits, and species */
	uint64_t *counts;
	uint32_t count_room;
	uint32_t plant, pair;   /* counted last */
};

static const char *species_of(const struct make_species *s, uint32_t pair)
{
	return s->pairs.items[pair] + PLANT_DIGITS;
}

/* The pair's number. */
static uint32_t find_pair(struct make_species *s, uint32_t plant, const char *species)
{
	char key[PLANT_DIGITS + ECO_INVENTORY_NAME_MAX + 1];
	snprintf(key, sizeof key, "%08x%.*s", plant, (int)ECO_INVENTORY_NAME_MAX, species);
	uint32_t before = s->pairs.count, pair = eco_string_number(&s->pairs, key);
	eco_grow(&s->counts, &s->count_room, pair, sizeof *s->counts);
	if (pair == before)
		s->counts[pair] = 0;
	return pair;
}

static void make_species_count(struct make *m, uint32_t plant, const char *species)
{
	struct make_species *s = m->stood_species;
	if (!s)
		s = m->stood_species = eco_alloc(1, sizeof *s);
	if (!s->pairs.count || plant != s->plant || strcmp(species_of(s, s->pair), species) != 0)
		s->pair = find_pair(s, plant, species);
	s->plant = plant;
	s->counts[s->pair]++;
}

/* By plant; of a plant, the commonest first. */
static int by_most(const void *a, const void *b, void *ctx)
{
	const struct make_species *s = ctx;
	uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
	int plants = memcmp(s->pairs.items[x], s->pairs.items[y], PLANT_DIGITS);
	if (plants)
		return plants;
	if (s->counts[x] != s->counts[y])
		return s->counts[x] > s->counts[y] ? -1 : 1;
	return strcmp(species_of(s, x), species_of(s, y));
}

/* {"of": number of species, "most": [[name, or null where rows state none, plants], ...]} */
static json_t *said_of(const struct make_species *s, const uint32_t *pairs, uint32_t count)
{
	json_t *most = json_array();
	for (uint32_t i = 0; i < count && i < SAID_MOST; i++) {
		const char *name = species_of(s, pairs[i]);
		bool is_stated = strcmp(name, ECO_INVENTORY_UNSTATED) != 0;
		json_array_append_new(most,
			json_pack("[s?, I]", is_stated ? name : NULL, (json_int_t)s->counts[pairs[i]]));
	}
	return json_pack("{s:I, s:o}", "of", (json_int_t)count, "most", most);
}

void make_species_say(const struct make *m, json_t *plants)
{
	const struct make_species *s = m->stood_species;
	uint32_t count = s ? s->pairs.count : 0, *order = eco_alloc(count, sizeof *order);
	for (uint32_t i = 0; i < count; i++)
		order[i] = i;
	qsort_r(order, count, sizeof *order, by_most, (void *)s);
	for (uint32_t i = 0, end; i < count; i = end) {
		char plant[PLANT_DIGITS + 1] = "";
		memcpy(plant, s->pairs.items[order[i]], PLANT_DIGITS);
		for (end = i + 1; end < count && memcmp(s->pairs.items[order[end]], plant, PLANT_DIGITS) == 0;)
			end++;
		json_object_set_new(json_array_get(plants, strtoul(plant, NULL, 16)), "species",
			said_of(s, order + i, end - i));
	}
	free(order);
}

void make_species_free(struct make *m)
{
	if (!m->stood_species)
		return;
	eco_string_pool_free(&m->stood_species->pairs);
	free(m->stood_species->counts);
	free(m->stood_species);
	m->stood_species = NULL;
}

/* ---- Rows ---- */

struct make_inventory {
	struct eco_inventory_row rows[ECO_INVENTORY_PLACES];
	uint32_t count;
	struct eco_bytes *blocks;
	uint32_t block_count, block_room;
	struct eco_string_pool names;
	uint32_t species, file; /* those of the row before */
	bool is_needed;         /* something is to be said of a plant */
};

/* The kept name that equals `name`, or NULL; *number: of a kept one that it often is. */
static const char *keep_name(struct eco_string_pool *names, const char *name, uint32_t *number)
{
	if (name && !(*number < names->count && strcmp(names->items[*number], name) == 0))
		*number = eco_string_number(names, name);
	return name ? names->items[*number] : NULL;
}

static void close_block(struct make_inventory *in)
{
	eco_grow(&in->blocks, &in->block_room, in->block_count, sizeof *in->blocks);
	in->blocks[in->block_count++] = eco_inventory_encode(in->rows, in->count);
	in->count = 0;
}

void make_inventory_add(struct make *m, uint32_t plant, const struct eco_inventory_row *row)
{
	struct make_inventory *in = m->inventory;
	if (!in)
		in = m->inventory = eco_alloc(1, sizeof *in);
	struct eco_inventory_row *kept = &in->rows[in->count];
	*kept = *row;
	kept->species = keep_name(&in->names, row->species, &in->species);
	kept->file = keep_name(&in->names, row->file, &in->file);
	in->is_needed = in->is_needed || kept->species || kept->file;
	make_species_count(m, plant, row->species ? row->species : m->table[plant].name);
	if (++in->count == ECO_INVENTORY_PLACES)
		close_block(in);
}

void make_inventory_pack(struct make *m)
{
	struct make_inventory *in = m->inventory;
	const struct eco_list list = { .kind = ECO_LIST_INVENTORY, .coder = ECO_CODER_BYTES, .owner = ECO_NONE,
		.grid_step = { 1, 1, 1 }, .image = ECO_NONE, .partner = ECO_NONE };
	if (!in || !in->is_needed)
		return;
	if (in->count)
		close_block(in);
	make_add_bytes(m, &list, in->blocks, in->block_count);
}

void make_inventory_free(struct make *m)
{
	struct make_inventory *in = m->inventory;
	if (!in)
		return;
	for (uint32_t i = 0; i < in->block_count; i++)
		free(in->blocks[i].at);
	free(in->blocks);
	eco_string_pool_free(&in->names);
	free(in);
	m->inventory = NULL;
}
