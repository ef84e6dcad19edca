#include "server/catalog.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

struct srv_catalog {
	pthread_mutex_t mutex;
	struct srv_edition *current;     /* which the catalog holds */
};

void srv_edition_release(struct srv_edition *edition)
{
	if (!edition || atomic_fetch_sub(&edition->holders, 1) > 1)
		return;
	for (uint32_t i = 0; i < edition->store.count; i++)
		srv_scene_release(edition->store.scenes[i]);
	for (uint32_t i = 0; i < edition->retired_count; i++)
		srv_scene_release(edition->retired[i].scene);
	free(edition->store.scenes);
	free(edition->retired);
	free(edition);
}

static bool has(const struct srv_store *store, const struct srv_scene *scene)
{
	for (uint32_t i = 0; i < store->count; i++)
		if (store->scenes[i] == scene)
			return true;
	return false;
}

/* The latest come first: where reloads follow each other fast, the oldest go. */
static void keep(struct srv_edition *edition, struct srv_scene *scene, uint64_t until_us)
{
	if (edition->retired_count == SRV_RETIRED_MAX)
		return;
	srv_scene_hold(scene);
	edition->retired[edition->retired_count++] = (struct srv_retired){ scene, until_us };
}

/* An edition of the store's scenes; what `before` (NULL: none) had beside is kept until `until_us`, and what
 * it kept, as long as it was to be, unless that is before `now_us`. */
static enum eco_code edition_new(struct srv_edition **out, const struct srv_store *store,
	const struct srv_edition *before, uint64_t until_us, uint64_t now_us, struct eco_error *error)
{
	struct srv_edition *edition = calloc(1, sizeof *edition);
	enum eco_code code = ECO_OK;
	*out = NULL;
	if (!edition || !(edition->retired = calloc(SRV_RETIRED_MAX, sizeof *edition->retired))) {
		free(edition);
		return eco_fail(error, ECO_NO_MEMORY, "no memory for %u scenes", store->count);
	}
	edition->holders = 1;
	for (uint32_t i = 0; i < store->count && !code; i++)
		code = srv_store_share(&edition->store, store->scenes[i], error);
	for (uint32_t i = 0; before && i < before->store.count; i++)
		if (!has(store, before->store.scenes[i]))
			keep(edition, before->store.scenes[i], until_us);
	for (uint32_t i = 0; before && i < before->retired_count; i++)
		if (before->retired[i].until_us > now_us && !has(store, before->retired[i].scene))
			keep(edition, before->retired[i].scene, before->retired[i].until_us);
	if (code)
		srv_edition_release(edition);
	else
		*out = edition;
	return code;
}

enum eco_code srv_catalog_new(struct srv_catalog **out, const struct srv_store *store,
	struct eco_error *error)
{
	struct srv_catalog *catalog = calloc(1, sizeof *catalog);
	*out = NULL;
	if (!catalog)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for %u scenes", store->count);
	enum eco_code code = edition_new(&catalog->current, store, NULL, 0, 0, error);
	if (code) {
		free(catalog);
		return code;
	}
	pthread_mutex_init(&catalog->mutex, NULL);
	*out = catalog;
	return ECO_OK;
}

void srv_catalog_free(struct srv_catalog *catalog)
{
	if (!catalog)
		return;
	srv_edition_release(catalog->current);
	pthread_mutex_destroy(&catalog->mutex);
	free(catalog);
}

struct srv_edition *srv_catalog_hold(struct srv_catalog *catalog)
{
	pthread_mutex_lock(&catalog->mutex);
	struct srv_edition *edition = catalog->current;
	atomic_fetch_add(&edition->holders, 1);
	pthread_mutex_unlock(&catalog->mutex);
	return edition;
}

/* Makes it the current one, and releases the one before. */
static void publish(struct srv_catalog *catalog, struct srv_edition *edition)
{
	pthread_mutex_lock(&catalog->mutex);
	struct srv_edition *before = catalog->current;
	catalog->current = edition;
	pthread_mutex_unlock(&catalog->mutex);
	srv_edition_release(before);
}

enum eco_code srv_catalog_replace(struct srv_catalog *catalog, const struct srv_store *store,
	uint64_t until_us, uint64_t now_us, struct eco_error *error)
{
	struct srv_edition *before = srv_catalog_hold(catalog), *edition;
	enum eco_code code = edition_new(&edition, store, before, until_us, now_us, error);
	srv_edition_release(before);
	if (!code)
		publish(catalog, edition);
	return code;
}

static bool is_over(const struct srv_edition *edition, uint64_t now_us)
{
	for (uint32_t i = 0; i < edition->retired_count; i++)
		if (edition->retired[i].until_us <= now_us)
			return true;
	return false;
}

enum eco_code srv_catalog_retire(struct srv_catalog *catalog, uint64_t now_us, struct eco_error *error)
{
	struct srv_edition *before = srv_catalog_hold(catalog);
	enum eco_code code = is_over(before, now_us)
		? srv_catalog_replace(catalog, &before->store, now_us, now_us, error) : ECO_OK;
	srv_edition_release(before);
	return code;
}

struct srv_scene *srv_edition_find(const struct srv_edition *edition, const char *name, bool retired)
{
	struct srv_scene *scene = srv_store_find(&edition->store, name);
	for (uint32_t i = 0; !scene && retired && i < edition->retired_count; i++)
		if (strcmp(edition->retired[i].scene->name, name) == 0)
			scene = edition->retired[i].scene;
	return scene;
}

struct srv_scene *srv_edition_chunk(const struct srv_edition *edition, const char *name,
	const struct eco_chunk_id *id, uint32_t *chunk)
{
	struct srv_scene *scene = srv_store_find(&edition->store, name);
	*chunk = scene ? srv_scene_chunk(scene, id) : ECO_NONE;
	for (uint32_t i = 0; *chunk == ECO_NONE && i < edition->retired_count; i++) {
		scene = edition->retired[i].scene;
		*chunk = strcmp(scene->name, name) == 0 ? srv_scene_chunk(scene, id) : ECO_NONE;
	}
	return *chunk == ECO_NONE ? NULL : scene;
}
