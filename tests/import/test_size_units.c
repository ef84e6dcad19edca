/* Units of heights and trunks, by names and by how numbers spread. */
#include <string.h>

#include "ecofiles/import/places/size_units.h"
#include "tests/support/unit_test.h"

#include <math.h>

UNIT_TEST(a_spread_has_the_quantiles_of_its_stream)
{
	struct eco_spread spread = { 0 };
	assert_true(isnan(eco_spread_quantile(&spread, 0.5)));
	for (int i = 0; i < 100000; i++)
		eco_spread_add(&spread, (i * 7919) % 100000);
	assert_int_equal(spread.seen, 100000);
	assert_true(spread.count <= ECO_SPREAD_KEPT);
	assert_true(fabs(eco_spread_quantile(&spread, 0.5) - 50000) < 1500);
	assert_true(fabs(eco_spread_quantile(&spread, 0.98) - 98000) < 1000);
	eco_spread_free(&spread);
}

static const struct {
	enum eco_quantity quantity;
	const char *name, *beside;
	double middle, high;
	const char *unit;
} guesses[] = {
	/* by the name */
	{ ECO_QUANTITY_HEIGHT, "Height (ft)", NULL, 35, 80, "ft" },
	{ ECO_QUANTITY_HEIGHT, "H\u00f6he_m", NULL, 12, 25, "m" },
	{ ECO_QUANTITY_HEIGHT, "height in m", NULL, 12, 25, "m" },
	{ ECO_QUANTITY_DBH, "dbh_mm", NULL, 30, 500, "mm" },
	{ ECO_QUANTITY_DBH, "Diameter [inches]", NULL, 10, 30, "in" },
	/* by the numbers */
	{ ECO_QUANTITY_HEIGHT, "height", NULL, 9, 22, "m" },
	{ ECO_QUANTITY_HEIGHT, "height", NULL, 40, 95, "ft" }, { ECO_QUANTITY_HEIGHT, "height", NULL, 29, 60, "ft" },
	{ ECO_QUANTITY_HEIGHT, "height", NULL, 24, 35, "m" },      /* a wood */
	{ ECO_QUANTITY_HEIGHT, "height", NULL, 850, 2200, "cm" },
	{ ECO_QUANTITY_HEIGHT, "height", NULL, 8500, 22000, "mm" },
	{ ECO_QUANTITY_DBH, "dbh", NULL, 28, 90, "cm" }, { ECO_QUANTITY_DBH, "dbh", NULL, 9, 30, "in" },
	{ ECO_QUANTITY_DBH, "dbh", NULL, 250, 800, "mm" }, { ECO_QUANTITY_DBH, "dbh", NULL, 0.25, 0.8, "m" },
	{ ECO_QUANTITY_GIRTH, "Umfang", NULL, 80, 250, "cm" },
	/* by the other sizes */
	{ ECO_QUANTITY_HEIGHT, "height", "cm", 29, 38, "m" }, { ECO_QUANTITY_HEIGHT, "height", "in", 29, 38, "ft" },
	{ ECO_QUANTITY_DBH, "dbh", "ft", 16, 45, "in" }, { ECO_QUANTITY_DBH, "dbh", "m", 16, 45, "cm" },
	/* not at all */
	{ ECO_QUANTITY_HEIGHT, "height", NULL, 18, 40, NULL },
	{ ECO_QUANTITY_DBH, "dbh", NULL, 15, 45, NULL },
	{ ECO_QUANTITY_HEIGHT, "height_m", NULL, 120, 150, NULL }, /* a height of 120 m is asked about */
	{ ECO_QUANTITY_HEIGHT, "height", NULL, 1, 1.6, NULL },     /* an oak of 1 m, too */
};

UNIT_TEST(units_are_those_of_plants_or_asked_for)
{
	for (size_t i = 0; i < sizeof guesses / sizeof *guesses; i++) {
		struct eco_unit_guess guess = eco_unit_guess(guesses[i].quantity, guesses[i].name,
			guesses[i].beside, &(struct eco_size_numbers){ guesses[i].middle, guesses[i].high });
		const char *unit = guess.unit ? guess.unit : "?",
			   *wanted = guesses[i].unit ? guesses[i].unit : "?";
		if (strcmp(unit, wanted) != 0 || guess.why[0] == 0 || (!guess.unit && !guess.other))
			fail_msg("%s of %g, %g: %s, not %s (%s)", guesses[i].name, guesses[i].middle, guesses[i].high,
				unit, wanted, guess.why);
	}
}

UNIT_TEST(a_stated_unit_is_doubted_only_where_it_cannot_be)
{
	const struct eco_size_numbers feet = { 40, 95 }, metres = { 12, 25 }, shrubs = { 1.2, 4 };
	assert_string_equal(eco_unit_doubt(ECO_QUANTITY_HEIGHT, 1, &feet), "ft");
	assert_null(eco_unit_doubt(ECO_QUANTITY_HEIGHT, 0.3048, &feet));
	assert_null(eco_unit_doubt(ECO_QUANTITY_HEIGHT, 1, &metres));
	assert_null(eco_unit_doubt(ECO_QUANTITY_HEIGHT, 1, &shrubs));
	assert_string_equal(eco_unit_doubt(ECO_QUANTITY_DBH, 0.001, &(struct eco_size_numbers){ 25, 80 }),
		"cm");
}
