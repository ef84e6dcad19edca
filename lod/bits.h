/* Counting bits of words, millions of times. */
#ifndef LOD_BITS_H
#define LOD_BITS_H

#include <stdint.h>

/* Before a function: compiles it also for processors with SSE 4.2 (instructions that count bits and round)
 * and with AVX2 and BMI2 (four doubles at a time, shifts by any number). Results are the same, as nothing is
 * fused (-ffp-contract=off). A function that it calls gains only if it is LOD_INLINE. */
#define LOD_INLINE static inline __attribute__((always_inline))
#if defined(__x86_64__) && defined(__GNUC__) && __GNUC__ >= 12 && !defined(__clang__) \
	&& !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define LOD_CLONES __attribute__((target_clones("arch=x86-64-v3", "sse4.2", "default")))
#define lod_bits_of(x) ((uint32_t)__builtin_popcountll(x))
#else
#define LOD_CLONES
/* The builtin would be a call unless a flag allowed newer processors. */
static inline uint32_t lod_bits_of(uint64_t x)
{
	x -= x >> 1 & UINT64_C(0x5555555555555555);
	x = (x & UINT64_C(0x3333333333333333)) + (x >> 2 & UINT64_C(0x3333333333333333));
	return (uint32_t)(((x + (x >> 4)) & UINT64_C(0x0f0f0f0f0f0f0f0f)) * UINT64_C(0x0101010101010101)
		>> 56);
}
#endif

#endif
