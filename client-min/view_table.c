#include "client-min/view_table.h"

#include <assert.h>
#include <stdlib.h>

#define EMPTY UINT32_MAX

static uint32_t home_of(const struct view_table *table, uint64_t key)
{
	uint64_t folded = key ^ (key >> 32) * 0x85EBCA77u;
	return (uint32_t)((folded * 0x9E3779B97F4A7C15u) >> 32) & (table->room - 1);
}

static uint32_t slot_of(const struct view_table *table, uint64_t key)
{
	uint32_t slot = home_of(table, key);
	while (table->slots[slot] != EMPTY && table->keys[slot] != key)
		slot = (slot + 1) & (table->room - 1);
	return slot;
}

uint32_t view_table_get(const struct view_table *table, uint64_t key)
{
	return table->room ? table->slots[slot_of(table, key)] : EMPTY;
}

static bool grow(struct view_table *table)
{
	struct view_table bigger = { .room = table->room ? table->room * 2 : 64 };
	if (bigger.room > 1u << 30)
		return false;
	bigger.slots = malloc(bigger.room * sizeof *bigger.slots);
	bigger.keys = malloc(bigger.room * sizeof *bigger.keys);
	if (!bigger.slots || !bigger.keys) {
		view_table_free(&bigger);
		return false;
	}
	for (uint32_t i = 0; i < bigger.room; i++)
		bigger.slots[i] = EMPTY;
	for (uint32_t i = 0; i < table->room; i++)
		if (table->slots[i] != EMPTY)
			view_table_put(&bigger, table->keys[i], table->slots[i]);
	view_table_free(table);
	*table = bigger;
	return true;
}

bool view_table_put(struct view_table *table, uint64_t key, uint32_t value)
{
	assert(value != EMPTY);
	if (table->count * 2 >= table->room && !grow(table))
		return false;
	uint32_t slot = slot_of(table, key);
	if (table->slots[slot] == EMPTY)
		table->count++;
	table->slots[slot] = value;
	table->keys[slot] = key;
	return true;
}

/* Keys behind the gap that are looked for from before it move into it (Knuth 6.4, algorithm R). */
void view_table_remove(struct view_table *table, uint64_t key)
{
	uint32_t gap = table->room ? slot_of(table, key) : 0, mask = table->room - 1;
	if (!table->room || table->slots[gap] == EMPTY)
		return;
	for (uint32_t at = (gap + 1) & mask; table->slots[at] != EMPTY; at = (at + 1) & mask) {
		uint32_t from_home = (at - home_of(table, table->keys[at])) & mask;
		if (from_home < ((at - gap) & mask))
			continue;
		table->slots[gap] = table->slots[at];
		table->keys[gap] = table->keys[at];
		gap = at;
	}
	table->slots[gap] = EMPTY;
	table->count--;
}

void view_table_free(struct view_table *table)
{
	free(table->slots);
	free(table->keys);
	*table = (struct view_table){ 0 };
}
