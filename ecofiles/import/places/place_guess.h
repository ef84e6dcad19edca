/* The places of a table's plants: the CRS of its numbers, and the scene's CRS and origin that suit them. */
#pragma once

#include "ecofiles/import/places/gis_files.h"
#include "ecofiles/import/places/table_columns.h"

struct eco_offsets {
	bool polar;                  /* x and y, if there are, are the plots' centres */
	double whole_turn;           /* 360 or 400 */
	const char *distance_unit;
	double quadrat_m;            /* 0: x and y count from one point */
};

/* ECO_BAD_INPUT, with the columns to add: plants of several plots have no centre; the quadrats that are
 * meant do not show; or many rows share each x and y, unless the user `said` these columns. A plant's own
 * place counts more than an azimuth. */
enum eco_code eco_offsets_find(struct eco_offsets *offsets, const struct eco_table *table,
	const struct eco_columns *columns, bool said, struct eco_error *error);

#define ECO_WHY_BYTES 300u

struct eco_place_asked {         /* what the user says wins; NULL: nothing */
	const struct eco_table *table;
	const struct eco_rows_source *source;        /* of the table */
	const struct eco_columns *columns;
	const char *crs, *scene_crs;
	bool axes_said;              /* which column is x and which is y */
	const struct eco_raster_extent *dem;
};

struct eco_place_guess {
	bool from_geometry;          /* the file's points; x and y are no columns */
	bool swapped;                /* x and y of the columns are to change places */
	const char *unit;            /* of the columns x and y of a plot: "m", "ft", ... */
	struct eco_offsets offsets;
	bool stand;                  /* the plants stand as close as in a wood */
	double per_ha;               /* plants, over the box of all but the outermost; 0: in plots of surveyors */
	bool file_says;              /* the file states its CRS, so the entry need not */
	char crs[32];                /* of the numbers; "": plain metres, or as the file says */
	char scene_crs[32];          /* "": plain metres */
	char dem_crs[32];            /* "": the raster says its own, or there is none */
	double origin[2], degrees[2];        /* in the scene's CRS; NaN: nowhere on Earth */
	char crs_why[ECO_WHY_BYTES], scene_why[ECO_WHY_BYTES], origin_why[ECO_WHY_BYTES];
};

/* ECO_BAD_INPUT where several CRSs are equally good: it names them, and --crs; or both ways of its axes: it
 * names --x and --y. */
enum eco_code eco_place_guess(struct eco_place_guess *guess, const struct eco_place_asked *asked,
	struct eco_error *error);
