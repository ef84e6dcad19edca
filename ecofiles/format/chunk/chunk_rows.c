/* Elements as rows of small integers. Draco's sequential coder has one model of symbol frequencies per
 * column, so the values of a column should be small and alike. Most of a leaf follows from its first
 * corners: a quad's fourth corner is near the parallelogram of the others, a hexagon continues as its
 * first three corners began. The best rule depends on the model, so each is tried and the cheapest is
 * stored, four bits a corner. The same goes for differences from row to row, which cost nothing where all
 * leaves show the same piece of a texture. */
#include "ecofiles/format/chunk/chunk_rows.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/format/chunk/chunk_columns.h"

/* Corner k relative to corner 0 is predicted as the sum of these eighths times corners k-1, k-2, k-3 and
 * k-4 relative to corner 0. */
static const int8_t predictors[ECO_ROWS_PREDICTORS][4] = {
	{ 0, 0, 0, 0 },              /* nothing (corner 0) */
	{ 8, 0, 0, 0 },              /* the corner before */
	{ 8, -8, 0, 0 },             /* the parallelogram of corner 0 and the two before: a quad's last */
	{ 16, -8, 0, 0 },            /* straight on */
	{ 16, -16, 8, 0 },           /* an affine regular hexagon */
	{ 13, -13, 8, 0 },           /* an affine regular pentagon, 13/8 for the golden ratio */
	{ 8, 0, -8, 0 },             /* the parallelogram of the three before, as along a bent strip */
	{ 0, 8, 0, -8 },             /* the same for a strip that goes up one side and down the other */
};

static unsigned predictor_of(uint16_t stored, unsigned corner)
{
	return corner < 2 ? 0 : stored >> (4 * (corner - 2)) & 15u;
}

static int64_t floor_eighth(int64_t v)
{
	return v >= 0 ? v / 8 : -((-v + 7) / 8);
}

/* One coordinate of corner k, relative to corner 0. */
static int32_t predict(unsigned predictor, const int32_t *position, unsigned corner, unsigned axis)
{
	int64_t sum = 0;
	if (predictor == 0)
		return 0;
	for (unsigned back = 1; back <= 4 && back < corner; back++)
		sum += (int64_t)predictors[predictor][back - 1]
			* ((int64_t)position[3 * (corner - back) + axis] - position[axis]);
	return (int32_t)(uint32_t)floor_eighth(sum);
}

/* Differences modulo 2^32: exact both ways whatever the values are. */
static int32_t minus(int32_t a, int32_t b)
{
	return (int32_t)((uint32_t)a - (uint32_t)b);
}

static int32_t plus(int32_t a, int32_t b)
{
	return (int32_t)((uint32_t)a + (uint32_t)b);
}

static bool in_bounds(int32_t v)
{
	return v >= -ECO_ROWS_VALUE_MAX && v <= ECO_ROWS_VALUE_MAX;
}

enum eco_code eco_rows_make(struct eco_chunk_rows *rows, const struct eco_rows_shape *shape,
	struct eco_error *error)
{
	uint32_t per_row = 0;
	assert(shape->corners >= 1 && shape->corners <= ECO_ROWS_CORNERS_MAX && shape->extra_count
		<= ECO_ROWS_EXTRA_MAX);
	memset(rows, 0, sizeof *rows);
	rows->shape = *shape;
	assert(!shape->split || shape->corners == 1);
	for (unsigned axis = 0; shape->split && axis < 3; axis++)
		rows->columns[rows->column_count++] = (struct eco_draco_column){ .components = 1 };
	for (unsigned k = 0; !shape->split && k < shape->corners; k++)
		rows->columns[rows->column_count++] = (struct eco_draco_column){ .components = 3 };
	for (unsigned k = 0; shape->uv && k < shape->corners; k++)
		rows->columns[rows->column_count++] = (struct eco_draco_column){ .components = 2 };
	for (unsigned k = 0; k < shape->extra_count; k++)
		rows->columns[rows->column_count++] = (struct eco_draco_column){ .components = 1 };
	for (uint32_t i = 0; i < rows->column_count; i++)
		per_row += rows->columns[i].components;
	rows->storage = calloc((size_t)per_row * shape->rows, sizeof *rows->storage);
	if (!rows->storage)
		return eco_fail(error, ECO_NO_MEMORY, "out of memory for %u rows of a chunk", shape->rows);
	int32_t *at = rows->storage;
	for (uint32_t i = 0; i < rows->column_count; i++) {
		rows->columns[i].values = at;
		at += (size_t)rows->columns[i].components * shape->rows;
	}
	return ECO_OK;
}

