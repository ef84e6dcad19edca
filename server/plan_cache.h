/* Answers to plan and stream requests, by their ETag: the same request to the same pack gives the same bytes,
 * so that a HEAD, a 304 and a repeated GET cost no plan. Status and size are kept of each, the body if it is
 * small. The least recently used goes first. Any thread; a body lives as long as someone holds it. */
#ifndef SRV_PLAN_CACHE_H
#define SRV_PLAN_CACHE_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define SRV_KEPT_BODY_MAX (256u << 10)

struct srv_kept_body { _Atomic(uint32_t) holders; size_t size; uint8_t bytes[]; };
struct srv_kept_answer { unsigned status; uint64_t size_bytes; struct srv_kept_body *body; /* or NULL */ };

/* A body of `size` bytes, which the caller fills and holds; NULL: no memory, or larger than SRV_KEPT_BODY_MAX. */
struct srv_kept_body *srv_kept_body_make(uint64_t size);
void srv_kept_body_hold(struct srv_kept_body *body);
void srv_kept_body_release(struct srv_kept_body *body);          /* NULL is fine */

struct srv_plan_cache;
/* NULL if there is no memory. */
struct srv_plan_cache *srv_plan_cache_new(uint64_t bytes_max);
void srv_plan_cache_free(struct srv_plan_cache *cache);          /* NULL is fine */
/* Holds the body, too. `etag`: short; "": nothing is kept, as without memory. */
void srv_plan_cache_put(struct srv_plan_cache *cache, const char *etag, const struct srv_kept_answer *kept);
/* The caller holds the body then, if there is one. */
bool srv_plan_cache_get(struct srv_plan_cache *cache, const char *etag, struct srv_kept_answer *kept);
/* Memory of all that is kept. */
uint64_t srv_plan_cache_bytes(struct srv_plan_cache *cache);

#endif
