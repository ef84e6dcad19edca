/* Cells of tables that are written as CSV (RFC 4180) and may be opened by a spreadsheet. */
#ifndef ECO_CSV_H
#define ECO_CSV_H

#include <stdio.h>

/* Writes a text as a cell. Quotes it if it holds a separator, a quote or the end of a line. A spreadsheet
 * would run a text that begins as a formula does (=, +, -, @, a tab or the end of a line), so an apostrophe
 * comes before it. Numbers are written by other means: -1 is one. */
void eco_csv_write_text(FILE *out, const char *text);

#endif
