/* What people write into tables: numbers with decimal commas, ranges, units behind numbers, many words for nothing, names in any case. */
#ifndef ECO_INVENTORY_TEXT_H
#define ECO_INVENTORY_TEXT_H

#include <stdbool.h>
#include <stddef.h>

/* Empty, or a word for it: NA, N/A, NaN, null, none, -, ... in any case. */
bool eco_text_is_missing(const char *text);

/* For comparing: without spaces at its ends, runs of spaces as one, small letters (Latin, Greek, Cyrillic). Writes at most `size`
 * bytes with the ending 0, cut where it does not fit, and returns the length. */
size_t eco_text_fold(const char *text, char *folded, size_t size);

/* Does a folded text fit a folded pattern, where "*" stands for any text, the empty one too? Time: lengths' product at worst. */
bool eco_text_fits(const char *text, const char *pattern);

/* A decimal number, spaces around it. decimal ',' : "1,5" and "1.234,5"; a lone point is taken for a decimal point too. decimal '.' :
 * "1.5" and "1,234.5". A lone comma is never guessed. No infinities, no hexadecimal. */
bool eco_text_number(const char *text, char decimal, double *number);

enum eco_size_form {
	ECO_FORM_NONE,               /* says no size */
	ECO_FORM_EXACT,
	ECO_FORM_RANGE,              /* "21 to 30", "<10": the middle, from 0 where only the upper end is given */
	ECO_FORM_OPEN                /* "> 101", "101+": the bound */
};

/* A size: a number, a range, or a bound, perhaps with units ("12.5 m", "40'", "5 ft 6 in"). *unit_m is what the text's unit is in
 * metres, or 0 where it has none. The number is finite and >= 0. */
enum eco_size_form eco_text_size(const char *text, char decimal, double *number, double *unit_m);

#endif
