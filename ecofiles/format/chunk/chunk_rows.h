/* Elements in Draco's rows: one row an element, corner by corner as differences that are small and alike.
 *
 *   eco_rows_make(&rows, &shape, ...);           columns for so many elements of one corner count
 *   eco_rows_put(&rows, row, &element);          encoder: element -> row
 *   eco_rows_encode(&rows, ...)                  -> a Draco stream          (eco_rows_decode the other way)
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
 * Draco codes each column as values or as differences to the row before, whichever is smaller (the stream
 * says which; kd: values).
 *
 * Split positions suit rows whose order is given. Samples of ground are always packed (chunk_columns.h).
 *
 * A `wide` stream has values beyond ECO_DRACO_VALUE_MAX: each column is stored as two, value >> 16 and
 * value & 65535. */
#ifndef ECO_CHUNK_ROWS_H
#define ECO_CHUNK_ROWS_H

#include "ecofiles/format/chunk/draco_shim.h"
#include "ecofiles/format/list.h"

#define ECO_ROWS_CORNERS_MAX ECO_CORNERS_MAX
#define ECO_ROWS_EXTRA_MAX 12
#define ECO_ROWS_COLUMNS_MAX (3 + 2 * ECO_ROWS_CORNERS_MAX + ECO_ROWS_EXTRA_MAX)
#define ECO_ROWS_PREDICTORS 8u

struct eco_rows_shape {
	enum eco_draco_order order;
	uint32_t rows;
	uint8_t corners;             /* 1..ECO_ROWS_CORNERS_MAX */
	uint8_t extra_count;
	bool uv;
	bool wide;
	bool packed;                 /* decoding: coded as chunk_columns.h says, not by Draco */
	uint8_t zeros;               /* packed: bytes left off at the end */
	uint8_t uv_shift;            /* 0..15 */
	uint8_t shift;               /* 0..7: eco_rows_get gives 2^shift times the value; not with `split` */
	bool split;                  /* one corner only */
	uint32_t ground_columns;     /* samples a row of a ground grid, with `split`; else 0 */
	uint16_t predictors;         /* 4 bits for each of corners 2..5, from the low end */
};

struct eco_chunk_rows {
	struct eco_rows_shape shape;
	struct eco_draco_column columns[ECO_ROWS_COLUMNS_MAX];
	uint32_t column_count;
	int32_t *storage;
};

/* One element, in arrays of the caller. `uv` and `extra` may be NULL where the shape has none. */
struct eco_rows_element { int32_t *position, *uv, *extra; };

/* Largest magnitude of a position, uv or extra value in a chunk. */
#define ECO_ROWS_VALUE_MAX ((1 << 28) - 1)

/* Columns for shape->rows rows, all 0. The shape is trusted: at most ECO_ROWS_CORNERS_MAX corners,
 * ECO_ROWS_EXTRA_MAX extra values; split rows have one corner. ECO_NO_MEMORY leaves nothing to free. */
enum eco_code eco_rows_make(struct eco_chunk_rows *rows, const struct eco_rows_shape *shape,
	struct eco_error *error);
void eco_rows_free(struct eco_chunk_rows *rows);

/* `row` is below shape.rows. _get returns false where a value is beyond ECO_ROWS_VALUE_MAX. */
void eco_rows_put(struct eco_chunk_rows *rows, uint32_t row, const struct eco_rows_element *element);
bool eco_rows_get(const struct eco_chunk_rows *rows, uint32_t row, const struct eco_rows_element *element);

/* Encoding sets shape.predictors, uv_shift and wide to the best; they must be stored with the stream. */
enum eco_code eco_rows_encode(struct eco_chunk_rows *rows, uint8_t **bytes, size_t *size,
	struct eco_error *error);
enum eco_code eco_rows_decode(struct eco_chunk_rows *rows, const uint8_t *bytes, size_t size,
	struct eco_error *error);

#endif
