/* A seeded choice per row: SplitMix64's finalizer (Steele, Lea, Flood 2014). Integers only, so the same on every machine. */
#ifndef ECO_MIX_H
#define ECO_MIX_H

#include <stdint.h>

static inline uint64_t eco_mix(uint64_t seed, uint64_t number)
{
	uint64_t z = seed * 0xd1b54a32d192ed03u + (number + 1) * 0x9e3779b97f4a7c15u;

	z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
	z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
	return z ^ (z >> 31);
}

/* One of `count` models of a plant, and a yaw in 1/65536 turns: independent bits of one hash. */
static inline uint32_t eco_mix_variant(uint64_t seed, uint64_t number, uint32_t count)
{
	return count <= 1 ? 0 : (uint32_t)((eco_mix(seed, number) >> 32) % count);
}

static inline uint16_t eco_mix_turn(uint64_t seed, uint64_t number)
{
	return (uint16_t)eco_mix(seed, number);
}

#endif
