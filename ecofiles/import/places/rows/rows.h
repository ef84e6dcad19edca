/* A table read row by row: the common form of all inventory formats. A further format implements `next`
 * and `close`, and is chosen in eco_rows_open_here (rows.c).
 *
 *   eco_rows_open(&rows, &source, &error);           in a child process; or eco_rows_open_here in this one
 *   while (rows->next(rows, &more, &error) == ECO_OK && more) rows->fields[...], rows->place
 *   eco_rows_close(rows); */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "ecofiles/base/status.h"

#define ECO_ROW_BYTES_MAX (1u << 20)
#define ECO_COLUMNS_MAX 4096u
#define ECO_ROWS_NOTES_MAX 32u
#define ECO_ROWS_CRS_BYTES 16384u

enum eco_place_kind {
	ECO_PLACE_NONE,              /* a table without geometry: coordinates are in columns */
	ECO_PLACE_POINT,
	ECO_PLACE_EMPTY,             /* null or empty */
	ECO_PLACE_OTHER,             /* not a point; place.what names the type */
	ECO_PLACE_AREA,              /* any geometry, whole, if source.areas asks for it */
	ECO_PLACE_COUNT
};

struct eco_rows_place {          /* the geometry of a row */
	enum eco_place_kind kind;
	double at[3];                /* easting or longitude first */
	char what[16];
	double width;                /* metres, of a polygon that is a plant: the disc of its area; 0: a point */
	/* ECO_PLACE_AREA: well-known binary, two dimensions; valid until the next row */
	const uint8_t *wkb;
	uint32_t wkb_bytes;
};

struct eco_rows {
	/* Sets fields, field_count, row, line and place; *more is false, and nothing else set, after the
	 * last row. */
	enum eco_code (*next)(struct eco_rows *rows, bool *more, struct eco_error *error);
	void (*close)(struct eco_rows *rows);
	char **columns;              /* names, as written */
	uint32_t column_count;
	const char **fields;         /* of the current row, ended by 0; valid until the next call */
	uint32_t field_count;
	uint64_t row, line;          /* data rows from 1; line of the file where the row begins, from 1 */
	const char *where;           /* unit of `line`: "line", "feature" */
	bool has_geometry, has_z;    /* rows have places, and these a height */
	bool degrees_doubted;        /* degrees by the format alone, but the numbers cannot be degrees */
	char *crs;                   /* of the places, as code or WKT; NULL: not stated */
	char no_crs[112];            /* the reason, for an error; may be empty */
	struct eco_rows_place place;
	char *notes[ECO_ROWS_NOTES_MAX];     /* guesses and oddities; malloc'ed, without the file's name */
	uint32_t note_count;
};

struct eco_rows_source {
	const char *path, *layer;    /* layer: NULL: not stated */
	char separator;              /* of a CSV; 0: found in its header */
	const char *const *wanted;   /* columns needed; others may come empty; NULL: all */
	uint32_t wanted_count;
	bool areas;                  /* geometries whole; files without any are refused */
	bool crowns;                 /* a polygon is a plant: its centroid, and its width as the crown's */
	bool partial;                /* a file that breaks off is read until there */
};

/* Opens by content, then by extension. The error for a file that is not what it seems says what to do. */
enum eco_code eco_rows_open(struct eco_rows **rows, const struct eco_rows_source *source,
	struct eco_error *error);
/* The same in this process: for the child, and for tests of the readers themselves. */
enum eco_code eco_rows_open_here(struct eco_rows **rows, const struct eco_rows_source *source,
	struct eco_error *error);
void eco_rows_close(struct eco_rows *rows);

/* Lists the columns' names for a message. */
void eco_rows_list_columns(const struct eco_rows *rows, char *text, size_t size);
/* Index of the column of that name; ECO_NONE for NULL. `path` is for errors, which list the columns there
 * are. */
enum eco_code eco_rows_find_column(const struct eco_rows *rows, const char *path, const char *name,
	uint32_t *column, struct eco_error *error);

/* The height of the row's point, as a text; "": none. */
void eco_text_of_z(const struct eco_rows *rows, char *text, size_t size);

/* Adds a note to a struct eco_rows, printf-like; each once, up to ECO_ROWS_NOTES_MAX. */
void eco_rows_note(void *rows, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* CSV (RFC 4180): the first row names the columns; quoted fields may hold separators, line breaks and
 * doubled quotes; lines end in LF or CRLF; a byte order mark and empty lines are skipped; a row that is
 * not UTF-8 is taken for Windows-1252. Memory: one row. separator 0: found in the header. A column
 * whose first value is a point as well-known text, or latitude and longitude in one field, is the
 * geometry. */
enum eco_code eco_rows_open_csv(struct eco_rows **rows, const char *path, char separator,
	struct eco_error *error);

/* ---- For readers ---- */

/* Frees columns, fields, notes and crs; for a reader's `close`. */
void eco_rows_free_texts(struct eco_rows *rows);

/* ---- Points as text (rows.c) ---- */

#define ECO_ROWS_POINT_LOOK 64u          /* rows in which a column with points is looked for */

enum eco_point_form { ECO_POINT_WKT, ECO_POINT_JSON, ECO_POINT_PAIR };       /* PAIR: latitude, longitude */
struct eco_rows_point { uint32_t column; bool found; enum eco_point_form form; };

/* The first column with a point in the row at hand, well-known text before pairs of degrees; sets
 * has_geometry and has_z. False: none has. */
bool eco_rows_point_find(struct eco_rows *rows, struct eco_rows_point *point);
/* Sets the CRS that the column's form states, and notes it. */
void eco_rows_point_state(struct eco_rows *rows, const struct eco_rows_point *point);
/* Sets the place of the row at hand. */
void eco_rows_point_take(struct eco_rows *rows, const struct eco_rows_point *point);
