/* A column of rows in an adaptive range coder, in the way that takes fewest bits of a sample. */
#include <math.h>
#include <string.h>

#include "ecofiles/base/range.h"
#include "tests/bench/coders/bench_coders_rows.h"

#define SAMPLE 1024u             /* rows that choose the way */
#define NEAR 6u                  /* columns that are looked at, on both sides */
#define MODELLED_MOST 8u
#define RECENT_MOST 64u
#define SLOTS 16u
#define SIZES 32u

enum how {
	PLAIN,                       /* less the least, the highest bits modelled */
	SIGNED,                      /* its size in bits, its sign, its bits */
	STEP,                        /* the difference to the row before, as SIGNED */
	RECENT,                      /* how many other values came since it came last */
	LAST_GIVEN,                  /* as where another column was the same last; or else as PLAIN */
	TREE_GIVEN,                  /* as PLAIN, with models for each value of another column */
	SIZE_GIVEN,                  /* as SIGNED, with models for each size of another column */
	HOWS
};
struct mode { uint32_t how, given, modelled, bits; int32_t low; };

struct column {
	struct eco_range *range;
	struct mode mode;
	const int32_t *given;        /* of the row at hand */
	int32_t before;
	int32_t recent[RECENT_MOST], key[RECENT_MOST];
	uint32_t recent_count;
	struct eco_bit hit, models[SLOTS << MODELLED_MOST], rank[SIZES], size[SIZES * SIZES];
};

static uint32_t bit_length(uint32_t v)
{
	return v ? 32u - (uint32_t)__builtin_clz(v) : 0;
}

static uint32_t size_of(int32_t v)
{
	return bit_length(v < 0 ? 0u - (uint32_t)v : (uint32_t)v);
}

static int32_t code_field(struct column *c, uint32_t slot, int32_t value)
{
	uint32_t field = eco_range_field(c->range, c->models + (slot << MODELLED_MOST), c->mode.modelled,
		c->mode.bits, (uint32_t)value - (uint32_t)c->mode.low);
	return (int32_t)(field + (uint32_t)c->mode.low);
}

static uint32_t code_rank(struct column *c, uint32_t rank)
{
	uint32_t bits = eco_range_tree(c->range, c->rank, 4, bit_length(rank)) & 15;
	if (bits < 2)
		return bits;
	rank &= (1u << (bits - 1)) - 1;
	return 1u << (bits - 1) | (uint32_t)eco_range_raw(c->range, bits - 1, rank);
}

static int32_t code_recent(struct column *c, int32_t value)
{
	uint32_t rank = 0;
	while (rank < c->recent_count && c->recent[rank] != value)
		rank++;
	rank = code_rank(c, rank);
	if (rank < c->recent_count)
		value = c->recent[rank];
	else {
		value = code_field(c, 0, value);
		c->recent_count += c->recent_count < RECENT_MOST;
		rank = c->recent_count - 1;
	}
	memmove(c->recent + 1, c->recent, rank * sizeof *c->recent);
	return c->recent[0] = value;
}

/* The slot of the given value, made where there is none: the last is shared. */
static uint32_t slot_of(struct column *c, uint32_t most)
{
	uint32_t slot = 0;
	while (slot < c->recent_count && c->key[slot] != *c->given)
		slot++;
	if (slot == c->recent_count && slot < most)
		c->key[c->recent_count++] = *c->given;
	return slot < most ? slot : most - 1;
}

static int32_t code_last(struct column *c, int32_t value)
{
	uint32_t known = c->recent_count, slot = slot_of(c, RECENT_MOST);
	if (slot < known && !eco_range_bit(c->range, &c->hit, value != c->recent[slot]))
		return c->recent[slot];
	return c->recent[slot] = code_field(c, 0, value);
}

static int32_t code_value(struct column *c, int32_t value)
{
	switch (c->mode.how) {
	case SIGNED:
		return eco_range_number(c->range, c->size, value);
	case STEP:
		return (int32_t)((uint32_t)c->before + (uint32_t)eco_range_number(c->range, c->size,
			(int32_t)((uint32_t)value - (uint32_t)c->before)));
	case RECENT:
		return code_recent(c, value);
	case LAST_GIVEN:
		return code_last(c, value);
	case TREE_GIVEN:
		return code_field(c, slot_of(c, SLOTS), value);
	case SIZE_GIVEN:
		return eco_range_number(c->range, c->size + SIZES * (size_of(*c->given) % SIZES), value);
	default:
		return code_field(c, 0, value);
	}
}

