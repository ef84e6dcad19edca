/* Finished plants in files by key, their bound, and the failures of a folder that others share. */
#include "ecofiles/ecopack/cache.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <link.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <xxhash.h>

#include "ecofiles/base/bytes.h"
#include "ecofiles/base/files.h"
#include "ecofiles/base/memory.h"
#include "ecofiles/ecopack/run.h"
#include "ecofiles/format/list.h"
#include "lod/build/plant.h"

#define SUFFIX ".plant"
#define NAME_BYTES (32 + strlen(SUFFIX))

bool main_cache_default(char folder[MAIN_CACHE_PATH])
{
	const char *base = getenv("XDG_CACHE_HOME"), *home = getenv("HOME");
	int length = -1;
	if (base && base[0] == '/')          /* the XDG specification says to ignore a relative one */
		length = snprintf(folder, MAIN_CACHE_PATH, "%s/ecostream", base);
	else if (home && home[0] == '/')
		length = snprintf(folder, MAIN_CACHE_PATH, "%s/.cache/ecostream", home);
	if (length < 0 || length >= (int)MAIN_CACHE_PATH - 64)
		folder[0] = 0;
	return folder[0] != 0;
}

void main_cache_open(struct main_cache *cache, const char *folder, uint64_t limit_bytes)
{
	*cache = (struct main_cache){ .limit_bytes = limit_bytes, .lock = PTHREAD_MUTEX_INITIALIZER };
	if (folder && strlen(folder) < sizeof cache->folder - 64)
		strcpy(cache->folder, folder);
}

static void path_of(const struct main_cache *cache, const struct main_cache_key *key,
	char path[MAIN_CACHE_PATH])
{
	snprintf(path, MAIN_CACHE_PATH, "%.*s/%s" SUFFIX, (int)MAIN_CACHE_PATH - 64, cache->folder,
		eco_id_text(key->bytes).hex);
}

/* ---- Reading ---- */

static uint64_t check_of(const struct main_cache_key *key, const uint8_t *bytes, size_t size)
{
	uint64_t seed;
	memcpy(&seed, key->bytes, sizeof seed);
	return XXH3_64bits_withSeed(bytes, size, seed);
}

static void note_damage(const char *path, const char *why)
{
	main_note("the cached %s is damaged (%s): the plant is built again", path, why);
}

bool main_cache_get(struct main_cache *cache, const struct main_cache_key *key, uint8_t **bytes, size_t *size)
{
	char path[MAIN_CACHE_PATH];
	uint64_t check = 0;
	if (!cache->folder[0])
		return false;
	path_of(cache, key, path);
	if (eco_file_read(path, INT64_MAX, bytes, size, NULL))
		return false;
	bool good = *size > sizeof check;
	*size -= good ? sizeof check : 0;
	memcpy(&check, *bytes + *size, good ? sizeof check : 0);
	good = good && check == check_of(key, *bytes, *size);
	if (good) {
		utimensat(AT_FDCWD, path, NULL, 0);      /* used just now */
		return true;
	}
	note_damage(path, "its hash does not hold");
	free(*bytes);
	return false;
}

/* ---- Writing ---- */

bool main_cache_make(const char *folder)
{
	char path[MAIN_CACHE_PATH];
	snprintf(path, sizeof path, "%s", folder);
	for (char *at = path + 1; *at; at++) {
		if (*at != '/')
			continue;
		*at = 0;
		if (mkdir(path, 0700) != 0 && errno != EEXIST)
			return false;
		*at = '/';
	}
	return mkdir(path, 0700) == 0 || errno == EEXIST;
}

void main_cache_put(struct main_cache *cache, const struct main_cache_key *key, const uint8_t *bytes, size_t size)
{
	char path[MAIN_CACHE_PATH];
	struct eco_writer w = { 0 };
	struct eco_error why = { 0 };
	if (!cache->folder[0] || size > cache->limit_bytes)
		return;
	path_of(cache, key, path);
	uint64_t check = check_of(key, bytes, size);
	eco_write_bytes(&w, bytes, size);
	eco_write_bytes(&w, &check, sizeof check);
	pthread_mutex_lock(&cache->lock);
	enum eco_code code = w.failed ? eco_no_memory(&why, "a plant") : !main_cache_make(cache->folder)
		? eco_fail_write(&why, cache->folder, errno) : eco_file_write(path, w.bytes, w.size, &why);
	if (code && !cache->told)
		main_note("cannot keep finished plants; they will be built again next time (--cache DIR names another "
			"folder, --no-cache none): %s", why.text);
	cache->told = cache->told || code;
	cache->written = cache->written || !code;
	pthread_mutex_unlock(&cache->lock);
	eco_writer_free(&w);
}

