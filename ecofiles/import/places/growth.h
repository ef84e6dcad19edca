/* Sizes of plants from others of theirs, by species, genus and form: words/heights.tsv and words/crowns.tsv have the
 * curves and their sources. All lengths are in metres. */
#ifndef ECO_GROWTH_H
#define ECO_GROWTH_H

#include "ecofiles/import/places/flora.h"

/* Height by the trunk's diameter at breast height. */
double eco_growth_height(const struct eco_flora *flora, double dbh_m);
/* Height by years since planting. */
double eco_growth_height_at(const struct eco_flora *flora, double years);
/* The trunk's diameter of a plant of that height: the inverse of eco_growth_height, below the curve's end. */
double eco_growth_trunk(const struct eco_flora *flora, double height_m);
/* The crown's diameter by height and trunk; dbh_m NaN: by the trunk of that height. */
double eco_growth_crown(const struct eco_flora *flora, double height_m, double dbh_m);

#endif