void eco_rows_free(struct eco_chunk_rows *rows)
{
	free(rows->storage);
	memset(rows, 0, sizeof *rows);
}

/* Stores positions relative to corner 0; eco_rows_encode subtracts the prediction once it is chosen. */
void eco_rows_put(struct eco_chunk_rows *rows, uint32_t row, const struct eco_rows_element *element)
{
	const struct eco_rows_shape *s = &rows->shape;
	const struct eco_draco_column *column = rows->columns;
	assert(row < s->rows);
	for (unsigned axis = 0; s->split && axis < 3; axis++, column++)
		column->values[row] = element->position[axis];
	for (unsigned k = 0; !s->split && k < s->corners; k++, column++)
		for (unsigned axis = 0; axis < 3; axis++)
			column->values[3 * (size_t)row + axis] = k == 0 ? element->position[axis]
				: minus(element->position[3 * k + axis], element->position[axis]);
	for (unsigned k = 0; s->uv && k < s->corners; k++, column++)
		for (unsigned axis = 0; axis < 2; axis++)
			column->values[2 * (size_t)row + axis] = k == 0 ? element->uv[axis]
				: minus(element->uv[2 * k + axis], element->uv[2 * (k - 1) + axis]);
	for (unsigned i = 0; i < s->extra_count; i++, column++)
		column->values[row] = element->extra[i];
}

bool eco_rows_get(const struct eco_chunk_rows *rows, uint32_t row, const struct eco_rows_element *element)
{
	const struct eco_rows_shape *s = &rows->shape;
	const struct eco_draco_column *column = rows->columns;
	bool good = true;
	assert(row < s->rows);
	for (unsigned axis = 0; s->split && axis < 3; axis++, column++) {
		element->position[axis] = column->values[row];
		good &= in_bounds(element->position[axis]);
	}
	for (unsigned k = 0; !s->split && k < s->corners; k++, column++) {
		unsigned predictor = predictor_of(s->predictors, k);
		for (unsigned axis = 0; axis < 3; axis++) {
			int32_t v = column->values[3 * (size_t)row + axis];
			if (k > 0)
				v = plus(v,
					plus(element->position[axis],
					predict(predictor, element->position, k, axis)));
			element->position[3 * k + axis] = v;
			good &= in_bounds(v);
		}
	}
	for (unsigned i = 0; s->shift > 0 && i < 3u * s->corners; i++) {
		int64_t v = (int64_t)element->position[i] * (1 << s->shift);
		good &= v >= -ECO_ROWS_VALUE_MAX && v <= ECO_ROWS_VALUE_MAX;
		element->position[i] = good ? (int32_t)v : 0;
	}
	for (unsigned k = 0; s->uv && k < s->corners; k++, column++)
		for (unsigned axis = 0; axis < 2; axis++) {
			int32_t v =
				(int32_t)((uint32_t)column->values[2 * (size_t)row + axis] << s->uv_shift);
			element->uv[2 * k + axis] = k == 0 ? v : plus(v, element->uv[2 * (k - 1) + axis]);
			good &= in_bounds(element->uv[2 * k + axis]);
		}
	for (unsigned i = 0; i < s->extra_count; i++, column++) {
		element->extra[i] = column->values[row];
		good &= in_bounds(element->extra[i]);
	}
	return good;
}

static unsigned bit_length(uint32_t v)
{
	return v == 0 ? 0 : 32u - (unsigned)__builtin_clz(v);
}

/* Roughly the bits of corner k's residuals under a predictor, from a sample of the rows. */
static uint64_t predictor_cost(const struct eco_chunk_rows *rows, unsigned corner, unsigned predictor)
{
	int32_t position[3 * ECO_ROWS_CORNERS_MAX] = { 0 };
	uint32_t step = rows->shape.rows / 2048 + 1;
	uint64_t bits = 0;
	for (uint32_t row = 0; row < rows->shape.rows; row += step)
		for (unsigned axis = 0; axis < 3; axis++) {
			for (unsigned k = 1; k <= corner; k++)
				position[3 * k + axis] = rows->columns[k].values[3 * (size_t)row + axis];
			int32_t v = minus(position[3 * corner + axis],
				predict(predictor, position, corner, axis));
			bits += bit_length(v < 0 ? 0u - (uint32_t)v : (uint32_t)v);
		}
	return bits;
}

