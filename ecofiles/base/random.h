/* Random numbers that are the same on every machine: SplitMix64 (Steele, Lea, Flood 2014), a counter of
 * full period and a good mixer, in integers only. */
#pragma once

#include <stdint.h>

/* The next 64 bits of a sequence; any state begins one. */
static inline uint64_t eco_random_next(uint64_t *state)
{
	uint64_t z = *state += 0x9e3779b97f4a7c15u;
	z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
	z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
	return z ^ (z >> 31);
}

/* 64 bits that depend on a seed and a number (of a row, for example) alone. */
static inline uint64_t eco_random(uint64_t seed, uint64_t number)
{
	uint64_t state = seed * 0xd1b54a32d192ed03u + number * 0x9e3779b97f4a7c15u;
	return eco_random_next(&state);
}

/* Mixed bits as a number in [0, 1), exact. */
static inline double eco_random_unit(uint64_t bits)
{
	return (double)(bits >> 11) / 9007199254740992.0;
}

/* A slot in a hash table for three numbers; its low bits are as good as the high ones. */
static inline uint32_t eco_random_slot(uint32_t a, uint32_t b, uint32_t c)
{
	uint64_t h = (a * 0x9e3779b97f4a7c15u) ^ (b * 0xc2b2ae3d27d4eb4fu) ^ (c * 0x165667b19e3779f9u);
	h ^= h >> 29;
	h *= 0xbf58476d1ce4e5b9u;
	return (uint32_t)(h >> 32);
}

/* One of `count` models of a plant. */
static inline uint32_t eco_random_variant(uint64_t seed, uint64_t number, uint32_t count)
{
	return count <= 1 ? 0 : (uint32_t)((eco_random(seed, number) >> 32) % count);
}