int32_t coders_code_plain(struct eco_range *r, int32_t value)
{
	uint32_t zigzag = (uint32_t)value << 1 ^ (0u - ((uint32_t)value >> 31)), bits = bit_length(zigzag);
	bits = (uint32_t)eco_range_raw(r, 5, bits);
	zigzag = (uint32_t)eco_range_raw(r, bits, zigzag);
	return (int32_t)(zigzag >> 1 ^ (0u - (zigzag & 1)));
}

static void code_head(struct eco_range *r, struct mode *m)
{
	m->how = (uint32_t)eco_range_raw(r, 3, m->how);
	if (m->how >= LAST_GIVEN)
		m->given = (uint32_t)eco_range_raw(r, 6, m->given);
	if (m->how == SIGNED || m->how == STEP || m->how == SIZE_GIVEN)
		return;
	m->modelled = 2 * (uint32_t)eco_range_raw(r, 3, m->modelled / 2);
	m->bits = (uint32_t)eco_range_raw(r, 5, m->bits);
	m->low = coders_code_plain(r, m->low);
}

static void code_rows(struct eco_range *r, struct coders_table *t, uint32_t column, struct mode mode,
	uint32_t rows)
{
	struct column c;
	code_head(r, &mode);
	c.range = r;
	c.mode = mode;
	c.before = 0;
	c.recent_count = 0;
	eco_bits_start(&c.hit, 1);
	eco_bits_start(c.rank, SIZES);
	eco_bits_start(c.size, mode.how == SIZE_GIVEN ? SIZES * SIZES : SIZES);
	eco_bits_start(c.models, (mode.how == TREE_GIVEN ? SLOTS : 1) << MODELLED_MOST);
	for (uint32_t i = 0; i < rows; i++) {
		int32_t *row = t->values + (size_t)t->columns * i;
		c.given = row + mode.given % t->columns;
		c.before = row[column] = code_value(&c, row[column]);
	}
}

/* ---- The best way ---- */

static double bits_of(struct coders_table *t, uint32_t column, struct mode mode)
{
	struct eco_writer w = { 0 };
	struct eco_range r;
	eco_range_write(&r, &w);
	code_rows(&r, t, column, mode, t->rows < SAMPLE ? t->rows : SAMPLE);
	double bits = 8.0 * (double)(w.size + r.held) - log2(r.range);
	eco_writer_free(&w);
	return bits;
}

static void span_of(const struct coders_table *t, uint32_t column, struct mode *mode)
{
	int32_t low = t->values[column], high = low;
	for (uint32_t i = 0; i < t->rows; i++) {
		int32_t v = t->values[(size_t)t->columns * i + column];
		low = v < low ? v : low;
		high = v > high ? v : high;
	}
	mode->bits = bit_length((uint32_t)high - (uint32_t)low);
	mode->low = low >= 0 && (uint32_t)high >> mode->bits == 0 ? 0 : low;
}

static void try_mode(struct coders_table *t, uint32_t column, struct mode mode, struct mode *best,
	double *least)
{
	double bits = bits_of(t, column, mode);
	if (bits >= *least)
		return;
	*least = bits;
	*best = mode;
}

/* Ways that look at other columns have as many modelled bits as PLAIN has at its best. */
static struct mode best_mode(struct coders_table *t, uint32_t column, uint64_t coded)
{
	struct mode plain = { .how = PLAIN }, best, m;
	double least = INFINITY;
	span_of(t, column, &plain);
	best = m = plain;
	for (m.modelled = 0; m.modelled <= MODELLED_MOST && m.modelled < plain.bits + 2; m.modelled += 2)
		try_mode(t, column, m, &best, &least);
	m = best;
	for (m.how = SIGNED; m.how <= RECENT; m.how++)
		try_mode(t, column, m, &best, &least);
	for (m.given = 0; m.given < t->columns; m.given++) {
		bool near = m.given < column ? column - m.given <= NEAR : m.given - column <= NEAR;
		if (!(coded >> m.given & 1) || (!near && m.given < t->columns - t->known))
			continue;
		m.how = LAST_GIVEN;
		try_mode(t, column, m, &best, &least);
		m.how = SIZE_GIVEN;
		try_mode(t, column, m, &best, &least);
		m.how = TREE_GIVEN;
		struct mode tree = m;
		tree.modelled = (plain.bits + 1) / 2 * 2;
		if (plain.bits <= MODELLED_MOST)
			try_mode(t, column, tree, &best, &least);
	}
	return best;
}

void coders_code_column(struct eco_range *range, struct coders_table *table, uint32_t column, uint64_t coded)
{
	struct mode mode = { .how = PLAIN };
	if (range->writer)
		mode = best_mode(table, column, coded);
	code_rows(range, table, column, mode, table->rows);
}
