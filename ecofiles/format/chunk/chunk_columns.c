#include "ecofiles/format/chunk/chunk_columns.h"

#include <string.h>

#include "ecofiles/base/range.h"

#define WAY_BITS 3u
#define MODELLED_STEP 2u         /* bits */
#define MODELLED_STEPS 5u
#define MODELLED_MOST (MODELLED_STEP * (MODELLED_STEPS - 1))
#define MODELS (1u << MODELLED_MOST)
#define BITS_MAX 32u
#define SHIFT_BITS 4u
#define STEP_MOST (1u << 30)     /* so that a step's magnitude is below 2^31 */
#define RECENT_MOST 64u
#define RANK_BITS 4u
#define SLOTS 16u                /* values of another component that have models of their own, but the last */
#define GIVEN_BITS 7u
#define COMPONENTS_MAX (3u * ECO_ROWS_COLUMNS_MAX)
#define END_MARK 0xa5u
#define END_BITS 8u

/* One component of a column: row i is values[i * apart]. */
struct component { int32_t *values; uint32_t rows, apart; bool extra; };

enum way { VALUES, DIFFERENCES, STEPS, RECENT, GIVEN, WAYS };
/* How a component is coded. */
struct head { uint32_t way, first, low, modelled, bits, shift, given; };

struct columns {
	struct eco_range range;
	struct component items[COMPONENTS_MAX];
	uint32_t count;
};

/* Adaptive state of a component's coder. */
struct learnt {
	struct eco_bit models[SLOTS * MODELS], sizes[ECO_RANGE_NUMBER], ranks[1u << RANK_BITS];
	/* values, the last first; of GIVEN: those of the other component, the first first */
	int32_t recent[RECENT_MOST];
	uint32_t recent_count;
};

static uint32_t zigzag(uint32_t v)
{
	return v << 1 ^ (0u - (v >> 31));
}

static uint32_t unzigzag(uint32_t v)
{
	return v >> 1 ^ (0u - (v & 1));
}

uint32_t eco_columns_number(struct eco_range *r, uint32_t value)
{
	uint32_t code = zigzag(value), bits = code ? 32u - (uint32_t)__builtin_clz(code) : 0;
	bits = (uint32_t)eco_range_raw(r, 6, bits);
	return unzigzag((uint32_t)eco_range_raw(r, bits < BITS_MAX ? bits : BITS_MAX, code));
}

/* Reads component `index`. False: impossible. */
static bool code_head(struct eco_range *r, uint32_t index, struct head *h)
{
	h->way = (uint32_t)eco_range_raw(r, WAY_BITS, h->way);
	if (h->way == DIFFERENCES || h->way == STEPS)
		h->first = eco_columns_number(r, h->first);
	if (h->way == STEPS)
		return true;
	if (h->way == GIVEN)
		h->given = (uint32_t)eco_range_raw(r, GIVEN_BITS, h->given);
	h->modelled = (uint32_t)eco_range_raw(r, 3, h->modelled / MODELLED_STEP) * MODELLED_STEP;
	h->bits = (uint32_t)eco_range_raw(r, 6, h->bits);
	if (eco_range_raw(r, 1, h->shift != 0))
		h->shift = (uint32_t)eco_range_raw(r, SHIFT_BITS, h->shift);
	if (eco_range_raw(r, 1, h->low != 0))
		h->low = eco_columns_number(r, h->low);
	return h->way < WAYS && h->bits + h->shift <= BITS_MAX && h->modelled <= MODELLED_MOST
		&& (h->way != GIVEN || h->given < index);
}

static uint32_t code_field(struct eco_range *r, struct learnt *l, const struct head *h, uint32_t slot,
	uint32_t value)
{
	return h->low + (eco_range_field(r, l->models + slot * MODELS, h->modelled, h->bits,
		(value - h->low) >> h->shift) << h->shift);
}

/* Any number below 2^15: its number of bits, then those below the highest. */
static uint32_t code_rank(struct eco_range *r, struct learnt *l, uint32_t rank)
{
	uint32_t bits = rank ? 32u - (uint32_t)__builtin_clz(rank) : 0;
	bits = eco_range_tree(r, l->ranks, RANK_BITS, bits) & ((1u << RANK_BITS) - 1);
	if (bits < 2)
		return bits;
	return 1u << (bits - 1) | (uint32_t)eco_range_raw(r, bits - 1, rank & ((1u << (bits - 1)) - 1));
}

/* How many other values came since this one came last; as many as there are: it is new. */
static uint32_t code_recent(struct eco_range *r, struct learnt *l, const struct head *h, uint32_t value)
{
	uint32_t rank = 0;
	while (r->writer && rank < l->recent_count && (uint32_t)l->recent[rank] != value)
		rank++;
	rank = code_rank(r, l, rank);
	if (rank < l->recent_count)
		value = (uint32_t)l->recent[rank];
	else {
		value = code_field(r, l, h, 0, value);
		l->recent_count += l->recent_count < RECENT_MOST;
		rank = l->recent_count - 1;
	}
	memmove(l->recent + 1, l->recent, rank * sizeof *l->recent);
	l->recent[0] = (int32_t)value;
	return value;
}

