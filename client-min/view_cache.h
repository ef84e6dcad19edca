/* The lists that a client holds, within a limit of memory: which chunks go when it is short.
 *
 * The rule. The chunk goes that was not needed for the longest time; of chunks that were last needed by the
 * same plan, the largest. It is "least recently used" (Mattson et al. 1970) with size as the second key
 * (Williams, Abrams et al. 1996, "Removal policies in network caches", who compared such pairs of keys).
 * Deussen et al. 2002, section 6.3, keep the models that are used most in the current scene; a plan names
 * what the current view uses, so its time of last use says the same for a camera that moves. Plans need
 * prefixes of lists, so a list loses its last chunk first.
 *
 * Time is a counter: each begin and each plan of a stream is one tick later. What has the current tick stays:
 * it came for the next plan. But while `wanted` is not empty, it is known what a plan needs, the last one or
 * the next: what `wanted` names stays, all else may go.
 *
 *   view_cache_begin(&cache);                       per stream: ages everything, drops lists of no chunk
 *   view_cache_make_room(&cache, bytes, false);     pops chunks until so many bytes fit; false: they cannot
 *   view_cache_add(&cache, list); ... view_list_push(list, ...); view_cache_charge(&cache, list, before);
 *   view_cache_touch(&cache, list, chunks);         a plan needs these
 *   view_cache_free(&cache); */
#ifndef VIEW_CACHE_H
#define VIEW_CACHE_H

#include "client-min/view_list.h"
#include "client-min/view_table.h"

#define VIEW_MEMORY_LEAST (64ull << 10)   /* limits of what --memory takes */
#define VIEW_MEMORY_MOST (1ull << 40)

struct view_cache {
	uint64_t memory_max, memory_bytes;       /* the second never exceeds the first */
	uint64_t peak_bytes;                     /* the most that memory_bytes has been */
	uint64_t tick;
	struct view_list **lists;                /* in order of arrival, until one goes */
	uint32_t list_count, list_room;
	struct view_table table;                 /* id -> index in lists */
	struct view_table wanted;                /* list -> chunks that must stay; empty: see above */
	/* list -> chunks of it that came at some time, known once one of them went */
	struct view_table lost;
	bool is_tight;           /* memory has been short: arrays take no more than they need */
	uint64_t evictions, evicted_bytes;       /* chunks, and their decoded bytes */
};

void view_cache_free(struct view_cache *cache);
void view_cache_begin(struct view_cache *cache);
/* A later tick: what has come so far may go. */
void view_cache_tick(struct view_cache *cache);

struct view_list *view_cache_find(const struct view_cache *cache, uint32_t id);      /* or NULL */
/* Owns the list from then on; false: no memory, the list is the caller's. Its bytes must have room. */
bool view_cache_add(struct view_cache *cache, struct view_list *list);
/* After list->bytes has changed from `before`. */
void view_cache_charge(struct view_cache *cache, const struct view_list *list, uint64_t before);
/* Charges what belongs to no list; false if it does not fit. */
bool view_cache_charge_bytes(struct view_cache *cache, uint64_t bytes);
/* The first `chunks` chunks, as far as they are held, are needed now. */
void view_cache_touch(struct view_cache *cache, struct view_list *list, uint32_t chunks);
bool view_cache_wants(const struct view_cache *cache, uint32_t list, uint32_t ordinal);
/* The chunk came before, and went. */
bool view_cache_had(const struct view_cache *cache, uint32_t list, uint32_t ordinal);
void view_cache_remember(struct view_cache *cache, uint32_t list, uint32_t ordinal);
/* Says that these chunks must stay; false: no memory. */
bool view_cache_want(struct view_cache *cache, uint32_t list, uint32_t chunks);
void view_cache_want_nothing(struct view_cache *cache);
/* What there would be if all lists that are here held what is wanted of them, and nothing else: of chunks
 * that are not held, marks say how much they take. */
uint64_t view_cache_wanted_bytes(const struct view_cache *cache);

/* True once `bytes` fit. `all`: what came for the next plan may go, too, in the same order. */
bool view_cache_make_room(struct view_cache *cache, uint64_t bytes, bool all);
/* Pops, before a stream comes, until `bytes` fit or only what was needed at tick `since` or later is left. */
void view_cache_leave_room(struct view_cache *cache, uint64_t bytes, uint64_t since);

/* ---- Forms ---- */

/* Lists that are forms of others: element i of one is element i of the other, in whatever order they come. What is
 * known of that stays when the lists have gone. */
#define VIEW_FORMS_MAX 8u                /* of one list: each of its chunks is compared with each */

struct view_forms {                      /* zero is empty */
	struct view_table table;         /* list that has forms -> row */
	uint32_t (*rows)[VIEW_FORMS_MAX];        /* ids of forms, then UINT32_MAX */
	uint32_t count, room;
};
void view_forms_free(struct view_forms *forms);

/* Checks a list that is about to be held against those that it is a form of, or that are forms of it. */
enum eco_code view_forms_bind(struct view_forms *forms, const struct view_cache *cache,
	const struct view_list *list,
	struct eco_error *error);
/* The same for its chunk `ordinal`, which ends at element `elements`. */
enum eco_code view_forms_check(const struct view_forms *forms, const struct view_cache *cache,
	const struct view_list *list, uint32_t ordinal, uint32_t elements, struct eco_error *error);

#endif
