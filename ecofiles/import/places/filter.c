#include "ecofiles/import/places/filter.h"

#include <stdlib.h>

#include "ecofiles/import/places/inventory_text.h"

#define TEXT_BYTES 256u

static bool has_value(const struct eco_filter *filter, const char *text, char decimal)
{
	char folded[TEXT_BYTES];
	double number;
	bool numeric = eco_text_number(text, decimal, &number);
	eco_text_fold(text, folded, sizeof folded);
	for (uint32_t i = 0; i < filter->value_count; i++) {
		const struct eco_value *value = &filter->values[i];
		if (value->text ? eco_text_fits(folded, value->text) : numeric && number == value->number)
			return true;
	}
	return false;
}

bool eco_filter_passes(const struct eco_filter *filter, const char *text, char decimal)
{
	return has_value(filter, text, decimal) == filter->only;
}

void eco_filters_free(struct eco_filter *filters, uint32_t count)
{
	for (uint32_t i = 0; i < count; i++) {
		for (uint32_t k = 0; k < filters[i].value_count; k++)
			free(filters[i].values[k].text);
		free(filters[i].values);
		free(filters[i].column);
	}
	free(filters);
}