static uint16_t choose_predictors(const struct eco_chunk_rows *rows)
{
	uint16_t chosen = 0;
	for (unsigned corner = 2; corner < rows->shape.corners; corner++) {
		unsigned best = 0;
		uint64_t best_cost = predictor_cost(rows, corner, 0);
		for (unsigned p = 1; p < ECO_ROWS_PREDICTORS; p++) {
			uint64_t cost = predictor_cost(rows, corner, p);
			if (cost < best_cost) {
				best = p;
				best_cost = cost;
			}
		}
		chosen |= (uint16_t)(best << (4 * (corner - 2)));
	}
	return chosen;
}

/* Subtracts predictions, from the last corner to the first: a prediction needs the corners before it
 * unchanged. */
static void take_predictions(struct eco_chunk_rows *rows)
{
	int32_t position[3 * ECO_ROWS_CORNERS_MAX] = { 0 };
	for (unsigned corner = rows->shape.corners - 1u; corner >= 2; corner--) {
		unsigned predictor = predictor_of(rows->shape.predictors, corner);
		for (uint32_t row = 0; predictor != 0 && row < rows->shape.rows; row++)
			for (unsigned axis = 0; axis < 3; axis++) {
				int32_t *v = &rows->columns[corner].values[3 * (size_t)row + axis];
				for (unsigned k = 1; k < corner; k++)
					position[3 * k + axis] =
						rows->columns[k].values[3 * (size_t)row + axis];
				*v = minus(*v, predict(predictor, position, corner, axis));
			}
	}
}

/* Finds uv_shift: texture coordinates of whole pictures and of atlases are multiples of a power of two. */
static void take_uv_shift(struct eco_chunk_rows *rows)
{
	uint32_t first = rows->shape.split ? 3 : rows->shape.corners, count = rows->shape.uv
		? rows->shape.corners : 0, all = 0;
	/* of all uv columns: adjacent */
	int32_t *values = count > 0 ? rows->columns[first].values : NULL;
	size_t total = 2 * (size_t)rows->shape.rows * count;
	for (size_t i = 0; i < total; i++)
		all |= (uint32_t)values[i];
	while (rows->shape.uv_shift < 15 && all != 0 && !(all >> rows->shape.uv_shift & 1))
		rows->shape.uv_shift++;
	for (size_t i = 0; i < total; i++)
		values[i] /= 1 << rows->shape.uv_shift;
}

/* Whether Draco can code a column's values, or their differences, without allocating too much. */
static void find_bounds(const struct eco_draco_column *column, uint32_t rows, bool *values_fit,
	bool *differences_fit)
{
	size_t count = (size_t)column->components * rows;
	int32_t low = column->values[0], high = column->values[0];
	for (size_t k = 1; k < count; k++) {
		low = column->values[k] < low ? column->values[k] : low;
		high = column->values[k] > high ? column->values[k] : high;
	}
	*values_fit = high <= ECO_DRACO_VALUE_MAX && low >= -ECO_DRACO_VALUE_MAX;
	*differences_fit = (int64_t)high - low <= ECO_DRACO_VALUE_MAX;
}

/* Asks the coder which is smaller, each column's values or its differences. Sets shape.wide where neither
 * fits. */
static enum eco_code choose_differences(struct eco_chunk_rows *rows, struct eco_error *error)
{
	for (uint32_t i = 0; rows->shape.order == ECO_DRACO_SEQUENTIAL && i < rows->column_count; i++) {
		struct eco_draco_column *column = &rows->columns[i], as_difference = *column;
		bool values_fit, differences_fit;
		enum eco_code code = ECO_OK;
		size_t plain = SIZE_MAX, difference = SIZE_MAX;
		find_bounds(column, rows->shape.rows, &values_fit, &differences_fit);
		as_difference.difference = true;
		if (values_fit)
			code = eco_draco_column_size(column, rows->shape.rows, &plain, error);
		if (code == ECO_OK && differences_fit)
			code = eco_draco_column_size(&as_difference, rows->shape.rows, &difference, error);
		if (code)
			return code;
		column->difference = difference < plain;
		if (!values_fit && !differences_fit)
			rows->shape.wide = true;
	}
	return ECO_OK;
}

