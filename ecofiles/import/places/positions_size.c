/* From a text to metres: heights, crowns, and heights by allometry. Rounded to the millimetre, so that the
 * last bits of exp() and pow(), which differ between machines, do not change a pack. */
#include <math.h>

#include "ecofiles/import/places/inventory_text.h"
#include "ecofiles/format/model.h"
#include "ecofiles/import/places/positions_parts.h"

#define DBH_PLAUSIBLE_M 12.0

static double to_millimetres(double metres)
{
	return floor(metres * 1000 + 0.5) / 1000;
}

static const struct eco_allometry *rule_of(const struct eco_size *size, uint32_t plant)
{
	uint32_t low = 0, high = size->rule_count;
	while (low < high) {
		uint32_t middle = low + (high - low) / 2;
		if (size->rules[middle].plant == plant)
			return &size->rules[middle];
		if (size->rules[middle].plant < plant)
			low = middle + 1;
		else
			high = middle;
	}
	/* the rule of all other plants is the last: ECO_NONE is the greatest number */
	return size->rule_count > 0 && size->rules[size->rule_count - 1].plant == ECO_NONE
		? &size->rules[size->rule_count - 1] : NULL;
}

static double by_allometry(const struct eco_allometry *rule, double dbh_m)
{
	double grown = 1 - exp(-rule->rate * dbh_m * 1000);
	return 1.3 + (rule->max_m - 1.3) * (rule->shape == 1 ? grown : pow(grown, rule->shape));
}

double eco_size_read(const struct eco_size *size, const char *text, char decimal, uint32_t plant,
	double low_m, double high_m, struct eco_size_remarks *remarks)
{
	const struct eco_allometry *rule = NULL;
	double number, unit_m, metres;
	if (size->kind == ECO_SIZE_NUMBER)
		return size->value_m;
	if (size->kind == ECO_SIZE_DBH && !(rule = rule_of(size, plant)))
		return NAN;
	enum eco_size_form form = eco_text_size(text, decimal, &number, &unit_m);
	remarks->unread |= form == ECO_FORM_NONE && !eco_text_is_missing(text);
	if (form == ECO_FORM_NONE || !(number > 0))
		return NAN;
	remarks->measured_m = unit_m != 0 ? 0 : number * size->unit_m;
	metres = number * (unit_m != 0 ? unit_m : size->unit_m) * size->factor;
	bool trunk_too_thick = rule && metres > DBH_PLAUSIBLE_M;
	if (rule)
		metres = by_allometry(rule, metres);
	metres = to_millimetres(metres);
	if (!(metres >= low_m && metres <= high_m)) {
		remarks->unused = true;
		return NAN;
	}
	remarks->implausible |= trunk_too_thick;
	remarks->range |= form == ECO_FORM_RANGE;
	remarks->open |= form == ECO_FORM_OPEN;
	remarks->other_unit |= unit_m != 0 && unit_m != size->unit_m;
	return metres;
}
