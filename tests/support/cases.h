/* Cases of a test as a table, tests/ROOM/cases/NAME.tsv. Its first row names the columns; a line that begins
 * with # is a comment. In a field \n, \t, \r, \\ and \xHH are bytes, \N is NULL, and ${NAME} is the text of a
 * line "%NAME<tab>text" above.
 *
 *   struct row { const char *text, *wanted; };           texts only, one for each column
 *   uint32_t count;
 *   const struct row *rows = cases_read("tests/base/cases/text.tsv", sizeof *rows, &count); */
#pragma once

#include <stddef.h>
#include <stdint.h>

/* Rows of `row_size` bytes; they stay until the program ends. A table that is not there or has other columns ends it. */
const void *cases_read(const char *path, size_t row_size, uint32_t *count);
/* Rows with numbers, as a struct of that size has them. A letter for each column: s text, d double, i int,
 * u uint32_t, z size_t, y uint8_t, b bool (0 or 1), c enum eco_code by its name.
 *
 *   struct row { const char *text; double wanted; };
 *   const struct row *rows = cases_rows("tests/base/cases/number.tsv", "sd", sizeof *rows, &count); */
const void *cases_rows(const char *path, const char *types, size_t row_size, uint32_t *count);
/* Bytes of a field of a row, which may hold zeros: cases_size(&row->text). Only rows of texts have them. */
size_t cases_size(const char *const *field);
/* Writes the files of a table into a folder that is there: columns file and text. */
void cases_write(const char *path, const char *folder);
/* A number of a row, "nan" among them. */
double cases_number(const char *text);
/* The index of a text among names, which end with NULL. */
int cases_choice(const char *text, const char *const *names);