/* Splits the columns of a wide stream for Draco: high halves, then low halves. *storage is malloc'ed. */
static enum eco_code wide_columns(const struct eco_chunk_rows *rows, struct eco_draco_column *columns,
	int32_t **storage, struct eco_error *error)
{
	size_t total = 0;
	int32_t *at;
	for (uint32_t i = 0; i < rows->column_count; i++)
		total += (size_t)rows->columns[i].components * rows->shape.rows;
	at = *storage = calloc(2 * total, sizeof **storage);
	if (!at)
		return eco_fail(error, ECO_NO_MEMORY, "out of memory for %u rows of a chunk",
			rows->shape.rows);
	for (uint32_t half = 0; half < 2; half++)
		for (uint32_t i = 0; i < rows->column_count; i++) {
			struct eco_draco_column *c = &columns[half * rows->column_count + i];
			*c = rows->columns[i];
			c->values = at;
			at += (size_t)c->components * rows->shape.rows;
		}
	return ECO_OK;
}

enum eco_code eco_rows_encode(struct eco_chunk_rows *rows, uint8_t **bytes, size_t *size,
	struct eco_error *error)
{
	struct eco_draco_column wide[2 * ECO_ROWS_COLUMNS_MAX];
	int32_t *storage = NULL;
	rows->shape.predictors = choose_predictors(rows);
	take_predictions(rows);
	take_uv_shift(rows);
	enum eco_code code = choose_differences(rows, error);
	if (code == ECO_OK && !rows->shape.wide)
		return eco_draco_encode_rows(rows->shape.order, rows->columns, rows->column_count,
			rows->shape.rows, bytes, size, error);
	code = code ? code : wide_columns(rows, wide, &storage, error);
	if (code)
		return code;
	for (uint32_t i = 0; i < rows->column_count; i++)
		for (size_t k = 0; k < (size_t)wide[i].components * rows->shape.rows; k++) {
			uint32_t v = (uint32_t)rows->columns[i].values[k];
			uint32_t high = v >> 16;
			wide[i].values[k] = high < 0x8000 ? (int32_t)high : (int32_t)high - 0x10000;
			wide[rows->column_count + i].values[k] = (int32_t)(v & 0xffff);
		}
	code = eco_draco_encode_rows(rows->shape.order, wide, 2 * rows->column_count, rows->shape.rows, bytes,
		size, error);
	free(storage);
	return code;
}

static enum eco_code decode_wide(struct eco_chunk_rows *rows, const uint8_t *bytes, size_t size,
	struct eco_error *error)
{
	struct eco_draco_column wide[2 * ECO_ROWS_COLUMNS_MAX];
	int32_t *storage = NULL;
	enum eco_code code = wide_columns(rows, wide, &storage, error);
	code = code ? code : eco_draco_decode_rows(rows->shape.order, bytes, size, wide, 2 * rows->column_count,
		rows->shape.rows, error);
	for (uint32_t i = 0; code == ECO_OK && i < rows->column_count; i++)
		for (size_t k = 0; k < (size_t)wide[i].components * rows->shape.rows; k++)
			rows->columns[i].values[k] = (int32_t)(((uint32_t)wide[i].values[k] << 16)
				+ (uint32_t)wide[rows->column_count + i].values[k]);
	free(storage);
	return code;
}

enum eco_code eco_rows_decode(struct eco_chunk_rows *rows, const uint8_t *bytes, size_t size,
	struct eco_error *error)
{
	for (unsigned k = 2; k < 6; k++)
		if (predictor_of(rows->shape.predictors, k) >= ECO_ROWS_PREDICTORS)
			return eco_fail(error, ECO_DAMAGED, "chunk: predictor %u of corner %u is unknown",
				predictor_of(rows->shape.predictors, k), k);
	if (rows->shape.ground_columns)
		return eco_ground_decode(rows, bytes, size, rows->shape.zeros, error);
	if (rows->shape.packed)
		return eco_columns_decode(rows, bytes, size, rows->shape.zeros, error);
	return rows->shape.wide ? decode_wide(rows, bytes, size, error)
		: eco_draco_decode_rows(rows->shape.order, bytes, size, rows->columns, rows->column_count,
		rows->shape.rows, error);
}
