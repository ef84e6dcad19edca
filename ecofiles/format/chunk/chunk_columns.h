/* Columns of rows in one adaptively coded stream (ecofiles/base/range.h), for chunks of few rows: Draco
 * stores a table of symbols for each column, which takes more bytes than the rows of a small chunk.
 *
 * Component by component, columns in the order of chunk_rows.h (of a kd-tree without positions, which come
 * first, as chunk_counts.h says), each with a head:
 *   3 bits   way: VALUES 0, DIFFERENCES 1, STEPS 2, RECENT 3, GIVEN 4
 *   number   the first row, of DIFFERENCES and STEPS: their other rows are coded as the difference to the row
 *            before
 *   7 bits   of GIVEN: an earlier component
 *   3 bits   n: the highest 2n bits of a field are modelled, those below are as good as random
 *   6 bits   b: fields lie in [low, low + 2^(b + s)), b + s <= 32
 *   1 bit    0: s is 0; 1: 4 bits, s: low bits that are 0 in every field less low, and not coded
 *   1 bit    0: low is 0; 1: a number, low
 * (of STEPS only way and first row), then the rows: VALUES and DIFFERENCES a field each, less low in b bits.
 * STEPS: eco_range_number. RECENT: how many other values came since this one came last, at most 64; where it
 * is none of them, as many as there are, and a field. GIVEN: a field with models of its own for each of the
 * first 15 values of the earlier component. A number is 6 bits n <= 32, then n bits of its zigzag code. Sums
 * and differences are modulo 2^32, so every row comes back as it was. At the end stand the 8 bits 0xa5: what
 * is cut off reads as zeros, and zeros could be rows. */
#ifndef ECO_CHUNK_COLUMNS_H
#define ECO_CHUNK_COLUMNS_H

#include "ecofiles/base/range.h"
#include "ecofiles/format/chunk/chunk_rows.h"

/* Rows of a chunk that is coded so, but for points of a kd-tree; larger ones are decoded faster by Draco, and
 * hardly larger. */
#define ECO_COLUMNS_ROWS_MAX 4096u

/* Encodes the columns as they stand in rows->columns; *zeros: bytes left off at the end. Bytes are malloc'ed.
 * Rows of a kd-tree are put into the order in which they are decoded. */
enum eco_code eco_columns_encode(struct eco_chunk_rows *rows, uint8_t **bytes, size_t *size, uint8_t *zeros,
	struct eco_error *error);
/* Fills rows->columns. ECO_DAMAGED where bytes are not as written. */
enum eco_code eco_columns_decode(struct eco_chunk_rows *rows, const uint8_t *bytes, size_t size,
	uint8_t zeros, struct eco_error *error);

/* A number as above, modulo 2^32. */
uint32_t eco_columns_number(struct eco_range *range, uint32_t value);

#endif
