/* Columns of rows in one adaptively coded stream (ecofiles/base/range.h), for chunks of few rows: Draco
 * stores a table of symbols for each column, which takes more bytes than the rows of a small chunk.
 *
 * Component by component, columns in the order of chunk_rows.h, each with a head:
 *   1 bit    1: all rows but the first are coded as the difference to the row before
 *   number   the first row, with differences only
 *   3 bits   n: the highest 2n bits of a value are modelled, those below are as good as random
 *   6 bits   b: values lie in [low, low + 2^b), b <= 32
 *   1 bit    0: low is 0; 1: a number, low
 * then each value less low in b bits. A number is 6 bits n <= 32, then n bits of its zigzag code. Sums and
 * differences are modulo 2^32, so every row comes back as it was. At the end stand the 8 bits 0xa5: what is
 * cut off reads as zeros, and zeros could be rows. */
#ifndef ECO_CHUNK_COLUMNS_H
#define ECO_CHUNK_COLUMNS_H

#include "ecofiles/format/chunk_rows.h"

/* Rows of a chunk that is coded so; larger ones are decoded faster by Draco, and hardly larger. */
#define ECO_COLUMNS_ROWS_MAX 4096u

/* Encodes the columns as they stand in rows->columns; *zeros: bytes left off at the end. Bytes are
 * malloc'ed. */
enum eco_code eco_columns_encode(const struct eco_chunk_rows *rows, uint8_t **bytes, size_t *size,
	uint8_t *zeros, struct eco_error *error);
/* Fills rows->columns. ECO_DAMAGED where bytes are not as written. */
enum eco_code eco_columns_decode(struct eco_chunk_rows *rows, const uint8_t *bytes, size_t size,
	uint8_t zeros, struct eco_error *error);

#endif
