

#include "ecofiles/base/bytes.h"
#include "tests/support/unit_test.h"

UNIT_TEST(numbers_come_back_and_are_little_endian)
{
	static const uint8_t expected[] = { 0xfe, 0x34, 0x12, 0x78, 0x56, 0x34, 0x12, 8, 7, 6, 5, 4, 3, 2, 1,
		0, 0, 0xc0, 0xbf, 0, 0, 0, 0, 0, 0, 4, 0x40, 'a', 'b' };
	struct eco_writer w = { 0 };
	struct eco_reader r;
	eco_write_u8(&w, 0xfe);
	eco_write_u16(&w, 0x1234);
	eco_write_u32(&w, 0x12345678);
	eco_write_u64(&w, 0x0102030405060708);
	eco_write_f32(&w, -1.5f);
	eco_write_f64(&w, 2.5);
	eco_write_bytes(&w, "ab", 2);
	eco_write_bytes(&w, NULL, 0);
	assert_false(w.failed);
	assert_int_equal(w.size, sizeof expected);
	assert_memory_equal(w.bytes, expected, sizeof expected);

	r = (struct eco_reader){ .bytes = w.bytes, .size = w.size };
	assert_int_equal(eco_read_u8(&r), 0xfe);
	assert_int_equal(eco_read_u16(&r), 0x1234);
	assert_int_equal(eco_read_u32(&r), 0x12345678);
	assert_true(eco_read_u64(&r) == 0x0102030405060708);
	assert_true(eco_read_f32(&r) == -1.5f);
	assert_true(eco_read_f64(&r) == 2.5);
	assert_memory_equal(eco_read_bytes(&r, 2), "ab", 2);
	assert_false(r.failed);
	assert_int_equal(r.at, r.size);
	eco_writer_free(&w);
	assert_null(w.bytes);
}

UNIT_TEST(a_reader_that_ran_out_stays_failed)
{
	const uint8_t bytes[] = { 1, 2, 3 };
	struct eco_reader r = { .bytes = bytes, .size = sizeof bytes };
	assert_int_equal(eco_read_u32(&r), 0);
	assert_true(r.failed);
	assert_int_equal(eco_read_u8(&r), 0);
	assert_null(eco_read_bytes(&r, 0));
	r = (struct eco_reader){ .bytes = bytes, .size = sizeof bytes };
	assert_null(eco_read_bytes(&r, SIZE_MAX));
	assert_true(r.failed);
}

UNIT_TEST(varints_have_one_spelling)
{
	static const struct { uint8_t bytes[11]; size_t size; } bad[] = {
		{ { 0x80, 0 }, 2 },                                                    /* zero in two bytes */
		{ { 0xff, 0 }, 2 },
		{ { 0x80 }, 1 },                                                       /* truncated */
		{ { 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 2 }, 10 },   /* 65 bits */
		{ { 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0x81, 0 }, 11 },
		{ { 0 }, 0 },
	};

	for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
		struct eco_reader r = { .bytes = bad[i].bytes, .size = bad[i].size };
		assert_true(eco_read_varint(&r) == 0);
		assert_true(r.failed);
	}
}
