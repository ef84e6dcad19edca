#include "ecofiles/format/chunk/chunk_columns.h"

#include <math.h>
#include <string.h>

#include "ecofiles/base/memory.h"
#include "ecofiles/base/order.h"
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

static uint32_t code_signed(struct eco_range *r, uint32_t value)
{
	uint32_t code = eco_zigzag(value), bits = (uint32_t)eco_range_raw(r, 6, eco_bit_length(code));
	return eco_unzigzag((uint32_t)eco_range_raw(r, bits < BITS_MAX ? bits : BITS_MAX, code));
}

/* Reads component `index`. False: impossible. */
static bool code_head(struct eco_range *r, uint32_t index, struct head *h)
{
	h->way = (uint32_t)eco_range_raw(r, WAY_BITS, h->way);
	if (h->way == DIFFERENCES || h->way == STEPS)
		h->first = code_signed(r, h->first);
	if (h->way == STEPS)
		return true;
	if (h->way == GIVEN)
		h->given = (uint32_t)eco_range_raw(r, GIVEN_BITS, h->given);
	h->modelled = (uint32_t)eco_range_raw(r, 3, h->modelled / MODELLED_STEP) * MODELLED_STEP;
	h->bits = (uint32_t)eco_range_raw(r, 6, h->bits);
	if (eco_range_raw(r, 1, h->shift != 0))
		h->shift = (uint32_t)eco_range_raw(r, SHIFT_BITS, h->shift);
	if (eco_range_raw(r, 1, h->low != 0))
		h->low = code_signed(r, h->low);
	return h->way < WAYS && h->bits + h->shift <= BITS_MAX && h->modelled <= MODELLED_MOST
		&& (h->way != GIVEN || h->given < index);
}

static uint32_t code_field(struct eco_range *r, struct learnt *l, const struct head *h, uint32_t slot,
	uint32_t value)
{
	return h->low + (eco_range_field(r, l->models + slot * MODELS, h->modelled, h->bits,
		(value - h->low) >> h->shift) << h->shift);
}

