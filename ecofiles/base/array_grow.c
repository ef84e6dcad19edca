#include "ecofiles/base/array_grow.h"

#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/random.h"

#define FIRST 64u
#define MOST (1u << 31)

bool eco_array_grow(void *array, uint32_t *capacity, uint32_t count, size_t size)
{
	uint32_t wanted = *capacity ? 2 * *capacity : FIRST;
	void *items, *bigger;
	if (count < *capacity)
		return true;
	/* memcpy: pointers of all types look alike here, but aliasing forbids reading one as another */
	memcpy(&items, array, sizeof items);
	bigger = *capacity < MOST ? realloc(items, wanted * size) : NULL;
	if (!bigger)
		return false;
	memcpy(array, &bigger, sizeof bigger);
	*capacity = wanted;
	return true;
}

void eco_free_all(void *const *pointers, size_t count)
{
	for (size_t i = 0; i < count; i++)
		free(pointers[i]);
}

#define NOBODY UINT32_MAX
#define FIRST_SLOTS 64u

static uint32_t hash_of(const char *text)
{
	uint64_t hash = 0;
	for (; *text; text++)
		hash = (hash ^ (unsigned char)*text) * 0x100000001b3u;
	return (uint32_t)eco_random(0, hash);
}

/* The slot where a text is, or belongs. */
static uint32_t *slot_of(const struct eco_string_pool *t, const char *text)
{
	uint32_t at = hash_of(text) & (t->slot_count - 1);
	while (t->slots[at] != NOBODY && strcmp(t->items[t->slots[at]], text) != 0)
		at = (at + 1) & (t->slot_count - 1);
	return &t->slots[at];
}

/* Half of the slots stay empty. */
static bool make_slots(struct eco_string_pool *t)
{
	uint32_t count = t->slot_count ? 2 * t->slot_count : FIRST_SLOTS;
	if (t->count < t->slot_count / 2)
		return true;
	uint32_t *slots = count ? malloc(count * sizeof *slots) : NULL;
	if (!slots)
		return false;
	memset(slots, 0xff, count * sizeof *slots);
	free(t->slots);
	t->slots = slots;
	t->slot_count = count;
	for (uint32_t i = 0; i < t->count; i++)
		*slot_of(t, t->items[i]) = i;
	return true;
}

bool eco_string_pool_add(struct eco_string_pool *texts, const char *text, uint32_t *number)
{
	if (!make_slots(texts)
			|| !eco_array_grow(&texts->items, &texts->capacity, texts->count, sizeof *texts->items))
		return false;
	uint32_t *slot = slot_of(texts, text);
	if (*slot == NOBODY) {
		if (!(texts->items[texts->count] = strdup(text)))
			return false;
		*slot = texts->count++;
	}
	*number = *slot;
	return true;
}

void eco_string_pool_free(struct eco_string_pool *texts)
{
	for (uint32_t i = 0; i < texts->count; i++)
		free(texts->items[i]);
	free(texts->items);
	free(texts->slots);
	*texts = (struct eco_string_pool){ 0 };
}
