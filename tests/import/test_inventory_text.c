/* Texts of tables, as people write them in several countries. */
#include <math.h>
#include <string.h>

#include "ecofiles/import/places/inventory_text.h"
#include "tests/support/unit_test.h"

UNIT_TEST(case_and_spaces_do_not_count)
{
	static const char *const pairs[][2] = { { " Tilia  CORDATA ", "tilia cordata" },
		{ "ÄHRE Öl Über", "ähre öl über" }, { "ÉRABLE", "érable" },
		{ "ДУБ Ёлка", "дуб ёлка" }, { "ΔΡΥΣ", "δρυσ" }, { "ŠŽČ Łódź", "šžč łódź" },
		{ "a\u00a0\u2009b", "a b" }, { "×", "×" },
		{ "Quercus robur 'Fastigiata'", "quercus robur 'fastigiata'" } };
	char folded[64];
	for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++) {
		assert_int_equal(eco_text_fold(pairs[i][0], folded, sizeof folded), strlen(pairs[i][1]));
		assert_string_equal(folded, pairs[i][1]);
	}
	for (size_t size = 1; size < 12; size++) {
		memset(folded, 'x', sizeof folded);
		assert_true(eco_text_fold("Ä b ÜÖ  c", folded, size) < size && strlen(folded) < size
			&& folded[size] == 'x');
	}
}

UNIT_TEST(numbers_have_one_meaning_or_none)
{
	static const struct { const char *text; char decimal; double number; } cases[] =
		{ { "1.5", '.', 1.5 }, { " 1.5 ", '.', 1.5 }, { "+2", '.', 2 },
		{ "-.5", '.', -0.5 }, { "5.", '.', 5 }, { "1e3", '.', 1000 }, { "1.5E-2", '.', 0.015 },
		{ "1,234.5", '.', 1234.5 },
		{ "1,234,567", '.', 1234567 }, { "1,5", '.', NAN }, { "1,234", '.', NAN },
		{ "1.2.3", '.', NAN }, { "12,34.5", '.', NAN }, { "5 334 000", '.', 5334000 },
		{ "691\u00a0234,5", ',', 691234.5 }, { "691\u202f234.5", '.', 691234.5 },
		{ "2'600'000", '.', 2600000 }, { "2\u20191234", '.', NAN }, { "1234 567", '.', NAN },
		{ "1 234,567", '.', NAN }, { "12 34", '.', NAN }, { "-1 234 ", '.', -1234 },
		{ "1,5", ',', 1.5 },
		{ "1.234,5", ',', 1234.5 }, { "1.234.567,25", ',', 1234567.25 },
		{ "565123.45", ',', 565123.45 }, { "565123,45", ',', 565123.45 },
		{ "-0,5", ',', -0.5 }, { "3", ',', 3 }, { "1.234.567", ',', 1234567 }, { "0x10", '.', NAN },
		{ "inf", '.', NAN }, { "nan", '.', NAN },
		{ "1e999", '.', NAN }, { "", '.', NAN }, { "12m", '.', NAN }, { "1 2", '.', NAN },
		{ "--1", '.', NAN }, { "e5", '.', NAN }, { ",", ',', NAN },
		{ ".", '.', NAN }, { "1e", '.', NAN },
		{ "40\u00b024'36\"N", '.', 40.41 }, { "3\u00b0 42' 0,0\" W", ',', -3.7 },
		{ "-3\u00ba30\u2032", '.', -3.5 }, { "S 33.5\u00b0", '.', -33.5 },
		{ "-0\u00b030'", '.', -0.5 }, { "12\u00b0", '.', 12 }, { "40\u00b060'", '.', NAN },
		{ "40\u00b0 24", '.', NAN }, { "40\u00b024'36\"X", '.', NAN }, { "N 40\u00b0 S", '.', NAN },
		{ "-40\u00b0S", '.', NAN },
		{ "40\u00b0-5'", '.', NAN }, { "N40", '.', NAN }, { "5'", '.', NAN },
		{ "12345678901234567890123456789012345678901234567890123456789012345", '.', NAN } };

	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		double number = NAN;
		bool good = eco_text_number(cases[i].text, cases[i].decimal, &number);
		if (good == isnan(cases[i].number) || (good && number != cases[i].number))
			fail_msg("\"%s\" with '%c' is %g", cases[i].text, cases[i].decimal,
				good ? number : NAN);
	}
}

UNIT_TEST(a_sign_between_thousands_may_be_lone)
{
	static const struct { const char *text; char thousands; double number; } cases[] = { { "691,234", ',',
		691234 }, { "5,334,000", ',', 5334000 }, { "691,234.5", ',', 691234.5 }, { "-691.234", '.',
		-691234 }, { "5.334.000,25", '.', 5334000.25 }, { "691", ',', NAN }, { "691,23", ',', NAN },
		{ "0,512", ',', NAN }, { "1234,567", ',', NAN }, { "1,234,56", ',', NAN }, { "1.5,234", ',',
		NAN }, { "691,234", '.', NAN }, { ",234", ',', NAN }, { "1,234m", ',', NAN } };
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		double number = NAN;
		bool good = eco_text_grouped(cases[i].text, cases[i].thousands, &number);
		if (good == isnan(cases[i].number) || (good && number != cases[i].number))
			fail_msg("\"%s\" is %g", cases[i].text, good ? number : NAN);
	}
}

