/* Shared by the readers of tables; private. */
#ifndef ECO_ROWS_FORMATS_H
#define ECO_ROWS_FORMATS_H

#include "ecofiles/import/places/rows/rows.h"

/* Frees columns, fields, notes and crs; for a reader's `close`. */
void eco_rows_free_texts(struct eco_rows *rows);

/* ---- Points as text (rows.c) ---- */

#define ECO_ROWS_POINT_LOOK 64u          /* rows in which a column with points is looked for */

struct eco_rows_point { uint32_t column; bool (*read)(const char *text, double at[3]); };

/* The first column with a point in the row at hand, well-known text before pairs of degrees; sets
 * has_geometry and has_z. False: none has. */
bool eco_rows_point_find(struct eco_rows *rows, struct eco_rows_point *point);
/* Sets the CRS that the column's form states, and notes it. */
void eco_rows_point_state(struct eco_rows *rows, const struct eco_rows_point *point);
/* Sets the place of the row at hand. */
void eco_rows_point_take(struct eco_rows *rows, const struct eco_rows_point *point);

#endif
