/* Valid UTF-8, byte by byte. */
#include <stdio.h>
#include <string.h>

#include "ecofiles/base/text.h"
#include "tests/support/unit_test.h"

UNIT_TEST(characters_have_one_form)
{
	static const struct { const char *text; size_t size, bytes; } cases[] = {
		{ "", 0, 0 }, { "", 1, 0 }, { "oak", 3, 1 }, { "\x7F", 1, 1 }, { "\x80", 1, 0 },
			{ "\xC1\xBF", 2, 0 }, { "\xC2\x80", 2, 2 }, { "\xC2\x80", 1, 0 },
		{ "\xDF\xBF", 2, 2 }, { "\xDF\xC0", 2, 0 }, { "\xE0\x9F\xBF", 3, 0 },
		{ "\xE0\xA0\x80", 3, 3 }, { "\xE0\xA0\x80", 2, 0 }, { "\xED\x9F\xBF", 3, 3 },
		{ "\xED\xA0\x80", 3, 0 }, { "\xEF\xBF\xBF", 3, 3 }, { "\xEF\xBF\x7F", 3, 0 },
		{ "\xF0\x8F\xBF\xBF", 4, 0 }, { "\xF0\x90\x80\x80", 4, 4 },
		{ "\xF4\x8F\xBF\xBF", 4, 4 }, { "\xF4\x90\x80\x80", 4, 0 }, { "\xF5\x80\x80\x80", 4, 0 },
		{ "\xFF", 1, 0 },
	};
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
		assert_int_equal(eco_utf8_bytes(cases[i].text, cases[i].size), cases[i].bytes);
	assert_true(eco_utf8_valid("", 0) && eco_utf8_valid("W\xC3\xA4ldchen", 9));
	assert_false(eco_utf8_valid("a\0b", 3) || eco_utf8_valid("W\xE4ldchen", 8));
}

UNIT_TEST(some_characters_are_not_printed)
{
	static const struct { const char *text; uint32_t code; bool printable; } cases[] = { { "a", 'a', true },
		{ "\n", 10, false }, { "\x7F", 0x7f, false }, { "\xC2\x85", 0x85, false },
		{ "\xC2\x9B", 0x9b, false }, { "\xC2\xA0", 0xa0, true }, { "\xC3\xA4", 0xe4, true },
		{ "\xD8\x9C", 0x61c, false }, { "\xE2\x80\x8E", 0x200e, false },
		{ "\xE2\x80\xA8", 0x2028, false }, { "\xE2\x80\xAE", 0x202e, false },
		{ "\xE2\x80\xAF", 0x202f, true }, { "\xE2\x81\xA6", 0x2066, false },
		{ "\xF0\x9F\x8C\xB2", 0x1f332, true } };
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		assert_int_equal(eco_utf8_code(cases[i].text, strlen(cases[i].text)), cases[i].code);
		assert_int_equal(eco_utf8_printable(cases[i].code), cases[i].printable);
	}
	assert_false(eco_utf8_printable(eco_utf8_code("", 0)));
}

UNIT_TEST(characters_that_steer_are_known)
{
	static const struct { const char *text; size_t bytes; } cases[] = {
		{ "", 0 }, { "a", 0 }, { " ", 0 }, { "\n", 1 }, { "\x1f", 1 }, { "\x7f", 1 }, { "\x9b", 0 },
		{ "\xc2\x80", 2 }, { "\xc2\x9b", 2 }, { "\xc2\x9f", 2 }, { "\u00a0", 0 }, { "\u00e4", 0 },
		{ "\u061c", 2 }, { "\u061b", 0 }, { "\u200d", 0 }, { "\u200e", 3 }, { "\u200f", 3 },
		{ "\u2010", 0 }, { "\u2027", 0 }, { "\u2028", 3 }, { "\u2029", 3 }, { "\u202a", 3 },
		{ "\u202e", 3 }, { "\u202f", 0 }, { "\u2065", 0 }, { "\u2066", 3 }, { "\u2069", 3 },
		{ "\u206a", 0 }, { "\u6728", 0 } };
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		size_t size = strlen(cases[i].text);
		char text[16];
		assert_int_equal(eco_utf8_control(cases[i].text, size), cases[i].bytes);
		snprintf(text, sizeof text, "oak%s-", cases[i].text);
		assert_int_equal(eco_utf8_has_control(text, strlen(text)), cases[i].bytes > 0);
		eco_utf8_tame(text, "", '?');
		assert_int_equal(strcspn(text, "?"), cases[i].bytes ? 3 : strlen(text));
		assert_int_equal(strspn(text + 3, "?"), cases[i].bytes);
	}
	char kept[] = "a\n\tb\x1b";
	eco_utf8_tame(kept, "\n\t", '?');
	assert_string_equal(kept, "a\n\tb?");
}

UNIT_TEST(names_are_cut_between_characters)
{
	static const struct { const char *text; size_t most, kept; } cases[] = {
		{ "", 9, 0 }, { "oak", 9, 3 }, { "oak", 3, 3 }, { "oak", 2, 2 }, { "oak", 0, 0 },
			{ "\xC3\xA4\xC3\xA4", 4, 4 }, { "\xC3\xA4\xC3\xA4", 3, 2 },
		{ "\xC3\xA4", 1, 0 }, { "a\xE4s", 9, 1 }, { "\xE4", 9, 0 }, { "a\xC3", 9, 1 },
		{ "\xF0\x9F\x8C\xB2", 4, 4 }, { "\xF0\x9F\x8C\xB2", 3, 0 },
	};
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
		assert_int_equal(eco_utf8_cut(cases[i].text, strlen(cases[i].text), cases[i].most),
			cases[i].kept);
}
