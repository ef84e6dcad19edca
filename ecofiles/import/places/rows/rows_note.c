/* Notes of a reader of tables, and the freeing of its texts. */
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/import/places/rows/rows_formats.h"

void eco_rows_add_note(char *notes[ECO_ROWS_NOTES_MAX], uint32_t *count, const char *format,
	va_list arguments)
{
	char text[400];
	vsnprintf(text, sizeof text, format, arguments);
	for (uint32_t i = 0; i < *count; i++)
		if (strcmp(notes[i], text) == 0)
			return;
	if (*count < ECO_ROWS_NOTES_MAX && (notes[*count] = strdup(text)))
		++*count;
}

void eco_rows_note(struct eco_rows *rows, const char *format, ...)
{
	va_list arguments;
	va_start(arguments, format);
	eco_rows_add_note(rows->notes, &rows->note_count, format, arguments);
	va_end(arguments);
}

void eco_rows_free_texts(struct eco_rows *rows)
{
	for (uint32_t i = 0; i < rows->column_count; i++)
		free(rows->columns[i]);
	for (uint32_t i = 0; i < rows->note_count; i++)
		free(rows->notes[i]);
	free(rows->columns);
	free(rows->fields);
	free(rows->crs);
}
