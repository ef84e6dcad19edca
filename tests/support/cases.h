/* Cases of a test as a table, tests/ROOM/cases/NAME.tsv. Its first row names the columns; a line that begins with # is a
 * comment. In a field \n, \t, \r, \\ and \xHH are bytes, \N is NULL, and ${NAME} is the text of a line "%NAME<tab>text" above.
 *
 *   struct row { const char *text, *wanted; };           texts only, one for each column
 *   uint32_t count;
 *   const struct row *rows = cases_read("tests/base/cases/text.tsv", sizeof *rows, &count); */
#pragma once

#include <stddef.h>
#include <stdint.h>

/* Rows of `row_size` bytes; they stay until the program ends. A table that is not there or has other columns ends it. */
const void *cases_read(const char *path, size_t row_size, uint32_t *count);
/* Bytes of a field of a row, which may hold zeros: cases_size(&row->text). */
size_t cases_size(const char *const *field);
/* A number of a row, "nan" among them. */
double cases_number(const char *text);
/* The index of a text among names, which end with NULL. */
int cases_choice(const char *text, const char *const *names);