/* How many other values came since this one came last; as many as there are: it is new. */
static uint32_t code_recent(struct eco_range *r, struct learnt *l, const struct head *h, uint32_t value)
{
	uint32_t rank = 0;
	while (r->writer && rank < l->recent_count && (uint32_t)l->recent[rank] != value)
		rank++;
	rank = (uint32_t)eco_range_size(r, l->ranks, RANK_BITS, rank);
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

/* Counting ends where bytes would be `most` or more. */
static bool code_component(struct eco_range *r, const struct columns *columns, uint32_t index, struct head *h,
	size_t most)
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
	for (uint32_t i = steps; i < c->rows && (!r->writer || r->size < most); i++) {
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
	h.bits = eco_bit_length(span);
	h.low = low >= 0 && (uint64_t)high < (uint64_t)1 << h.bits ? 0 : (uint32_t)low;
	take_shift(c, difference, &h);
	return h;
}

/* The way that takes fewest bytes so far. Coding leaves the values as they are, so all can be tried. */
struct choice { struct head best; size_t least; };

static void take_smaller(struct choice *choice, struct head h, struct eco_range *range)
{
	eco_range_end(range);
	if (range->size < choice->least)
		*choice = (struct choice){ h, range->size };
}

static void try_way(struct choice *choice, const struct columns *columns, uint32_t index, struct head h)
{
	struct eco_range range;
	eco_range_count(&range);
	code_component(&range, columns, index, &h, choice->least);
	take_smaller(choice, h, &range);
}

/* Counts a field for all numbers of modelled bits at once: their models learn the same. */
static void count_fields(struct eco_range ranges[MODELLED_STEPS], const struct columns *columns, uint32_t index,
	struct head h)
{
	const struct component *c = &columns->items[index];
	struct eco_bit models[MODELS];
	bool difference = h.way == DIFFERENCES;
	for (uint32_t i = 0; i < MODELLED_STEPS; i++) {
		h.modelled = i * MODELLED_STEP;
		eco_range_count(&ranges[i]);
		code_head(&ranges[i], index, &h);
	}
	eco_bits_start(models, MODELS);
	for (uint32_t i = difference; i < c->rows; i++)
		eco_range_fields(ranges, MODELLED_STEPS, MODELLED_STEP, models, h.bits,
			(value_at(c, i, difference) - h.low) >> h.shift);
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
	struct eco_range of_values[MODELLED_STEPS], of_differences[MODELLED_STEPS];
	count_fields(of_values, columns, index, values);
	count_fields(of_differences, columns, index, differences);
	for (uint32_t i = 0; i < MODELLED_STEPS; i++) {
		values.modelled = differences.modelled = i * MODELLED_STEP;
		if (values.modelled < values.bits + MODELLED_STEP)
			take_smaller(&choice, values, &of_values[i]);
		if (differences.modelled < differences.bits + MODELLED_STEP)
			take_smaller(&choice, differences, &of_differences[i]);
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

/* ---- Positions by counts ---- */

#define AXES 3u
#define FEW 16u                  /* points of a cell whose counts have models for each number */
#define FEW_BITS 5u
#define SEEN 6u                  /* numbers that the start of a model is worth */
#define LEAST 64u                /* probability that it begins with, in 65536ths */
#define TOP_BITS 3u
#define CELLS_MAX 128u           /* waiting: at most one for each bit of the coordinates */

struct cell { uint32_t first, end, at[AXES], bits[AXES]; };

struct counts {
	struct eco_range *range;
	struct eco_chunk_rows *rows;
	uint32_t axes, low[AXES], shift[AXES];
	struct eco_bit few[FEW + 1][AXES][1u << FEW_BITS], many[32][1u << TOP_BITS];
	struct cell cells[CELLS_MAX];
	uint32_t cell_count;
};

/* Models of a tree whose leaves are the numbers 0 to n: any, 3 in 10, or binomial, 7 in 10. */
static void start_few(struct eco_bit models[1u << FEW_BITS], uint32_t n)
{
	uint32_t share[2u << FEW_BITS] = { 0 }, ways = 1;
	for (uint32_t k = 0; k <= n; k++) {
		share[(1u << FEW_BITS) + k] = 3 * (1u << n) + 7 * (n + 1) * ways;
		ways = ways * (n - k) / (k + 1);
	}
	for (uint32_t node = (1u << FEW_BITS) - 1; node > 0; node--) {
		share[node] = share[2 * node] + share[2 * node + 1];
		uint64_t zero = share[node] ? ((uint64_t)share[2 * node] << 16) / share[node] : 1u << 15;
		zero = zero < LEAST ? LEAST : zero > (1u << 16) - LEAST ? (1u << 16) - LEAST : zero;
		models[node] = (struct eco_bit){ (uint16_t)zero, SEEN };
	}
}

static void start_counts(struct counts *c)
{
	for (uint32_t n = 2; n <= FEW && n <= c->rows->stream.elements; n++)
		for (uint32_t a = 0; a < c->axes; a++)
			start_few(c->few[n][a], n);
	eco_bits_start(&c->many[0][0], sizeof c->many / sizeof **c->many);
}

static int32_t *place(const struct counts *c, uint32_t row)
{
	return c->rows->columns[0].values + AXES * (size_t)row;
}

static uint32_t coordinate(const struct counts *c, uint32_t row, uint32_t axis)
{
	return ((uint32_t)place(c, row)[axis] - c->low[axis]) >> c->shift[axis];
}

static void swap_rows(struct eco_chunk_rows *rows, uint32_t a, uint32_t b)
{
	for (uint32_t i = 0; i < rows->column_count; i++) {
		uint32_t components = rows->columns[i].components;
		int32_t *x = rows->columns[i].values + (size_t)components * a,
			*y = rows->columns[i].values + (size_t)components * b;
		for (uint32_t k = 0; k < components; k++) {
			int32_t v = x[k];
			x[k] = y[k];
			y[k] = v;
		}
	}
}

/* Writing: rows of the lower half first; returns how many there are. */
static uint32_t divide(struct counts *c, const struct cell *cell, uint32_t axis, uint32_t bit)
{
	uint32_t lower = cell->first;
	for (uint32_t i = cell->first; i < cell->end; i++)
		if (!(coordinate(c, i, axis) >> bit & 1))
			swap_rows(c->rows, i, lower++);
	return lower - cell->first;
}

static uint32_t code_count(struct counts *c, uint32_t n, uint32_t axis, uint32_t lower)
{
	if (n <= FEW)
		lower = eco_range_tree(c->range, c->few[n][axis], FEW_BITS, lower);
	else {
		uint32_t bits = 32u - (uint32_t)__builtin_clz(n);
		uint64_t part = ((uint64_t)lower << bits) / (n + 1);
		part = eco_range_field(c->range, c->many[bits], TOP_BITS, bits, (uint32_t)part);
		/* parts are no wider than 1, so each has at most one number */
		lower = (uint32_t)((part * (n + 1) + (1u << bits) - 1) >> bits);
	}
	return lower < n ? lower : n;
}

static void code_point(struct counts *c, uint32_t row, const struct cell *cell)
{
	for (uint32_t a = 0; a < c->axes; a++) {
		uint32_t v = c->range->writer ? coordinate(c, row, a) & ((1u << cell->bits[a]) - 1) : 0;
		v = (uint32_t)eco_range_raw(c->range, cell->bits[a], v) | cell->at[a] << cell->bits[a];
		place(c, row)[a] = (int32_t)((v << c->shift[a]) + c->low[a]);
	}
}

/* Codes the count of a cell and leaves its halves, the lower on top. */
static void halve(struct counts *c, struct cell cell, uint32_t axis)
{
	uint32_t n = cell.end - cell.first, bit = --cell.bits[axis],
		lower = c->range->writer ? divide(c, &cell, axis, bit) : 0;
	lower = code_count(c, n, axis, lower);
	cell.at[axis] = cell.at[axis] << 1 | 1;
	struct cell half = cell;
	half.first += lower;
	if (lower < n)
		c->cells[c->cell_count++] = half;
	cell.at[axis]--;
	cell.end = half.first;
	if (lower)
		c->cells[c->cell_count++] = cell;
}

static struct cell code_root(struct counts *c)
{
	struct cell root = { .end = c->rows->stream.elements };
	for (uint32_t a = 0; a < c->axes; a++) {
		bool writes = c->range->writer;
		int32_t low = writes ? place(c, 0)[a] : 0, high = low;
		uint32_t any = 0;
		for (uint32_t i = 0; writes && i < root.end; i++) {
			low = place(c, i)[a] < low ? place(c, i)[a] : low;
			high = place(c, i)[a] > high ? place(c, i)[a] : high;
		}
		for (uint32_t i = 0; writes && c->rows->placed && i < root.end; i++)
			any |= (uint32_t)place(c, i)[a] - (uint32_t)low;
		uint32_t span = (uint32_t)high - (uint32_t)low, zeros = any ? (uint32_t)__builtin_ctz(any) : 0;
		if (c->rows->placed)
			zeros = (uint32_t)eco_range_raw(c->range, 5, zeros);
		root.bits[a] = (uint32_t)eco_range_raw(c->range, 5, eco_bit_length(span >> zeros));
		c->shift[a] = zeros;
		c->low[a] = code_signed(c->range, (uint32_t)low);
	}
	return root;
}

static void code_cells(struct counts *c, struct cell root)
{
	c->cells[0] = root;
	c->cell_count = 1;
	while (c->cell_count > 0) {
		struct cell cell = c->cells[--c->cell_count];
		uint32_t axis = 0;
		for (uint32_t a = 1; a < c->axes; a++)
			axis = cell.bits[a] > cell.bits[axis] ? a : axis;
		if (cell.end - cell.first > 1 && cell.bits[axis])
			halve(c, cell, axis);
		else
			for (uint32_t i = cell.first; i < cell.end; i++)
				code_point(c, i, &cell);
	}
}

/* Writes or reads column 0, of 3 components. Writing puts all rows into the order in which they are read. */
static void code_counts(struct eco_range *range, struct eco_chunk_rows *rows)
{
	struct counts c = { .range = range, .rows = rows, .axes = AXES };
	start_counts(&c);
	code_cells(&c, code_root(&c));
}

/* ---- Places of plants ---- */

#define NEAR_ROWS 128u           /* rows before a row, by which its height is guessed */
#define RUN_BITS 5u
#define TURNS(rows) ((rows)->column_count - 2)   /* the last columns are turns and scales */

/* Whether row may follow the row before it in the order of cells. */
static bool follows(const struct counts *c, uint32_t row)
{
	return eco_order_cells((uint32_t[]){ coordinate(c, row - 1, 0), coordinate(c, row - 1, 1) },
		(uint32_t[]){ coordinate(c, row, 0), coordinate(c, row, 1) }, 2) <= 0;
}

/* The height of the plane through the rows before: weights are 1 / (1 + the square of a row's distance). */
static int32_t guess_height(const struct counts *c, uint32_t row)
{
	double w = 0, x = 0, y = 0, z = 0, xx = 0, xy = 0, yy = 0, xz = 0, yz = 0;
	const int32_t *to = place(c, row), *base = place(c, row - 1);
	for (uint32_t i = row > NEAR_ROWS ? row - NEAR_ROWS : 0; i < row; i++) {
		const int32_t *at = place(c, i);
		double dx = (double)at[0] - to[0], dy = (double)at[1] - to[1], dz = (double)at[2] - base[2],
			share = 1 / (1 + dx * dx + dy * dy);
		w += share;
		x += share * dx;
		y += share * dy;
		z += share * dz;
		xx += share * dx * dx;
		xy += share * dx * dy;
		yy += share * dy * dy;
		xz += share * dx * dz;
		yz += share * dy * dz;
	}
	xx -= x * x / w;
	xy -= x * y / w;
	yy -= y * y / w;
	xz -= x * z / w;
	yz -= y * z / w;
	double ridge = 1.0 / 128 * (xx + yy) + 1e-9, most = 1u << 30;
	xx += ridge;
	yy += ridge;
	double slopes = (x * (xz * yy - yz * xy) + y * (yz * xx - xz * xy)) / (xx * yy - xy * xy);
	double guess = base[2] + floor((z - slopes) / w + 0.5);
	return guess > -most && guess < most ? (int32_t)guess : base[2];
}

static void code_heights(struct counts *c)
{
	struct eco_near near;
	struct eco_scale kind;
	eco_near_start(&near, &kind, 1);
	place(c, 0)[2] = (int32_t)code_signed(c->range, (uint32_t)place(c, 0)[2]);
	for (uint32_t row = 1; row < c->rows->stream.elements; row++) {
		uint32_t guess = (uint32_t)guess_height(c, row);
		int32_t *at = &place(c, row)[2];
		int32_t miss = eco_range_near(c->range, &near, &kind, (int32_t)((uint32_t)*at - guess));
		*at = (int32_t)(guess + (uint32_t)miss);
	}
}

/* Whether turns are those that follow from the places; then they are not coded. */
static bool code_turns(struct counts *c, struct eco_column *turns)
{
	bool given = false;
	for (uint32_t row = 0; c->range->writer && row < c->rows->stream.elements && !given; row++)
		given = turns->values[row] != eco_place_turn(place(c, row));
	given = eco_range_raw(c->range, 1, given);
	for (uint32_t row = 0; row < c->rows->stream.elements && !given; row++)
		turns->values[row] = eco_place_turn(place(c, row));
	return given;
}

/* The same of rows whose order stays: runs of them that are in the order of cells. */
static bool code_places(struct eco_range *range, struct eco_chunk_rows *rows, bool *turned)
{
	struct counts c = { .range = range, .rows = rows, .axes = 2 };
	struct eco_bit runs[1u << RUN_BITS];
	eco_bits_start(runs, 1u << RUN_BITS);
	start_counts(&c);
	struct cell root = code_root(&c);
	for (const uint32_t end = root.end; root.first < end; root.first = root.end) {
		uint32_t run = 1;
		while (range->writer && root.first + run < end && follows(&c, root.first + run))
			run++;
		run = (uint32_t)eco_range_size(range, runs, RUN_BITS, run - 1) + 1;
		if (run - 1 >= end - root.first)
			return false;
		root.end = root.first + run;
		code_cells(&c, root);
	}
	code_heights(&c);
	*turned = code_turns(&c, &rows->columns[TURNS(rows)]);
	return true;
}

/* ---- Both ---- */

/* Components of the columns that are coded one by one: not of positions by counts, nor of turns that are not
 * given. */
static void list_components(struct columns *columns, const struct eco_chunk_rows *rows, bool turned)
{
	columns->count = 0;
	for (uint32_t i = rows->cloud || rows->placed; i < rows->column_count; i++)
		for (uint32_t k = 0; k < rows->columns[i].components && (turned || i != TURNS(rows)); k++)
			columns->items[columns->count++] = (struct component){
				.values = rows->columns[i].values + k, .rows = rows->stream.elements,
				.apart = rows->columns[i].components,
				.extra = rows->columns[i].components == 1 };
}

static bool code_columns(struct columns *columns, struct eco_chunk_rows *rows)
{
	bool turned = true, good = !rows->placed || code_places(&columns->range, rows, &turned);
	if (rows->cloud)
		code_counts(&columns->range, rows);
	list_components(columns, rows, turned);
	for (uint32_t i = 0; i < columns->count && good; i++) {
		struct head h = { .way = VALUES };
		if (columns->range.writer)
			h = smallest_head(columns, i);
		good = code_component(&columns->range, columns, i, &h, SIZE_MAX);
	}
	return good;
}

void eco_columns_encode(struct eco_chunk_rows *rows, struct eco_stream *stream)
{
	struct eco_writer w = { 0 };
	struct columns columns;
	eco_range_write(&columns.range, &w);
	code_columns(&columns, rows);
	eco_range_raw(&columns.range, END_BITS, END_MARK);
	stream->zeros = (uint8_t)eco_range_end(&columns.range);
	if (w.failed)
		eco_end("no memory");
	stream->bytes = w.bytes;
	stream->size = w.size;
}

enum eco_code eco_columns_decode(struct eco_chunk_rows *rows, struct eco_error *error)
{
	struct columns columns;
	eco_range_read(&columns.range, rows->stream.bytes, rows->stream.size);
	if (code_columns(&columns, rows) && eco_range_raw(&columns.range, END_BITS, 0) == END_MARK
			&& eco_range_end(&columns.range) == rows->stream.zeros)
		return ECO_OK;
	return eco_fail(error, ECO_DAMAGED, "chunk: its rows are cut short or hold impossible values");
}
