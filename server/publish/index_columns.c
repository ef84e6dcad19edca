/* One description of the bytes for both ways: see range.h. */
#include "server/publish/index_columns.h"

#include <stdlib.h>

#define SLOTS 16u
#define SIZE_BITS 6u
#define SIZES 33u
#define KEY_BITS 12u
#define HITS 3u
#define ZEROS_MOST 255u          /* eco_range_end leaves off; what needs more bytes is damaged */
#define TOP_MOST (SRV_INDEX_TOP_STEP * (SRV_INDEX_TOP_STEPS - 1))

/* Models of a column. after: per key, hashed, what followed it. */
struct srv_index_learnt {
	struct eco_bit same[1u << HITS], size[SLOTS][1u << SIZE_BITS], sign[SLOTS], top[SIZES][1u << TOP_MOST];
	uint32_t after[1u << KEY_BITS];
};

static void start(struct srv_index_learnt *l)
{
	eco_bits_start(l->same, 1u << HITS);
	eco_bits_start(l->size[0], SLOTS << SIZE_BITS);
	eco_bits_start(l->sign, SLOTS);
	eco_bits_start(l->top[0], SIZES << TOP_MOST);
	for (uint32_t i = 0; i < 1u << KEY_BITS; i++)
		l->after[i] = 0;
}

static uint32_t hash(uint32_t a, uint32_t b, unsigned bits) { return (a * 2654435761u + b * 2246822519u) >> (32 - bits); }
static uint32_t size_of(uint32_t v) { return eco_bit_length(v >> 31 ? 0u - v : v); }

/* Sets *bits to those of its magnitude. */
static uint32_t code_number(struct eco_range *range, struct srv_index_learnt *l, unsigned top, uint32_t slot, uint32_t value,
	uint32_t *bits)
{
	bool minus = value >> 31;
	*bits = eco_range_tree(range, l->size[slot], SIZE_BITS, size_of(value));
	*bits = *bits < SIZES ? *bits : SIZES - 1;
	if (!*bits)
		return 0;
	uint32_t high = 1u << (*bits - 1), size = minus ? 0u - value : value;
	size = high | eco_range_field(range, l->top[*bits], top, *bits - 1, size & (high - 1));
	return eco_range_bit(range, &l->sign[slot], minus) ? 0u - size : size;
}

void srv_index_column(struct eco_range *range, const struct srv_index_columns *columns, uint32_t column,
	const struct srv_index_way *way, uint32_t rows, size_t most)
{
	struct srv_index_learnt *l = columns->learnt;
	uint32_t *v = columns->values + (size_t)column * columns->rows, hits = 0, bits = 0;
	const uint32_t *of = columns->values + (size_t)way->of * columns->rows, *by = columns->values
		+ (size_t)way->by * columns->rows;
	start(l);
	for (uint32_t i = 0; i < rows && (range->size < most && range->at <= range->size + ZEROS_MOST); i++) {
		uint32_t before = i ? v[i - 1] : 0, of_before = i ? of[i - 1] : 0, by_before = i ? by[i - 1] : 0;
		const uint32_t guesses[SRV_BASES] = { 0, before, i > 1 ? 2 * before - v[i - 2] : before, before + of_before,
			of[i], before + of[i] - of_before };
		const uint32_t slots[SRV_SLOT_KINDS] = { 0, bits, size_of(by[i] - by_before), hash(by[i], 0, 4) };
		const uint32_t slot = slots[way->slots] < SLOTS ? slots[way->slots] : SLOTS - 1, guess = guesses[way->base];
		uint32_t *after = &l->after[hash(way->key == SRV_KEY_BY ? 0 : before, way->key == SRV_KEY_BEFORE ? 0 : by[i],
			KEY_BITS)];
		bool same = eco_range_bit(range, &l->same[hits], v[i] == *after);
		v[i] = same ? *after : guess + code_number(range, l, way->top * SRV_INDEX_TOP_STEP, slot, v[i] - guess, &bits);
		bits = same ? size_of(v[i] - guess) : bits;
		*after = v[i];
		hits = (hits << 1 | same) & ((1u << HITS) - 1);
	}
}

