/* First corners by counts in the halves of a kd-tree (Devillers and Gandoin 2000, "Geometric compression for
 * interactive transmission"): a cell is halved along its longest side, and of its n points so many lie in the
 * lower half. Where points lie at random that number is binomial, so models of small n begin there and learn
 * how points cluster: a chunk of a dozen points has no time to learn. The order of rows costs nothing. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/range.h"
#include "tests/bench/coders/bench_coders_rows.h"

#define MODELLED_MOST 16u        /* points of a cell whose counts are modelled one by one */
#define BELIEVED 6u              /* numbers that this start is worth */
#define UNIFORM 0.3              /* of the start: points that cluster */
#define TOP_BITS 3u

struct counts {
	struct eco_range *range;
	struct coders_table *table;
	int32_t low[CODERS_AXES];
	struct eco_bit few[MODELLED_MOST + 1][CODERS_AXES][32], many[32][1 << TOP_BITS];
};
struct box { uint32_t at[CODERS_AXES], bits[CODERS_AXES]; };

/* Models of a tree whose leaves are the numbers 0 to n. */
static void start_few(struct eco_bit models[32], uint32_t n)
{
	double p[64] = { 0 }, ways = 1;
	for (uint32_t k = 0; k <= n; k++) {
		p[32 + k] = UNIFORM / (n + 1) + (1 - UNIFORM) * ldexp(ways, -(int)n);
		ways = ways * (n - k) / (k + 1);
	}
	for (uint32_t node = 31; node > 0; node--) {
		p[node] = p[2 * node] + p[2 * node + 1];
		double zero = p[node] > 0 ? p[2 * node] / p[node] : 0.5;
		zero = fmin(fmax(zero, 0.001), 0.999);
		models[node] = (struct eco_bit){ (uint16_t)(65536 * zero), BELIEVED };
	}
}

static int32_t *row_of(const struct counts *c, uint32_t row)
{
	return c->table->values + (size_t)c->table->columns * row;
}

static uint32_t place_of(const struct counts *c, uint32_t row, uint32_t axis)
{
	return (uint32_t)row_of(c, row)[axis] - (uint32_t)c->low[axis];
}

/* Writing: puts rows of the lower half first and returns how many there are. */
static uint32_t divide(struct counts *c, uint32_t first, uint32_t end, uint32_t axis, uint32_t bit)
{
	uint32_t low = first;
	for (uint32_t i = first; i < end; i++) {
		if (place_of(c, i, axis) >> bit & 1)
			continue;
		for (uint32_t k = 0; k < c->table->columns && i != low; k++) {
			int32_t v = row_of(c, i)[k];
			row_of(c, i)[k] = row_of(c, low)[k];
			row_of(c, low)[k] = v;
		}
		low++;
	}
	return low - first;
}

static uint32_t code_count(struct counts *c, uint32_t n, uint32_t axis, uint32_t lower)
{
	if (n <= MODELLED_MOST)
		lower = eco_range_tree(c->range, c->few[n][axis], 5, lower) & 31;
	else {
		uint32_t bits = 32u - (uint32_t)__builtin_clz(n);
		uint64_t part = ((uint64_t)lower << bits) / (n + 1);
		part = eco_range_field(c->range, c->many[bits], TOP_BITS, bits, (uint32_t)part);
		/* the least number of this part: parts are no wider than one */
		lower = (uint32_t)((part * (n + 1) + (1u << bits) - 1) >> bits);
	}
	return lower < n ? lower : n;
}

static void code_alone(struct counts *c, uint32_t row, const struct box *box)
{
	for (uint32_t a = 0; a < CODERS_AXES; a++) {
		uint32_t v = c->range->writer ? place_of(c, row, a) & ((1u << box->bits[a]) - 1) : 0;
		v = (uint32_t)eco_range_raw(c->range, box->bits[a], v) | box->at[a] << box->bits[a];
		row_of(c, row)[a] = (int32_t)(v + (uint32_t)c->low[a]);
	}
}

static void code_cell(struct counts *c, uint32_t first, uint32_t end, struct box box)
{
	uint32_t axis = 0;
	for (uint32_t a = 1; a < CODERS_AXES; a++)
		axis = box.bits[a] > box.bits[axis] ? a : axis;
	if (end - first == 1 || !box.bits[axis]) {
		for (uint32_t i = first; i < end; i++)
			code_alone(c, i, &box);
		return;
	}
	uint32_t bit = --box.bits[axis], lower = c->range->writer ? divide(c, first, end, axis, bit) : 0;
	lower = code_count(c, end - first, axis, lower);
	box.at[axis] <<= 1;
	if (lower)
		code_cell(c, first, first + lower, box);
	box.at[axis] |= 1;
	if (first + lower < end)
		code_cell(c, first + lower, end, box);
}

bool coders_code_counts(struct eco_range *range, struct coders_table *table)
{
	struct counts *c = calloc(1, sizeof *c);
	if (!c)
		return false;
	struct box box = { .bits = { 0 } };
	c->range = range;
	c->table = table;
	for (uint32_t n = 0; n <= MODELLED_MOST; n++)
		for (uint32_t a = 0; a < CODERS_AXES; a++)
			start_few(c->few[n][a], n);
	eco_bits_start(&c->many[0][0], sizeof c->many / sizeof **c->many);
	if (range->writer)
		coders_table_box(table, c->low);
	for (uint32_t a = 0; a < CODERS_AXES; a++) {
		uint32_t all = 0;
		for (uint32_t i = 0; i < table->rows && range->writer; i++)
			all |= place_of(c, i, a);
		box.bits[a] = (uint32_t)eco_range_raw(range, 5, all ? 32u - (uint32_t)__builtin_clz(all) : 0);
		c->low[a] = coders_code_plain(range, c->low[a]);
	}
	code_cell(c, 0, table->rows, box);
	free(c);
	return true;
}
