/* The same functions write and read. Whatever the bytes say, sums stay within 64 bits: heights are 32 bits,
 * weights 24. */
#include "ecofiles/format/chunk/chunk_columns.h"

#include <assert.h>
#include <stdlib.h>

#include "ecofiles/base/memory.h"
#include "ecofiles/base/range.h"

#define GUESSES 6
#define KINDS 24u                /* sizes of misses, two an octave */
#define BESIDE 6                 /* samples whose misses tell what this one's may be */
#define WEIGHT_ONE (1u << 24)
#define MISS_MAX (1u << 20)
#define SHIFT_BITS 4u
#define BORDERS 3u
#define END_MARK 0xa5u
#define END_BITS 8u

struct sample { int32_t height; uint32_t miss, missed[GUESSES]; };

struct ground {
	struct eco_range range;
	struct eco_bit low[BORDERS], steps[2][ECO_RANGE_NUMBER];
	struct eco_near near;
	struct eco_scale kinds[KINDS];
	struct sample *samples;
	uint32_t columns, rows, shift;
	int32_t *x, *y, *z;
};

static bool in_whole_rows(const struct eco_chunk_rows *rows)
{
	return rows->stream.elements % rows->ground_columns == 0;
}

static bool start(struct ground *g, const struct eco_chunk_rows *rows)
{
	*g = (struct ground){ .columns = rows->ground_columns,
		.rows = rows->stream.elements / rows->ground_columns, .x = rows->columns[0].values,
		.y = rows->columns[1].values, .z = rows->columns[2].values };
	eco_bits_start(g->low, BORDERS);
	eco_bits_start(g->steps[0], 2 * ECO_RANGE_NUMBER);
	eco_near_start(&g->near, g->kinds, KINDS);
	g->samples = calloc(rows->stream.elements, sizeof *g->samples);
	return g->samples;
}

static int32_t narrow(int64_t v) { return (int32_t)(uint32_t)(uint64_t)v; }

/* Values that are `apart`, by the change of their steps. */
static void code_axis(struct ground *g, struct eco_bit *models, int32_t *values, uint32_t count,
	uint32_t apart)
{
	int64_t last = 0, step = 0;
	for (uint32_t i = 0; i < count; i++) {
		int32_t *at = &values[(size_t)i * apart];
		int32_t change = eco_range_number(&g->range, models, narrow(*at - last - step));
		*at = narrow(last + step + change);
		step = i ? *at - last : 0;
		last = *at;
	}
}

static bool on_axes(const struct ground *g)
{
	for (uint32_t i = 0; i < g->rows * g->columns; i++)
		if (g->x[i] != g->x[i % g->columns] || g->y[i] != g->y[i - i % g->columns])
			return false;
	return true;
}

static void put_on_axes(struct ground *g)
{
	for (uint32_t i = 0; i < g->rows * g->columns; i++) {
		g->x[i] = g->x[i % g->columns];
		g->y[i] = g->y[i - i % g->columns];
	}
}

static uint32_t find_shift(const struct ground *g)
{
	uint32_t zeros[1u << SHIFT_BITS] = { 0 }, count = g->rows * g->columns, shift = 0;
	for (uint32_t i = 0; i < count; i++)
		for (unsigned k = 1; k < 1u << SHIFT_BITS && !((uint32_t)g->z[i] & ((1u << k) - 1)); k++)
			zeros[k]++;
	while (shift + 1 < 1u << SHIFT_BITS && zeros[shift + 1] > count / 4 * 3)
		shift++;
	return shift;
}

/* Continues what is known of the samples before; at the west and south borders fewer of them are. */
static void guess(const struct ground *g, uint32_t i, int64_t guesses[GUESSES])
{
	const struct sample *s = &g->samples[i];
	const ptrdiff_t up = -(ptrdiff_t)g->columns;
	uint32_t column = i % g->columns, row = i / g->columns;
	int64_t west = column ? s[-1].height : row ? s[up].height : 0, north = row ? s[up].height : west;
	int64_t north_west = row && column ? s[up - 1].height : row ? north : west;
	int64_t north_east = !row ? west : column + 1 < g->columns ? s[up + 1].height
		: 2 * north - north_west;
	int64_t west_of_it = column > 1 ? s[-2].height : west;
	int64_t north_of_it = row > 1 ? s[2 * up].height : north;
	guesses[0] = column ? west + north - north_west : north;
	guesses[1] = column ? 2 * west - west_of_it : north;
	guesses[2] = 2 * north - north_of_it;
	guesses[3] = column ? (2 * (west + north) + north_east - north_west) / 4 : north;
	guesses[4] = column ? (3 * (west + north) - 2 * north_west) / 4 : north;
	guesses[5] = column ? west + north_east - north : north;
}

/* Samples beside that are known; returns how many. */
static int beside(const struct ground *g, uint32_t i, const struct sample *out[BESIDE])
{
	const struct sample *s = &g->samples[i];
	const ptrdiff_t up = -(ptrdiff_t)g->columns;
	uint32_t column = i % g->columns, row = i / g->columns;
	int n = 0;
	if (column)
		out[n++] = &s[-1];
	if (row)
		out[n++] = &s[up];
	if (row && column)
		out[n++] = &s[up - 1];
	if (row && column + 1 < g->columns)
		out[n++] = &s[up + 1];
	if (column > 1)
		out[n++] = &s[-2];
	if (row > 1)
		out[n++] = &s[2 * up];
	return n;
}