UNIT_TEST(sizes_are_numbers_ranges_and_bounds)
{
	static const struct { const char *text; char decimal; enum eco_size_form form; double number, unit_m;
		} cases[] = {
		{ "12.5", '.', ECO_FORM_EXACT, 12.5, 0 }, { "12,5", ',', ECO_FORM_EXACT, 12.5, 0 },
			{ "12.5 m", '.', ECO_FORM_EXACT, 12.5, 1 },
		{ "12.5m", '.', ECO_FORM_EXACT, 12.5, 1 }, { "45 cm", '.', ECO_FORM_EXACT, 45, 0.01 },
		{ "30 ft.", '.', ECO_FORM_EXACT, 30, 0.3048 },
		{ "40'", '.', ECO_FORM_EXACT, 40, 0.3048 }, { "12\"", '.', ECO_FORM_EXACT, 12, 0.0254 },
		{ "5'6\"", '.', ECO_FORM_EXACT, 5.5, 0.3048 },
		{ "5 ft 6 in", '.', ECO_FORM_EXACT, 5.5, 0.3048 },
		{ "5\u20326\u2033", '.', ECO_FORM_EXACT, 5.5, 0.3048 },
		{ "7 Inches", '.', ECO_FORM_EXACT, 7, 0.0254 },
		{ "21 to 30", '.', ECO_FORM_RANGE, 25.5, 0 }, { "21-30", '.', ECO_FORM_RANGE, 25.5, 0 },
		{ "21 \u2013 30 ft", '.', ECO_FORM_RANGE, 25.5,
			0.3048 },
		{ "5 bis 10 m", ',', ECO_FORM_RANGE, 7.5, 1 }, { "10 à 20 m", ',', ECO_FORM_RANGE, 15, 1 },
		{ "de 10 m à 20 m", ',', ECO_FORM_RANGE, 15, 1 },
		{ "0,5-1,5", ',', ECO_FORM_RANGE, 1, 0 }, { "0-3", '.', ECO_FORM_RANGE, 1.5, 0 },
		{ "< 10", '.', ECO_FORM_RANGE, 5, 0 },
		{ "unter 5 m", ',', ECO_FORM_RANGE, 2.5, 1 },
		{ "Greater than 101", '.', ECO_FORM_OPEN, 101, 0 }, { "> 101", '.', ECO_FORM_OPEN, 101, 0 },
		{ ">=20m", '.', ECO_FORM_OPEN, 20, 1 }, { "101+", '.', ECO_FORM_OPEN, 101, 0 },
		{ "20 m et plus", ',', ECO_FORM_OPEN, 20, 1 },
		{ "über 25 m", ',', ECO_FORM_OPEN, 25, 1 }, { "Plus de 20 m", ',', ECO_FORM_OPEN, 20, 1 },
		{ "ca. 15 m", ',', ECO_FORM_EXACT, 15, 1 },
		{ "~12", '.', ECO_FORM_EXACT, 12, 0 }, { "(10-15]", '.', ECO_FORM_RANGE, 12.5, 0 },
		{ "10m-15m", '.', ECO_FORM_RANGE, 12.5, 1 },
		{ "N/A", '.', ECO_FORM_NONE, 0, 0 }, { "-5", '.', ECO_FORM_NONE, 0, 0 },
		{ "30 to 21", '.', ECO_FORM_NONE, 0, 0 },
		{ "5 kg", '.', ECO_FORM_NONE, 0, 0 },
		{ "10 m - 20 ft", '.', ECO_FORM_NONE, 0, 0 }, { "tall", '.', ECO_FORM_NONE, 0, 0 },
		{ "", '.', ECO_FORM_NONE, 0, 0 },
		{ "12 12", '.', ECO_FORM_NONE, 0, 0 }, { "1,5", '.', ECO_FORM_NONE, 0, 0 },
		{ "2021-05-03", '.', ECO_FORM_NONE, 0, 0 },
		{ "3 meter", '.', ECO_FORM_EXACT, 3, 1 }, { "10 Fuß", '.', ECO_FORM_EXACT, 10, 0.3048 },
		{ "3 metros", '.', ECO_FORM_EXACT, 3, 1 },
		{ "between 10 and 20 ft", '.', ECO_FORM_RANGE, 15, 0.3048 },
		{ "30 à 40m", ',', ECO_FORM_RANGE, 35, 1 },
		{ "10..20", '.', ECO_FORM_RANGE, 15, 0 }, { "a. tot 6 m.", ',', ECO_FORM_RANGE, 3, 1 },
		{ "c. 9 tot 12 m.", ',', ECO_FORM_RANGE, 10.5, 1 },
		{ "2: 5-10 m", '.', ECO_FORM_RANGE, 7.5, 1 }, { "3. 10 - 15", '.', ECO_FORM_RANGE, 12.5, 0 },
		{ "Small (< 10 ft)", '.', ECO_FORM_RANGE, 5, 0.3048 },
		{ "Large (over 60')", '.', ECO_FORM_OPEN, 60, 0.3048 },
		{ "30' - 40'", '.', ECO_FORM_RANGE, 35, 0.3048 },
		{ "q. niet van toepassing", '.', ECO_FORM_NONE, 0, 0 }, { "Small", '.', ECO_FORM_NONE, 0, 0 },
		{ "12 (estimated)", '.', ECO_FORM_NONE, 0, 0 } };

	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		double number = 0, unit_m = 0;
		enum eco_size_form form = eco_text_size(cases[i].text, cases[i].decimal, &number, &unit_m);
		if (form != cases[i].form
				|| (form != ECO_FORM_NONE
				&& (fabs(number - cases[i].number) > 1e-12 || fabs(unit_m - cases[i].unit_m)
				> 1e-12)))
			fail_msg("\"%s\" is of form %d, %g in units of %g m", cases[i].text, form, number,
				unit_m);
	}
}
