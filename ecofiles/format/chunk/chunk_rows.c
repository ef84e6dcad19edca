/* Elements as rows of small integers. Columns are coded one by one, so the values of a column should be small
 * and alike. Most of a leaf follows from its first corners: a quad's fourth corner is near the parallelogram
 * of the others, a hexagon continues as its first three corners began. The best rule depends on the model, so
 * each is tried and the cheapest is stored, four bits a corner. The same goes for differences from row to
 * row, which cost nothing where all leaves show the same piece of a texture. */
#include "ecofiles/format/chunk/chunk_rows.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/memory.h"
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

int32_t *eco_rows_storage(struct eco_column *columns, uint32_t count, uint32_t rows)
{
	size_t per_row = 0;
	for (uint32_t i = 0; i < count; i++)
		per_row += columns[i].components;
	int32_t *storage = calloc(per_row * rows, sizeof *storage), *at = storage;
	for (uint32_t i = 0; storage && i < count; i++) {
		columns[i].values = at;
		at += (size_t)columns[i].components * rows;
	}
	return storage;
}

static void add_columns(struct eco_chunk_rows *rows, uint32_t count, uint8_t components)
{
	while (count-- > 0)
		rows->columns[rows->column_count++] = (struct eco_column){ .components = components };
}

static enum eco_code no_memory(const struct eco_chunk_rows *rows, struct eco_error *error)
{
	return eco_fail(error, ECO_NO_MEMORY, "out of memory for %u rows of a chunk", rows->stream.elements);
}

enum eco_code eco_rows_make(struct eco_chunk_rows *rows, const struct eco_list *list, uint8_t coder,
	const struct eco_stream *stream, struct eco_error *error)
{
	*rows = (struct eco_chunk_rows){ .cloud = coder == ECO_CODER_KD,
		.extra_count = (uint8_t)eco_list_extra_count(list), .uv = list->attributes & ECO_ATTR_UV,
		.placed = list->kind == ECO_LIST_INSTANCES,
		.split = coder == ECO_CODER_ROWS && list->kind != ECO_LIST_INSTANCES,
		.ground_columns = list->kind == ECO_LIST_GROUND ? list->columns : 0, .stream = *stream };
	assert(!rows->split || stream->corners == 1);
	add_columns(rows, rows->split ? 3 : stream->corners, rows->split ? 1 : 3);
	add_columns(rows, rows->uv ? stream->corners : 0, 2);
	add_columns(rows, rows->extra_count, 1);
	rows->storage = eco_rows_storage(rows->columns, rows->column_count, stream->elements);
	return rows->storage ? ECO_OK : no_memory(rows, error);
}

void eco_rows_free(struct eco_chunk_rows *rows)
{
	free(rows->storage);
	memset(rows, 0, sizeof *rows);
}

/* Stores positions relative to corner 0; eco_rows_encode subtracts the prediction once it is chosen. */
void eco_rows_put(struct eco_chunk_rows *rows, uint32_t row, const struct eco_rows_element *element)
{
	const struct eco_stream *s = &rows->stream;
	const struct eco_column *column = rows->columns;
	assert(row < s->elements);
	for (unsigned axis = 0; rows->split && axis < 3; axis++, column++)
		column->values[row] = element->position[axis];
	for (unsigned k = 0; !rows->split && k < s->corners; k++, column++)
		for (unsigned axis = 0; axis < 3; axis++)
			column->values[3 * (size_t)row + axis] = k == 0 ? element->position[axis]
				: minus(element->position[3 * k + axis], element->position[axis]);
	for (unsigned k = 0; rows->uv && k < s->corners; k++, column++)
		for (unsigned axis = 0; axis < 2; axis++)
			column->values[2 * (size_t)row + axis] = k == 0 ? element->uv[axis]
				: minus(element->uv[2 * k + axis], element->uv[2 * (k - 1) + axis]);
	for (unsigned i = 0; i < rows->extra_count; i++, column++)
		column->values[row] = element->extra[i];
}

bool eco_rows_get(const struct eco_chunk_rows *rows, uint32_t row, const struct eco_rows_element *element)
{
	const struct eco_stream *s = &rows->stream;
	const struct eco_column *column = rows->columns;
	bool good = true;
	assert(row < s->elements);
	for (unsigned axis = 0; rows->split && axis < 3; axis++, column++) {
		element->position[axis] = column->values[row];
		good &= in_bounds(element->position[axis]);
	}
	for (unsigned k = 0; !rows->split && k < s->corners; k++, column++) {
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
	for (unsigned k = 0; rows->uv && k < s->corners; k++, column++)
		for (unsigned axis = 0; axis < 2; axis++) {
			int32_t v =
				(int32_t)((uint32_t)column->values[2 * (size_t)row + axis] << s->uv_shift);
			element->uv[2 * k + axis] = k == 0 ? v : plus(v, element->uv[2 * (k - 1) + axis]);
			good &= in_bounds(element->uv[2 * k + axis]);
		}
	for (unsigned i = 0; i < rows->extra_count; i++, column++) {
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
	uint32_t step = rows->stream.elements / 2048 + 1;
	uint64_t bits = 0;
	for (uint32_t row = 0; row < rows->stream.elements; row += step)
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
	for (unsigned corner = 2; corner < rows->stream.corners; corner++) {
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
	for (unsigned corner = rows->stream.corners - 1u; corner >= 2; corner--) {
		unsigned predictor = predictor_of(rows->stream.predictors, corner);
		for (uint32_t row = 0; predictor != 0 && row < rows->stream.elements; row++)
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
	uint32_t first = rows->split ? 3 : rows->stream.corners, count = rows->uv
		? rows->stream.corners : 0, all = 0;
	/* of all uv columns: adjacent */
	int32_t *values = count > 0 ? rows->columns[first].values : NULL;
	size_t total = 2 * (size_t)rows->stream.elements * count;
	for (size_t i = 0; i < total; i++)
		all |= (uint32_t)values[i];
	while (rows->stream.uv_shift < 15 && all != 0 && !(all >> rows->stream.uv_shift & 1))
		rows->stream.uv_shift++;
	for (size_t i = 0; i < total; i++)
		values[i] /= 1 << rows->stream.uv_shift;
}

void eco_rows_encode(struct eco_chunk_rows *rows)
{
	rows->stream.predictors = choose_predictors(rows);
	take_predictions(rows);
	take_uv_shift(rows);
	eco_columns_encode(rows, &rows->stream);
}

enum eco_code eco_rows_decode(struct eco_chunk_rows *rows, struct eco_error *error)
{
	const struct eco_stream *s = &rows->stream;
	for (unsigned k = 2; k < 6; k++)
		if (predictor_of(s->predictors, k) >= ECO_ROWS_PREDICTORS)
			return eco_fail(error, ECO_DAMAGED, "chunk: predictor %u of corner %u is unknown",
				predictor_of(s->predictors, k), k);
	if (rows->ground_columns)
		return eco_ground_decode(rows, error);
	return eco_columns_decode(rows, error);
}
