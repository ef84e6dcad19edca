#include "ecofiles/format/chunk/chunk_columns.h"


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
	uint32_t low[AXES];
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

static void start(struct counts *c)
{
	for (uint32_t n = 2; n <= FEW && n <= c->rows->shape.rows; n++)
		for (uint32_t a = 0; a < AXES; a++)
			start_few(c->few[n][a], n);
	eco_bits_start(&c->many[0][0], sizeof c->many / sizeof **c->many);
}

static int32_t *place(const struct counts *c, uint32_t row)
{
	return c->rows->columns[0].values + AXES * (size_t)row;
}

static uint32_t coordinate(const struct counts *c, uint32_t row, uint32_t axis)
{
	return (uint32_t)place(c, row)[axis] - c->low[axis];
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
		lower = eco_range_tree(c->range, c->few[n][axis], FEW_BITS, lower) & ((1u << FEW_BITS) - 1);
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
	for (uint32_t a = 0; a < AXES; a++) {
		uint32_t v = c->range->writer ? coordinate(c, row, a) & ((1u << cell->bits[a]) - 1) : 0;
		v = (uint32_t)eco_range_raw(c->range, cell->bits[a], v) | cell->at[a] << cell->bits[a];
		place(c, row)[a] = (int32_t)(v + c->low[a]);
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
	struct cell root = { .end = c->rows->shape.rows };
	for (uint32_t a = 0; a < AXES; a++) {
		bool writes = c->range->writer;
		int32_t low = writes ? place(c, 0)[a] : 0, high = low;
		for (uint32_t i = 0; writes && i < root.end; i++) {
			low = place(c, i)[a] < low ? place(c, i)[a] : low;
			high = place(c, i)[a] > high ? place(c, i)[a] : high;
		}
		uint32_t span = (uint32_t)high - (uint32_t)low;
		root.bits[a] = (uint32_t)eco_range_raw(c->range, 5, span ? 32u - (uint32_t)__builtin_clz(span)
			: 0);
		c->low[a] = eco_columns_number(c->range, (uint32_t)low);
	}
	return root;
}

void eco_counts_code(struct eco_range *range, struct eco_chunk_rows *rows)
{
	struct counts c = { .range = range, .rows = rows, .cell_count = 1 };
	start(&c);
	c.cells[0] = code_root(&c);
	while (c.cell_count > 0) {
		struct cell cell = c.cells[--c.cell_count];
		uint32_t axis = 0;
		for (uint32_t a = 1; a < AXES; a++)
			axis = cell.bits[a] > cell.bits[axis] ? a : axis;
		if (cell.end - cell.first > 1 && cell.bits[axis])
			halve(&c, cell, axis);
		else
			for (uint32_t i = cell.first; i < cell.end; i++)
				code_point(&c, i, &cell);
	}
}
