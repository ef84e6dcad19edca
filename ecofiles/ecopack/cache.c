/* Files by key, their bound, and the failures of a folder that others share. */
#include "ecofiles/ecopack/cache.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>
#include <xxhash.h>

#include "ecofiles/base/array_grow.h"
#include "ecofiles/base/bytes.h"
#include "ecofiles/ecopack/run.h"

#define MAGIC "ECOCACHE"
#define HEADER_BYTES 40u
#define SUFFIX ".plant"
#define LEFT_OVER_S 3600             /* an unfinished entry this old has lost its writer */

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
	char hex[33];
	for (int i = 0; i < 16; i++)
		snprintf(hex + 2 * i, 3, "%02x", key->bytes[i]);
	snprintf(path, MAIN_CACHE_PATH, "%.*s/%s" SUFFIX, (int)MAIN_CACHE_PATH - 64, cache->folder, hex);
}

static void count(struct main_cache *cache, int64_t hits, int64_t misses)
{
	pthread_mutex_lock(&cache->lock);
	cache->hits += (uint64_t)hits;
	cache->misses += (uint64_t)misses;
	pthread_mutex_unlock(&cache->lock);
}

/* ---- Reading ---- */

/* Reads a whole open file of at most `most` bytes; else NULL. */
static uint8_t *read_all(int file, uint64_t most, size_t *size)
{
	struct stat status;
	if (fstat(file, &status) != 0 || !S_ISREG(status.st_mode) || status.st_size < 0
			|| (uint64_t)status.st_size > most)
		return NULL;
	uint8_t *bytes = malloc((size_t)status.st_size + 1);
	for (*size = 0; bytes && *size < (size_t)status.st_size;) {
		ssize_t got = read(file, bytes + *size, (size_t)status.st_size - *size);
		if (got < 0 && errno == EINTR)
			continue;
		if (got <= 0)
			break;
		*size += (size_t)got;
	}
	return bytes;
}

/* The fault of an entry, or NULL. */
static const char *fault_of(const uint8_t *bytes, size_t size, const struct main_cache_key *key)
{
	struct eco_reader r = { bytes, size, 0, false };
	const uint8_t *magic = eco_read_bytes(&r, 8), *named = eco_read_bytes(&r, sizeof key->bytes);
	uint64_t length = eco_read_u64(&r), hash = eco_read_u64(&r);
	if (r.failed || length != size - HEADER_BYTES)
		return "it is cut off";
	if (memcmp(magic, MAGIC, 8) != 0 || memcmp(named, key->bytes, sizeof key->bytes) != 0)
		return "it is something else";
	return XXH3_64bits(bytes + HEADER_BYTES, length) == hash ? NULL : "its hash does not hold";
}

bool main_cache_get(struct main_cache *cache, const struct main_cache_key *key, uint8_t **bytes, size_t *size)
{
	char path[MAIN_CACHE_PATH];
	if (!cache->folder[0])
		return false;
	path_of(cache, key, path);
	int file = open(path, O_RDONLY | O_CLOEXEC | O_NOCTTY | O_NONBLOCK);
	count(cache, 0, 1);
	if (file < 0)
		return false;
	uint8_t *all = read_all(file, UINT64_MAX / 4, size);
	const char *fault = all ? fault_of(all, *size, key) : NULL;
	if (all && !fault)
		/* marks the entry as used; without permission it is dropped a little early */
		futimens(file, NULL);
	close(file);
	if (!all || fault) {
		free(all);
		if (fault)
			main_note("the cached %s is damaged (%s): the plant is built anew", path, fault);
		return false;
	}
	*size -= HEADER_BYTES;
	memmove(all, all + HEADER_BYTES, *size);
	*bytes = all;
	count(cache, 1, -1);
	return true;
}

