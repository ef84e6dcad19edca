#include "server/store.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "ecofiles/base/array_grow.h"

void srv_store_init(struct srv_store *store)
{
	*store = (struct srv_store){ 0 };
}

static void hold_scene(struct srv_scene *scene)
{
	atomic_fetch_add(&scene->holders, 1);
}

/* With the last holder it is freed. */
static void release_scene(struct srv_scene *scene)
{
	if (atomic_fetch_sub(&scene->holders, 1) > 1)
		return;
	lod_plan_tables_free(scene->tables);
	json_decref(scene->meta);
	eco_pack_close(scene->pack);
	eco_free(scene->file.path, scene->by_id, scene->checked, scene);
}

void srv_store_free(struct srv_store *store)
{
	for (uint32_t i = 0; i < store->count; i++)
		release_scene(store->scenes[i]);
	free(store->scenes);
	*store = (struct srv_store){ 0 };
}

bool srv_name_valid(const char *name)
{
	size_t size = strspn(name, "abcdefghijklmnopqrstuvwxyz0123456789_-");
	return size >= 1 && size < SRV_NAME_BYTES && !name[size] && name[0] != '_' && name[0] != '-';
}

static int by_id(const void *a, const void *b, void *ctx)
{
	const struct eco_chunk *chunks = ctx;
	uint32_t ia = *(const uint32_t *)a, ib = *(const uint32_t *)b;
	int order = memcmp(chunks[ia].id.bytes, chunks[ib].id.bytes, sizeof chunks->id.bytes);
	return order ? order : (ia > ib) - (ia < ib);
}

static enum eco_code scene_index(struct srv_scene *scene, struct eco_error *error)
{
	uint32_t count = scene->pack->scene.chunk_count;
	scene->by_id = malloc((count + 1) * sizeof *scene->by_id);
	scene->checked = calloc(count + 1, sizeof *scene->checked);
	if (!scene->by_id || !scene->checked)
		return eco_fail(error, ECO_NO_MEMORY, "scene '%s': no memory for an index of %u chunks",
			scene->name, count);
	for (uint32_t i = 0; i < count; i++)
		scene->by_id[i] = i;
	qsort_r(scene->by_id, count, sizeof *scene->by_id, by_id, (void *)scene->pack->scene.chunks);
	return ECO_OK;
}

/* A META that is no JSON counts as empty. */
static enum eco_code scene_meta(struct srv_scene *scene, struct eco_error *error)
{
	json_error_t why = { .line = 0 };
	scene->meta = json_loadb(scene->pack->meta, scene->pack->meta_size, 0, &why);
	if (!scene->meta && json_error_code(&why) != json_error_out_of_memory)
		scene->meta = json_object();
	return scene->meta ? ECO_OK : eco_fail(error, ECO_NO_MEMORY, "scene '%s': no memory for what its "
		"pack says of it", scene->name);
}

static enum eco_code check_name(const struct srv_store *store, const char *name, struct eco_error *error)
{
	if (!srv_name_valid(name))
		return eco_fail(error, ECO_BAD_USAGE, "'%.80s' cannot name a scene: use 1 to 63 of a-z, 0-9, "
			"'_' and '-', the first a letter or digit, as in NAME=OUT.eco", name);
	if (srv_store_find(store, name))
		return eco_fail(error, ECO_BAD_USAGE, "two scenes are named '%s': give one of them another "
			"name, as in NAME=OUT.eco", name);
	if (store->count == SRV_SCENES_MAX)
		return eco_fail(error, ECO_TOO_LARGE, "more than %u scenes; serve the others by another "
			"ecoserve", SRV_SCENES_MAX);
	return ECO_OK;
}

static enum eco_code append(struct srv_store *store, struct srv_scene *scene, struct eco_error *error)
{
	struct srv_scene **grown = realloc(store->scenes, (store->count + 1) * sizeof *grown);
	if (!grown)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for another scene");
	store->scenes = grown;
	store->scenes[store->count++] = scene;
	return ECO_OK;
}

enum eco_code srv_store_share(struct srv_store *store, struct srv_scene *scene, struct eco_error *error)
{
	enum eco_code code = check_name(store, scene->name, error);
	code = code ? code : append(store, scene, error);
	if (!code)
		hold_scene(scene);
	return code;
}

