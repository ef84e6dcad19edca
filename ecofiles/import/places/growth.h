/* Sizes of plants from others of theirs, by species, genus and form, in the open or in a stand: words/curves.tsv has
 * the curves, their ranges and sources. All lengths are in metres; beyond its range a curve is level. */
#pragma once

#include "ecofiles/import/places/flora.h"

struct eco_grower {
	const struct eco_flora *flora;       /* NULL: a plant of which nothing is known */
	bool stand;                  /* it grows in a stand, not in the open */
};

/* Height by the trunk's diameter at breast height. */
double eco_growth_height(struct eco_grower plant, double dbh_m);
/* Height by years since planting: that of the trunk of this age. */
double eco_growth_height_at(struct eco_grower plant, double years);
/* The crown's diameter by the trunk, dbh_m NaN: by the trunk of a plant of that height. If both are known the
 * plant grows between a stand and the open as its height lies between theirs; NaN: it is not measured. */
double eco_growth_crown(struct eco_grower plant, double height_m, double dbh_m);
/* Which curve gives its height: 0, 1, 2: its species', its genus's, its form's. */
unsigned eco_growth_rank(struct eco_grower plant);
