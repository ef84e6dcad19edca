#include "ecofiles/format/chunk_columns.h"

#include <assert.h>

#include "ecofiles/base/range.h"

#define MODELLED_STEP 2u         /* bits */
#define MODELLED_STEPS 5u
#define MODELS (1u << MODELLED_STEP * (MODELLED_STEPS - 1))
#define BITS_MAX 32u
#define END_MARK 0xa5u
#define END_BITS 8u

/* One component of a column: row i is values[i * apart]. */
struct component { int32_t *values; uint32_t rows, apart; };

/* How it is coded. */
struct head { bool difference; uint32_t first, low, modelled, bits; };

static uint32_t zigzag(uint32_t v)
{
	return v << 1 ^ (0u - (v >> 31));
}

static uint32_t unzigzag(uint32_t v)
{
	return v >> 1 ^ (0u - (v & 1));
}

static uint32_t code_number(struct eco_range *r, uint32_t value)
{
	uint32_t code = zigzag(value), bits = code ? 32u - (uint32_t)__builtin_clz(code) : 0;
	bits = (uint32_t)eco_range_raw(r, 6, bits);
	return unzigzag((uint32_t)eco_range_raw(r, bits < BITS_MAX ? bits : BITS_MAX, code));
}

/* False: impossible. */
static bool code_head(struct eco_range *r, struct head *h)
{
	h->difference = eco_range_raw(r, 1, h->difference);
	if (h->difference)
		h->first = code_number(r, h->first);
	h->modelled = (uint32_t)eco_range_raw(r, 3, h->modelled / MODELLED_STEP) * MODELLED_STEP;
	h->bits = (uint32_t)eco_range_raw(r, 6, h->bits);
	if (eco_range_raw(r, 1, h->low != 0))
		h->low = code_number(r, h->low);
	return h->bits <= BITS_MAX && h->modelled <= MODELLED_STEP * (MODELLED_STEPS - 1);
}

static bool code_component(struct eco_range *r, const struct component *c, struct head *h)
{
	struct eco_bit models[MODELS];
	if (!code_head(r, h))
		return false;
	eco_bits_start(models, MODELS);
	uint32_t before = h->difference ? h->first : 0;
	if (h->difference)
		c->values[0] = (int32_t)h->first;
	for (uint32_t i = h->difference; i < c->rows; i++) {
		int32_t *at = &c->values[(size_t)i * c->apart];
		uint32_t value = h->low + before + eco_range_field(r, models, h->modelled, h->bits,
			(uint32_t)*at - before - h->low);
		*at = (int32_t)value;
		before = h->difference ? value : 0;
	}
	return true;
}

/* ---- Writing ---- */

/* The span of the values, or of their differences. `low` stays 0 where that takes no more bits. */
static struct head head_of(const struct component *c, bool difference)
{
	struct head h = { .difference = difference, .first = (uint32_t)c->values[0] };
	int32_t low = 0, high = 0;
	for (uint32_t i = difference; i < c->rows; i++) {
		uint32_t v = (uint32_t)c->values[(size_t)i * c->apart];
		if (difference)
			v -= (uint32_t)c->values[(size_t)(i - 1) * c->apart];
		int32_t value = (int32_t)v;
		low = i == difference || value < low ? value : low;
		high = i == difference || value > high ? value : high;
	}
	uint32_t span = (uint32_t)high - (uint32_t)low;
	h.bits = span ? 32u - (uint32_t)__builtin_clz(span) : 0;
	h.low = low >= 0 && (uint64_t)high < (uint64_t)1 << h.bits ? 0 : (uint32_t)low;
	return h;
}

/* Coding leaves the values as they are, so the sizes of all ways can be tried; SIZE_MAX without memory. */
static size_t size_of(const struct component *c, struct head h)
{
	struct eco_writer w = { 0 };
	struct eco_range range;
	eco_range_write(&range, &w);
	code_component(&range, c, &h);
	size_t zeros = eco_range_end(&range), size = w.failed ? SIZE_MAX : w.size + zeros;
	eco_writer_free(&w);
	return size;
}

static struct head smallest_head(const struct component *c)
{
	struct head best = head_of(c, false);
	size_t least = size_of(c, best);
	for (uint32_t way = 1; way < 2 * MODELLED_STEPS; way++) {
		struct head h = head_of(c, way >= MODELLED_STEPS);
		h.modelled = way % MODELLED_STEPS * MODELLED_STEP;
		size_t size = h.modelled < h.bits + MODELLED_STEP ? size_of(c, h) : SIZE_MAX;
		if (size < least) {
			least = size;
			best = h;
		}
	}
	return best;
}

static struct component component_of(const struct eco_chunk_rows *rows, uint32_t column, uint32_t k)
{
	const struct eco_draco_column *c = &rows->columns[column];
	return (struct component){ c->values + k, rows->shape.rows, c->components };
}

enum eco_code eco_columns_encode(const struct eco_chunk_rows *rows, uint8_t **bytes, size_t *size,
	uint8_t *zeros, struct eco_error *error)
{
	struct eco_writer w = { 0 };
	struct eco_range range;
	eco_range_write(&range, &w);
	for (uint32_t i = 0; i < rows->column_count; i++)
		for (uint32_t k = 0; k < rows->columns[i].components; k++) {
			struct component c = component_of(rows, i, k);
			struct head h = smallest_head(&c);
			code_component(&range, &c, &h);
		}
	eco_range_raw(&range, END_BITS, END_MARK);
	*zeros = (uint8_t)eco_range_end(&range);
	if (w.failed) {
		eco_writer_free(&w);
		return eco_fail(error, ECO_NO_MEMORY, "out of memory for %u rows of a chunk",
			rows->shape.rows);
	}
	*bytes = w.bytes;
	*size = w.size;
	return ECO_OK;
}

/* ---- Reading ---- */

enum eco_code eco_columns_decode(struct eco_chunk_rows *rows, const uint8_t *bytes, size_t size,
	uint8_t zeros, struct eco_error *error)
{
	struct eco_range range;
	bool good = true;
	eco_range_read(&range, bytes, size);
	for (uint32_t i = 0; i < rows->column_count && good; i++)
		for (uint32_t k = 0; k < rows->columns[i].components && good; k++) {
			struct component c = component_of(rows, i, k);
			struct head h = { 0 };
			good = code_component(&range, &c, &h);
		}
	if (good && eco_range_raw(&range, END_BITS, 0) == END_MARK && eco_range_end(&range) == zeros)
		return ECO_OK;
	return eco_fail(error, ECO_DAMAGED, "chunk: its rows are cut short or hold impossible values");
}
