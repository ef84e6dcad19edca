/* "only" and "skip" of entries in "instances": the rows wanted. */
#include <stdlib.h>
#include <string.h>

#include "ecofiles/import/places/inventory_text.h"
#include "ecofiles/scene/scene_parse.h"

#define VALUE_BYTES 200u
#define VALUES_MAX 4096u
#define COLUMNS_MAX (ECO_FILTERS_MAX / 2)    /* in each of "only" and "skip" */

static bool parse_value(const struct eco_json *at, struct eco_value *value)
{
	char folded[VALUE_BYTES + 1];
	if (json_is_number(at->value)) {
		value->number = json_number_value(at->value);
		return true;
	}
	if (!json_is_string(at->value) || json_string_length(at->value) > VALUE_BYTES)
		return eco_json_fail(at, ECO_BAD_INPUT, "a value is a text of up to %u bytes, with \"*\" "
			"for any text, or a number", VALUE_BYTES);
	eco_text_fold(json_string_value(at->value), folded, sizeof folded);
	value->text = strdup(folded);
	return value->text || eco_json_no_memory(at);
}

static bool parse_filter(const struct eco_json *at, struct eco_filter *filter)
{
	bool several = json_is_array(at->value);
	size_t count = several ? json_array_size(at->value) : 1;
	if (several && !eco_json_array(at, VALUES_MAX))
		return false;
	filter->column = strdup(at->key);
	filter->values = calloc(count + 1, sizeof *filter->values);
	if (!filter->column || !filter->values)
		return eco_json_no_memory(at);
	for (size_t i = 0; i < count; i++) {
		struct eco_json item = several ? eco_json_item(at, i) : *at;
		filter->value_count++;
		if (!parse_value(&item, &filter->values[i]))
			return false;
	}
	return true;
}

static bool parse_columns(const struct eco_json *at, const char *name, struct eco_filter *filters,
	uint32_t *count)
{
	struct eco_json columns = eco_json_member(at, name), entry = { .file = NULL };
	if (!columns.value)
		return true;
	if (!eco_json_names(&columns, COLUMNS_MAX))
		return false;
	while (eco_json_next(&columns, &entry)) {
		struct eco_filter *filter = &filters[(*count)++];
		filter->only = strcmp(name, "only") == 0;
		if (!parse_filter(&entry, filter))
			return false;
	}
	return true;
}

bool eco_scene_parse_filters(const struct eco_json *at, struct eco_filter **filters, uint32_t *count)
{
	*filters = calloc(ECO_FILTERS_MAX, sizeof **filters);
	return *filters ? parse_columns(at, "only", *filters, count)
		&& parse_columns(at, "skip", *filters, count) : eco_json_no_memory(at);
}
