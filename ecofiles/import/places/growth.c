/* Sizes of plants from others of theirs. The curves are tables of values, so that no libm decides. */
#include "ecofiles/import/places/growth.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "build/words/curves.table"

#define COUNT(table) (sizeof(table) / sizeof *(table))

enum curve { HEIGHT, CROWN, TRUNK };

/* Centimetres or years of a row's values. */
static const double places[] = { 0, 5, 10, 15, 20, 30, 40, 50, 60, 80, 100, 120, 150 };

static int compare_curve(const void *key, const void *row)
{
	return strcmp(key, *(const char *const *)row);
}

/* The row of a plant; COUNT(curves_rows): none. */
static size_t named(enum curve curve, bool stand, const char *genus, const char *epithet)
{
	static const char *const names[] = { "height", "crown", "trunk" };
	char key[128];
	snprintf(key, sizeof key, "%s %s %s%s%s", stand ? "stand" : "open", names[curve], genus,
		*epithet ? " " : "", epithet);
	const void *row = bsearch(key, curves_rows, COUNT(curves_rows), sizeof *curves_rows, compare_curve);
	return row ? (size_t)((const char *)row - (const char *)curves_rows) / sizeof *curves_rows
		   : COUNT(curves_rows);
}

/* The row that serves a plant, *rank as eco_growth_rank. A species that grows as trees of its genus do not
 * has the crown of its form. */
static size_t row_of(struct eco_grower plant, enum curve curve, unsigned *rank)
{
	const struct eco_flora *flora = plant.flora;
	enum eco_form form = flora ? flora->form : ECO_FORM_UNKNOWN;
	bool own = curve != CROWN || form == ECO_FORM_BROAD || form == ECO_FORM_CONIFER;
	size_t row = COUNT(curves_rows);
	for (unsigned other = 0; other < 2; other++)
		for (*rank = 0; *rank < 2 && own && flora && flora->genus; ++*rank) {
			row = named(curve, plant.stand != other, flora->genus,
				*rank == 0 ? flora->epithet : "");
			if (row < COUNT(curves_rows) && (*rank == 1 || flora->epithet[0] != 0))
				return row;
		}
	*rank = 2;
	row = named(curve, plant.stand, eco_form_names[form], "");
	return row < COUNT(curves_rows) ? row : named(curve, false, eco_form_names[form], "");
}

unsigned eco_growth_rank(struct eco_grower plant)
{
	unsigned rank;
	row_of(plant, HEIGHT, &rank);
	return rank;
}

/* The value at a place, or with `inverse` the place of a value, between the two of the row beside it. */
static double between(const char *values, double by, bool inverse)
{
	double x = 0, y = 0;
	char *end;
	for (size_t i = 0; i < COUNT(places) && *values; i++, values = end) {
		double x1 = places[i], y1 = strtod(values, &end);
		double from = inverse ? y : x, to = inverse ? y1 : x1, low = inverse ? x : y,
		       high = inverse ? x1 : y1;
		if (by <= to)
			return i == 0 || to <= from ? high : low + (high - low) * (by - from) / (to - from);
		x = x1;
		y = y1;
	}
	return inverse ? x : y;
}

/* Both axes are as much longer as the plant's greatest height is greater than that of those that were measured. */
static double follow(struct eco_grower plant, enum curve curve, double by, bool inverse)
{
	unsigned rank;
	size_t row = row_of(plant, curve, &rank);
	const char *values = curves_rows[row].values;
	double most = plant.flora ? plant.flora->height_m : 0, measured = curves_rows[row].height_m;
	double times = most > 0 && measured > 0 ? most / measured : 1, first = strtod(values, NULL);
	if (inverse)
		return times * between(values, first + (by - first) / times, true);
	return first + times * (between(values, by / times, false) - first);
}

double eco_growth_height(struct eco_grower plant, double dbh_m)
{
	return follow(plant, HEIGHT, 100 * dbh_m, false);
}

double eco_growth_height_at(struct eco_grower plant, double years)
{
	return follow(plant, HEIGHT, follow(plant, TRUNK, years, false), false);
}

double eco_growth_crown(struct eco_grower plant, double height_m, double dbh_m)
{
	struct eco_grower open = { plant.flora, false }, stand = { plant.flora, true };
	if (isnan(dbh_m))
		return follow(plant, CROWN, follow(plant, HEIGHT, height_m, true), false);
	double low_m = eco_growth_height(open, dbh_m), high_m = eco_growth_height(stand, dbh_m),
	       wide_m = follow(open, CROWN, 100 * dbh_m, false);
	if (isnan(height_m) || !(high_m > low_m))
		return follow(plant, CROWN, 100 * dbh_m, false);
	double share = fmin(fmax((height_m - low_m) / (high_m - low_m), 0), 1);
	return wide_m + share * (follow(stand, CROWN, 100 * dbh_m, false) - wide_m);
}