static uint32_t slot_of(struct learnt *l, int32_t given)
{
	uint32_t slot = 0;
	while (slot < l->recent_count && l->recent[slot] != given)
		slot++;
	if (slot == l->recent_count && slot < SLOTS - 1)
		l->recent[l->recent_count++] = given;
	return slot;
}

static uint32_t code_value(struct eco_range *r, struct learnt *l, const struct head *h, uint32_t before,
	const int32_t *given, uint32_t value)
{
	switch (h->way) {
	case DIFFERENCES:
		return before + code_field(r, l, h, 0, value - before);
	case STEPS:
		return before + (uint32_t)eco_range_number(r, l->sizes, (int32_t)(value - before));
	case RECENT:
		return code_recent(r, l, h, value);
	case GIVEN:
		return code_field(r, l, h, slot_of(l, *given), value);
	default:
		return code_field(r, l, h, 0, value);
	}
}

static bool code_component(struct eco_range *r, const struct columns *columns, uint32_t index, struct head *h)
{
	const struct component *c = &columns->items[index];
	struct learnt l;
	if (!code_head(r, index, h))
		return false;
	const struct component *given = &columns->items[h->way == GIVEN ? h->given : index];
	bool steps = h->way == DIFFERENCES || h->way == STEPS;
	uint32_t before = h->first;
	eco_bits_start(l.models, h->way == GIVEN ? SLOTS * MODELS : MODELS);
	eco_bits_start(l.sizes, ECO_RANGE_NUMBER);
	eco_bits_start(l.ranks, 1u << RANK_BITS);
	l.recent_count = 0;
	if (steps)
		c->values[0] = (int32_t)h->first;
	for (uint32_t i = steps; i < c->rows; i++) {
		int32_t *at = &c->values[(size_t)i * c->apart];
		before = code_value(r, &l, h, before, &given->values[(size_t)i * given->apart],
			(uint32_t)*at);
		*at = (int32_t)before;
	}
	return true;
}

/* ---- Writing ---- */

static uint32_t value_at(const struct component *c, uint32_t i, bool difference)
{
	uint32_t v = (uint32_t)c->values[(size_t)i * c->apart];
	return difference ? v - (uint32_t)c->values[(size_t)(i - 1) * c->apart] : v;
}

/* Leaves out low bits that no field has. */
static void take_shift(const struct component *c, bool difference, struct head *h)
{
	uint32_t any = 0;
	for (uint32_t i = difference; i < c->rows; i++)
		any |= value_at(c, i, difference) - h->low;
	h->shift = any ? (uint32_t)__builtin_ctz(any) : 0;
	h->shift = h->shift >> SHIFT_BITS ? (1u << SHIFT_BITS) - 1 : h->shift;
	h->bits -= h->shift;
}

/* The span of the values, or of their differences. `low` stays 0 where that takes no more bits. */
static struct head head_of(const struct component *c, bool difference)
{
	struct head h = { .way = difference ? DIFFERENCES : VALUES, .first = (uint32_t)c->values[0] };
	int32_t low = 0, high = 0;
	for (uint32_t i = difference; i < c->rows; i++) {
		int32_t value = (int32_t)value_at(c, i, difference);
		low = i == difference || value < low ? value : low;
		high = i == difference || value > high ? value : high;
	}
	uint32_t span = (uint32_t)high - (uint32_t)low;
	h.bits = span ? 32u - (uint32_t)__builtin_clz(span) : 0;
	h.low = low >= 0 && (uint64_t)high < (uint64_t)1 << h.bits ? 0 : (uint32_t)low;
	take_shift(c, difference, &h);
	return h;
}

/* Size of VALUES or DIFFERENCES, by the number of modelled bits. */
static void field_sizes(const struct columns *columns, uint32_t index, struct head h,
	size_t sizes[MODELLED_STEPS])
{
	const struct component *c = &columns->items[index];
	struct eco_writer w = { 0 };
	struct eco_range range;
	struct eco_counted counted[MODELLED_STEPS];
	struct eco_bit models[MODELS];
	eco_range_write(&range, &w);
	code_head(&range, index, &h);
	for (uint32_t i = 0; i < MODELLED_STEPS; i++)
		eco_range_count(&counted[i], &range);
	columns->range.writer->failed |= w.failed;       /* else want of memory would choose another way */
	eco_writer_free(&w);
	eco_bits_start(models, MODELS);
	for (uint32_t i = h.way == DIFFERENCES; i < c->rows; i++)
		eco_range_count_field(counted, MODELLED_STEPS, MODELLED_STEP, models, h.bits,
			(value_at(c, i, h.way == DIFFERENCES) - h.low) >> h.shift);
	for (uint32_t i = 0; i < MODELLED_STEPS; i++)
		sizes[i] = eco_range_counted(&counted[i]);
}

