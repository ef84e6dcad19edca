#include "tests/bench/coders/bench_coders_rows.h"

#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "ecofiles/format/chunk/chunk_payload.h"

double coders_now_ns(void)
{
	struct timespec now;
	clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
	return 1e9 * (double)now.tv_sec + (double)now.tv_nsec;
}

/* ---- From chunks ---- */

static uint32_t columns_of(const struct eco_elements *e, uint32_t corners)
{
	return 3 * corners + (e->uv ? 2 * corners : 0) + e->extra_count;
}

/* The table for elements of so many corners, with room for all of the chunk's. */
static struct coders_table *table_of(struct coders_set *set, const struct eco_elements *e, uint32_t corners)
{
	for (uint32_t i = 0; i < set->count; i++)
		if (set->tables[i].corners == corners)
			return &set->tables[i];
	if (set->count == CODERS_TABLES_MAX)
		return NULL;
	struct coders_table *t = &set->tables[set->count];
	*t = (struct coders_table){ .columns = columns_of(e, corners), .corners = corners };
	t->values = malloc(sizeof *t->values * t->columns * e->element_count);
	set->count += t->values != NULL;
	return t->values ? t : NULL;
}

static int32_t coarse(int32_t v, uint32_t shift)
{
	int32_t half = shift ? 1 << shift >> 1 : 0;
	return (v + half) >> shift;
}

static void put_row(struct coders_table *t, const struct eco_elements *e, uint32_t element, size_t corner,
	uint32_t shift)
{
	int32_t *row = t->values + (size_t)t->columns * t->rows++;
	for (uint32_t k = 0; k < 3 * t->corners; k++)
		row[k] = coarse(e->position[3 * corner + k], shift);
	for (uint32_t k = 3 * t->corners; k-- > 3;)
		row[k] -= row[k % 3];
	row += 3 * t->corners;
	for (uint32_t k = 0; e->uv && k < 2 * t->corners; k++)
		*row++ = e->uv[2 * corner + k];
	for (uint32_t k = 0; k < e->extra_count; k++)
		*row++ = e->extra[(size_t)e->extra_count * element + k];
}

/* Draw position i shows stored element order[i]: `drawn` is the inverse. NULL: no memory. */
static uint32_t *drawn_order(const struct eco_list *list, uint32_t ordinal, uint32_t count)
{
	bool permuted = list->coder == ECO_CODER_ELEMENTS || list->coder == ECO_CODER_FORM
		|| list->coder == ECO_CODER_KD;
	uint32_t *order = malloc(count * sizeof *order), *drawn = malloc(count * sizeof *drawn);
	for (uint32_t i = 0; i < count && order; i++)
		order[i] = i;
	if (permuted && order)
		eco_chunk_permutation(ordinal, count, order);
	for (uint32_t i = 0; i < count && order && drawn; i++)
		drawn[order[i]] = i;
	free(order);
	return drawn;
}

static bool take_all(struct coders_set *set, const struct eco_elements *e, const uint32_t *drawn,
	uint32_t shift)
{
	size_t *at = malloc(e->element_count * sizeof *at), corner = 0;
	bool good = at && drawn;
	for (uint32_t i = 0; i < e->element_count && at; corner += e->corners[i++])
		at[i] = corner;
	for (uint32_t i = 0; i < e->element_count && good; i++) {
		struct coders_table *t = table_of(set, e, e->corners[drawn[i]]);
		good = t != NULL;
		if (good)
			put_row(t, e, drawn[i], at[drawn[i]], shift);
	}
	free(at);
	return good;
}