/* Owns the pack from then on, also on failure. */
static enum eco_code add_pack(struct srv_store *store, const char *name, struct eco_pack *pack,
	const struct srv_file *file, struct eco_error *error)
{
	struct srv_scene *scene = calloc(1, sizeof *scene);
	if (!scene) {
		eco_pack_close(pack);
		return eco_fail(error, ECO_NO_MEMORY, "no memory for another scene");
	}
	*scene = (struct srv_scene){ .holders = 1, .pack = pack, .file = *file,
		.modified_s = file->modified_s };
	scene->file.path = strdup(file->path);
	enum eco_code code = check_name(store, name, error);
	if (!code) {
		snprintf(scene->name, sizeof scene->name, "%s", name);
		code = scene_index(scene, error);
	}
	code = code ? code : scene_meta(scene, error);
	code = code ? code : lod_plan_tables_make(&scene->tables, &pack->scene, error);
	code = code ? code : srv_outlook_find(&pack->scene, &scene->outlook, error);
	code = code ? code : append(store, scene, error);
	if (code)
		release_scene(scene);
	return code;
}

/* Small letters, and one dash for each run of what no name may have; all as it is where nothing would be
 * left. */
static void fold_name(char name[SRV_NAME_BYTES])
{
	char folded[SRV_NAME_BYTES];
	size_t used = 0;
	for (const char *at = name; *at; at++) {
		char c = *at >= 'A' && *at <= 'Z' ? (char)(*at - 'A' + 'a') : *at;
		bool alphanumeric = (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9');
		if (alphanumeric || (c == '_' && used > 0))
			folded[used++] = c;
		else if (used > 0 && folded[used - 1] != '-')
			folded[used++] = '-';
	}
	while (used > 0 && folded[used - 1] == '-')
		used--;
	folded[used] = '\0';
	if (used > 0)
		memcpy(name, folded, used + 1);
}

void srv_name_of_file(char stem[SRV_NAME_BYTES], const char *path)
{
	const char *base = strrchr(path, '/');
	base = base ? base + 1 : path;
	size_t size = strlen(base);
	if (size > 4 && strcmp(base + size - 4, ".eco") == 0)
		size -= 4;
	snprintf(stem, SRV_NAME_BYTES, "%.*s", (int)(size < SRV_NAME_BYTES ? size : SRV_NAME_BYTES - 1),
		base);
	if (!srv_name_valid(stem))
		fold_name(stem);
}

static enum eco_code open_pack(struct eco_pack **pack, const struct srv_store *store, const char *path,
	struct eco_error *error)
{
	struct eco_error why = { 0 };
	if (!store->copies)
		return eco_pack_open(pack, path, error);
	enum eco_code code = eco_pack_open_private(pack, path, store->copies, store->cancelled, &why);
	const char *advice = code == ECO_IO && strstr(why.text, "private copy") ? ": make room there, name "
		"another folder (--copies DIR), or serve packs where they are (--in-place)" : "";
	return code ? eco_fail(error, code, "%s%s", why.text, advice) : ECO_OK;
}

static struct srv_file file_at(const char *path)
{
	struct stat about;
	if (stat(path, &about))
		return (struct srv_file){ .path = (char *)path };
	return (struct srv_file){ .path = (char *)path, .device = about.st_dev, .number = about.st_ino,
		.size_bytes = (uint64_t)about.st_size, .modified_s = about.st_mtim.tv_sec,
		.modified_ns = about.st_mtim.tv_nsec };
}

static bool same_file(const struct srv_file *a, const struct srv_file *b)
{
	return b->number && a->device == b->device && a->number == b->number
		&& a->size_bytes == b->size_bytes && a->modified_s == b->modified_s
		&& a->modified_ns == b->modified_ns;
}

struct srv_scene *srv_store_find_file(const struct srv_store *store, const char *name, const char *path,
	bool same)
{
	const struct srv_file now = file_at(path);
	for (uint32_t i = 0; i < store->count; i++) {
		struct srv_scene *scene = store->scenes[i];
		if (scene->file.path && strcmp(scene->file.path, path) == 0
				&& (!name || strcmp(scene->name, name) == 0)
				&& (!same || same_file(&scene->file, &now)))
			return scene;
	}
	return NULL;
}

enum eco_code srv_store_add(struct srv_store *store, const char *name, const char *path,
	struct eco_error *error)
{
	char chosen[SRV_NAME_BYTES];
	struct eco_pack *pack;
	ECO_PASS(name ? check_name(store, name, error) : ECO_OK);
	if (store->cancelled && atomic_load(store->cancelled))
		return eco_fail(error, ECO_INTERRUPTED, "%s: interrupted before it was read", path);
	/* before the pack is read: what changes meanwhile is read again at the next reload */
	const struct srv_file file = file_at(path);
	ECO_PASS(open_pack(&pack, store, path, error));
	if (name)
		snprintf(chosen, sizeof chosen, "%s", name);
	else if (srv_name_valid(pack->scene.name))
		snprintf(chosen, sizeof chosen, "%s", pack->scene.name);
	else
		srv_name_of_file(chosen, path);
	return add_pack(store, chosen, pack, &file, error);
}

struct srv_scene *srv_store_find(const struct srv_store *store, const char *name)
{
	for (uint32_t i = 0; i < store->count; i++)
		if (strcmp(store->scenes[i]->name, name) == 0)
			return store->scenes[i];
	return NULL;
}

struct id_key { const struct eco_chunk *chunks; const struct eco_chunk_id *id; };

static int compare_id(const void *key, const void *chunk)
{
	const struct id_key *k = key;
	return memcmp(k->id->bytes, k->chunks[*(const uint32_t *)chunk].id.bytes, sizeof k->id->bytes);
}

/* A chunk with this id, or ECO_NONE. Chunks of equal content share an id; any of them is returned. */
static uint32_t find_chunk(const struct srv_scene *scene, const struct eco_chunk_id *id)
{
	const struct id_key key = { scene->pack->scene.chunks, id };
	const uint32_t *chunk = bsearch(&key, scene->by_id, scene->pack->scene.chunk_count, sizeof *chunk, compare_id);
	return chunk ? *chunk : ECO_NONE;
}

enum eco_code srv_scene_payload(const struct srv_scene *scene, uint32_t chunk, const uint8_t **bytes,
	size_t *size_bytes, struct eco_error *error)
{
	assert(chunk < scene->pack->scene.chunk_count);
	if (!atomic_load_explicit(&scene->checked[chunk], memory_order_acquire)) {
		enum eco_code code = eco_pack_payload(scene->pack, chunk, bytes, size_bytes, error);
		if (!code)
			atomic_store_explicit(&scene->checked[chunk], 1, memory_order_release);
		return code;
	}
	*bytes = scene->pack->map + scene->pack->scene.chunks[chunk].offset;
	*size_bytes = scene->pack->scene.chunks[chunk].size_bytes;
	return ECO_OK;
}

/* ---- Editions ---- */

void srv_edition_release(struct srv_edition *edition)
{
	if (!edition || atomic_fetch_sub(&edition->holders, 1) > 1)
		return;
	srv_store_free(&edition->store);
	for (uint32_t i = 0; i < edition->retired_count; i++)
		release_scene(edition->retired[i].scene);
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
	hold_scene(scene);
	edition->retired[edition->retired_count].scene = scene;
	edition->retired[edition->retired_count++].until_us = until_us;
}

/* An edition of the store's scenes; what `before` (NULL: none) had beside is kept until `until_us`, and what
 * it kept, as long as it was to be, unless that is before `now_us`. */
static enum eco_code edition_new(struct srv_edition **out, const struct srv_store *store,
	const struct srv_edition *before, uint64_t until_us, uint64_t now_us, struct eco_error *error)
{
	struct srv_edition *edition = calloc(1, sizeof *edition);
	enum eco_code code = ECO_OK;
	*out = NULL;
	if (!edition)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for %u scenes", store->count);
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

struct srv_edition *srv_catalog_hold(struct srv_catalog *catalog)
{
	pthread_mutex_lock(&catalog->mutex);
	struct srv_edition *edition = catalog->current;
	atomic_fetch_add(&edition->holders, 1);
	pthread_mutex_unlock(&catalog->mutex);
	return edition;
}

enum eco_code srv_catalog_replace(struct srv_catalog *catalog, const struct srv_store *store,
	uint64_t until_us, uint64_t now_us, struct eco_error *error)
{
	struct srv_edition *before = catalog->current, *edition;
	ECO_PASS(edition_new(&edition, store, before, until_us, now_us, error));
	pthread_mutex_lock(&catalog->mutex);
	catalog->current = edition;
	pthread_mutex_unlock(&catalog->mutex);
	srv_edition_release(before);
	return ECO_OK;
}

enum eco_code srv_catalog_retire(struct srv_catalog *catalog, uint64_t now_us, struct eco_error *error)
{
	struct srv_edition *before = srv_catalog_hold(catalog);
	enum eco_code code = before->retired_count
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
	*chunk = scene ? find_chunk(scene, id) : ECO_NONE;
	for (uint32_t i = 0; *chunk == ECO_NONE && i < edition->retired_count; i++) {
		scene = edition->retired[i].scene;
		*chunk = strcmp(scene->name, name) == 0 ? find_chunk(scene, id) : ECO_NONE;
	}
	return *chunk == ECO_NONE ? NULL : scene;
}
