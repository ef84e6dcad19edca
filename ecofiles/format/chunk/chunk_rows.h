/* Elements in rows: one row an element, corner by corner as differences that are small and alike.
 *
 *   eco_rows_make(&rows, &list, ...);            columns for so many elements of one corner count
 *   eco_rows_put(&rows, row, &element);          encoder: element -> row
 *   eco_rows_encode(&rows)                       -> a stream                (eco_rows_decode the other way)
 *   eco_rows_get(&rows, row, &element);          decoder: row -> element; false if a value is out of bounds
 *   eco_rows_free(&rows);
 *
 * Columns of a row with m corners:
 *   position 0 (3 values; split: 1, 1, 1)
 *   position k = 1..m-1 (3)            corner k relative to corner 0, less a linear prediction from the
 *                                      corners before it; the prediction is stored per stream and corner
 *   uv 0, uv k - uv k-1 (2 each)       where the list has UV; without the low `uv_shift` bits, which are all
 *                                      zero
 *   extra (1 each)
 *
 * Positions are split where the order of rows is given, but of instances. chunk_columns.h says how columns,
 * places and samples of ground are coded. */
#pragma once

#include <stddef.h>

#include "ecofiles/format/list.h"

#define ECO_ROWS_CORNERS_MAX ECO_CORNERS_MAX
#define ECO_ROWS_EXTRA_MAX 12
#define ECO_ROWS_COLUMNS_MAX (3 + 2 * ECO_ROWS_CORNERS_MAX + ECO_ROWS_EXTRA_MAX)
#define ECO_ROWS_PREDICTORS 8u

struct eco_column {
	int32_t *values;             /* components per row, row by row */
	uint8_t components;
};

/* A stream of rows and how it is coded; a SHAPES payload's stream has only zeros, bytes and size. */
struct eco_stream {
	uint8_t corners;             /* of an element: 1..ECO_ROWS_CORNERS_MAX */
	uint8_t uv_shift;            /* 0..15 */
	uint8_t shift;               /* of positions, 0..7: eco_rows_get gives 2^shift times the value; not split */
	uint16_t predictors;         /* 4 bits for each of corners 2..5, from the low end */
	uint8_t zeros;               /* bytes at the end that are zero and not stored */
	uint32_t elements;           /* of an only stream of rows eco_payload_read leaves it 0: the chunk's record says it */
	const uint8_t *bytes;        /* reading: within the payload; writing: malloc'ed */
	size_t size;
};

struct eco_chunk_rows {
	uint8_t extra_count;
	bool cloud, placed;          /* of a KD list; of instances */
	bool uv, split;              /* split: one corner only */
	uint32_t ground_columns;     /* samples a row of a ground grid, with `split`; else 0 */
	struct eco_stream stream;
	struct eco_column columns[ECO_ROWS_COLUMNS_MAX];
	uint32_t column_count;
	int32_t *storage;
};

/* One element, in arrays of the caller. `uv` and `extra` may be NULL where the shape has none. */
struct eco_rows_element { int32_t *position, *uv, *extra; };

/* Largest magnitude of a position, uv or extra value in a chunk. */
#define ECO_ROWS_VALUE_MAX ((1 << 28) - 1)

/* Columns for the elements of a stream of `coder` in a list, all 0. The list and the stream's counts are
 * trusted. ECO_NO_MEMORY leaves nothing to free. */
enum eco_code eco_rows_make(struct eco_chunk_rows *rows, const struct eco_list *list, uint8_t coder,
	const struct eco_stream *stream, struct eco_error *error);
void eco_rows_free(struct eco_chunk_rows *rows);

/* Values of `count` columns with so many rows, all 0, in one array, which is malloc'ed; NULL: no memory. */
int32_t *eco_rows_storage(struct eco_column *columns, uint32_t count, uint32_t rows);

/* `row` is below stream.elements. _get returns false where a value is beyond ECO_ROWS_VALUE_MAX. */
void eco_rows_put(struct eco_chunk_rows *rows, uint32_t row, const struct eco_rows_element *element);
bool eco_rows_get(const struct eco_chunk_rows *rows, uint32_t row, const struct eco_rows_element *element);

/* Encodes the rows as put, and fills the stream. Without memory it ends the program (memory.h). */
void eco_rows_encode(struct eco_chunk_rows *rows);
/* Decodes the stream's bytes. */
enum eco_code eco_rows_decode(struct eco_chunk_rows *rows, struct eco_error *error);
