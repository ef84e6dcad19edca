/* Sizes of plants from others of theirs. Results depend on exp and log, and are rounded where they are stored. */
#include "ecofiles/import/places/growth.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "build/words/crowns.table"
#include "build/words/heights.table"

#define COUNT(table) (sizeof(table) / sizeof *(table))
#define BREAST_M 1.3
#define PLANTED_M 1.5
#define CROWN_FROM_CM 12.7       /* below it no crown was measured: a line to CROWN_LEAST_M */
#define CROWN_LEAST_M 0.5

/* The row of the form; unknown forms have the last. */
static size_t form_row(enum eco_form form)
{
	size_t i = 0;
	while (i + 1 < COUNT(heights_rows) && strcmp(heights_rows[i].form, eco_form_names[form]) != 0)
		i++;
	return i;
}

static double greatest(const struct eco_flora *flora)
{
	double height_m = flora->height_m > 0 ? flora->height_m : heights_rows[form_row(flora->form)].height_m;
	return fmax(height_m, BREAST_M + 0.2);
}

double eco_growth_height(const struct eco_flora *flora, double dbh_m)
{
	double above = greatest(flora) - BREAST_M;
	return BREAST_M + above * (1 - exp(-heights_rows[form_row(flora->form)].slope * dbh_m / above));
}

double eco_growth_height_at(const struct eco_flora *flora, double years)
{
	size_t row = form_row(flora->form);
	double most = fmax(heights_rows[row].share * greatest(flora), 0.1), planted = fmin(PLANTED_M, 0.5 * most);
	return planted + (most - planted) * (1 - exp(-heights_rows[row].rate * fmax(years, 0)));
}

double eco_growth_trunk(const struct eco_flora *flora, double height_m)
{
	double above = greatest(flora) - BREAST_M, share = fmin((height_m - BREAST_M) / above, 0.95);
	return share <= 0 ? 0 : -log(1 - share) * above / heights_rows[form_row(flora->form)].slope;
}

/* The row of a species, else of its genus, else of its form; COUNT(crowns_rows): none. */
static size_t crown_row(const struct eco_flora *flora)
{
	char species[96];
	snprintf(species, sizeof species, "%s %s", flora->genus ? flora->genus : "", flora->epithet);
	const char *const names[] = { species, flora->genus ? flora->genus : "", eco_form_names[flora->form] };
	bool usual = flora->form == ECO_FORM_BROAD || flora->form == ECO_FORM_CONIFER;
	for (size_t k = 0; usual && k < 3; k++)
		for (size_t i = 0; i < COUNT(crowns_rows); i++)
			if (strcmp(crowns_rows[i].taxon, names[k]) == 0)
				return i;
	return COUNT(crowns_rows);
}

static double curve(size_t row, double cm)
{
	double d = fmin(cm, crowns_rows[row].most_cm);
	return crowns_rows[row].a_m + d * (crowns_rows[row].b + d * crowns_rows[row].c);
}

double eco_growth_crown(const struct eco_flora *flora, double height_m, double dbh_m)
{
	size_t row = crown_row(flora);
	if (row == COUNT(crowns_rows))
		return height_m * heights_rows[form_row(flora->form)].slender;
	double cm = 100 * (isnan(dbh_m) ? eco_growth_trunk(flora, height_m) : dbh_m);
	if (cm >= CROWN_FROM_CM)
		return curve(row, cm);
	return CROWN_LEAST_M + (curve(row, CROWN_FROM_CM) - CROWN_LEAST_M) * cm / CROWN_FROM_CM;
}
