/* Low and range as in LZMA's coder: low has 33 bits; the highest is a carry into bytes held back.
 * Probabilities have 16 bits and range at least 24, so that the most probable bit costs 1/700 bit. */
#include "ecofiles/base/range.h"

#include <assert.h>

#define TOP (1u << 24)
#define LEAST 48u                /* least probability, in 65536ths */
#define SEEN_MAX 127u            /* limits the memory, so that older bits fade */

/* The share by which a probability moves after n bits: 1 / (n + 2), in 1/65536. */
#define R(n) 65536 / ((n) + 2)
#define R4(n) R(n), R((n) + 1), R((n) + 2), R((n) + 3)
#define R16(n) R4(n), R4((n) + 4), R4((n) + 8), R4((n) + 12)
static const uint16_t share[SEEN_MAX + 1] = { R16(0), R16(16), R16(32), R16(48), R16(64), R16(80), R16(96),
	R16(112) };

void eco_bits_start(struct eco_bit *models, size_t count)
{
	for (size_t i = 0; i < count; i++)
		models[i] = (struct eco_bit){ 1u << 15, 0 };
}

void eco_range_write(struct eco_range *r, struct eco_writer *writer)
{
	*r = (struct eco_range){ .writer = writer, .range = UINT32_MAX, .start = writer->size };
}

static uint8_t next_byte(struct eco_range *r)
{
	return r->at < r->size ? r->bytes[r->at++] : (r->at++, 0);
}

void eco_range_read(struct eco_range *r, const uint8_t *bytes, size_t size)
{
	*r = (struct eco_range){ .range = UINT32_MAX, .bytes = bytes, .size = size };
	for (int i = 0; i < 4; i++)
		r->code = r->code << 8 | next_byte(r);
}

static struct eco_writer counting;       /* nothing is ever written into it */

void eco_range_count(struct eco_range *r)
{
	*r = (struct eco_range){ .writer = &counting, .range = UINT32_MAX };
}

/* A carry can turn bytes of 255 into 0, so they are only counted. Before the first byte there is nothing
 * to carry into. */
static void shift_low(struct eco_range *r)
{
	if ((uint32_t)r->low < 0xff000000u || r->low >> 32) {
		uint8_t carry = (uint8_t)(r->low >> 32);
		if (r->begun)
			eco_write_u8(r->writer, (uint8_t)(r->first + carry));
		for (; r->held > 0; r->held--)
			eco_write_u8(r->writer, (uint8_t)(0xff + carry));
		r->first = (uint8_t)(r->low >> 24);
		r->begun = true;
	} else {
		r->held++;
	}
	r->low = (uint32_t)r->low << 8 & UINT32_MAX;
}

static inline void normalize(struct eco_range *r)
{
	while (__builtin_expect(r->range < TOP, 0)) {
		r->range <<= 8;
		if (r->writer == &counting)
			r->size++;
		else if (r->writer)
			shift_low(r);
		else
			r->code = r->code << 8 | next_byte(r);
	}
}

static inline void learn(struct eco_bit *m, bool bit)
{
	if (bit)
		m->zero = (uint16_t)(m->zero - ((uint32_t)(m->zero - LEAST) * share[m->seen] >> 16));
	else
		m->zero = (uint16_t)(m->zero + ((65536u - LEAST - m->zero) * share[m->seen] >> 16));
	m->seen += m->seen < SEEN_MAX;
}

/* In line: half of the time of decoding leaves is spent here. */
static inline bool code_bit(struct eco_range *r, struct eco_bit *m, bool bit)
{
	uint32_t bound = (r->range >> 16) * m->zero;
	if (!r->writer)
		bit = r->code >= bound;
	if (bit) {
		if (r->writer)
			r->low += bound;
		else
			r->code -= bound;
		r->range -= bound;
	} else {
		r->range = bound;
	}
	learn(m, bit);
	normalize(r);
	return bit;
}

