/* Where plants stand, from an inventory: a stream of records.
 *
 *   eco_positions_open(&reader, &spec, &frame, &error);
 *   while (eco_positions_next(reader, &record, &error) == ECO_OK && record.plant != ECO_NONE) ...
 *   eco_positions_report(reader, say, ctx);          the table: rows, plants, what was left out and why
 *   eco_positions_close(reader);
 *
 * A file is never loaded whole. A row that says nothing usable is counted by reason and passed over; a file that does not fit
 * its description (a column that is not there, a CRS that nobody knows) is an error. A further format is one more
 * struct eco_rows (rows.h): columns by name, rows as texts, perhaps with a geometry; all else is shared. Files are read in a child
 * process (guard.h), which runs beside the caller. */
#ifndef ECO_POSITIONS_H
#define ECO_POSITIONS_H

#include <stdbool.h>
#include <stdint.h>

#include "ecofiles/import/places/filter.h"
#include "ecofiles/base/status.h"

struct eco_species {             /* a species, with "*" for any text, and its plant (the first of its variants) */
	char *name;
	uint32_t plant, variant_count;       /* plant ECO_NONE: left out on purpose */
};

/* h = 1.3 + (max_m - 1.3) (1 - exp(-rate * dbh))^shape, dbh in mm: Chapman and Richards; shape 1 is the common two-parameter form. */
struct eco_allometry {
	uint32_t plant;              /* first variant; ECO_NONE: of all plants without one of their own */
	double max_m, rate, shape;
};

enum eco_size_kind { ECO_SIZE_NONE, ECO_SIZE_NUMBER, ECO_SIZE_COLUMN, ECO_SIZE_DBH };

struct eco_size {                /* one place where a height, or a crown's radius, may come from */
	enum eco_size_kind kind;
	char *column;
	double value_m;              /* ECO_SIZE_NUMBER */
	double unit_m;               /* of the column, in metres */
	double factor;               /* 0.5 from a crown's diameter to its radius, 1/pi from a girth to dbh, else 1 */
	struct eco_allometry *rules; /* ECO_SIZE_DBH, ascending by plant */
	uint32_t rule_count;
};

struct eco_positions_spec {      /* texts are owned by whoever made it; NULL where not given */
	char *path, *layer;
	char *x, *y, *z;             /* columns; x is easting or longitude, y northing or latitude; z: metres above the datum.
	                              * x and y NULL: the file's geometry. z "geometry": that of the geometry */
	char *crs, *vertical;        /* win over what the file says */
	char *species;               /* column; NULL: every row is `fallback` */
	char separator;              /* of a CSV; 0: found in its header */
	char decimal;                /* 0: '.'; or ',' */
	bool skip_duplicates;
	struct eco_species *map;     uint32_t map_count;
	struct eco_species fallback; /* "*", or the only plant; plant ECO_NONE and name NULL: unknown species are skipped */
	struct eco_filter *filters;  uint32_t filter_count;
	struct eco_size *heights;    uint32_t height_count;      /* the first that gives one counts; none: the plant's own height */
	struct eco_size crown;       /* kind ECO_SIZE_NONE: not given */
	uint32_t levels;             /* 0: as they are; else heights of a plant are brought to at most so many values */
	char *yaw_deg;               /* column; NULL: random, by `seed` and the row's number */
	char *scale;                 /* column; NULL: 1 */
	uint64_t seed;
	uint32_t line, column;       /* where the scene file says so, for messages */
};

/* The coordinates that records are wanted in. */
struct eco_frame {
	const char *crs;             /* of the scene; NULL: plain metres */
	const char *vertical;        /* vertical datum of its heights; NULL: not stated, unless crs is a compound one */
	double origin[3];
};

struct eco_position {
	uint32_t plant;              /* ECO_NONE: no more rows; one of the variants, by a hash of the row's number */
	uint32_t variant_first, variant_count;       /* those it was taken from */
	double at[3];                /* metres from the origin; z is 0 where there is no z */
	bool absolute;               /* at[2] counts from the origin, not from the ground */
	double yaw_deg;              /* counter-clockwise */
	double height_m;             /* NaN: the plant's own height, or as crown_radius_m says */
	double crown_radius_m;       /* NaN: not known */
	double scale;                /* times all of that; 1 where not given */
	uint64_t row, line;          /* data row from 1; line of the file where it begins, or number of the feature */
};