enum eco_code coders_rows_take(struct coders_set *set, const struct eco_list *list,
	const struct eco_chunk *chunk, uint32_t ordinal, const uint8_t *bytes, struct eco_error *error)
{
	struct eco_payload payload;
	struct eco_elements elements;
	*set = (struct coders_set){ .count = 0 };
	enum eco_code code = eco_payload_read(&payload, bytes, chunk->size_bytes, error);
	if (!code)
		code = eco_chunk_decode(list, chunk, ordinal, bytes, chunk->size_bytes, &elements, error);
	if (code)
		return code;
	uint32_t shift = payload.coder == ECO_CODER_SHAPES ? ECO_EXACT_SHIFT : payload.streams[0].shift;
	uint32_t *drawn = drawn_order(list, ordinal, elements.element_count);
	bool good = take_all(set, &elements, drawn, shift);
	free(drawn);
	eco_elements_free(&elements);
	if (!good)
		coders_set_free(set);
	return good ? ECO_OK : eco_fail(error, ECO_NO_MEMORY, "no memory for the rows of a chunk");
}

bool coders_set_append(struct coders_set *to, const struct coders_set *from)
{
	for (uint32_t i = 0; i < from->count; i++) {
		const struct coders_table *f = &from->tables[i];
		uint32_t k = 0;
		while (k < to->count && to->tables[k].corners != f->corners)
			k++;
		if (k == CODERS_TABLES_MAX)
			return false;
		struct coders_table *t = &to->tables[k];
		if (k == to->count) {
			*t = *f;
			t->rows = 0;
			t->values = NULL;
			to->count++;
		}
		size_t row = t->columns * sizeof *t->values;
		int32_t *values = realloc(t->values, row * (t->rows + f->rows));
		if (!values)
			return false;
		t->values = values;
		memcpy(values + (size_t)t->columns * t->rows, f->values, row * f->rows);
		t->rows += f->rows;
	}
	return true;
}

void coders_set_free(struct coders_set *set)
{
	for (uint32_t i = 0; i < set->count; i++)
		free(set->tables[i].values);
	*set = (struct coders_set){ .count = 0 };
}

/* ---- Order ---- */

uint32_t coders_table_box(const struct coders_table *t, int32_t low[CODERS_AXES])
{
	uint32_t most = 0;
	for (uint32_t a = 0; a < CODERS_AXES; a++) {
		int32_t high = t->values[a];
		low[a] = high;
		for (uint32_t i = 0; i < t->rows; i++) {
			int32_t v = t->values[(size_t)t->columns * i + a];
			low[a] = v < low[a] ? v : low[a];
			high = v > high ? v : high;
		}
		uint32_t span = (uint32_t)high - (uint32_t)low[a];
		most = span > most ? span : most;
	}
	return most ? 32u - (uint32_t)__builtin_clz(most) : 0;
}

struct keyed { uint64_t key; uint32_t row; };

static int compare_keyed(const void *left, const void *right)
{
	const struct keyed *a = left, *b = right;
	if (a->key != b->key)
		return a->key < b->key ? -1 : 1;
	return a->row < b->row ? -1 : a->row > b->row;
}

static uint64_t morton(const int32_t *at, const int32_t *low)
{
	uint64_t key = 0;
	for (uint32_t bit = CODERS_DEPTH_MAX; bit-- > 0;)
		for (uint32_t a = 0; a < CODERS_AXES; a++)
			key = key << 1 | (((uint32_t)at[a] - (uint32_t)low[a]) >> bit & 1);
	return key;
}

bool coders_table_sort(struct coders_table *t)
{
	int32_t low[CODERS_AXES];
	size_t row = t->columns * sizeof *t->values;
	if (coders_table_box(t, low) > CODERS_DEPTH_MAX)
		return false;
	struct keyed *keyed = malloc(t->rows * sizeof *keyed);
	int32_t *sorted = malloc(row * t->rows);
	bool good = keyed && sorted;
	for (uint32_t i = 0; i < t->rows && good; i++)
		keyed[i] = (struct keyed){ morton(t->values + (size_t)t->columns * i, low), i };
	if (good)
		qsort(keyed, t->rows, sizeof *keyed, compare_keyed);
	for (uint32_t i = 0; i < t->rows && good; i++)
		memcpy(sorted + (size_t)t->columns * i, t->values + (size_t)t->columns * keyed[i].row, row);
	if (good)
		memcpy(t->values, sorted, row * t->rows);
	free(keyed);
	free(sorted);
	return good;
}
