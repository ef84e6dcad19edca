/* Texts that are kept once: each keeps its number and its place, however many there are. */
#include <string.h>

#include "ecofiles/base/text.h"
#include "ecofiles/base/status.h"
#include "ecofiles/base/array_grow.h"
#include "tests/support/unit_test.h"

UNIT_TEST(equal_texts_have_one_number)
{
	static const char *const given[] = { "oak", "ash", "", "oak", "Oak", "", "ash" };
	static const uint32_t want[] = { 0, 1, 2, 0, 3, 2, 1 };
	struct eco_string_pool texts = { 0 };
	for (size_t i = 0; i < sizeof given / sizeof *given; i++) {
		uint32_t number;
		assert_true(eco_string_pool_add(&texts, given[i], &number));
		assert_int_equal(number, want[i]);
		assert_string_equal(texts.items[number], given[i]);
	}
	assert_int_equal(texts.count, 4);
	eco_string_pool_free(&texts);
	assert_int_equal(texts.count, 0);
}

/* ---- Lists and texts for messages ---- */

UNIT_TEST(names_that_do_not_fit_are_counted)
{
	char list[48] = "";
	eco_phrase_add(list, sizeof list, "oak");
	eco_phrase_add(list, sizeof list, "ash and elm");
	assert_string_equal(list, "oak, ash and elm");
	eco_phrase_add(list, sizeof list, "a name that is too long for this list of names");
	assert_string_equal(list, "oak, ash and elm and 1 more");
	for (int i = 0; i < 11; i++)
		eco_phrase_add(list, sizeof list, "yew");
	assert_string_equal(list, "oak, ash and elm and 12 more");
	list[0] = 0;
	eco_phrase_add(list, sizeof list, "a name that is too long for this list of names");
	assert_string_equal(list, "1 more");
	eco_phrase_add(list, sizeof list, "oak");
	assert_string_equal(list, "2 more");
}

UNIT_TEST(errors_end_after_a_whole_word)
{
	struct eco_error error = { 0 };
	char words[3000];
	for (size_t i = 0; i < sizeof words - 1; i++)
		words[i] = "oaken "[i % 6];
	words[sizeof words - 1] = 0;
	eco_fail(&error, ECO_BAD_INPUT, "%s", words);
	size_t length = strlen(error.text);
	assert_true(length < sizeof error.text && length > sizeof error.text - 12);
	assert_string_equal(error.text + length - 10, " oaken ...");
	error.code = ECO_OK;
	eco_fail(&error, ECO_BAD_INPUT, "%.*s", (int)sizeof error.text - 1, words);
	assert_int_equal(strlen(error.text), sizeof error.text - 1);
	memset(words, 'x', sizeof words - 1);
	error.code = ECO_OK;
	eco_fail(&error, ECO_BAD_INPUT, "%s", words);
	assert_string_equal(error.text + strlen(error.text) - 5, "x ...");
}