/* ---- Bound ---- */

struct entry { char name[64]; uint64_t size; struct timespec used; };

static int by_use(const void *left, const void *right)
{
	const struct entry *a = left, *b = right;
	if (a->used.tv_sec != b->used.tv_sec)
		return a->used.tv_sec < b->used.tv_sec ? -1 : 1;
	if (a->used.tv_nsec != b->used.tv_nsec)
		return a->used.tv_nsec < b->used.tv_nsec ? -1 : 1;
	return strcmp(a->name, b->name);
}

/* Lists the entries, and removes those that were left unfinished. No other file is touched. */
static uint64_t list_entries(DIR *folder, struct entry **entries, uint32_t *entry_count)
{
	uint64_t sum = 0;
	uint32_t capacity = 0;
	for (struct dirent *d; (d = readdir(folder));) {
		struct stat status;
		struct entry entry = { .size = 0 };
		snprintf(entry.name, sizeof entry.name, "%.*s", (int)NAME_BYTES, d->d_name);
		if (strspn(entry.name, "0123456789abcdef") != 32 || strcmp(entry.name + 32, SUFFIX) != 0)
			continue;
		if (eco_unfinished_is(d->d_name, entry.name))
			eco_unfinished_remove_file(dirfd(folder), d->d_name);
		if (strlen(d->d_name) != NAME_BYTES
				|| fstatat(dirfd(folder), d->d_name, &status, AT_SYMLINK_NOFOLLOW) != 0
				|| !S_ISREG(status.st_mode))
			continue;
		entry.size = (uint64_t)status.st_size;
		entry.used = status.st_mtim;
		eco_grow(entries, &capacity, *entry_count, sizeof entry);
		(*entries)[(*entry_count)++] = entry;
		sum += entry.size;
	}
	return sum;
}

static void trim(struct main_cache *cache)
{
	struct entry *entries = NULL;
	uint32_t entry_count = 0;
	DIR *folder = opendir(cache->folder);
	if (!folder)
		return;
	uint64_t sum = list_entries(folder, &entries, &entry_count);
	if (entry_count)
		qsort(entries, entry_count, sizeof *entries, by_use);
	for (uint32_t i = 0; i < entry_count && sum > cache->limit_bytes; i++)
		if (unlinkat(dirfd(folder), entries[i].name, 0) == 0 || errno == ENOENT)
			sum -= entries[i].size;
	free(entries);
	closedir(folder);
}

void main_cache_close(struct main_cache *cache)
{
	if (cache->folder[0] && cache->written)
		trim(cache);
	pthread_mutex_destroy(&cache->lock);
	*cache = (struct main_cache){ .limit_bytes = 0 };
}

/* ---- Keys: of the program ---- */

/* Results may change with a library: its name, size and time stand for it. */
static int add_library(struct dl_phdr_info *info, size_t size, void *ctx)
{
	struct stat status = { .st_size = 0 };
	(void)size;
	stat(info->dlpi_name, &status);
	const int64_t is[] = { status.st_size, status.st_mtim.tv_sec, status.st_mtim.tv_nsec };
	XXH3_128bits_update(ctx, info->dlpi_name, strlen(info->dlpi_name) + 1);
	XXH3_128bits_update(ctx, is, sizeof is);
	return 0;
}

/* Hashes the program's own file: it has a build id only if the linker was asked for one. */
static bool add_program(XXH3_state_t *hash)
{
	FILE *file = fopen("/proc/self/exe", "rbe");
	static const size_t room = 1u << 16;
	uint8_t *bytes = malloc(room);
	bool ok = file && bytes;
	for (size_t got; ok && (got = fread(bytes, 1, room, file)) > 0;)
		XXH3_128bits_update(hash, bytes, got);
	ok = ok && !ferror(file);
	if (file)
		fclose(file);
	free(bytes);
	dl_iterate_phdr(add_library, hash);
	return ok;
}

static struct { XXH128_hash_t hash; bool known; } program;
static pthread_once_t program_once = PTHREAD_ONCE_INIT;

static XXH3_state_t *hash_begin(void)
{
	XXH3_state_t *hash = XXH3_createState();
	if (!hash)
		eco_end("no memory");
	XXH3_128bits_reset(hash);
	return hash;
}

static void find_program(void)
{
	XXH3_state_t *hash = hash_begin();
	program.known = add_program(hash);
	program.hash = XXH3_128bits_digest(hash);
	XXH3_freeState(hash);
}

