#include "client-min/view_cache.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/array_grow.h"

#define BAD(...) eco_fail(error, ECO_DAMAGED, __VA_ARGS__)

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

bool view_cache_wants(const struct view_cache *cache, uint32_t list, uint32_t ordinal)
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
	return chunks == 0 || view_cache_wants(cache, list, chunks - 1)
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
		for (uint32_t c = 0; c < list->served && view_cache_wants(cache, list->id, c); c++)
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
	return all || (cache->wanted.count ? !view_cache_wants(cache, list->id, last)
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

static void trim_all(struct view_cache *cache)
{
	for (uint32_t i = 0; i < cache->list_count; i++) {
		uint64_t before = cache->lists[i]->bytes;
		view_list_trim(cache->lists[i]);
		view_cache_charge(cache, cache->lists[i], before);
	}
	cache->is_tight = true;
}

bool view_cache_make_room(struct view_cache *cache, uint64_t bytes, bool all)
{
	if (bytes > cache->memory_max)
		return false;
	if (bytes > room_left(cache) && !cache->is_tight)
		trim_all(cache);
	while (bytes > room_left(cache)) {
		struct view_list *list = next_victim(cache, all);
		if (!list)
			return false;
		evict(cache, list);
	}
	return true;
}

void view_cache_leave_room(struct view_cache *cache, uint64_t bytes, uint64_t since)
{
	while (bytes > room_left(cache)) {
		struct view_list *list = next_victim(cache, false);
		if (!list || list->marks[list->chunk_count - 1].used >= since)
			return;
		evict(cache, list);
	}
}

/* ---- Forms ---- */

void view_forms_free(struct view_forms *forms)
{
	view_table_free(&forms->table);
	free(forms->rows);
	*forms = (struct view_forms){ 0 };
}

/* As both are described. */
static enum eco_code check_form(const struct view_list *form, const struct view_list *of,
	struct eco_error *error)
{
	if (of->list.kind != ECO_LIST_TRIANGLES || of->list.coder != ECO_CODER_ELEMENTS)
		return BAD("list %u is a form of list %u, which is not one of fans", form->id, of->id);
	if (form->list.chunk_count != of->list.chunk_count
		|| form->list.element_count != of->list.element_count)
		return BAD("list %u is a form of list %u: %u elements in %u chunks for %u in %u", form->id,
			of->id, form->list.element_count, form->list.chunk_count, of->list.element_count,
			of->list.chunk_count);
	return ECO_OK;
}

/* Up to the end of a chunk, of which one is held and one (`list`) is about to be. */
static enum eco_code check_chunk(const struct view_list *list, uint32_t ordinal, uint32_t elements,
	const struct view_list *other, struct eco_error *error)
{
	if (ordinal < other->chunk_count && elements != other->marks[ordinal].elements)
		return BAD("chunk %u of list %u ends at element %u, that of list %u at %u: they are forms of "
			"the same", ordinal, list->id, elements, other->id, other->marks[ordinal].elements);
	return ECO_OK;
}

static const struct view_list *form_of(const struct view_cache *cache, const struct view_list *list)
{
	return list->list.coder == ECO_CODER_FORM ? view_cache_find(cache, list->list.partner) : NULL;
}

/* The row of a list that has forms, or NULL. */
static uint32_t *row_of(const struct view_forms *forms, uint32_t list)
{
	uint32_t index = view_table_get(&forms->table, list);
	return index == UINT32_MAX ? NULL : forms->rows[index];
}

static uint32_t *row_make(struct view_forms *forms, uint32_t list)
{
	uint32_t *row = row_of(forms, list);
	if (row || !eco_array_grow(&forms->rows, &forms->room, forms->count, sizeof *forms->rows)
			|| !view_table_put(&forms->table, list, forms->count))
		return row;
	return memset(forms->rows[forms->count++], 0xff, sizeof *forms->rows);
}

static enum eco_code enter(struct view_forms *forms, const struct view_list *list, struct eco_error *error)
{
	uint32_t *row = row_make(forms, list->list.partner);
	if (!row)
		return eco_no_memory(error, "a list");
	for (uint32_t i = 0; i < VIEW_FORMS_MAX; i++)
		if (row[i] == list->id || row[i] == UINT32_MAX) {
			row[i] = list->id;
			return ECO_OK;
		}
	return BAD("list %u has more than %u forms", list->list.partner, VIEW_FORMS_MAX);
}

enum eco_code view_forms_bind(struct view_forms *forms, const struct view_cache *cache,
	const struct view_list *list,
	struct eco_error *error)
{
	const struct view_list *of = form_of(cache, list);
	const uint32_t *row = row_of(forms, list->id);
	enum eco_code code = of ? check_form(list, of, error) : ECO_OK;
	for (uint32_t i = 0; row && i < VIEW_FORMS_MAX && !code; i++) {
		const struct view_list *form = view_cache_find(cache, row[i]);
		code = form ? check_form(form, list, error) : ECO_OK;
	}
	return code || list->list.coder != ECO_CODER_FORM ? code : enter(forms, list, error);
}

enum eco_code view_forms_check(const struct view_forms *forms, const struct view_cache *cache,
	const struct view_list *list, uint32_t ordinal, uint32_t elements, struct eco_error *error)
{
	const struct view_list *of = form_of(cache, list);
	const uint32_t *row = row_of(forms, list->id);
	enum eco_code code = of ? check_chunk(list, ordinal, elements, of, error) : ECO_OK;
	for (uint32_t i = 0; row && i < VIEW_FORMS_MAX && !code; i++) {
		const struct view_list *form = view_cache_find(cache, row[i]);
		code = form ? check_chunk(list, ordinal, elements, form, error) : ECO_OK;
	}
	return code;
}
