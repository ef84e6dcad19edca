/* Rows of a table as one text, to be compared with what is expected. */
#ifndef TESTS_ROWS_TEXT_H
#define TESTS_ROWS_TEXT_H

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "ecofiles/import/places/rows/rows.h"

/* "columns / row / row ...", a row as "place fields", places as (x y) or (x y z), none, empty or what they
 * are; ends with the error's text if there was one. Closes the rows. */
static inline const char *rows_text_of(struct eco_rows *rows, char *text, size_t size)
{
	struct eco_error error = { .code = ECO_OK };
	bool more = true;
	size_t used = 0;
#define ROWS_PUT(...) (used += used < size ? (size_t)snprintf(text + used, size - used, __VA_ARGS__) : 0)
	*text = 0;
	for (uint32_t i = 0; i < rows->column_count; i++)
		ROWS_PUT("%s%s", i > 0 ? "," : "", rows->columns[i]);
	while (rows->next(rows, &more, &error) == ECO_OK && more) {
		const struct eco_rows_place *place = &rows->place;
		ROWS_PUT(" /");
		if (place->kind == ECO_PLACE_POINT && !isnan(place->at[2]))
			ROWS_PUT(" (%.9g %.9g %.9g)", place->at[0], place->at[1], place->at[2]);
		else if (place->kind == ECO_PLACE_POINT)
			ROWS_PUT(" (%.9g %.9g)", place->at[0], place->at[1]);
		else if (place->kind != ECO_PLACE_NONE)
			ROWS_PUT(" %s", place->kind == ECO_PLACE_EMPTY ? "empty" : place->what);
		for (uint32_t i = 0; i < rows->field_count; i++)
			ROWS_PUT("%s%s", i > 0 ? "," : " ", rows->fields[i]);
	}
	if (error.code != ECO_OK)
		ROWS_PUT(" ! %s", error.text);
#undef ROWS_PUT
	eco_rows_close(rows);
	return text;
}

#endif
