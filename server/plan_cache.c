/* A hash table of chains, and a ring from the latest asked for to the one to go first. The mutex guards
 * both; no body is copied under it. */
#include "server/plan_cache.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <xxhash.h>

#define CHAINS 4096u
#define ETAG_BYTES_MAX 40u
#define PAGES_FROM (8u << 10)

struct entry {
	struct entry *before, *next;             /* ring */
	struct entry *chain;
	char etag[ETAG_BYTES_MAX];
	struct srv_kept_answer kept;
};

struct srv_plan_cache {
	pthread_mutex_t mutex;
	struct entry ring;
	uint64_t bytes, bytes_max;
	struct entry *chains[CHAINS];
};

/* Large bodies have pages of their own, which go back when they are forgotten: among what plans take and
 * leave they made gaps, by which memory grew for 700,000 requests. */
static bool has_pages(size_t room)
{
	return room >= PAGES_FROM;
}

static void *take(size_t room)
{
	void *at = has_pages(room) ? mmap(NULL, room, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1,
		0) : malloc(room);
	return at == MAP_FAILED ? NULL : at;
}

static void give(void *at, size_t room)
{
	if (has_pages(room))
		munmap(at, room);
	else
		free(at);
}

struct srv_kept_body *srv_kept_body_make(uint64_t size)
{
	struct srv_kept_body *body = size > SRV_KEPT_BODY_MAX ? NULL : take(sizeof *body + (size_t)size);
	if (body) {
		atomic_init(&body->holders, 1);
		body->size = (size_t)size;
	}
	return body;
}

void srv_kept_body_hold(struct srv_kept_body *body)
{
	atomic_fetch_add(&body->holders, 1);
}

void srv_kept_body_release(struct srv_kept_body *body)
{
	if (body && atomic_fetch_sub(&body->holders, 1) == 1)
		give(body, sizeof *body + body->size);
}

struct srv_plan_cache *srv_plan_cache_new(uint64_t bytes_max)
{
	struct srv_plan_cache *cache = calloc(1, sizeof *cache);
	if (!cache)
		return NULL;
	pthread_mutex_init(&cache->mutex, NULL);
	cache->ring.before = cache->ring.next = &cache->ring;
	cache->bytes_max = bytes_max;
	return cache;
}

static struct entry **chain_of(struct srv_plan_cache *cache, const char *etag)
{
	return &cache->chains[XXH3_64bits(etag, strlen(etag)) % CHAINS];
}

static struct entry *find(struct srv_plan_cache *cache, const char *etag)
{
	struct entry *entry = *chain_of(cache, etag);
	while (entry && strcmp(entry->etag, etag) != 0)
		entry = entry->chain;
	return entry;
}

static uint64_t bytes_of(const struct srv_kept_answer *kept)
{
	return sizeof(struct entry) + (kept->body ? sizeof *kept->body + kept->body->size : 0);
}

static void leave_ring(struct entry *entry)
{
	entry->before->next = entry->next;
	entry->next->before = entry->before;
}

static void lead_ring(struct srv_plan_cache *cache, struct entry *entry)
{
	entry->before = &cache->ring;
	entry->next = cache->ring.next;
	entry->before->next = entry->next->before = entry;
}

static void drop(struct srv_plan_cache *cache, struct entry *entry)
{
	struct entry **link = chain_of(cache, entry->etag);
	while (*link != entry)
		link = &(*link)->chain;
	*link = entry->chain;
	leave_ring(entry);
	cache->bytes -= bytes_of(&entry->kept);
	srv_kept_body_release(entry->kept.body);
	free(entry);
}

static void add(struct srv_plan_cache *cache, struct entry *entry)
{
	struct entry **chain = chain_of(cache, entry->etag);
	entry->chain = *chain;
	*chain = entry;
	lead_ring(cache, entry);
	cache->bytes += bytes_of(&entry->kept);
	if (entry->kept.body)
		srv_kept_body_hold(entry->kept.body);
}

void srv_plan_cache_put(struct srv_plan_cache *cache, const char *etag, const struct srv_kept_answer *kept)
{
	struct entry *entry = strlen(etag) < ETAG_BYTES_MAX ? calloc(1, sizeof *entry) : NULL;
	if (!entry)
		return;
	strcpy(entry->etag, etag);
	entry->kept = *kept;
	pthread_mutex_lock(&cache->mutex);
	struct entry *known = find(cache, etag);
	if (known)
		drop(cache, known);
	add(cache, entry);
	while (cache->bytes > cache->bytes_max)
		drop(cache, cache->ring.before);
	pthread_mutex_unlock(&cache->mutex);
}

bool srv_plan_cache_get(struct srv_plan_cache *cache, const char *etag, struct srv_kept_answer *kept)
{
	pthread_mutex_lock(&cache->mutex);
	struct entry *entry = find(cache, etag);
	if (entry) {
		leave_ring(entry);
		lead_ring(cache, entry);
		*kept = entry->kept;
		if (kept->body)
			srv_kept_body_hold(kept->body);
	}
	pthread_mutex_unlock(&cache->mutex);
	return entry;
}

uint64_t srv_plan_cache_bytes(struct srv_plan_cache *cache)
{
	pthread_mutex_lock(&cache->mutex);
	uint64_t bytes = cache->bytes;
	pthread_mutex_unlock(&cache->mutex);
	return bytes;
}

void srv_plan_cache_free(struct srv_plan_cache *cache)
{
	if (!cache)
		return;
	while (cache->ring.next != &cache->ring)
		drop(cache, cache->ring.next);
	pthread_mutex_destroy(&cache->mutex);
	free(cache);
}
