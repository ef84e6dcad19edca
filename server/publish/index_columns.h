/* Columns of an index's tables (index.h): whole numbers, each coded from those that are known by then.
 *
 *   srv_index_table(&range, kind, records, count, find);         the same function writes and reads
 *
 * Values of a record are columns (eco_record_widths), the last one first, as counts stand behind what they add up to.
 * A column has a head, 1 bit, 0: all values are as the first one, and else a struct srv_index_way; then its values:
 *   1 bit    is it what followed the same key the last time?
 *   number   otherwise: its difference to a guess, modulo 2^32, as the bits of its magnitude in 6 modelled bits, those below
 *            the highest, the first ones modelled, and a sign
 * Runs, and columns that repeat, as of models in several forms, take next to nothing. */
#pragma once

#include "ecofiles/base/range.h"
#include "ecofiles/format/pack_record.h"

enum srv_index_base {            /* the guess: ... */
	SRV_BASE_ZERO,           /* ... 0 */
	SRV_BASE_BEFORE,         /* ... the value before */
	SRV_BASE_LINE,           /* ... as far on as that was from the one before it */
	SRV_BASE_SUM,            /* ... the value before, and column `of` there */
	SRV_BASE_OTHER,          /* ... column `of` */
	SRV_BASE_PARALLEL,       /* ... as far on as column `of` */
	SRV_BASES
};
/* Sizes of differences have models for: nothing, the size of the last one, the size of the change of column `by`, its
 * value. A key is the value before, the value of column `by`, or both. */
enum { SRV_SLOTS_NONE, SRV_SLOTS_OWN, SRV_SLOTS_CHANGE, SRV_SLOTS_VALUE, SRV_SLOT_KINDS };
enum { SRV_KEY_BEFORE, SRV_KEY_BY, SRV_KEY_BOTH, SRV_KEYS };
#define SRV_INDEX_TOP_STEP 2u    /* modelled bits below the highest: 0, 2, 4, 6 */
#define SRV_INDEX_TOP_STEPS 4u

struct srv_index_way { uint8_t base, of, by, slots, key, top, shift; };         /* shift: low bits that are 0 in all */
struct srv_index_columns { uint32_t *values, rows, count; struct srv_index_learnt *learnt; };

/* Codes the first `rows` values of a column; where bytes are counted as far as `most`. */
void srv_index_column(struct eco_range *range, const struct srv_index_columns *columns, uint32_t column,
	const struct srv_index_way *way, uint32_t rows, size_t most);
/* Codes a table; find: writing, the way of a column. False: no memory, or damaged. */
typedef struct srv_index_way srv_index_find(const struct srv_index_columns *columns, uint32_t column);
bool srv_index_table(struct eco_range *range, enum eco_section_kind kind, uint8_t *records, uint32_t count,
	srv_index_find *find);