bool eco_range_bit(struct eco_range *r, struct eco_bit *m, bool bit)
{
	return code_bit(r, m, bit);
}

uint64_t eco_range_raw(struct eco_range *r, unsigned bits, uint64_t value)
{
	uint64_t got = 0;
	if (bits == 0)
		return 0;
	assert(bits <= 64);
	while (bits > 0) {
		unsigned take = bits < 16 ? bits : 16;
		uint32_t v;
		bits -= take;
		r->range >>= take;
		if (r->writer) {
			v = (uint32_t)(value >> bits) & ((1u << take) - 1);
			r->low += (uint64_t)r->range * v;
		} else {
			v = r->code / r->range;
			v = v >> take ? (1u << take) - 1 : v;        /* only in damaged bytes */
			r->code -= r->range * v;
		}
		got = got << take | v;
		normalize(r);
	}
	return got;
}

uint32_t eco_range_tree(struct eco_range *r, struct eco_bit *models, unsigned bits, uint32_t value)
{
	uint32_t node = 1;
	assert(bits <= 16);
	for (unsigned left = bits; left-- > 0;)
		node = node << 1 | code_bit(r, &models[node], value >> left & 1);
	return node - (1u << bits);
}

uint32_t eco_range_unary(struct eco_range *r, struct eco_bit *models, uint32_t steps, uint32_t most, uint32_t value)
{
	uint32_t n = 0;
	while (n < most && code_bit(r, &models[n < steps ? n : steps - 1], n < value))
		n++;
	return n;
}

uint64_t eco_range_size(struct eco_range *r, struct eco_bit *models, unsigned tree_bits, uint64_t value)
{
	uint32_t bits = eco_range_tree(r, models, tree_bits, eco_bit_length(value));
	if (bits == 0)
		return 0;
	uint64_t highest = (uint64_t)1 << (bits - 1);
	return highest | eco_range_raw(r, bits - 1, value & (highest - 1));
}

uint32_t eco_range_field(struct eco_range *r, struct eco_bit *models, unsigned modelled, unsigned bits,
	uint32_t value)
{
	unsigned high = bits < modelled ? bits : modelled, low = bits - high;
	uint32_t top = eco_range_tree(r, models, high, high ? (uint32_t)((uint64_t)value >> low) : 0);
	return (uint32_t)((uint64_t)top << low
		| eco_range_raw(r, low, low < 32 ? value & (((uint64_t)1 << low) - 1) : value));
}

static inline void count_bytes(struct eco_range *r)
{
	for (; __builtin_expect(r->range < TOP, 0); r->range <<= 8)
		r->size++;
}

void eco_range_fields(struct eco_range *ranges, uint32_t count, unsigned step, struct eco_bit *models, unsigned bits,
	uint32_t value)
{
	uint32_t node = 1;
	for (unsigned k = 0; k < bits && k < (count - 1) * step; k++) {
		struct eco_bit *m = &models[node];
		bool bit = value >> (bits - 1 - k) & 1;
		for (uint32_t i = k / step + 1; i < count; i++) {
			uint32_t bound = (ranges[i].range >> 16) * m->zero;
			ranges[i].range = bit ? ranges[i].range - bound : bound;
			count_bytes(&ranges[i]);
		}
		learn(m, bit);
		node = node << 1 | bit;
	}
	for (uint32_t i = 0; i < count; i++)
		for (unsigned k = i * step, take; k < bits; k += take) {
			take = bits - k < 16 ? bits - k : 16;
			ranges[i].range >>= take;
			count_bytes(&ranges[i]);
		}
}

int32_t eco_range_number(struct eco_range *r, struct eco_bit *models, int32_t value)
{
	uint32_t size = value < 0 ? 0u - (uint32_t)value : (uint32_t)value,
		bits = eco_range_tree(r, models, 5, eco_bit_length(size));
	if (bits == 0)
		return 0;
	bool negative = eco_range_raw(r, 1, value < 0);
	size = 1u << (bits - 1) | (uint32_t)eco_range_raw(r, bits - 1, size & ((1u << (bits - 1)) - 1));
	return negative ? -(int32_t)size : (int32_t)size;
}

