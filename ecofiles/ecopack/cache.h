/* Finished plants, kept in files. A key is a hash of all input and of the program, so an entry is never out of
 * date, only unused. The model is hashed as it was read, not its files: their places and times do not matter.
 *
 *   main_cache_open(&cache, folder, limit);
 *   if (main_cache_key(&key, model, options) && !main_cache_get_plant(&cache, &key, model, name, &plant)) {
 *           ...; main_cache_put_plant(&cache, &key, &plant); }
 *   main_cache_close(&cache);                       removes the entries used least recently beyond the limit
 *
 * A cache never makes anything fail: a read or write that fails is said once and done without. Any number
 * of processes share a folder: an entry is written to a temporary file and renamed, and an open entry can
 * be read to its end after it was removed. A damaged entry is noticed by its hash, named, and written anew.
 *
 * KEY.plant, KEY in 32 hex digits: the bytes, and their XXH3-64 with the key's first half as its seed.
 *
 * The time of an entry's last use is the file's modification time. All functions but open and close may be
 * called by any thread. */
#pragma once

#include <pthread.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "lod/build/plant.h"

#define MAIN_CACHE_LIMIT_MB 2048u
#define MAIN_CACHE_PATH 4096u

struct main_cache_key { uint8_t bytes[16]; };

struct main_cache {
	char folder[MAIN_CACHE_PATH];        /* "": no cache */
	uint64_t limit_bytes;
	uint64_t hits, misses;       /* of plants */
	bool written, told;          /* told: the user knows that it cannot be written */
	pthread_mutex_t lock;        /* around the four above, and around writing */
};

/* $XDG_CACHE_HOME/ecostream, else $HOME/.cache/ecostream; false if neither variable is set. */
bool main_cache_default(char folder[MAIN_CACHE_PATH]);

/* Makes the folder and those above it, for this user alone, as the specification of XDG_CACHE_HOME
 * demands. */
bool main_cache_make(const char *folder);

/* folder NULL or "": every get is a miss and nothing is kept. The folder is made when the first entry is
 * written. */
void main_cache_open(struct main_cache *cache, const char *folder, uint64_t limit_bytes);
void main_cache_close(struct main_cache *cache);

/* True with malloc'ed bytes if there is an undamaged entry. */
bool main_cache_get(struct main_cache *cache, const struct main_cache_key *key, uint8_t **bytes, size_t *size);
void main_cache_put(struct main_cache *cache, const struct main_cache_key *key, const uint8_t *bytes, size_t size);

/* Call it before any library is loaded on demand: it hashes the libraries that are loaded. */
void main_cache_begin(void);
/* False if the program's file cannot be read: then keep nothing. */
bool main_cache_key(struct main_cache_key *key, const struct eco_model *model, const struct lod_plant_options *options);
/* Fetches the plant, as lod_plant_measure left it, and gives it that name; false: not in the cache. */
bool main_cache_get_plant(struct main_cache *cache, const struct main_cache_key *key, const struct eco_model *model,
	const char *name, struct lod_plant *plant);
void main_cache_put_plant(struct main_cache *cache, const struct main_cache_key *key, const struct lod_plant *plant);
