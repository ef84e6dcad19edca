/* Plants from an inventory: a stream of records.
 *
 *   eco_positions_open(&reader, &spec, &frame, &error);
 *   while (eco_positions_next(reader, &record, &error) == ECO_OK && record.plant != ECO_NONE) ...
 *   eco_positions_report(reader, say, ctx);          the table: rows, plants, rows left out by reason
 *   eco_positions_close(reader);
 *
 * A file is never loaded whole. An unusable row is counted by reason and skipped. A file that does not fit
 * its description (a missing column, an unknown CRS) is an error. A further format is one more struct
 * eco_rows (rows.h): columns by name, rows as texts, perhaps with a geometry; everything else is shared.
 * Files are read in a child process (guard.h), which runs beside the caller. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "ecofiles/import/places/inventory_text.h"
#include "ecofiles/import/places/tints.h"
#include "ecofiles/base/status.h"

#define ECO_SPECIES_BYTES 255u
#define ECO_SPECIES_COLUMNS 3u

struct eco_species {             /* a species, in which "*" is any text, and its plant */
	char *name;
	uint32_t plant, variant_count;       /* the first variant; ECO_NONE: left out on purpose */
};

/* h = 1.3 + (max_m - 1.3) (1 - exp(-rate * dbh))^shape, dbh in mm: Chapman and Richards; shape 1 is the
 * common two-parameter form. */
struct eco_allometry {
	uint32_t plant;              /* first variant; ECO_NONE: all plants without a rule of their own */
	double max_m, rate, shape;
};

enum eco_size_kind { ECO_SIZE_NONE, ECO_SIZE_NUMBER, ECO_SIZE_COLUMN, ECO_SIZE_DBH,
	ECO_SIZE_AGE,                /* of years; h = 1.5 + (max_m - 1.5) (1 - exp(-rate * age))^shape */
	ECO_SIZE_YEAR                /* of planting: `now` less it is the age */
};

#define ECO_CROWN_COLUMNS 4u
#define ECO_CELLS_MAX 8u

struct eco_size {                /* one source of a height or of a crown's radius */
	enum eco_size_kind kind;
	char *column;
	double value_m;              /* ECO_SIZE_NUMBER */
	double unit_m;               /* of the column, in metres */
	/* 0.5 from a crown's diameter to its radius, 1/pi from a girth to dbh, else 1 */
	double factor;
	struct eco_allometry *rules; /* ECO_SIZE_DBH, ascending by plant */
	uint32_t rule_count;
	/* curves of the row's species, genus and form (growth.h); unknown species grow by the rules, if there are any */
	bool by_species;
	double now;                  /* ECO_SIZE_YEAR */
	double spread;               /* heights from trunks and ages: evenly within 1 - spread to 1 + spread */
	bool is_area;                /* the radius of a disc of so many square units */
};

struct eco_crown {               /* of crowns' widths; all zero: not given */
	char *columns[ECO_CROWN_COLUMNS];    /* their mean counts; NULL: no more */
	double unit_m, factor;       /* 0.5 from a diameter to its radius */
	bool is_area;                /* the column holds areas, in square units */
	bool of_geometry;            /* also by the area of a row's polygon */
	bool by_species;             /* where no column says it */
	double spread;
	char *base;                  /* column of the height where crowns begin, or of their length over the plant's; NULL: none */
	double base_unit_m;
	bool base_is_ratio;          /* a share or per cent */
};

struct eco_polar {               /* a place by its bearing from x and y; azimuth NULL: it is x and y */
	char *azimuth, *distance;    /* columns; clockwise from north, horizontal */
	double whole_turn;           /* of the azimuth: 360 or 400 */
	double unit_m;               /* of the distance */
};

struct eco_quadrat {             /* x and y count from a corner of the quadrat; column NULL: they do not */
	char *column;                /* "0512": the sixth from the west, the thirteenth from the south */
	double size_m;
};

struct eco_positions_spec {      /* texts are owned by the spec's maker; NULL: not given */
	char *path, *layer;
	/* columns; x is easting or longitude, y northing or latitude; z: metres above the datum. x and y
	 * NULL: the file's geometry. z "geometry": its z */
	char *x, *y, *z;
	double unit_m;               /* of x and y; 0: not said, metres or the CRS's */
	struct eco_polar polar;      /* without x, y and geometry: from the scene's origin */
	struct eco_quadrat quadrat;
	char *crs, *vertical;        /* win over the file's */
	/* columns whose texts make the species, genus, epithet and cultivar; the first NULL: every row is
	 * `fallback` */
	char *species[ECO_SPECIES_COLUMNS];
	char *codes;                 /* the system of codes.tsv that the species use, or "letters"; NULL: names */
	char separator;              /* of a CSV; 0: found in its header */
	char decimal;                /* 0: '.'; or ',' */
	char thousands;              /* 0; or the other sign: it parts groups of coordinates, also a lone one */
	bool skip_duplicates;
	struct eco_species *map;     uint32_t map_count;
	/* "*", or the only plant; plant ECO_NONE and name NULL: unknown species are skipped */
	struct eco_species fallback;
	struct eco_filter *filters;  uint32_t filter_count;
	/* the first that gives one counts; none: the plant's */
	struct eco_size *heights;    uint32_t height_count;
	struct eco_crown crown;
	bool stand;                  /* guesses are by curves of plants in stands, not in the open */
	struct eco_tint tint;
	/* 0: as they are; else heights of a plant are brought to at most so many values */
	uint32_t levels;
	char *yaw_deg;               /* 0: unlimited; else at most so many heights per plant */
	char *scale;                 /* column; NULL: 1 */
	uint64_t seed;
	/* further columns, whose fields come with each record; files may lack some */
	const char *const *cells;    uint32_t cell_count;
	bool left_out;               /* hands out the places of rows that `filters` and the map leave out, and no others */
	uint32_t line, column;       /* in the scene file, for messages */
};