/* ---- Numbers near their usual size ---- */

#define NEAR_BITS_MAX 31u
#define SCALE_SEEN_MAX 30u
#define LEVEL_FIRST (8u << 8)

void eco_near_start(struct eco_near *near, struct eco_scale *kinds, size_t count)
{
	eco_bits_start(near->larger, ECO_NEAR_PARTS);
	for (uint32_t part = 0; part < ECO_NEAR_PARTS; part++) {
		eco_bits_start(near->more[part], ECO_NEAR_STEPS);
		eco_bits_start(near->less[part], ECO_NEAR_STEPS);
		eco_bits_start(near->half[part], ECO_NEAR_STEPS);
	}
	near->level = LEVEL_FIRST;
	for (size_t i = 0; i < count; i++) {
		kinds[i] = (struct eco_scale){ .level = 0 };
		eco_bits_start(&kinds[i].sign, 1);
	}
}

int32_t eco_range_near(struct eco_range *r, struct eco_near *near, struct eco_scale *kind, int32_t value)
{
	uint32_t level = kind->seen ? kind->level : near->level, usual = level >> 8,
		part = level >> 6 & (ECO_NEAR_PARTS - 1);
	uint32_t size = value < 0 ? 0u - (uint32_t)value : (uint32_t)value,
		bits = eco_bit_length(size);
	if (usual < NEAR_BITS_MAX && code_bit(r, &near->larger[part], bits > usual))
		bits = usual + 1 + eco_range_unary(r, near->more[part], ECO_NEAR_STEPS,
			NEAR_BITS_MAX - 1 - usual, bits - usual - 1);
	else
		bits = usual - eco_range_unary(r, near->less[part], ECO_NEAR_STEPS, usual, usual - bits);
	if (bits > 1) {
		uint32_t from = bits + ECO_NEAR_STEPS / 2 > usual ? bits + ECO_NEAR_STEPS / 2 - usual : 0;
		uint32_t half = code_bit(r, &near->half[part][from < ECO_NEAR_STEPS ? from
			: ECO_NEAR_STEPS - 1], size >> (bits - 2) & 1);
		size = (2 | half) << (bits - 2) | (uint32_t)eco_range_raw(r, bits - 2,
			size & ((1u << (bits - 2)) - 1));
	} else {
		size = bits;
	}
	int32_t now = bits ? (int32_t)(bits << 8 | ((uint64_t)size << 8 >> (bits - 1) & 255)) : 0;

	kind->seen += kind->seen < SCALE_SEEN_MAX;
	near->level = kind->level =
		(uint16_t)((int32_t)level + (now - (int32_t)level) / (int32_t)(kind->seen + 1));
	return size && code_bit(r, &kind->sign, value < 0) ? -(int32_t)size : (int32_t)size;
}

uint32_t eco_range_end(struct eco_range *r)
{
	if (!r->writer)
		return r->at < r->size ? UINT32_MAX : (uint32_t)(r->at - r->size);
	if (r->writer == &counting) {
		r->size += 4;            /* five, and the first holds none */
		return 0;
	}
	/* of the numbers in [low, low + range), the one with the most zeros at its end */
	uint64_t mask = UINT32_MAX;
	uint32_t zeros = 0;

	while (((r->low + mask) & ~mask) >= r->low + r->range)
		mask >>= 1;
	r->low = (r->low + mask) & ~mask;
	for (int i = 0; i < 5; i++)
		shift_low(r);
	for (; zeros < 255 && r->writer->size > r->start && r->writer->bytes[r->writer->size - 1] == 0;
			zeros++)
		r->writer->size--;
	return zeros;
}
