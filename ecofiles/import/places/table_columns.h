/* The meaning of a table's columns, by their names in several languages and by their content.
 *
 *   eco_table_read(&table, &source, &error);         an even selection of the rows, as texts
 *   eco_table_columns(&table, &columns)              which one is the longitude, the species, the height, ...
 *   eco_table_free(&table); */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "ecofiles/import/places/rows/rows.h"
#include "ecofiles/import/places/size_units.h"

#define ECO_TABLE_ROWS 2048u
#define ECO_COLUMN_GEOMETRY "geometry"   /* a name of the points' own heights */

struct eco_table {               /* owns everything */
	char *path;
	char **columns; uint32_t column_count;
	char **fields;               /* [row_count * column_count]; "" where a row is short */
	double (*places)[2];         /* per row; NaN: no point */
	struct eco_spread crowns;
	double crown_m;              /* the middle of the widths of polygons that are plants; 0: points */
	uint32_t row_count;
	uint64_t rows;               /* in the file */
	bool has_geometry, degrees_doubted;
	bool has_z;                  /* the last column holds the heights of the points, ECO_COLUMN_GEOMETRY */
	char *crs;                   /* of the geometry; NULL: not stated */
	char *notes[ECO_ROWS_NOTES_MAX]; uint32_t note_count;
};

/* Reads the whole file and keeps every row, every second, every fourth, ... so that at most
 * ECO_TABLE_ROWS stay. A file without a row is an error. */
enum eco_code eco_table_read(struct eco_table *table, const struct eco_rows_source *source,
	struct eco_error *error);
void eco_table_free(struct eco_table *table);
static inline const char *eco_table_field(const struct eco_table *table, uint32_t row, uint32_t column)
{
	return table->fields[(size_t)row * table->column_count + column];
}

enum eco_role { ECO_ROLE_X, ECO_ROLE_Y, ECO_ROLE_SPECIES, ECO_ROLE_HEIGHT, ECO_ROLE_DBH, ECO_ROLE_GIRTH,
	ECO_ROLE_CROWN, ECO_ROLE_AGE, ECO_ROLE_PLANTED,
	ECO_ROLE_PLOT, ECO_ROLE_AZIMUTH, ECO_ROLE_DISTANCE, ECO_ROLE_QUADRAT, ECO_ROLE_COUNT };
extern const char *const eco_role_names[ECO_ROLE_COUNT];

struct eco_columns {             /* ECO_NONE: no such column */
	uint32_t of[ECO_ROLE_COUNT];
	uint32_t species_more[2];            /* columns of epithets and cultivars beside that of the species */
	uint32_t rival[ECO_ROLE_COUNT];      /* the next best, where it is nearly as good */
	char decimal;                /* ',' if numbers have decimal commas, else '.' */
	/* the sign between groups of x and y, where it also stands alone; else 0 */
	char thousands;
	bool thousands_open;         /* lone commas of x and y may part thousands or decimals */
	/* x and y by name: degrees, metres of a grid, or neither */
	bool names_say_degrees;
};

#define ECO_COLUMN_ENOUGH 50
/* How surely a column's name tells that role; ECO_COLUMN_ENOUGH makes it that. */
int eco_column_points(enum eco_role role, const char *name);
/* Whether a word of a column's name is one of a set's, or has one of five letters within it: "Kronenradius" says radius. */
bool eco_column_says(const char *name, const char *set);
/* Whether a column is one of longitudes or latitudes by its name. */
bool eco_column_says_degrees(const char *name);
/* Columns that `columns` names already (not ECO_NONE) are left as they are. */
void eco_table_columns(const struct eco_table *table, struct eco_columns *columns);
/* Whether x and y count within quadrats, by their names: "lx", "qy". */
bool eco_columns_are_local(const struct eco_table *table, const struct eco_columns *columns);
/* Sizes above 0 of a column, as the texts have them, of rows whose species, if there is that column, is not a
 * vacant place or a stump. *own_unit: share of texts with a unit of their own. */
void eco_table_spread(const struct eco_table *table, uint32_t column, const struct eco_columns *columns,
	struct eco_spread *spread, double *own_unit);
/* Coordinates of a column. */
void eco_table_coordinates(const struct eco_table *table, uint32_t column, const struct eco_columns *columns,
	struct eco_spread *spread);

#define ECO_COLUMNS_JOINED 3u
#define ECO_TABLE_VALUES_MAX 65536u      /* further values are not told apart */

struct eco_table_value { char *text; uint64_t rows, first_line; };
struct eco_table_values {        /* owned; most rows first, of equals the earlier one */
	struct eco_table_value *items;
	uint32_t count;
};

/* The different texts of a column, or of several joined (eco_text_join). Reads the whole file. Spaces around
 * a text do not count. */
enum eco_code eco_table_values_read(struct eco_table_values *values, const struct eco_rows_source *source,
	const char *const *columns, uint32_t count, struct eco_error *error);
void eco_table_values_free(struct eco_table_values *values);
