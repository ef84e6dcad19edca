/* Bits that are not equally likely, in fewer bits: an adaptive binary range coder (Martin 1979; as in LZMA), one code for both directions.
 *
 *   struct eco_bit models[N]; eco_bits_start(models, N);
 *   eco_range_write(&range, &writer);                     or eco_range_read(&range, bytes, size)
 *   value = eco_range_tree(&range, models, 3, value);     writing: takes value and gives it back; reading: gives what was written
 *   zeros = eco_range_end(&range);
 *
 * It needs no tables: a model starts as knowing nothing and learns by counting (Krichevsky and Trofimov 1981), so that chunks of a few dozen
 * elements pay, where tables of symbols would take more than they save. Reading beyond the end gives zeros: the bytes may say anything, and
 * every value is within its bits. */
#ifndef ECO_RANGE_H
#define ECO_RANGE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "ecofiles/base/bytes.h"

struct eco_bit { uint16_t zero, seen; };         /* probability of 0 in 1/65536; how often it was coded */

struct eco_range {
	struct eco_writer *writer;                   /* NULL: reading */
	uint32_t range, code;
	uint64_t low, held;                          /* held: bytes that a carry may still change */
	uint8_t first;                               /* of those */
	bool begun;
	size_t start, at, size;
	const uint8_t *bytes;
};

void eco_bits_start(struct eco_bit *models, size_t count);       /* models that know nothing */

void eco_range_write(struct eco_range *range, struct eco_writer *writer);
void eco_range_read(struct eco_range *range, const uint8_t *bytes, size_t size);
/* Writes the last bytes, but for at most 255 zeros at the end, and returns how many those were; see writer->failed. Reading, returns how many
 * bytes beyond the end were read: the same number, where all bytes are there and as they were written; UINT32_MAX: bytes are left over. */
uint32_t eco_range_end(struct eco_range *range);

/* Writing, these take a value and return it; reading, the value is ignored, and what was written is returned. */

/* A bit, and its model learns from it. */
bool eco_range_bit(struct eco_range *range, struct eco_bit *model, bool bit);
/* `bits` (0..64) bits, each as likely 0 as 1. */
uint64_t eco_range_raw(struct eco_range *range, unsigned bits, uint64_t value);
/* `bits` (0..16) bits from the high end, each with a model for those before it: 2^bits models. */
uint32_t eco_range_tree(struct eco_range *range, struct eco_bit *models, unsigned bits, uint32_t value);
/* As that for the first `modelled` of `bits` (0..32) bits, the others raw. */
uint32_t eco_range_field(struct eco_range *range, struct eco_bit *models, unsigned modelled, unsigned bits, uint32_t value);
/* Any number of magnitude < 2^31: how many bits it has, then its sign and those: ECO_RANGE_NUMBER models. */
#define ECO_RANGE_NUMBER 32u
int32_t eco_range_number(struct eco_range *range, struct eco_bit *models, int32_t value);

/* Numbers of many kinds, each with a usual size of its own, that is learned: how many bits more or less one has, then those, then its sign.
 * About how far numbers are from their usual size the same is learned of all kinds, so that there is little to be learned of each. */
#define ECO_NEAR_PARTS 4u        /* usual sizes are told apart by so many parts of a bit */
#define ECO_NEAR_STEPS 16u
struct eco_near {
	struct eco_bit larger[ECO_NEAR_PARTS], more[ECO_NEAR_PARTS][ECO_NEAR_STEPS], less[ECO_NEAR_PARTS][ECO_NEAR_STEPS],
		half[ECO_NEAR_PARTS][ECO_NEAR_STEPS];
	uint32_t level;              /* of the number before: what a kind of which none was seen begins with */
};
struct eco_scale { struct eco_bit sign; uint16_t level, seen; };         /* level: about log2 + 1 of the usual size, in 1/256; 0 of 0 */
void eco_near_start(struct eco_near *near, struct eco_scale *kinds, size_t count);
/* Any number of magnitude < 2^31. */
int32_t eco_range_near(struct eco_range *range, struct eco_near *near, struct eco_scale *kind, int32_t value);

#endif