void main_cache_reject(struct main_cache *cache, const struct main_cache_key *key, const char *why)
{
	char path[MAIN_CACHE_PATH];
	path_of(cache, key, path);
	main_note("the cached %s is damaged (%s): the plant is built anew", path, why);
	unlink(path);
	count(cache, -1, 1);
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

static bool write_all(int file, const uint8_t *bytes, size_t size)
{
	while (size > 0) {
		ssize_t put = write(file, bytes, size);
		if (put < 0 && errno == EINTR)
			continue;
		if (put <= 0)
			return false;
		bytes += put;
		size -= (size_t)put;
	}
	return true;
}

static bool write_entry(int file, const struct main_cache_key *key, const uint8_t *bytes, size_t size)
{
	struct eco_writer header = { 0 };
	eco_write_bytes(&header, MAGIC, 8);
	eco_write_bytes(&header, key->bytes, sizeof key->bytes);
	eco_write_u64(&header, size);
	eco_write_u64(&header, XXH3_64bits(bytes, size));
	bool ok = !header.failed && write_all(file, header.bytes, header.size)
		&& write_all(file, bytes, size);
	eco_writer_free(&header);
	return ok;
}

static void tell(struct main_cache *cache, const char *path, int reason)
{
	pthread_mutex_lock(&cache->lock);
	bool first = !cache->told;
	cache->told = true;
	pthread_mutex_unlock(&cache->lock);
	if (first)
		main_note("%s: cannot keep finished plants there (%s); they will be built again next time. "
			"--cache DIR names another folder, --no-cache none", path, strerror(reason));
}

void main_cache_put(struct main_cache *cache, const struct main_cache_key *key, const uint8_t *bytes,
	size_t size)
{
	char path[MAIN_CACHE_PATH], beside[MAIN_CACHE_PATH + 16];
	if (!cache->folder[0] || size > cache->limit_bytes)
		return;
	path_of(cache, key, path);
	snprintf(beside, sizeof beside, "%s.XXXXXX", path);
	int file = main_cache_make(cache->folder) ? mkostemp(beside, O_CLOEXEC) : -1;
	if (file < 0) {
		tell(cache, cache->folder, errno);
		return;
	}
	bool ok = write_entry(file, key, bytes, size);
	int reason = ok ? 0 : errno ? errno : EIO;
	if (close(file) != 0 || (ok && rename(beside, path) != 0))
		reason = reason ? reason : errno;
	if (reason) {
		unlink(beside);
		tell(cache, cache->folder, reason);
		return;
	}
	pthread_mutex_lock(&cache->lock);
	cache->written++;
	pthread_mutex_unlock(&cache->lock);
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

/* 32 hex digits and the suffix; an unfinished entry has a dot and six more characters. No other file is
 * ever touched. */
static bool is_ours(const char *name, bool *unfinished)
{
	size_t length = strlen(name), whole = 32 + strlen(SUFFIX);
	if (strspn(name, "0123456789abcdef") != 32 || (length != whole && length != whole + 7)
			|| strncmp(name + 32, SUFFIX, strlen(SUFFIX)) != 0)
		return false;
	*unfinished = length > whole;
	return !*unfinished || name[whole] == '.';
}

/* Lists the entries, and removes those that were left unfinished long ago. */
static uint64_t list_entries(DIR *folder, struct entry **entries, uint32_t *entry_count)
{
	uint64_t sum = 0;
	uint32_t capacity = 0;
	for (struct dirent *d; (d = readdir(folder));) {
		struct stat status;
		struct entry entry = { .size = 0 };
		bool unfinished;
		if (!is_ours(d->d_name, &unfinished)
				|| fstatat(dirfd(folder), d->d_name, &status, AT_SYMLINK_NOFOLLOW) != 0
		    || !S_ISREG(status.st_mode))
			continue;
		if (unfinished && time(NULL) - status.st_mtime > LEFT_OVER_S)
			unlinkat(dirfd(folder), d->d_name, 0);
		if (unfinished)
			continue;
		snprintf(entry.name, sizeof entry.name, "%.*s", (int)sizeof entry.name - 1, d->d_name);
		entry.size = (uint64_t)status.st_size;
		entry.used = status.st_mtim;
		if (!eco_array_grow(entries, &capacity, *entry_count, sizeof entry))
			break;
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