void main_cache_begin(void) { pthread_once(&program_once, find_program); }

/* ---- The model and the options ---- */

static void add(XXH3_state_t *hash, const void *bytes, size_t size)
{
	uint64_t length = bytes ? size : UINT64_MAX;
	XXH3_128bits_update(hash, &length, sizeof length);
	if (bytes && size)
		XXH3_128bits_update(hash, bytes, size);
}

#define ADD(hash, value) add(hash, &(value), sizeof(value))

static void add_model(XXH3_state_t *hash, const struct eco_model *model)
{
	size_t vertices = model->vertex_count, triangles = model->triangle_count;
	add(hash, model->position, 3 * vertices * sizeof *model->position);
	add(hash, model->uv, 2 * vertices * sizeof *model->uv);
	add(hash, model->index, 3 * triangles * sizeof *model->index);
	add(hash, model->material, triangles * sizeof *model->material);
	add(hash, model->part, triangles * sizeof *model->part);
	add(hash, model->organ, triangles * sizeof *model->organ);
	add(hash, model->importance, triangles);
	add(hash, model->importances, model->importance_count * sizeof *model->importances);
	ADD(hash, model->dropped);
	ADD(hash, model->object);
	for (uint32_t i = 0; i < model->material_count; i++) {
		const struct eco_material *m = &model->materials[i];
		const uint8_t flags[] = { m->cutout, m->colourless };
		add(hash, m->name, strlen(m->name));
		ADD(hash, m->rgb);
		ADD(hash, flags);
		ADD(hash, m->image);
	}
	for (uint32_t i = 0; i < model->image_count; i++) {
		const struct eco_image *image = &model->images[i];
		ADD(hash, image->width);
		ADD(hash, image->height);
		add(hash, image->rgba, 4 * (size_t)image->width * image->height);
	}
	for (uint32_t i = 0; i < model->part_count; i++)
		add(hash, model->parts[i].name, strlen(model->parts[i].name));
}

/* Hashes the options except the name, which the plant gets afterwards, and the progress callback. */
static void add_options(XXH3_state_t *hash, const struct lod_plant_options *options)
{
	const uint32_t numbers[] = { options->seed, (uint32_t)options->order, options->cell_triangles,
		options->grid_bits, options->views, options->pixels, options->draft };
	ADD(hash, numbers);
	ADD(hash, options->importance);
}

bool main_cache_key(struct main_cache_key *key, const struct eco_model *model, const struct lod_plant_options *options)
{
	XXH128_canonical_t canonical;
	main_cache_begin();
	if (!program.known)
		return false;
	XXH3_state_t *hash = hash_begin();
	ADD(hash, program.hash.low64);
	ADD(hash, program.hash.high64);
	add_model(hash, model);
	add_options(hash, options);
	XXH128_canonicalFromHash(&canonical, XXH3_128bits_digest(hash));
	memcpy(key->bytes, canonical.digest, sizeof key->bytes);
	XXH3_freeState(hash);
	return true;
}

/* ---- Plants ---- */

static bool names_images(const struct lod_plant *plant, const struct eco_model *model)
{
	for (uint32_t i = 0; i < plant->image_count; i++)
		if (plant->images[i] >= model->image_count)
			return false;
	return true;
}

bool main_cache_get_plant(struct main_cache *cache, const struct main_cache_key *key, const struct eco_model *model,
	const char *name, struct lod_plant *plant)
{
	struct eco_error error = { 0 };
	uint8_t *bytes;
	size_t size;
	bool good = main_cache_get(cache, key, &bytes, &size);
	if (good) {
		enum eco_code code = lod_plant_read(plant, bytes, size, &error);
		free(bytes);
		good = !code && names_images(plant, model);
		if (!code && !good)
			lod_plant_free(plant);
		if (good)
			strncpy(plant->plant.name, name, sizeof plant->plant.name - 1);
		else
			note_damage("plant", code ? error.text : "textures that the model has not");
	}
	pthread_mutex_lock(&cache->lock);
	cache->hits += good;
	cache->misses += !good;
	pthread_mutex_unlock(&cache->lock);
	return good;
}

void main_cache_put_plant(struct main_cache *cache, const struct main_cache_key *key, const struct lod_plant *plant)
{
	struct eco_writer writer = { 0 };
	lod_plant_write(&writer, plant);
	if (!writer.failed)
		main_cache_put(cache, key, writer.bytes, writer.size);
	eco_writer_free(&writer);
}
