#include "lod/sort.h"

#include <assert.h>

void lod_shuffle(void *items, uint32_t count, size_t size, uint64_t seed)
{
	char spare[64], *bytes = items;
	assert(size <= sizeof spare);
	for (uint32_t i = count; i > 1; i--) {
		uint32_t k = (uint32_t)(eco_random(seed, i) % i);
		memcpy(spare, bytes + k * size, size);
		memcpy(bytes + k * size, bytes + (i - 1) * size, size);
		memcpy(bytes + (i - 1) * size, spare, size);
	}
}

/* Radix sort, least significant byte first; a pass in which all keys agree is left out. */
void lod_sort(struct lod_arena *arena, struct lod_keyed *items, uint32_t count)
{
	struct lod_arena_piece *mark = arena->last;
	struct lod_keyed *from = items, *to = lod_arena_take(arena, count, sizeof *to);
	for (unsigned shift = 0; shift < 64 && count > 1; shift += 8) {
		uint32_t start[257] = { 0 };
		for (uint32_t i = 0; i < count; i++)
			start[1 + (from[i].key >> shift & 255)]++;
		if (start[1 + (from[0].key >> shift & 255)] == count)
			continue;
		for (unsigned b = 0; b < 256; b++)
			start[b + 1] += start[b];
		for (uint32_t i = 0; i < count; i++)
			to[start[from[i].key >> shift & 255]++] = from[i];
		struct lod_keyed *other = from;
		from = to;
		to = other;
	}
	if (from != items)
		memcpy(items, from, count * sizeof *items);
	lod_arena_release(arena, mark);
}
