/* Range-coded bits come back as they were written, in as many bytes as they are worth; anything can be read.
 */

#include "ecofiles/base/range.h"
#include "tests/support/unit_test.h"


static uint32_t next(uint32_t *state)
{
	*state = *state * 1664525u + 1013904223u;
	return *state >> 8;
}

/* Codes `count` numbers of each kind; when reading, compares them with those written. */
static void code_mixed(struct eco_range *r, uint32_t count, bool writing)
{
	static const int32_t numbers[] = { 0, 1, -1, 5, -700, 1 << 30, INT32_MAX, -INT32_MAX };
	struct eco_bit rare[1], tree[256], field[8], number[ECO_RANGE_NUMBER];
	uint32_t state = 3;
	eco_bits_start(rare, 1);
	eco_bits_start(tree, 256);
	eco_bits_start(field, 8);
	eco_bits_start(number, ECO_RANGE_NUMBER);
	for (uint32_t i = 0; i < count; i++) {
		bool bit = next(&state) % 100 == 0;
		uint32_t byte = next(&state) & next(&state) & 255, wide = next(&state),
			bits = next(&state) % 65;
		uint64_t raw = ((uint64_t)next(&state) << 40 ^ (uint64_t)next(&state) << 20 ^ next(&state))
			& (bits == 64 ? UINT64_MAX
			: ((uint64_t)1 << bits) - 1);
		int32_t value = numbers[next(&state) % 8];
		assert_int_equal(eco_range_bit(r, rare, writing && bit), bit);
		assert_int_equal(eco_range_tree(r, tree, 8, writing ? byte : 0) & 255, byte);
		assert_int_equal(eco_range_field(r, field, 3, 24, writing ? wide : 0), wide);
		assert_int_equal(eco_range_field(r, field, 3, 2, writing ? wide & 3 : 0), wide & 3);
		assert_int_equal(eco_range_field(r, field, 3, 0, 0), 0);
		assert_true(eco_range_raw(r, bits, writing ? raw : 0) == raw);
		assert_int_equal(eco_range_number(r, number, writing ? value : 0), value);
	}
}

UNIT_TEST(what_is_written_is_read)
{
	for (uint32_t count = 0; count < 300; count++) {
		struct eco_writer w = { 0 };
		struct eco_range r;
		eco_write_u8(&w, 7);
		eco_range_write(&r, &w);
		code_mixed(&r, count, true);
		uint32_t zeros = eco_range_end(&r);
		assert_false(w.failed);
		eco_range_read(&r, w.bytes + 1, w.size - 1);
		code_mixed(&r, count, false);
		assert_int_equal(eco_range_end(&r), zeros);
		assert_int_equal(w.bytes[0], 7);
		/* bytes that nobody reads are noticed */
		for (int i = 0; i < 8; i++)
			eco_write_u8(&w, 1);
		eco_range_read(&r, w.bytes + w.size - 8, 8);
		assert_int_equal(eco_range_end(&r), UINT32_MAX);
		eco_writer_free(&w);
	}
}

/* A run of ones that ends in a carry passes through bytes that were held back. */
/* By 0, 2, ... 8 modelled bits at once, and by one coder. */
UNIT_TEST(bytes_that_are_counted_are_those_that_are_written)
{
	for (uint32_t bits = 0; bits <= 32; bits++) {
		struct eco_range all[5], r, one;
		struct eco_bit shared[256], models[2][256];
		for (uint32_t i = 0; i < 5; i++)
			eco_range_count(&all[i]);
		eco_bits_start(shared, 256);
		for (uint32_t i = 0; i < 5; i++) {
			struct eco_writer w = { 0 };
			uint32_t state = 5;
			eco_range_write(&r, &w);
			eco_range_count(&one);
			eco_bits_start(models[0], 256);
			eco_bits_start(models[1], 256);
			for (uint32_t k = 0; k < 200; k++) {
				uint32_t value = (uint32_t)((uint64_t)(next(&state) & next(&state)) << 8 >> (32 - bits));
				eco_range_field(&r, models[0], 2 * i, bits, value);
				eco_range_field(&one, models[1], 2 * i, bits, value);
				if (i == 0)
					eco_range_fields(all, 5, 2, shared, bits, value);
			}
			size_t size = eco_range_end(&r) + w.size;
			eco_range_end(&one);
			eco_range_end(&all[i]);
			assert_int_equal(one.size, size);
			if (2 * i < bits + 2)
				assert_int_equal(all[i].size, size);
			eco_writer_free(&w);
		}
	}
}

UNIT_TEST(carries_go_through)
{
	for (uint32_t seed = 0; seed < 3000; seed++) {
		struct eco_writer w = { 0 };
		struct eco_range r;
		uint32_t state = seed;
		eco_range_write(&r, &w);
		for (uint32_t i = 0; i < 40; i++)
			eco_range_raw(&r, 16, next(&state) % 8 ? 0xffff : next(&state) & 1);
		uint32_t zeros = eco_range_end(&r);
		eco_range_read(&r, w.bytes, w.size);
		state = seed;
		for (uint32_t i = 0; i < 40; i++) {
			uint32_t expected = next(&state) % 8 ? 0xffff : next(&state) & 1;
			assert_int_equal(eco_range_raw(&r, 16, 0), expected);
		}
		assert_int_equal(eco_range_end(&r), zeros);
		eco_writer_free(&w);
	}
}

UNIT_TEST(anything_can_be_read)
{
	uint32_t state = 5;
	for (uint32_t i = 0; i < 2000; i++) {
		uint8_t bytes[64];
		struct eco_range r;
		struct eco_bit models[256];
		struct eco_near near;
		struct eco_scale kind;
		eco_near_start(&near, &kind, 1);
		for (size_t k = 0; k < sizeof bytes; k++)
			bytes[k] = i % 3 ? (uint8_t)next(&state) : 0xff;
		eco_bits_start(models, 256);
		eco_range_read(&r, bytes, i % (sizeof bytes + 1));
		for (uint32_t k = 0; k < 100; k++) {
			assert_true((eco_range_tree(&r, models, 8, 0) & 255) < 256);
			assert_true(eco_range_raw(&r, 13, 0) < 1u << 13);
			assert_true(eco_range_field(&r, models, 3, 20, 0) < 1u << 20);
			(void)eco_range_number(&r, models, 0);
			(void)eco_range_near(&r, &near, &kind, 0);
		}
	}
}
