/* Filters choose rows by the value of a column: {"only": {"status": ["alive*"]}, "skip": {"diameter":
 * [0]}}. */
#ifndef ECO_FILTER_H
#define ECO_FILTER_H

#include <stdbool.h>
#include <stdint.h>

#define ECO_FILTERS_MAX 64u

/* text folded (inventory_text.h), "*" is any text; NULL: the number */
struct eco_value { char *text; double number; };

struct eco_filter {
	char *column;
	bool only;                   /* drops rows with none of the values; else rows with one of them */
	struct eco_value *values;
	uint32_t value_count;
};

/* Whether a row with this text in the column is kept. `decimal` as in eco_text_number. */
bool eco_filter_passes(const struct eco_filter *filter, const char *text, char decimal);
void eco_filters_free(struct eco_filter *filters, uint32_t count);

#endif