/* False: impossible. */
static bool code_way(struct eco_range *range, const struct srv_index_columns *columns, struct srv_index_way *way)
{
	struct { uint8_t *value, bits; uint32_t end; } fields[] = { { &way->base, 3, SRV_BASES }, { &way->of, 6, columns->count },
		{ &way->by, 6, columns->count }, { &way->slots, 2, SRV_SLOT_KINDS }, { &way->key, 2, SRV_KEYS },
		{ &way->top, 2, SRV_INDEX_TOP_STEPS } };
	bool good = true;
	for (size_t i = 0; i < sizeof fields / sizeof *fields && good; i++) {
		*fields[i].value = (uint8_t)eco_range_raw(range, fields[i].bits, *fields[i].value);
		good = *fields[i].value < fields[i].end;
	}
	return good;
}

/* Low bits that are 0 in all values are left out. */
static uint32_t shift_values(uint32_t *values, uint32_t rows)
{
	uint32_t any = 0;
	for (uint32_t i = 0; i < rows; i++)
		any |= values[i];
	const uint32_t shift = any ? (uint32_t)__builtin_ctz(any) : 0;
	for (uint32_t i = 0; i < rows; i++)
		values[i] >>= shift;
	return shift;
}

/* Shifts are of records, as columns are known by what was coded. */
static bool code_columns(struct eco_range *range, const struct srv_index_columns *columns, srv_index_find *find,
	uint32_t shifts[ECO_RECORD_VALUES_MAX])
{
	bool good = columns->rows > 0;
	for (uint32_t c = 0; c < columns->count && good; c++)
		shifts[c] = range->writer ? shift_values(columns->values + (size_t)c * columns->rows, columns->rows) : 0;
	for (uint32_t c = columns->count; c-- > 0 && good;) {
		struct srv_index_way way = { 0 };
		uint32_t *v = columns->values + (size_t)c * columns->rows, varies = 0;
		for (uint32_t i = 1; i < columns->rows && range->writer; i++)
			varies |= v[i] ^ v[0];
		shifts[c] = (uint32_t)eco_range_raw(range, 5, shifts[c]);
		if (eco_range_raw(range, 1, varies != 0)) {
			way = range->writer ? find(columns, c) : way;
			good = code_way(range, columns, &way);
			srv_index_column(range, columns, c, &way, good ? columns->rows : 0, SIZE_MAX);
		} else {
			srv_index_column(range, columns, c, &way, 1, SIZE_MAX);
			for (uint32_t i = 1; i < columns->rows; i++)
				v[i] = v[0];
		}
	}
	return good || !columns->rows;
}

bool srv_index_table(struct eco_range *range, enum eco_section_kind kind, uint8_t *records, uint32_t count,
	srv_index_find *find)
{
	uint8_t widths[ECO_RECORD_VALUES_MAX];
	uint32_t shifts[ECO_RECORD_VALUES_MAX], values = eco_record_widths(kind, widths), record = eco_record_bytes(kind);
	struct srv_index_columns columns = { calloc((size_t)count * values + 1, sizeof *columns.values), count, values,
		malloc(sizeof *columns.learnt) };
	bool good = columns.values && columns.learnt;
	for (uint32_t c = 0, at = 0; good && c < values; at += widths[c++])
		for (uint32_t i = 0; i < count && range->writer; i++)
			for (uint32_t k = 0; k < widths[c]; k++)
				columns.values[(size_t)c * count + i] |= (uint32_t)records[(size_t)i * record + at + k] << 8 * k;
	good = good && code_columns(range, &columns, find, shifts);
	for (uint32_t c = 0, at = 0; good && c < values; at += widths[c++])
		for (uint32_t i = 0; i < count && !range->writer; i++)
			for (uint32_t k = 0; k < widths[c]; k++)
				records[(size_t)i * record + at + k]
					= (uint8_t)(columns.values[(size_t)c * count + i] << shifts[c] >> 8 * k);
	free(columns.values);
	free(columns.learnt);
	return good;
}
