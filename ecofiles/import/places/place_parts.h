/* Shared by the files of the guess of places; private. A table's words tell its grid: the names of x and y,
 * and a column with the UTM zone or the CRS of each row, "18N", "18 T", "18", "EPSG:32618". */
#pragma once

#include "ecofiles/import/places/place_guess.h"
#include "ecofiles/import/places/words.h"

/* Words that both names have and a CRS's name may have, too. False: none; a name may be NULL. */
bool eco_place_hint(const char *const names[2], char hint[ECO_WORDS_BYTES]);

enum eco_zone_half { ECO_HALF_OPEN, ECO_HALF_NORTH, ECO_HALF_SOUTH };

struct eco_zone { uint32_t epsg, number; enum eco_zone_half half; };     /* epsg 0: number and half */

struct eco_zones {
	uint32_t column;             /* ECO_NONE: none says a zone */
	struct eco_zone zone;        /* of most rows */
	/* texts of two rows that differ; other: "" if all rows agree */
	char first[24], other[24];
};

/* The first column whose texts are all zones; all rows are read if a name speaks of zones. A zone by number
 * alone counts if the column's name says that it is UTM's, or if other names do (`utm`). */
enum eco_code eco_zones_find(const struct eco_table *table, const struct eco_rows_source *source, bool utm,
	struct eco_zones *zones, struct eco_error *error);
struct place_range { double low, middle, high; };
struct eco_place_look {
	const struct eco_place_asked *asked;
	struct eco_place_guess *guess;
	struct place_range xy[2];
	double at[2], turned[2];     /* the middle; with x and y swapped */
	double as_named[2];          /* the middle in degrees, longitudes up to 180 */
	const char *names[2];
	const char *unit;            /* that the names say, or NULL */
	double unit_m;
	bool nowhere;                /* no place, only offsets from one centre */
	struct eco_error *error;
};

/* Appends to a reason. */
void eco_place_why(char why[ECO_WHY_BYTES], const char *format, ...) __attribute__((format(printf, 2, 3)));
/* ECO_BAD_INPUT, with the table's path before the text. */
enum eco_code eco_place_fail(const struct eco_place_look *look, const char *format, ...)
	__attribute__((format(printf, 2, 3)));
/* ECO_BAD_INPUT: asks for the columns of x and y, which no name tells. */
enum eco_code eco_place_ask(const struct eco_place_look *look);
/* Whether the terrain lies at a place in degrees, within three of its lengths. */
bool eco_place_dem_has(const struct eco_place_look *look, const double degrees[2]);
/* The scene's CRS and origin, and the terrain's CRS, once that of the table is known (place_columns.c). */
enum eco_code eco_place_scene(struct eco_place_look *look);
