/* Shared by the readers of tables; private. */
#ifndef ECO_ROWS_FORMATS_H
#define ECO_ROWS_FORMATS_H

#include "ecofiles/import/places/rows/rows.h"

/* Frees columns, fields, notes and crs; for a reader's `close`. */
void eco_rows_free_texts(struct eco_rows *rows);

#endif
