/* Importance from colours: what few leaves have and most differ from. */
#include <string.h>

#include "lod/build/salience.h"
#include "tests/support/unit_test.h"

static struct lod_salience plant;

static const uint8_t green[3] = { 76, 110, 40 }, light_green[3] = { 110, 150, 60 },
	white[3] = { 240, 240, 235 }, red[3] = { 200, 40, 40 }, yellow[3] = { 250, 210, 30 };

static double importance(const uint8_t rgb[3])
{
	struct lod_tone group = { 0 };
	lod_tone_add(&group, rgb, 1);
	return lod_salience_of(&plant, &group);
}

static void grow(const uint8_t leaf[3], double leaves, const uint8_t petal[3], double petals)
{
	memset(&plant, 0, sizeof plant);
	lod_salience_add(&plant, leaf, leaves);
	lod_salience_add(&plant, petal, petals);
}

UNIT_TEST(rare_clear_colours_stand_out)
{
	const uint8_t *const petals[] = { white, red, yellow };
	for (int i = 0; i < 3; i++) {
		grow(green, 10, petals[i], 0.5);
		assert_true(importance(petals[i]) > 1.4 && importance(petals[i]) <= LOD_SALIENCE_MOST);
		assert_true(importance(green) == 1);
	}
}

UNIT_TEST(shades_of_one_colour_do_not)
{
	grow(green, 10, light_green, 1);
	assert_true(importance(light_green) == 1 && importance(green) == 1);
}

UNIT_TEST(the_more_it_differs_and_the_rarer_it_is_the_more_it_counts)
{
	double last = 10;
	for (double petals = 0.1; petals < 30; petals *= 2) {
		grow(green, 10, red, petals);
		assert_true(importance(red) <= last && importance(red) >= 1);
		last = importance(red);
	}
	assert_true(last == 1);
	grow(green, 10, white, 0.5);
	lod_salience_add(&plant, red, 0.5);
	assert_true(importance(red) > importance(white) && importance(white) > 1);
}

UNIT_TEST(half_and_half_has_no_majority)
{
	grow(green, 5, red, 5);
	assert_true(importance(red) == 1 && importance(green) == 1);
	memset(&plant, 0, sizeof plant);
	assert_true(importance(red) == 1);
}
