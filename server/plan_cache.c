/* A tree by tag, and a ring from the latest asked for to the one to go first. The mutex guards both; no body
 * is copied under it. */
#include "server/exchange.h"

#include <pthread.h>
#include <search.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

#define ETAG_BYTES_MAX 40u
#define PAGES_FROM (8u << 10)

struct answer_kept {
	struct answer_kept *next, *before;             /* ring, as insque has it */
	char etag[ETAG_BYTES_MAX];
	struct srv_kept_answer kept;
};

struct srv_plan_cache {
	pthread_mutex_t mutex;
	struct answer_kept ring;
	uint64_t bytes, bytes_max;
	void *tree;
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

static int by_tag(const void *a, const void *b)
{
	return strcmp(((const struct answer_kept *)a)->etag, ((const struct answer_kept *)b)->etag);
}

static struct answer_kept *find(struct srv_plan_cache *cache, const char *etag)
{
	struct answer_kept key;
	snprintf(key.etag, sizeof key.etag, "%s", etag);
	struct answer_kept *const *found = tfind(&key, &cache->tree, by_tag);
	return found ? *found : NULL;
}

static uint64_t bytes_of(const struct srv_kept_answer *kept)
{
	return sizeof(struct answer_kept) + (kept->body ? sizeof *kept->body + kept->body->size : 0);
}

static void drop(struct srv_plan_cache *cache, struct answer_kept *entry)
{
	tdelete(entry, &cache->tree, by_tag);
	remque(entry);
	cache->bytes -= bytes_of(&entry->kept);
	srv_kept_body_release(entry->kept.body);
	free(entry);
}

void srv_plan_cache_put(struct srv_plan_cache *cache, const char *etag, const struct srv_kept_answer *kept)
{
	struct answer_kept *entry = *etag && strlen(etag) < ETAG_BYTES_MAX ? calloc(1, sizeof *entry) : NULL;
	if (!entry)
		return;
	strcpy(entry->etag, etag);
	entry->kept = *kept;
	pthread_mutex_lock(&cache->mutex);
	struct answer_kept *known = find(cache, etag);
	if (known)
		drop(cache, known);
	if (tsearch(entry, &cache->tree, by_tag)) {
		insque(entry, &cache->ring);
		cache->bytes += bytes_of(&entry->kept);
		if (entry->kept.body)
			srv_kept_body_hold(entry->kept.body);
	} else {
		free(entry);
	}
	while (cache->bytes > cache->bytes_max)
		drop(cache, cache->ring.before);
	pthread_mutex_unlock(&cache->mutex);
}

bool srv_plan_cache_get(struct srv_plan_cache *cache, const char *etag, struct srv_kept_answer *kept)
{
	pthread_mutex_lock(&cache->mutex);
	struct answer_kept *entry = find(cache, etag);
	if (entry) {
		remque(entry);
		insque(entry, &cache->ring);
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