/* The frame of the records' coordinates. */
struct eco_frame {
	const char *crs;             /* the scene's; NULL: plain metres */
	const char *vertical;        /* datum of its heights; NULL: not stated, unless in a compound crs */
	double origin[3];
};

struct eco_position {
	/* as the row itself has it: UTF-8 without control characters, at most ECO_SPECIES_BYTES; "": it
	 * states none; NULL: no column does. Valid until the next call */
	const char *species;
	const char *tint;            /* the field of the tint's column, made fit and valid likewise; NULL: there is none */
	const char *cells[ECO_CELLS_MAX];    /* likewise, of the spec's cells; NULL: empty, or there is no such column */
	uint32_t plant;              /* a variant, by a hash of the row's number; ECO_NONE: end */
	uint32_t variant_first, variant_count;       /* the variants it was taken from */
	double at[3];                /* metres from the origin; z is 0 if the row has none */
	bool absolute;               /* at[2] counts from the origin, not from the ground */
	double yaw_deg;              /* counter-clockwise; NaN: not given */
	double height_m;             /* NaN: the plant's own, or by crown_radius_m */
	double crown_radius_m;       /* NaN: not known */
	bool crown_is_guess;         /* by the species */
	const char *height_from, *crown_from;        /* what a guess is made from, or "the model"; NULL: it is measured */
	double base;                 /* where the crown begins, as a share of the height; NaN: not known */
	double scale;                /* factor of the size; 1: not given */
	uint64_t row, line;          /* data row from 1; line where it begins, or feature */
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
	ECO_SKIP_REASONS,            /* the following are kept, but reported: */
	ECO_KEPT_NO_HEIGHT = ECO_SKIP_REASONS,       /* no usable height: the plant's own (or the crown's) */
	ECO_KEPT_BY_CROWN,           /* no usable height: the crown's radius decides */
	ECO_KEPT_RANGE,              /* a height, dbh or crown as a range: its middle */
	ECO_KEPT_OPEN,               /* "> 101": its bound */
	ECO_KEPT_STEMS,              /* several stems: one of the same area */
	ECO_KEPT_OTHER_UNIT,         /* a value with its own unit, which counts */
	ECO_KEPT_UNREAD,             /* no size in the text: the next source, else the plant's own */
	ECO_KEPT_UNUSED,
		            /* height beyond 0.01 to 300 m, dbh > 12 m, crown radius beyond 0.01 to 100 m: as UNREAD */
	ECO_KEPT_IMPLAUSIBLE,        /* height > 116 m, crown radius > 60 m */
	ECO_KEPT_DUPLICATE,          /* at the place of an earlier plant */
	ECO_SKIP_COUNT
};
const char *eco_skip_name(enum eco_skip reason);

struct eco_skipped {
	uint64_t count, first_line;
	char first_text[48];         /* the value there, shortened */
};

/* How the sizes of the plants became known. */
enum eco_sized { ECO_SIZED_MEASURED, ECO_SIZED_TRUNK, ECO_SIZED_AGE, ECO_SIZED_NUMBER, ECO_SIZED_NOT, ECO_SIZED_CROWN,
	ECO_SIZED_CROWN_GUESS,
	ECO_SIZED_BY_SPECIES, ECO_SIZED_BY_GENUS, ECO_SIZED_BY_FORM, /* rows with a guess, by whose curve */
	ECO_SIZED_COUNT };

#define ECO_UNKNOWN_MOST 5u      /* unknown species named */

/* Counts of the rows read so far. */
struct eco_positions_counts {
	uint64_t rows, plants;       /* data rows; records handed out */
	const struct eco_skipped *skipped;   /* [ECO_SKIP_COUNT] */
	/* [map_count + 1]: rows of each key (first_text: the species); last the fallback's */
	const struct eco_skipped *keys;
	const struct eco_skipped *filters;   /* [filter_count]: rows left out by each */
	struct eco_skipped unknown[ECO_UNKNOWN_MOST];        /* the commonest, most first; count 0: no more */
	uint32_t unknown_species;    /* number of different unknown species */
	const char *where;           /* unit of `line`: "line", "feature" */
	double low[2], high[2];      /* of the records' x and y; low > high: none */
};

struct eco_positions;

/* Opens and checks the file. `spec` and `frame` must outlive the reader. */
enum eco_code eco_positions_open(struct eco_positions **reader, const struct eco_positions_spec *spec,
	const struct eco_frame *frame, struct eco_error *error);
/* The next usable row; plant = ECO_NONE at the end. With `levels` the first call reads the whole file for
 * the heights. */
enum eco_code eco_positions_next(struct eco_positions *reader, struct eco_position *record,
	struct eco_error *error);
/* Rows seen so far, and ECO_SKIP_COUNT counters. */
const struct eco_skipped *eco_positions_skipped(const struct eco_positions *reader, uint64_t *rows);
void eco_positions_counted(const struct eco_positions *reader, struct eco_positions_counts *counts);
/* Reports through `say`, a line per call without line ends: first guesses and notes, then the table. */
void eco_positions_report(const struct eco_positions *reader, void (*say)(void *ctx, const char *text),
	void *ctx);
/* Does the file have the column of a cell of the spec? */
bool eco_positions_has_cell(const struct eco_positions *reader, uint32_t cell);
/* Are the records' lines those of a text, not numbers of features? */
bool eco_positions_has_lines(const struct eco_positions *reader);
void eco_positions_close(struct eco_positions *reader);
