/* Four floats or integers at a time, in the vector types of GCC and Clang: SSE2 or NEON where there is one,
 * plain code elsewhere. The results are the same bits everywhere: IEEE operations lane by lane, nothing
 * fused, no approximations. And clones of functions for newer processors, for counting bits of words. */
#pragma once

#include <stdint.h>
#include <string.h>
#ifdef __SSE2__
#include <emmintrin.h>
#endif

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

typedef float lod_f4 __attribute__((vector_size(16)));
typedef double lod_d4 __attribute__((vector_size(32)));      /* only within functions: processors differ in
                                                              * how they pass it */
typedef float lod_f8 __attribute__((vector_size(32)));       /* the same */
typedef int32_t lod_i8 __attribute__((vector_size(32)));
typedef int32_t lod_i4 __attribute__((vector_size(16)));
typedef uint32_t lod_u4 __attribute__((vector_size(16)));    /* for sums that may wrap in lanes that are not
                                                              * read */

/* fmaxf is a call, as it takes care of NaN. */
LOD_INLINE float lod_max(float a, float b) { return a > b ? a : b; }
LOD_INLINE lod_f4 lod_f4_all(float v) { return (lod_f4){ v, v, v, v }; }
LOD_INLINE lod_i4 lod_i4_all(int32_t v) { return (lod_i4){ v, v, v, v }; }
LOD_INLINE lod_f4 lod_f4_load(const float *from) { lod_f4 v; memcpy(&v, from, sizeof v); return v; }
LOD_INLINE void lod_f4_store(float *to, lod_f4 v) { memcpy(to, &v, sizeof v); }

LOD_INLINE lod_f4 lod_f4_select(lod_i4 mask, lod_f4 yes, lod_f4 no)
{
	return (lod_f4)(((lod_i4)yes & mask) | ((lod_i4)no & ~mask));
}

/* a < b ? a : b and a > b ? a : b: the second operand where either is NaN. */
LOD_INLINE lod_f4 lod_f4_min(lod_f4 a, lod_f4 b)
{
#ifdef __SSE2__
	return (lod_f4)_mm_min_ps((__m128)a, (__m128)b);
#else
	return lod_f4_select(a < b, a, b);
#endif
}
LOD_INLINE lod_f4 lod_f4_max(lod_f4 a, lod_f4 b)
{
#ifdef __SSE2__
	return (lod_f4)_mm_max_ps((__m128)a, (__m128)b);
#else
	return lod_f4_select(a > b, a, b);
#endif
}

LOD_INLINE lod_f4 lod_f4_abs(lod_f4 a) { return (lod_f4)((lod_i4)a & lod_i4_all(INT32_MAX)); }

/* The sign of each lane, a bit a lane. */
LOD_INLINE unsigned lod_i4_bits(lod_i4 mask)
{
#ifdef __SSE2__
	return (unsigned)_mm_movemask_ps((__m128)mask);
#else
	return (uint32_t)mask[0] >> 31 | (uint32_t)mask[1] >> 31 << 1 | (uint32_t)mask[2] >> 31 << 2
		| (uint32_t)mask[3] >> 31 << 3;
#endif
}

/* `middle` + the nearest integer, ties to even, for |a| < 2^22 (otherwise arbitrary): adding 1.5 * 2^23
 * leaves the integer in the low bits of the float. */
LOD_INLINE lod_i4 lod_f4_round(lod_f4 a, lod_i4 middle)
{
	return (lod_i4)((lod_u4)(a + lod_f4_all(12582912.0f))
		+ ((lod_u4)middle - (lod_u4)lod_i4_all(0x4b400000)));
}

LOD_INLINE lod_i4 lod_i4_add(lod_i4 a, int32_t b) { return (lod_i4)((lod_u4)a + (lod_u4)lod_i4_all(b)); }

/* Transposes in place. */
LOD_INLINE void lod_f4_transpose(lod_f4 r[4])
{
	lod_f4 ab_low = __builtin_shufflevector(r[0], r[1], 0, 4, 1, 5),
		ab_high = __builtin_shufflevector(r[0], r[1], 2, 6, 3, 7);
	lod_f4 cd_low = __builtin_shufflevector(r[2], r[3], 0, 4, 1, 5),
		cd_high = __builtin_shufflevector(r[2], r[3], 2, 6, 3, 7);
	r[0] = __builtin_shufflevector(ab_low, cd_low, 0, 1, 4, 5);
	r[1] = __builtin_shufflevector(ab_low, cd_low, 2, 3, 6, 7);
	r[2] = __builtin_shufflevector(ab_high, cd_high, 0, 1, 4, 5);
	r[3] = __builtin_shufflevector(ab_high, cd_high, 2, 3, 6, 7);
}
