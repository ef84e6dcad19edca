/* Adaptive binary range coder (Martin 1979; as in LZMA): bits that are not equally likely take fewer bits.
 * The same functions write and read.
 *
 *   struct eco_bit models[N]; eco_bits_start(models, N);
 *   eco_range_write(&range, &writer);                     or eco_range_read(&range, bytes, size)
 *   value = eco_range_tree(&range, models, 3, value);     writing: returns value; reading: what was written
 *   zeros = eco_range_end(&range);
 *
 * It needs no tables: a model starts even and learns by counting (Krichevsky and Trofimov 1981). So even
 * chunks of a few dozen elements get smaller, where tables of symbols would cost more than they save.
 * Reading beyond the end gives zeros; whatever the bytes say, every value stays within its bits. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "ecofiles/base/bytes.h"

struct eco_bit { uint16_t zero, seen; };         /* probability of 0 in 1/65536; bits coded so far */

struct eco_range {
	struct eco_writer *writer;                   /* NULL: reading */
	uint32_t range, code;
	uint64_t low, held;                          /* held: bytes that a carry may still change */
	uint8_t first;                               /* the first of the held bytes */
	bool begun;
	size_t start, at, size;
	const uint8_t *bytes;
};

void eco_bits_start(struct eco_bit *models, size_t count);       /* all even */

static inline uint32_t eco_bit_length(uint64_t v) { return v ? 64u - (uint32_t)__builtin_clzll(v) : 0; }
/* Differences modulo 2^32 so that small ones of either sign are small numbers: 0, -1, 1, -2, ... */
static inline uint32_t eco_zigzag(uint32_t v) { return v << 1 ^ (0u - (v >> 31)); }
static inline uint32_t eco_unzigzag(uint32_t v) { return v >> 1 ^ (0u - (v & 1)); }

void eco_range_write(struct eco_range *range, struct eco_writer *writer);
/* As writing, of which only the bytes are counted, in `size`. */
void eco_range_count(struct eco_range *range);
void eco_range_read(struct eco_range *range, const uint8_t *bytes, size_t size);
/* Writing: writes the last bytes but for up to 255 zeros at the end, and returns how many zeros were left
 * off; see writer->failed. Reading: returns how many bytes beyond the end were read, which is the same
 * number if the bytes are as written; UINT32_MAX: bytes are left over. */
uint32_t eco_range_end(struct eco_range *range);

/* Writing, these take a value and return it; reading, they ignore the value and return what was written. */

/* A bit; its model learns from it. */
bool eco_range_bit(struct eco_range *range, struct eco_bit *model, bool bit);
/* `bits` (0..64) bits, each as likely 0 as 1. */
uint64_t eco_range_raw(struct eco_range *range, unsigned bits, uint64_t value);
/* `bits` (0..16) bits from the high end, each with a model for the bits before it: 2^bits models. */
uint32_t eco_range_tree(struct eco_range *range, struct eco_bit *models, unsigned bits, uint32_t value);
/* The first `modelled` of `bits` (0..32) bits as eco_range_tree, the others raw. */
uint32_t eco_range_field(struct eco_range *range, struct eco_bit *models, unsigned modelled, unsigned bits,
	uint32_t value);
/* Writing that is counted: the value as that function, with 0, `step`, 2 `step`, ... (count - 1) `step` bits
 * modelled, in `count` coders, whose models are the same. */
void eco_range_fields(struct eco_range *ranges, uint32_t count, unsigned step, struct eco_bit *models, unsigned bits,
	uint32_t value);
/* A count of at most `most` in unary, each step with a model of its own, those from the last of `steps`
 * models on with that one. */
uint32_t eco_range_unary(struct eco_range *range, struct eco_bit *models, uint32_t steps, uint32_t most,
	uint32_t value);
/* Any number: how many bits it has, as a tree of `tree_bits`, then those below the highest, raw. */
uint64_t eco_range_size(struct eco_range *range, struct eco_bit *models, unsigned tree_bits, uint64_t value);
/* Any number of magnitude < 2^31: its number of bits, its sign, its bits below the highest.
 * ECO_RANGE_NUMBER models. */
#define ECO_RANGE_NUMBER 32u
int32_t eco_range_number(struct eco_range *range, struct eco_bit *models, int32_t value);

/* Numbers of many kinds, each kind with a usual size that is learned. A number is coded as its bits more
 * or fewer than usual, then its bits, then its sign. The spread about the usual size is learned from all
 * kinds together, so that each kind has little to learn. */
#define ECO_NEAR_PARTS 4u        /* a usual size is known to 1/4 bit */
#define ECO_NEAR_STEPS 16u
struct eco_near {
	struct eco_bit larger[ECO_NEAR_PARTS], more[ECO_NEAR_PARTS][ECO_NEAR_STEPS],
		less[ECO_NEAR_PARTS][ECO_NEAR_STEPS], half[ECO_NEAR_PARTS][ECO_NEAR_STEPS];
	uint32_t level;              /* of the number before: the first usual size of a new kind */
};
/* level: about log2 + 1 of the usual size, in 1/256; 0: size 0 */
struct eco_scale { struct eco_bit sign; uint16_t level, seen; };
void eco_near_start(struct eco_near *near, struct eco_scale *kinds, size_t count);
/* Any number of magnitude < 2^31. */
int32_t eco_range_near(struct eco_range *range, struct eco_near *near, struct eco_scale *kind, int32_t value);
