/* Texts as people write them into tables: numbers with decimal commas, ranges, units behind numbers, many
 * words for "no value", names in any case. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "ecofiles/import/model/import_file.h"

/* Whether a text is empty or means "no value": NA, N/A, NaN, null, none, -, ... in any case. */
bool eco_text_is_missing(const char *text);

/* A text without the spaces around it, cut to the buffer. */
const char *eco_text_trim(const char *text, char *buffer, size_t size);

/* Adds a further column of a species to a text: "Acer" and "rubrum" are "Acer rubrum", "Acer" and "Acer
 * rubrum", too. A missing value adds nothing, and a text that is one gives way. */
void eco_text_join(char *text, size_t size, const char *more);

/* A decimal number, with spaces around it. decimal ',' : "1,5" and "1.234,5"; a lone point counts as a
 * decimal point too. decimal '.' : "1.5" and "1,234.5". A lone comma is never guessed. Spaces and apostrophes
 * may part groups of three, "5 334 000", "2'600'000". No infinities, no hexadecimal. With
 * a sign of degrees also minutes, seconds and a hemisphere: "40° 24' 59.1\" N", "W 3.5°". */
bool eco_text_number(const char *text, char decimal, double *number);

/* A number with this sign, '.' or ',', between groups of three digits, also a lone one: "691,234" is 691234.
 * False without such a sign; the other sign is the decimal one. */
bool eco_text_grouped(const char *text, char thousands, double *number);

enum eco_size_form {
	ECO_FORM_NONE,               /* no size */
	ECO_FORM_EXACT,
	ECO_FORM_RANGE,              /* "21 to 30", "<10": the middle; the lower end is 0 if not given */
	ECO_FORM_OPEN,               /* "> 101", "101+": the bound */
	ECO_FORM_STEMS               /* "12;15;9", "20+18", "3x10": one trunk of the same area */
};

/* A size: a number, a range, or a bound, possibly with units ("12.5 m", "40'", "5 ft 6 in"). *unit_m is
 * the text's unit in metres, or 0 if it has none. The number is finite and >= 0. */
enum eco_size_form eco_text_size(const char *text, char decimal, double *number, double *unit_m);

/* A width: as a size, but "6 x 8" and "6/8" are the mean of several. */
enum eco_size_form eco_text_width(const char *text, char decimal, double *number, double *unit_m);

/* The year of a date, 1500 to 2099: "1987", "1987-04-12", "12.04.1987", "19870412", "19870412123456",
 * milliseconds since 1970, "Heisei 7" in Japanese; NaN: none. */
double eco_text_year(const char *text);

#define ECO_FILTERS_MAX 96u

/* text folded (inventory_text.h), "*" is any text; NULL: the number */
struct eco_value { char *text; double number; };

struct eco_filter {
	char *column;
	bool only;                   /* drops rows with none of the values; else rows with one of them */
	struct eco_value *values;
	uint32_t value_count;
	uint32_t plant, variant_count;       /* that such rows are, instead of being left out; variant_count 0: none */
};

/* Whether a row with this text in the column is kept. `decimal` as in eco_text_number. */
bool eco_filter_passes(const struct eco_filter *filter, const char *text, char decimal);
void eco_filters_free(struct eco_filter *filters, uint32_t count);