enum eco_skip {
	ECO_SKIP_NO_COORDINATES,     /* empty or NA */
	ECO_SKIP_BAD_NUMBER,         /* a coordinate that is no number */
	ECO_SKIP_NO_GEOMETRY,        /* null or empty */
	ECO_SKIP_NOT_A_POINT,        /* a line, a polygon, ... */
	ECO_SKIP_NO_CONVERSION,      /* PROJ cannot convert it to the scene's CRS */
	ECO_SKIP_OUTSIDE,            /* beyond 10,000 km of the origin */
	ECO_SKIP_UNKNOWN_SPECIES,    /* not in the map, and the map has no "*" */
	ECO_SKIP_LEFT_OUT,           /* the map says null */
	ECO_SKIP_FILTERED,           /* "only" or "skip" */
	ECO_SKIP_DUPLICATE,          /* at the place of an earlier plant, and "duplicates" says skip */
	ECO_SKIP_SHORT_ROW,          /* fewer fields than columns that are needed */
	ECO_SKIP_REASONS,            /* what follows is NOT skipped, but said: */
	ECO_KEPT_NO_HEIGHT = ECO_SKIP_REASONS,       /* no usable height, so the plant's own (or the crown's) */
	ECO_KEPT_BY_CROWN,           /* no usable height, so the crown's radius decides */
	ECO_KEPT_RANGE,              /* a height, dbh or crown as a range: its middle */
	ECO_KEPT_OPEN,               /* "> 101": its bound */
	ECO_KEPT_OTHER_UNIT,         /* a value with a unit of its own, which counts */
	ECO_KEPT_UNREAD,             /* a text that says no size: the next source, else the plant's own */
	ECO_KEPT_IMPLAUSIBLE,        /* height > 150 m, dbh > 12 m, crown radius > 60 m */
	ECO_KEPT_DUPLICATE,          /* at the place of an earlier plant */
	ECO_SKIP_COUNT
};
extern const char *const eco_skip_names[ECO_SKIP_COUNT];

struct eco_skipped {
	uint64_t count, first_line;
	char first_text[48];         /* what stood there, shortened */
};

#define ECO_UNKNOWN_MOST 5u      /* unknown species that are named */

/* What was read so far. */
struct eco_positions_counts {
	uint64_t rows, plants;       /* data rows; records handed out */
	const struct eco_skipped *skipped;   /* [ECO_SKIP_COUNT] */
	const struct eco_skipped *keys;      /* [map_count + 1]: rows of each key of the map (first_text: the species), last those of the fallback */
	const struct eco_skipped *filters;   /* [filter_count]: rows that it left out */
	struct eco_skipped unknown[ECO_UNKNOWN_MOST];        /* most frequent unknown species, most first; count 0: no more */
	uint32_t unknown_species;    /* how many different ones */
	const char *where;           /* what `line` counts: "line", "feature" */
	double low[2], high[2];      /* of the records' x and y; low > high without any */
};

struct eco_positions;

/* Opens and checks. `spec` and `frame` must outlive the reader. */
enum eco_code eco_positions_open(struct eco_positions **reader, const struct eco_positions_spec *spec,
	const struct eco_frame *frame, struct eco_error *error);
/* The next usable row; plant = ECO_NONE at the end. With `levels` the first call reads the whole file for the heights. */
enum eco_code eco_positions_next(struct eco_positions *reader, struct eco_position *record, struct eco_error *error);
/* Rows seen so far, and ECO_SKIP_COUNT counters. */
const struct eco_skipped *eco_positions_skipped(const struct eco_positions *reader, uint64_t *rows);
void eco_positions_counted(const struct eco_positions *reader, struct eco_positions_counts *counts);
/* Says all of it: first what was guessed and noted, then a table, a line per call, without line ends. */
void eco_positions_report(const struct eco_positions *reader, void (*say)(void *ctx, const char *text), void *ctx);
void eco_positions_close(struct eco_positions *reader);

#endif
