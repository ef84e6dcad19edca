/* The lists that a client holds, within a limit of memory: which chunks go when it is short.
 *
 * The chunk goes that was not needed for the longest time; among chunks last needed by the same plan, the
 * largest. This is "least recently used" (Mattson et al. 1970) with size as the second key (Williams, Abrams
 * et al. 1996, "Removal policies in network caches"); Deussen et al. 2002, section 6.3, keep the models used
 * most in the current scene. Plans need prefixes of lists, so a list loses its last chunk first.
 *
 * Time is a counter: each begin and each plan of a stream is one tick later. Chunks with the current tick
 * stay: they came for the next plan. While `wanted` is not empty, it stays instead, and all else may go.
 *
 *   view_cache_begin(&cache);                       per stream: ages everything, drops lists of no chunk
 *   view_cache_make_room(&cache, bytes, false);     pops chunks until so many bytes fit; false: they cannot
 *   view_cache_add(&cache, list); ... view_list_push(list, ...); view_cache_charge(&cache, list, before);
 *   view_cache_touch(&cache, list, chunks);         a plan needs these
 *   view_cache_free(&cache); */
#pragma once

#include "client-min/view_list.h"
#include "client-min/view_table.h"

#define VIEW_MEMORY_LEAST (64ull << 10)   /* limits of --memory */
#define VIEW_MEMORY_MOST (1ull << 40)

struct view_cache {
	uint64_t memory_max, memory_bytes, peak_bytes;   /* memory_bytes: at most memory_max; peak: its maximum */
	uint64_t tick;
	struct view_list **lists;                /* in order of arrival, until one goes */
	uint32_t list_count, list_room;
	struct view_table table;                 /* id -> index in lists */
	struct view_table wanted;                /* list -> chunks that must stay */
	struct view_table lost;                  /* list -> chunks that came at some time, once one of them went */
	uint64_t evictions, evicted_bytes;       /* chunks, and their decoded bytes */
};

void view_cache_free(struct view_cache *cache);
void view_cache_begin(struct view_cache *cache);
void view_cache_tick(struct view_cache *cache);                  /* what has come so far may go */

struct view_list *view_cache_find(const struct view_cache *cache, uint32_t id);      /* or NULL */
/* Owns the list from then on; false: no memory, the list is the caller's. Its bytes must have room. */
bool view_cache_add(struct view_cache *cache, struct view_list *list);
/* After list->bytes has changed from `before`. */
void view_cache_charge(struct view_cache *cache, const struct view_list *list, uint64_t before);
/* Charges what belongs to no list; false if it does not fit. */
bool view_cache_charge_bytes(struct view_cache *cache, uint64_t bytes);
/* The first `chunks` chunks, as far as they are held, are needed now. */
void view_cache_touch(struct view_cache *cache, struct view_list *list, uint32_t chunks);
/* The chunk came before, and went. */
bool view_cache_had(const struct view_cache *cache, uint32_t list, uint32_t ordinal);
void view_cache_remember(struct view_cache *cache, uint32_t list, uint32_t ordinal);
/* These chunks must stay; false: no memory. */
bool view_cache_want(struct view_cache *cache, uint32_t list, uint32_t chunks);
void view_cache_want_nothing(struct view_cache *cache);
/* Memory if all lists held exactly what is wanted of them, counted by marks. */
uint64_t view_cache_wanted_bytes(const struct view_cache *cache);
/* True once `bytes` fit. `all`: chunks that came for the next plan may go, too, in the same order. */
bool view_cache_make_room(struct view_cache *cache, uint64_t bytes, bool all);
