/* Tables whose plants stand at an azimuth and a distance from a plot's centre, or within a quadrat that
 * another column names. */
#ifndef ECO_PLACE_OFFSETS_H
#define ECO_PLACE_OFFSETS_H

#include "ecofiles/import/places/table_columns.h"

struct eco_offsets {
	bool polar;                  /* x and y, if there are, are the plots' centres */
	double whole_turn;           /* 360 or 400 */
	const char *distance_unit;
	double quadrat_m;            /* 0: x and y count from one point */
};

/* ECO_BAD_INPUT where plants of several plots have no centre, or it does not show which quadrats are
 * meant: it says which columns to add. A plant's own place counts more than an azimuth. And where many
 * rows share each x and y, which so are no plants', unless the user `said` these columns. */
enum eco_code eco_offsets_find(struct eco_offsets *offsets, const struct eco_table *table,
	const struct eco_columns *columns, bool said, struct eco_error *error);

#endif
