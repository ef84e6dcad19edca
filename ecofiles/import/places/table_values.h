/* The different values of a column, and how many rows have each. */
#ifndef ECO_TABLE_VALUES_H
#define ECO_TABLE_VALUES_H

#include "ecofiles/import/places/rows/rows.h"

#define ECO_TABLE_VALUES_MAX 65536u      /* further values are not told apart */

struct eco_table_value { char *text; uint64_t rows, first_line; };
struct eco_table_values {        /* owned; most rows first, of equals the earlier one */
	struct eco_table_value *items;
	uint32_t count;
};

/* Reads the whole file. Spaces around a text do not count. */
enum eco_code eco_table_values_read(struct eco_table_values *values, const struct eco_rows_source *source,
	const char *column, struct eco_error *error);
void eco_table_values_free(struct eco_table_values *values);

#endif
