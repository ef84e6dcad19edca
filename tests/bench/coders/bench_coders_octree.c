/* First corners by occupied octants, level by level, as G-PCC codes geometry (ISO/IEC 23090-9): each of the
 * eight bits with a model for its place, how many are set already, and how many of the three cells that touch
 * it at this level are occupied. A point alone in its cell gives the rest of its bits as they are (direct
 * coding, there too). Points in one place: how many. */
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/range.h"
#include "tests/bench/coders/bench_coders_rows.h"

#define TOUCHING 4u
#define SET_MOST 4u

/* A cell with its place at this level; writing: the rows in it. */
struct cell { uint32_t at[CODERS_AXES], first, count; };

struct octree {
	struct eco_range *range;
	struct coders_table *table;
	uint32_t depth, level, done;         /* done: rows read */
	int32_t low[CODERS_AXES];
	struct cell *cells, *next;
	uint32_t cell_count, next_count;
	struct eco_bit alone[CODERS_DEPTH_MAX + 1][TOUCHING], octant[8][SET_MOST][TOUCHING], same[32];
};

static int32_t *row_of(const struct octree *o, uint32_t row)
{
	return o->table->values + (size_t)o->table->columns * row;
}

static uint32_t bit_of(const struct octree *o, uint32_t row, uint32_t axis, uint32_t bit)
{
	return ((uint32_t)row_of(o, row)[axis] - (uint32_t)o->low[axis]) >> bit & 1;
}

/* As rows are sorted along the curve: the axis whose highest differing bit is highest decides. */
static int compare_cells(const uint32_t a[CODERS_AXES], const uint32_t b[CODERS_AXES])
{
	uint32_t difference = 0, axis = 0;
	for (uint32_t i = 0; i < CODERS_AXES; i++) {
		uint32_t d = a[i] ^ b[i];
		if (difference < d && difference < (difference ^ d)) {
			difference = d;
			axis = i;
		}
	}
	return a[axis] < b[axis] ? -1 : a[axis] > b[axis];
}

static bool occupied(const struct octree *o, const uint32_t at[CODERS_AXES], uint32_t axis, bool up)
{
	uint32_t want[CODERS_AXES], first = 0, end = o->cell_count;
	memcpy(want, at, sizeof want);
	want[axis] += up ? 1 : UINT32_MAX;
	while (first < end) {
		uint32_t middle = (first + end) / 2;
		int order = compare_cells(o->cells[middle].at, want);
		if (order == 0)
			return true;
		if (order < 0)
			first = middle + 1;
		else
			end = middle;
	}
	return false;
}

/* Bit 2 axis + up: the cell beyond that side is occupied. */
static uint32_t sides_of(const struct octree *o, const struct cell *cell)
{
	uint32_t sides = 0;
	for (uint32_t side = 0; side < 2 * CODERS_AXES; side++)
		sides |= (uint32_t)occupied(o, cell->at, side / 2, side & 1) << side;
	return sides;
}

static void put_row(struct octree *o, const uint32_t at[CODERS_AXES])
{
	int32_t *row = row_of(o, o->done++);
	for (uint32_t a = 0; a < CODERS_AXES; a++)
		row[a] = (int32_t)(at[a] + (uint32_t)o->low[a]);
}

static void code_alone(struct octree *o, const struct cell *cell)
{
	uint32_t rest = o->depth - o->level, at[CODERS_AXES], mask = (1u << rest) - 1;
	for (uint32_t a = 0; a < CODERS_AXES; a++) {
		uint32_t v = o->range->writer ? (uint32_t)row_of(o, cell->first)[a] - (uint32_t)o->low[a] : 0;
		at[a] = cell->at[a] << rest | (uint32_t)eco_range_raw(o->range, rest, v & mask);
	}
	if (!o->range->writer && o->done < o->table->rows)
		put_row(o, at);
}