/* Keeps the way that takes fewer bytes. Coding leaves the values as they are, so all can be tried. */
struct choice { struct head best; size_t least; };

static void consider(struct choice *choice, const struct head *h, size_t size)
{
	if (size < choice->least)
		*choice = (struct choice){ *h, size };
}

static void try_way(struct choice *choice, const struct columns *columns, uint32_t index, struct head h)
{
	struct eco_writer w = { 0 };
	struct eco_range range;
	eco_range_write(&range, &w);
	code_component(&range, columns, index, &h);
	size_t zeros = eco_range_end(&range), size = w.size + zeros;
	columns->range.writer->failed |= w.failed;       /* else want of memory would choose another way */
	eco_writer_free(&w);
	consider(choice, &h, size);
}

/* Other components: those of one value a row. Of values of many bits, models would learn nothing. */
static void try_given(struct choice *choice, const struct columns *columns, uint32_t index, struct head h)
{
	h.way = GIVEN;
	h.modelled = (h.bits + MODELLED_STEP - 1) / MODELLED_STEP * MODELLED_STEP;
	for (h.given = 0; h.given < index && h.modelled <= MODELLED_MOST; h.given++)
		if (columns->items[h.given].extra)
			try_way(choice, columns, index, h);
}

static struct head smallest_head(const struct columns *columns, uint32_t index)
{
	const struct component *c = &columns->items[index];
	struct head values = head_of(c, false), differences = head_of(c, true), h;
	struct choice choice = { values, SIZE_MAX };
	size_t as_values[MODELLED_STEPS], as_differences[MODELLED_STEPS];
	field_sizes(columns, index, values, as_values);
	field_sizes(columns, index, differences, as_differences);
	for (uint32_t i = 0; i < MODELLED_STEPS; i++) {
		values.modelled = differences.modelled = MODELLED_STEP * i;
		if (values.modelled < values.bits + MODELLED_STEP)
			consider(&choice, &values, as_values[i]);
		if (differences.modelled < differences.bits + MODELLED_STEP)
			consider(&choice, &differences, as_differences[i]);
	}
	h = values;
	h.way = RECENT;
	h.modelled = choice.best.way == VALUES ? choice.best.modelled : 0;
	try_way(&choice, columns, index, h);
	try_given(&choice, columns, index, values);
	h = differences;
	h.way = STEPS;
	if (1ull << (h.bits + h.shift) <= STEP_MOST && h.low + STEP_MOST <= 2 * STEP_MOST)
		try_way(&choice, columns, index, h);
	return choice.best;
}

/* ---- Both ---- */

/* Components of the columns that are coded one by one: a kd-tree's positions are not. */
static void list_components(struct columns *columns, const struct eco_chunk_rows *rows)
{
	columns->count = 0;
	for (uint32_t i = rows->shape.order == ECO_DRACO_KD; i < rows->column_count; i++)
		for (uint32_t k = 0; k < rows->columns[i].components; k++)
			columns->items[columns->count++] = (struct component){
				.values = rows->columns[i].values + k, .rows = rows->shape.rows,
				.apart = rows->columns[i].components,
				.extra = rows->columns[i].components == 1 };
}

static bool code_columns(struct columns *columns, struct eco_chunk_rows *rows)
{
	bool good = true;
	if (rows->shape.order == ECO_DRACO_KD)
		eco_counts_code(&columns->range, rows);
	for (uint32_t i = 0; i < columns->count && good; i++) {
		struct head h = { .way = VALUES };
		if (columns->range.writer)
			h = smallest_head(columns, i);
		good = code_component(&columns->range, columns, i, &h);
	}
	return good;
}

enum eco_code eco_columns_encode(struct eco_chunk_rows *rows, uint8_t **bytes, size_t *size, uint8_t *zeros,
	struct eco_error *error)
{
	struct eco_writer w = { 0 };
	struct columns columns;
	list_components(&columns, rows);
	eco_range_write(&columns.range, &w);
	code_columns(&columns, rows);
	eco_range_raw(&columns.range, END_BITS, END_MARK);
	*zeros = (uint8_t)eco_range_end(&columns.range);
	if (w.failed) {
		eco_writer_free(&w);
		return eco_fail(error, ECO_NO_MEMORY, "out of memory for %u rows of a chunk",
			rows->shape.rows);
	}
	*bytes = w.bytes;
	*size = w.size;
	return ECO_OK;
}

enum eco_code eco_columns_decode(struct eco_chunk_rows *rows, const uint8_t *bytes, size_t size,
	uint8_t zeros, struct eco_error *error)
{
	struct columns columns;
	list_components(&columns, rows);
	eco_range_read(&columns.range, bytes, size);
	if (code_columns(&columns, rows) && eco_range_raw(&columns.range, END_BITS, 0) == END_MARK
			&& eco_range_end(&columns.range) == zeros)
		return ECO_OK;
	return eco_fail(error, ECO_DAMAGED, "chunk: its rows are cut short or hold impossible values");
}
