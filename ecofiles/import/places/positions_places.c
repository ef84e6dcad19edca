/* A set of places: open addressing over 64-bit hashes of millimetres, in 256 parts. Each part grows by
 * half when it is four fifths full, so that a place takes 10 to 15 bytes, also during growth. Two places
 * with one hash (in one of 10^5 inventories of 10^7 rows) count as one. */
#include <math.h>
#include <stdlib.h>

#include "ecofiles/base/random.h"
#include "ecofiles/import/places/positions_parts.h"

#define PARTS 256u
#define FIRST 16u

struct part { uint64_t *slots; uint32_t count, capacity; };
struct eco_place_set { struct part parts[PARTS]; };

struct eco_place_set *eco_place_set_open(void)
{
	return calloc(1, sizeof(struct eco_place_set));
}

/* The slot of a hash, or the free slot where it belongs. */
static uint64_t *slot_of(const struct part *part, uint64_t hash)
{
	uint32_t at = (uint32_t)(((hash >> 8 & 0xffffffffu) * part->capacity) >> 32);
	while (part->slots[at] != 0 && part->slots[at] != hash)
		at = at + 1 == part->capacity ? 0 : at + 1;
	return &part->slots[at];
}

static bool grow(struct part *part)
{
	struct part bigger = { .count = part->count, .capacity = part->capacity == 0 ? FIRST
		: part->capacity + part->capacity / 2 };
	if (part->capacity > UINT32_MAX / 2)
		return false;
	bigger.slots = calloc(bigger.capacity, sizeof *bigger.slots);
	if (!bigger.slots)
		return false;
	for (uint32_t i = 0; i < part->capacity; i++)
		if (part->slots[i] != 0)
			*slot_of(&bigger, part->slots[i]) = part->slots[i];
	free(part->slots);
	*part = bigger;
	return true;
}

bool eco_place_set_add(struct eco_place_set *set, const double at[3], bool *known)
{
	uint64_t hash = 0, *slot;
	for (int k = 0; k < 3; k++)
		hash = eco_random(hash, (uint64_t)(int64_t)floor(at[k] * 1000 + 0.5));
	hash += hash == 0;
	struct part *part = &set->parts[hash % PARTS];
	if (part->count * 5ull >= part->capacity * 4ull && !grow(part))
		return false;
	slot = slot_of(part, hash);
	*known = *slot != 0;
	part->count += !*known;
	*slot = hash;
	return true;
}

void eco_place_set_close(struct eco_place_set *set)
{
	for (uint32_t i = 0; set && i < PARTS; i++)
		free(set->parts[i].slots);
	free(set);
}