static void code_same(struct octree *o, const struct cell *cell)
{
	uint32_t more = (uint32_t)eco_range_number(o->range, o->same, (int32_t)cell->count - 2) + 2;
	for (uint32_t i = 0; i < more && !o->range->writer && o->done < o->table->rows; i++)
		put_row(o, cell->at);
}

static void count_octants(const struct octree *o, const struct cell *cell, uint32_t count[8])
{
	uint32_t bit = o->depth - o->level - 1;
	memset(count, 0, 8 * sizeof *count);
	for (uint32_t i = cell->first; i < cell->first + cell->count; i++)
		count[bit_of(o, i, 0, bit) << 2 | bit_of(o, i, 1, bit) << 1 | bit_of(o, i, 2, bit)]++;
}

static void code_octants(struct octree *o, const struct cell *cell, uint32_t sides)
{
	uint32_t count[8] = { 0 }, set = 0, first = cell->first;
	if (o->range->writer)
		count_octants(o, cell, count);
	for (uint32_t k = 0; k < 8; k++) {
		const uint32_t up[CODERS_AXES] = { k >> 2 & 1, k >> 1 & 1, k & 1 };
		uint32_t touching = 0;
		for (uint32_t a = 0; a < CODERS_AXES; a++)
			touching += sides >> (2 * a + up[a]) & 1;
		bool full = (k == 7 && set == 0) || eco_range_bit(o->range,
			&o->octant[k][set < SET_MOST ? set : SET_MOST - 1][touching], count[k] > 0);
		if (!full || o->next_count >= o->table->rows)
			continue;
		struct cell *child = &o->next[o->next_count++];
		*child = (struct cell){ .first = first, .count = count[k] };
		for (uint32_t a = 0; a < CODERS_AXES; a++)
			child->at[a] = cell->at[a] << 1 | up[a];
		first += count[k];
		set++;
	}
}

static void code_level(struct octree *o)
{
	o->next_count = 0;
	for (uint32_t i = 0; i < o->cell_count; i++) {
		const struct cell *cell = &o->cells[i];
		uint32_t sides = sides_of(o, cell), some = (uint32_t)__builtin_popcount(sides);
		struct eco_bit *alone = &o->alone[o->level][some < TOUCHING ? some : TOUCHING - 1];
		bool many = eco_range_bit(o->range, alone, cell->count > 1);
		if (!many)
			code_alone(o, cell);
		else if (o->level == o->depth)
			code_same(o, cell);
		else
			code_octants(o, cell, sides);
	}
	struct cell *swap = o->cells;
	o->cells = o->next;
	o->next = swap;
	o->cell_count = o->next_count;
}

static void code_box(struct octree *o)
{
	if (o->range->writer)
		o->depth = coders_table_box(o->table, o->low);
	o->depth = (uint32_t)eco_range_raw(o->range, 5, o->depth);
	o->depth = o->depth < CODERS_DEPTH_MAX ? o->depth : CODERS_DEPTH_MAX;
	for (uint32_t a = 0; a < CODERS_AXES; a++)
		o->low[a] = coders_code_plain(o->range, o->low[a]);
}

bool coders_code_octree(struct eco_range *range, struct coders_table *table)
{
	struct octree *o = calloc(1, sizeof *o);
	if (!o)
		return false;
	o->range = range;
	o->table = table;
	o->cells = malloc(table->rows * sizeof *o->cells);
	o->next = malloc(table->rows * sizeof *o->next);
	bool good = o->cells && o->next;
	eco_bits_start(&o->alone[0][0], sizeof o->alone / sizeof **o->alone);
	eco_bits_start(&o->octant[0][0][0], sizeof o->octant / sizeof ***o->octant);
	eco_bits_start(o->same, sizeof o->same / sizeof *o->same);
	if (good) {
		code_box(o);
		o->cells[0] = (struct cell){ .count = table->rows };
		o->cell_count = 1;
		for (o->level = 0; o->level <= o->depth && o->cell_count; o->level++)
			code_level(o);
		good = range->writer || coders_table_sort(table);
	}
	free(o->cells);
	free(o->next);
	free(o);
	return good;
}
