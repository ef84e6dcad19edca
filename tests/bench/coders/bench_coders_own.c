/* Sets by the adaptive coders of this folder: first corners, then the other columns from the last to the
 * first, so that a colour may depend on the plant that it is of. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/range.h"
#include "tests/bench/coders/bench_coders_rows.h"

#define TIMES 3

static double bits_at(const struct eco_range *r)
{
	return r->writer ? 8.0 * (double)(r->writer->size + r->held) - log2(r->range) : 0;
}

static bool code_table(struct eco_range *r, struct coders_table *t, enum coders_places places, double *bits)
{
	uint32_t coded_count = t->columns - t->known, first = places == CODERS_ORDERED ? 0 : CODERS_AXES;
	uint64_t coded = 0;
	double before = bits_at(r);
	for (uint32_t k = coded_count; k < t->columns; k++)
		coded |= 1ull << k;
	bool good = places == CODERS_ORDERED
		|| (places == CODERS_OCTREE ? coders_code_octree(r, t) : coders_code_counts(r, t));
	for (uint32_t k = 0; k < first; k++)
		coded |= 1ull << k;
	if (bits)
		bits[0] += bits_at(r) - before;
	for (uint32_t i = first; i < coded_count && good; i++) {
		uint32_t column = first ? coded_count + first - 1 - i : i;
		before = bits_at(r);
		coders_code_column(r, t, column, coded);
		coded |= 1ull << column;
		if (bits)
			bits[column] += bits_at(r) - before;
	}
	return good;
}

static bool code_set(struct eco_range *r, struct coders_set *set, enum coders_places places, double *bits)
{
	bool good = true;
	for (uint32_t i = 0; i < set->count && good; i++)
		good = code_table(r, &set->tables[i], places, bits);
	return good;
}

static bool copy_set(struct coders_set *to, const struct coders_set *from)
{
	*to = (struct coders_set){ .count = 0 };
	return coders_set_append(to, from);
}

/* Zeros where rows will be read, but for the columns that are known. */
static void empty(struct coders_set *set)
{
	for (uint32_t i = 0; i < set->count; i++) {
		const struct coders_table *t = &set->tables[i];
		for (uint32_t row = 0; row < t->rows; row++)
			memset(t->values + (size_t)t->columns * row, 0,
				(t->columns - t->known) * sizeof *t->values);
	}
}

static bool same(const struct coders_set *a, const struct coders_set *b)
{
	for (uint32_t i = 0; i < a->count; i++)
		if (memcmp(a->tables[i].values, b->tables[i].values, (size_t)a->tables[i].rows
				* a->tables[i].columns * sizeof *a->tables[i].values))
			return false;
	return true;
}

/* The best of a few times of reading the set again. */
static double read_again(const struct coders_set *written, const struct eco_writer *w,
	enum coders_places places, bool *good)
{
	double best = INFINITY;
	for (int i = 0; i < TIMES && *good; i++) {
		struct coders_set set;
		struct eco_range r;
		*good = copy_set(&set, written);
		empty(&set);
		double before = coders_now_ns();
		eco_range_read(&r, w->bytes, w->size);
		*good = *good && code_set(&r, &set, places, NULL);
		best = fmin(best, coders_now_ns() - before);
		*good = *good && same(written, &set);
		coders_set_free(&set);
	}
	return best;
}

size_t coders_own(const struct coders_set *set, enum coders_places places, double *bits, double *ns,
	bool *good)
{
	struct coders_set written;
	struct eco_writer w = { 0 };
	struct eco_range r;
	int32_t low[CODERS_AXES];
	for (uint32_t i = 0; i < set->count; i++)
		if (places != CODERS_ORDERED && coders_table_box(&set->tables[i], low) > CODERS_DEPTH_MAX)
			return SIZE_MAX;
	bool fine = copy_set(&written, set);
	for (uint32_t i = 0; i < written.count && fine && places == CODERS_OCTREE; i++)
		fine = coders_table_sort(&written.tables[i]);
	eco_range_write(&r, &w);
	fine = fine && code_set(&r, &written, places, bits);
	eco_range_end(&r);
	fine = fine && !w.failed;
	*ns = read_again(&written, &w, places, &fine);
	*good &= fine;
	size_t size = w.size + CODERS_FRAME_BYTES + 4 * (set->count > 1 ? set->count : 0);
	coders_set_free(&written);
	eco_writer_free(&w);
	return size;
}
