/* Texts that are kept once: each keeps its number and its place, however many there are. */
#include <stdio.h>

#include "ecofiles/base/texts.h"
#include "tests/support/unit_test.h"

UNIT_TEST(equal_texts_have_one_number)
{
	static const char *const given[] = { "oak", "ash", "", "oak", "Oak", "", "ash" };
	static const uint32_t want[] = { 0, 1, 2, 0, 3, 2, 1 };
	struct eco_texts texts = { 0 };
	for (size_t i = 0; i < sizeof given / sizeof *given; i++) {
		uint32_t number;
		assert_true(eco_texts_add(&texts, given[i], &number));
		assert_int_equal(number, want[i]);
		assert_string_equal(texts.items[number], given[i]);
	}
	assert_int_equal(texts.count, 4);
	eco_texts_free(&texts);
	assert_int_equal(texts.count, 0);
}

UNIT_TEST(many_texts_stay_where_they_are)
{
	struct eco_texts texts = { 0 };
	char text[16];
	uint32_t number;
	assert_true(eco_texts_add(&texts, "first", &number));
	const char *first = texts.items[0];
	for (uint32_t pass = 0; pass < 2; pass++)
		for (uint32_t i = 1; i < 100000; i++) {
			snprintf(text, sizeof text, "%u", i);
			assert_true(eco_texts_add(&texts, text, &number));
			assert_int_equal(number, i);
		}
	assert_ptr_equal(texts.items[0], first);
	assert_int_equal(texts.count, 100000);
	eco_texts_free(&texts);
}
