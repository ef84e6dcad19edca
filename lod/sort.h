/* Stable sorting of 64-bit keys with 32-bit values: linear, the same result on every machine. */
#pragma once

#include <stdint.h>
#include <string.h>

#include "ecofiles/base/random.h"
#include "lod/arena.h"

struct lod_keyed { uint64_t key; uint32_t value; };

/* Ascending by key; equal keys keep their order. */
void lod_sort(struct lod_arena *arena, struct lod_keyed *items, uint32_t count);

/* Puts items of at most 64 bytes into an order that the seed decides. */
void lod_shuffle(void *items, uint32_t count, size_t size, uint64_t seed);

/* A key that orders doubles ascending (no NaN). */
static inline uint64_t lod_sort_key(double value)
{
	uint64_t bits;
	value += 0.0;                /* -0 and 0 are one key */
	memcpy(&bits, &value, sizeof bits);
	return bits >> 63 ? ~bits : bits | UINT64_C(1) << 63;
}

/* A well mixed hash of a number: all pseudo-random choices in lod/ come from it. */
static inline uint64_t lod_mix(uint64_t x)
{
	return eco_random_next(&x);
}