static int64_t mean_of(const int64_t guesses[GUESSES], const struct sample *const *near, int count)
{
	int64_t sum = 0, weights = 0;
	for (int k = 0; k < GUESSES; k++) {
		uint64_t missed = 1;
		for (int n = 0; n < count; n++)
			missed += near[n]->missed[k];
		int64_t weight = (int64_t)(WEIGHT_ONE / (missed * missed)) + 1;
		sum += weight * (guesses[k] - guesses[0]);
		weights += weight;
	}
	return guesses[0] + (sum >= 0 ? sum + weights / 2 : sum - weights / 2) / weights;
}

/* Mean of the misses beside: the nearest two count twice. */
static uint32_t kind_of(const struct sample *const *near, int count)
{
	uint64_t size = 0;
	for (int n = 0; n < count; n++)
		size += (uint64_t)near[n]->miss << (n < 2);
	uint32_t bits = size ? 64u - (uint32_t)__builtin_clzll(size) : 0,
		kind = 2 * bits + (bits > 1 && (size >> (bits - 2) & 1));
	return kind < KINDS ? kind : KINDS - 1;
}

static uint32_t magnitude(int64_t v)
{
	uint64_t size = v < 0 ? 0 - (uint64_t)v : (uint64_t)v;
	return size < MISS_MAX ? (uint32_t)size : MISS_MAX;
}

static uint32_t border_of(const struct ground *g, uint32_t i)
{
	uint32_t column = i % g->columns, row = i / g->columns, least = BORDERS - 1;
	uint32_t to[4] = { column, row, g->columns - 1 - column, g->rows - 1 - row };
	for (int k = 0; k < 4; k++)
		least = to[k] < least ? to[k] : least;
	return least;
}

static uint32_t code_low(struct ground *g, uint32_t i, uint32_t low)
{
	if (!g->shift || !eco_range_bit(&g->range, &g->low[border_of(g, i)], low != 0))
		return 0;
	return (uint32_t)eco_range_raw(&g->range, g->shift, low);
}

static void code_sample(struct ground *g, uint32_t i)
{
	const struct sample *near[BESIDE];
	struct sample *s = &g->samples[i];
	int64_t guesses[GUESSES];
	uint32_t low = code_low(g, i, (uint32_t)g->z[i] & ((1u << g->shift) - 1));
	int count = beside(g, i, near);
	guess(g, i, guesses);
	int32_t mean = narrow(mean_of(guesses, near, count));
	int32_t height = narrow(((int64_t)g->z[i] - low) / (1 << g->shift));
	int32_t miss = eco_range_near(&g->range, &g->near, &g->kinds[kind_of(near, count)],
		narrow((int64_t)height - mean));
	s->height = narrow((int64_t)mean + miss);
	s->miss = magnitude(miss);
	for (int k = 0; k < GUESSES; k++)
		s->missed[k] = magnitude(s->height - guesses[k]);
	g->z[i] = narrow((int64_t)((uint64_t)(int64_t)s->height << g->shift) + low);
}

static bool code(struct ground *g)
{
	code_axis(g, g->steps[0], g->x, g->columns, 1);
	code_axis(g, g->steps[1], g->y, g->rows, g->columns);
	g->shift = (uint32_t)eco_range_raw(&g->range, SHIFT_BITS, g->shift);
	for (uint32_t i = 0; i < g->rows * g->columns; i++)
		code_sample(g, i);
	return eco_range_raw(&g->range, END_BITS, END_MARK) == END_MARK;
}

void eco_ground_encode(struct eco_chunk_rows *rows)
{
	struct eco_writer w = { 0 };
	struct ground g;
	bool has_memory = start(&g, rows);
	assert(in_whole_rows(rows) && on_axes(&g));
	if (has_memory) {
		eco_range_write(&g.range, &w);
		g.shift = find_shift(&g);
		code(&g);
		rows->stream.zeros = (uint8_t)eco_range_end(&g.range);
	}
	if (!has_memory || w.failed)
		eco_end("no memory");
	free(g.samples);
	rows->stream.bytes = w.bytes;
	rows->stream.size = w.size;
}

enum eco_code eco_ground_decode(struct eco_chunk_rows *rows, struct eco_error *error)
{
	struct ground g;
	if (!start(&g, rows))
		return eco_fail(error, ECO_NO_MEMORY, "out of memory for %u samples of ground",
			rows->stream.elements);
	eco_range_read(&g.range, rows->stream.bytes, rows->stream.size);
	bool good = in_whole_rows(rows) && code(&g) && eco_range_end(&g.range) == rows->stream.zeros;
	if (good)
		put_on_axes(&g);
	free(g.samples);
	return good ? ECO_OK : eco_fail(error, ECO_DAMAGED, "chunk: its ground is cut short or holds "
		"impossible values");
}
