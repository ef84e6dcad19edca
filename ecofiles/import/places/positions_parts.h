/* Shared by the files of the reader of inventories; private. */
#ifndef ECO_POSITIONS_PARTS_H
#define ECO_POSITIONS_PARTS_H

#include <stddef.h>

#include "ecofiles/import/places/positions.h"
#include "ecofiles/import/places/crs.h"
#include "ecofiles/import/places/rows/rows.h"
#include "ecofiles/import/places/size_units.h"

/* ---- Species (positions_species.c): the map's keys, and the key of each text met ---- */

struct eco_species_table;

/* NULL when memory ran out. `spec` must outlive it. */
struct eco_species_table *eco_species_open(const struct eco_positions_spec *spec);
/* The map's key for a text, which it counts: exact keys before wildcards, of these the one with most
 * literal characters, of equals the first; spec->map_count: none, so the fallback. */
uint32_t eco_species_find(struct eco_species_table *table, const char *text, uint64_t line);
void eco_species_counted(const struct eco_species_table *table, struct eco_positions_counts *counts);
void eco_species_reset(struct eco_species_table *table);
void eco_species_close(struct eco_species_table *table);

/* ---- Places taken (positions_places.c): a set of 64-bit hashes, at most 16 bytes each ---- */

struct eco_place_set;

struct eco_place_set *eco_place_set_open(void);
/* Adds a place, rounded to the millimetre. *known: it was in the set. False when memory ran out. */
bool eco_place_set_add(struct eco_place_set *set, const double at[3], bool *known);
void eco_place_set_close(struct eco_place_set *set);

/* ---- Levels (positions_size.c): few heights instead of many. A plant's heights are divided into classes of equal
 * ratio between the least and the greatest, and each becomes the mean of its class: the relative error is bounded, and
 * the few tall trees among many shrubs keep their height ---- */

struct eco_levels;

struct eco_levels *eco_levels_open(void);
/* Counts a height of a plant (0.01 to 300 m). */
enum eco_code eco_levels_count(struct eco_levels *levels, uint32_t plant, double height_m, const char *path,
	struct eco_error *error);
/* Makes at most `count` heights for each plant; call it after all were counted. */
void eco_levels_make(struct eco_levels *levels, uint32_t count);
/* The height of the class of height_m, in metres; height_m itself if there is none. */
double eco_levels_height(const struct eco_levels *levels, uint32_t plant, double height_m);
void eco_levels_close(struct eco_levels *levels);

/* ---- Sizes (positions_size.c) ---- */

struct eco_size_remarks {
	uint32_t kinds;              /* a bit for each enum eco_skip that the text shows */
	double measured_m; /* what the text says, by the unit stated for the column; 0: by its own */
};

/* Reads a source of sizes from its column's text: metres, to the millimetre. NaN: none (also where it is unused,
 * as it is below low_m or above high_m). */
double eco_size_read(const struct eco_size *size, const char *text, char decimal, uint32_t plant,
	double low_m, double high_m, struct eco_size_remarks *remarks);

/* ---- Places that count from others (positions_size.c) ---- */

/* The south-western corner of a quadrat by its four digits (fewer: zeros were lost before them). False: they
 * are none. */
bool eco_quadrat_corner(const struct eco_quadrat *quadrat, const char *text, double corner_m[2]);
/* East and north of an azimuth and a distance. */
void eco_polar_offset(const struct eco_polar *polar, double azimuth, double distance, double offset_m[2]);

/* ---- The reader ---- */

enum { ECO_COLUMN_X, ECO_COLUMN_Y, ECO_COLUMN_Z, ECO_COLUMN_SPECIES, ECO_COLUMN_YAW, ECO_COLUMN_SCALE,
	ECO_COLUMN_CROWN, ECO_COLUMN_QUADRAT, ECO_COLUMN_AZIMUTH, ECO_COLUMN_DISTANCE, ECO_COLUMN_FIXED };

#define ECO_HEIGHT_SOURCES_MAX 16u

struct eco_positions {
	const struct eco_positions_spec *spec;
	struct eco_frame frame;
	struct eco_rows *rows;
	uint32_t column[ECO_COLUMN_FIXED];   /* ECO_NONE: not needed */
	uint32_t height_column[ECO_HEIGHT_SOURCES_MAX], filter_column[ECO_FILTERS_MAX];
	uint32_t fields_needed;
	bool from_geometry, use_z;
	bool at_origin;              /* no x, y and geometry: only offsets from the scene's origin */
	struct eco_crs *crs;
	struct eco_species_table *species;
	struct eco_place_set *places;
	struct eco_levels *levels;
	struct eco_skipped skipped[ECO_SKIP_COUNT], filtered[ECO_FILTERS_MAX];
	uint64_t plants, good_places, bad_places;    /* bad: not convertible */
	double first_bad[3];
	struct eco_spread measured[ECO_HEIGHT_SOURCES_MAX];  /* metres, by source */
	double low[2], high[2], nearest_m;   /* nearest_m: to the origin */
	double first[3];             /* the first place, in the file's coordinates */
	struct eco_crs_span span;    /* of all places, in the file's coordinates */
	bool sized;                  /* a size was understood */
	uint32_t height_source;      /* of the row being read; ECO_NONE: none */
	char said[ECO_SPECIES_BYTES + 1];    /* species of the row being read */
	char *notes[ECO_ROWS_NOTES_MAX];
	uint32_t note_count;
	bool ended;
};

/* Opens the file (again, if it was open) and finds the columns (positions_columns.c). */
enum eco_code eco_positions_open_rows(struct eco_positions *p, struct eco_error *error);

#endif
