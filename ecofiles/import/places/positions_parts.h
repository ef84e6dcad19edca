/* Shared by the files of the reader of inventories; private. */
#pragma once

#include <stddef.h>

#include "ecofiles/import/places/positions.h"
#include "ecofiles/import/places/crs.h"
#include "ecofiles/import/places/growth.h"
#include "ecofiles/import/places/rows/rows.h"

/* ---- Species (positions_species.c): the map's keys, and the key of each text met ---- */

/* `spec` must outlive it. */
struct eco_species_table *eco_species_open(const struct eco_positions_spec *spec);
/* The map's key for a text, which it counts: exact keys before wildcards, of these the one with most
 * literal characters, of equals the first; spec->map_count: none, so the fallback. */
uint32_t eco_species_find(struct eco_species_table *table, const char *text, uint64_t line);
/* The plant that a text names, remembered. Valid until the next call. */
const struct eco_flora *eco_species_flora(struct eco_species_table *table, const char *text);
void eco_species_counted(const struct eco_species_table *table, struct eco_positions_counts *counts);
void eco_species_close(struct eco_species_table *table);

/* ---- Levels (positions_species.c): few heights instead of many. A plant's heights are divided into classes
 * of equal ratio between the least and the greatest, and each becomes the mean of its class: the relative
 * error is bounded, and the few tall trees among many shrubs keep their height ---- */

struct eco_levels {              /* zero is empty; bin[cm]: first a count, then the class's height in cm */
	struct eco_plant_levels { uint32_t plant, *bin; } *plants;
	uint32_t count, room;
};

/* Counts a height of a plant (0.01 to 300 m). */
void eco_levels_count(struct eco_levels *levels, uint32_t plant, double height_m);
/* Makes at most `count` heights for each plant; call it after all were counted. */
void eco_levels_make(struct eco_levels *levels, uint32_t count);
/* The height of the class of height_m, in metres; height_m itself if there is none. */
double eco_levels_height(const struct eco_levels *levels, uint32_t plant, double height_m);
void eco_levels_free(struct eco_levels *levels);

/* ---- Sizes (positions_species.c) ---- */

struct eco_size_row {            /* the row that a size is read for */
	uint32_t plant;
	struct eco_grower plant_of;          /* its species, where that is known, and where it grows */
	uint64_t seed, row;          /* of the spread */
};

/* Reads a source of sizes from its column's text: metres, to the millimetre. NaN: none, or below low_m, or
 * above high_m. *remarks gets a bit for each enum eco_skip that the text shows. */
double eco_size_read(const struct eco_size *size, const char *text, char decimal,
	const struct eco_size_row *row, double low_m, double high_m, uint32_t *remarks);
/* A factor between 1 - spread and 1 + spread, by the row. */
double eco_size_spread(const struct eco_size_row *row, double spread);
/* The trunk's diameter in metres; NaN: none. */
double eco_size_trunk(const struct eco_size *size, const char *text, char decimal);

/* ---- The reader ---- */

#define ECO_HEIGHT_SOURCES_MAX 16u

/* Columns by their use; then those of filters. */
enum { ECO_COLUMN_X, ECO_COLUMN_Y, ECO_COLUMN_Z, ECO_COLUMN_SPECIES,
	ECO_COLUMN_YAW = ECO_COLUMN_SPECIES + ECO_SPECIES_COLUMNS, ECO_COLUMN_SCALE,
	ECO_COLUMN_CROWN, ECO_COLUMN_CROWN_BASE = ECO_COLUMN_CROWN + ECO_CROWN_COLUMNS,
	ECO_COLUMN_QUADRAT, ECO_COLUMN_AZIMUTH, ECO_COLUMN_DISTANCE, ECO_COLUMN_TINT, ECO_COLUMN_HEIGHTS,
	ECO_COLUMN_FILTERS = ECO_COLUMN_HEIGHTS + ECO_HEIGHT_SOURCES_MAX,
	ECO_COLUMN_CELLS = ECO_COLUMN_FILTERS + ECO_FILTERS_MAX, ECO_COLUMN_COUNT = ECO_COLUMN_CELLS + ECO_CELLS_MAX };

#define ECO_COLUMN_OF_Z (ECO_NONE - 1)   /* no column: the points' heights, where a size is of ECO_COLUMN_GEOMETRY */

struct eco_positions {
	const struct eco_positions_spec *spec;
	struct eco_frame frame;
	struct eco_rows *rows;
	uint32_t column[ECO_COLUMN_COUNT];   /* ECO_NONE: not needed */
	uint32_t fields_needed;
	bool from_geometry, use_z;
	bool at_origin;              /* no x, y and geometry: only offsets from the scene's origin */
	struct eco_crs *crs;
	struct eco_species_table *species;
	struct { uint64_t *slots; size_t count, size; } places;      /* those taken (positions_places.c) */
	struct eco_levels levels;
	bool levelled;               /* levels are made */
	struct eco_skipped skipped[ECO_SKIP_COUNT], filtered[ECO_FILTERS_MAX];
	uint64_t plants, good_places, bad_places;    /* bad: not convertible */
	double first_bad[3];
	double low[2], high[2], nearest_m;   /* nearest_m: to the origin */
	double first[3];             /* the first place, in the file's coordinates */
	struct eco_crs_span span;    /* of all places, in the file's coordinates */
	bool sized;                  /* a size was understood */
	uint64_t sizes[ECO_SIZED_COUNT];
	char said[ECO_SPECIES_BYTES + 1];    /* species of the row being read */
	char z[32];                  /* the height of its point */
	char tint[ECO_SPECIES_BYTES + 1];    /* its value of the tint's column */
	char cells[ECO_CELLS_MAX][ECO_SPECIES_BYTES + 1];
	bool ended;
};

enum verdict { GOOD, SKIPPED, FAILED };

/* A field's text without leading spaces; "" of a column that is not needed. */
const char *eco_row_field(const struct eco_positions *p, uint32_t column);
/* A text for a message: trimmed and shortened. */
const char *eco_row_shown(const char *text, char *buffer, size_t size);
char eco_row_decimal(const struct eco_positions *p);
/* The row being read, for errors: FILE:LINE, or FILE, feature NUMBER in a file without meaningful lines. */
const char *eco_row_name(const struct eco_positions *p, char *text, size_t size);
#define ECO_ROW_NAME 280
/* Counts the row being read, with the first line and text. */
enum verdict eco_row_skip(struct eco_positions *p, enum eco_skip why, const char *text);

/* ---- Places (positions_places.c) ---- */

enum verdict eco_positions_place(struct eco_positions *p, struct eco_position *record,
	struct eco_error *error);
/* Checks that need all rows: places far from everything, degrees in a CRS of metres, x and y swapped. */
enum eco_code eco_positions_check_places(struct eco_positions *p, struct eco_error *error);
