#include "client-min/view_cache.h"

#include <assert.h>
#include <stdlib.h>

#include "ecofiles/base/array_grow.h"

void view_cache_free(struct view_cache *cache)
{
	for (uint32_t i = 0; i < cache->list_count; i++)
		view_list_free(cache->lists[i]);
	view_table_free(&cache->table);
	view_table_free(&cache->wanted);
	view_table_free(&cache->lost);
	free(cache->lists);
	*cache = (struct view_cache){ 0 };
}

/* ---- Lists ---- */

struct view_list *view_cache_find(const struct view_cache *cache, uint32_t id)
{
	uint32_t index = view_table_get(&cache->table, id);
	return index == UINT32_MAX ? NULL : cache->lists[index];
}

static uint64_t room_left(const struct view_cache *cache)
{
	return cache->memory_max - cache->memory_bytes;
}

bool view_cache_charge_bytes(struct view_cache *cache, uint64_t bytes)
{
	if (bytes > room_left(cache))
		return false;
	cache->memory_bytes += bytes;
	if (cache->memory_bytes > cache->peak_bytes)
		cache->peak_bytes = cache->memory_bytes;
	return true;
}

void view_cache_charge(struct view_cache *cache, const struct view_list *list, uint64_t before)
{
	if (list->bytes <= before) {
		cache->memory_bytes -= before - list->bytes;
		return;
	}
	bool fits = view_cache_charge_bytes(cache, list->bytes - before);
	assert(fits);
}

bool view_cache_add(struct view_cache *cache, struct view_list *list)
{
	if (!eco_array_grow(&cache->lists, &cache->list_room, cache->list_count, sizeof *cache->lists)
			|| !view_table_put(&cache->table, list->id, cache->list_count))
		return false;
	cache->lists[cache->list_count++] = list;
	view_cache_charge(cache, list, 0);
	return true;
}

/* The last list takes the place of one that goes. */
static void remove_list(struct view_cache *cache, uint32_t index)
{
	struct view_list *list = cache->lists[index], *last = cache->lists[--cache->list_count];
	cache->memory_bytes -= list->bytes;
	view_table_remove(&cache->table, list->id);
	if (last != list) {
		cache->lists[index] = last;
		view_table_put(&cache->table, last->id, index);
	}
	view_list_free(list);
}

static void remove_empty(struct view_cache *cache)
{
	for (uint32_t i = cache->list_count; i-- > 0;)
		if (cache->lists[i]->chunk_count == 0)
			remove_list(cache, i);
}

/* ---- Use ---- */

void view_cache_tick(struct view_cache *cache)
{
	cache->tick++;
}

void view_cache_begin(struct view_cache *cache)
{
	view_cache_tick(cache);
	remove_empty(cache);
	for (uint32_t i = 0; i < cache->list_count; i++)
		cache->lists[i]->served = cache->lists[i]->chunk_count;
}

void view_cache_touch(struct view_cache *cache, struct view_list *list, uint32_t chunks)
{
	uint32_t c = chunks < list->chunk_count ? chunks : list->chunk_count;
	while (c > 0 && list->marks[c - 1].used != cache->tick)
		list->marks[--c].used = cache->tick;
}

static bool is_wanted(const struct view_cache *cache, uint32_t list, uint32_t ordinal)
{
	uint32_t chunks = view_table_get(&cache->wanted, list);
	return chunks != UINT32_MAX && ordinal < chunks;
}

bool view_cache_had(const struct view_cache *cache, uint32_t list, uint32_t ordinal)
{
	uint32_t chunks = view_table_get(&cache->lost, list);
	return chunks != UINT32_MAX && ordinal < chunks;
}

void view_cache_remember(struct view_cache *cache, uint32_t list, uint32_t ordinal)
{
	if (!view_cache_had(cache, list, ordinal))
		view_table_put(&cache->lost, list, ordinal + 1);
}

bool view_cache_want(struct view_cache *cache, uint32_t list, uint32_t chunks)
{
	return chunks == 0 || is_wanted(cache, list, chunks - 1)
		|| view_table_put(&cache->wanted, list, chunks);
}

void view_cache_want_nothing(struct view_cache *cache)
{
	view_table_free(&cache->wanted);
}

uint64_t view_cache_wanted_bytes(const struct view_cache *cache)
{
	uint64_t bytes = cache->memory_bytes;
	for (uint32_t i = 0; i < cache->list_count; i++) {
		const struct view_list *list = cache->lists[i];
		bytes = bytes - list->bytes + view_list_bytes(&list->list);
		for (uint32_t c = 0; c < list->served && is_wanted(cache, list->id, c); c++)
			bytes += list->marks[c].bytes;
	}
	return bytes;
}

/* ---- Eviction ---- */

static bool may_go(const struct view_cache *cache, const struct view_list *list, bool all)
{
	uint32_t last = list->chunk_count - 1;
	if (list->chunk_count == 0)
		return false;
	return all || (cache->wanted.count ? !is_wanted(cache, list->id, last)
		: list->marks[last].used < cache->tick);
}

/* Whether the last chunk of `a` goes before that of `b`. */
static bool goes_before(const struct view_list *a, const struct view_list *b)
{
	const struct view_mark *x = &a->marks[a->chunk_count - 1], *y = &b->marks[b->chunk_count - 1];
	if (x->used != y->used)
		return x->used < y->used;
	return x->bytes != y->bytes ? x->bytes > y->bytes : a->id < b->id;
}

/* The list whose last chunk goes next, or NULL. */
static struct view_list *next_victim(const struct view_cache *cache, bool all)
{
	struct view_list *victim = NULL;
	for (uint32_t i = 0; i < cache->list_count; i++)
		if (may_go(cache, cache->lists[i], all) && (!victim || goes_before(cache->lists[i], victim)))
			victim = cache->lists[i];
	return victim;
}

static void evict(struct view_cache *cache, struct view_list *list)
{
	uint64_t before = list->bytes;
	view_cache_remember(cache, list->id, list->chunk_count - 1);
	cache->evictions++;
	cache->evicted_bytes += list->marks[list->chunk_count - 1].bytes;
	view_list_pop(list);
	view_cache_charge(cache, list, before);
}

bool view_cache_make_room(struct view_cache *cache, uint64_t bytes, bool all)
{
	if (bytes > cache->memory_max)
		return false;
	while (bytes > room_left(cache)) {
		struct view_list *list = next_victim(cache, all);
		if (!list)
			return false;
		evict(cache, list);
	}
	return true;
}
