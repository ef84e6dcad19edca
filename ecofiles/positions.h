/* Where plants stand, from an inventory: a stream of records.
 *
 *   eco_positions_open(&reader, &spec, &frame, &error);
 *   while (eco_positions_next(reader, &record, &error) == ECO_OK && record.plant != ECO_NONE) ...
 *   eco_positions_skipped(reader, ...);              what was left out, and why
 *   eco_positions_close(reader);
 *
 * A file is never loaded whole. A row that says nothing usable is counted by reason and passed over; a file that does not fit
 * its description (a column that is not there, a CRS that nobody knows) is an error. A further format is one more
 * struct eco_rows (rows.h): columns by name, rows as texts; all else is shared. */
#ifndef ECO_POSITIONS_H
#define ECO_POSITIONS_H

#include <stdbool.h>
#include <stdint.h>

#include "ecofiles/status.h"

enum eco_height_kind {
	ECO_HEIGHT_NONE,             /* the plant's own height */
	ECO_HEIGHT_NUMBER,           /* value_m for all */
	ECO_HEIGHT_COLUMN,           /* column * unit_m */
	ECO_HEIGHT_DBH               /* h = 1.3 + (max_m - 1.3) (1 - exp(-rate * dbh)), dbh = column * unit_m in mm, h to the millimetre */
};

struct eco_species {             /* a species string and its plant (the first of its variants); ECO_NONE: left out on purpose */
	char *name;
	uint32_t plant, variant_count;
};

struct eco_positions_spec {      /* texts are owned by whoever made it; NULL where not given */
	char *path;
	char *x, *y, *z;             /* columns; x is easting or longitude, y northing or latitude; z: metres above the datum */
	char *crs;
	char *species;               /* column; NULL: every row is `fallback` */
	char separator;              /* of a CSV; 0: ',' */
	struct eco_species *map;     uint32_t map_count;
	struct eco_species fallback; /* "*", or the only plant; plant ECO_NONE and name NULL: unknown species are skipped */
	enum eco_height_kind height;
	char *height_column;
	double height_value_m, unit_m, max_m, rate;
	uint32_t levels;             /* 0: as they are; else heights of a plant are brought to at most so many values */
	char *yaw_deg;               /* column; NULL: random, by `seed` and the row's number */
	uint64_t seed;
	uint32_t line, column;       /* where the scene file says so, for messages */
};

/* The coordinates that records are wanted in. */
struct eco_frame {
	const char *crs;             /* of the scene; NULL: plain metres */
	double origin[3];
};

struct eco_position {
	uint32_t plant;              /* ECO_NONE: no more rows */
	double at[3];                /* metres from the origin; z is 0 where there is no z column */
	bool absolute;               /* at[2] counts from the origin, not from the ground */
	double yaw_deg;              /* counter-clockwise */
	double height_m;             /* NaN: the plant's own height */
	uint64_t row, line;          /* data row from 1; line of the file where it begins */
};

enum eco_skip {
	ECO_SKIP_NO_COORDINATES,     /* empty or NA */
	ECO_SKIP_BAD_NUMBER,         /* a coordinate that is no number */
	ECO_SKIP_OUTSIDE,            /* cannot be converted to the scene's CRS, or lies beyond 10,000 km of the origin */
	ECO_SKIP_UNKNOWN_SPECIES,    /* not in the map, and the map has no "*" */
	ECO_SKIP_LEFT_OUT,           /* the map says null */
	ECO_SKIP_SHORT_ROW,          /* fewer fields than columns that are needed */
	ECO_SKIP_NO_HEIGHT,          /* NOT skipped: no usable height, so the plant's own */
	ECO_SKIP_COUNT
};
extern const char *const eco_skip_names[ECO_SKIP_COUNT];

struct eco_skipped {
	uint64_t count, first_line;
	char first_text[48];         /* what stood there, shortened */
};

struct eco_positions;

/* Opens and checks; with `levels` it reads the file once for the heights. `spec` and `frame` must outlive the reader. */
enum eco_code eco_positions_open(struct eco_positions **reader, const struct eco_positions_spec *spec,
	const struct eco_frame *frame, struct eco_error *error);
/* The next usable row; plant = ECO_NONE at the end. */
enum eco_code eco_positions_next(struct eco_positions *reader, struct eco_position *record, struct eco_error *error);
/* Rows seen so far, and ECO_SKIP_COUNT counters. */
const struct eco_skipped *eco_positions_skipped(const struct eco_positions *reader, uint64_t *rows);
void eco_positions_close(struct eco_positions *reader);

#endif
