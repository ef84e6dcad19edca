/* From a text to metres: heights, crowns, and heights by allometry. Rounded to the millimetre, so that the
 * last bits of exp() and pow(), which differ between machines, do not change a pack. */
#include "ecofiles/import/places/positions_parts.h"

#include <math.h>
#include <stdlib.h>

#include "ecofiles/format/model.h"
#include "ecofiles/import/places/inventory_text.h"

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

static void remark(uint32_t *remarks, enum eco_skip kind, bool there)
{
	*remarks |= (uint32_t)there << kind;
}

double eco_size_read(const struct eco_size *size, const char *text, char decimal, uint32_t plant,
	double low_m, double high_m, uint32_t *remarks)
{
	const struct eco_allometry *rule = NULL;
	double number, unit_m, metres;
	if (size->kind == ECO_SIZE_NUMBER)
		return size->value_m;
	if (size->kind == ECO_SIZE_DBH && !(rule = rule_of(size, plant)))
		return NAN;
	enum eco_size_form form = eco_text_size(text, decimal, &number, &unit_m);
	remark(remarks, ECO_KEPT_UNREAD, form == ECO_FORM_NONE && !eco_text_is_missing(text));
	if (form == ECO_FORM_NONE || !(number > 0))
		return NAN;
	metres = number * (unit_m != 0 ? unit_m : size->unit_m) * size->factor;
	bool trunk_too_thick = rule && metres > DBH_PLAUSIBLE_M;
	if (rule)
		metres = by_allometry(rule, metres);
	metres = to_millimetres(metres);
	if (!(metres >= low_m && metres <= high_m)) {
		remark(remarks, ECO_KEPT_UNUSED, true);
		return NAN;
	}
	remark(remarks, ECO_KEPT_IMPLAUSIBLE, trunk_too_thick);
	remark(remarks, ECO_KEPT_RANGE, form == ECO_FORM_RANGE);
	remark(remarks, ECO_KEPT_OPEN, form == ECO_FORM_OPEN);
	remark(remarks, ECO_KEPT_OTHER_UNIT, unit_m != 0 && unit_m != size->unit_m);
	return metres;
}

#define BINS 30001u                  /* centimetres */
#define PLANTS_MAX 4096u

/* bin[cm]: first a count, then the class's height in cm */
struct plant_levels { uint32_t plant, *bin; };

struct eco_levels {
	struct plant_levels plants[PLANTS_MAX];
	uint32_t count;
};

struct eco_levels *eco_levels_open(void)
{
	return calloc(1, sizeof(struct eco_levels));
}

static uint32_t centimetres(double height_m)
{
	return (uint32_t)(height_m * 100 + 0.5);
}

static const struct plant_levels *levels_of(const struct eco_levels *levels, uint32_t plant)
{
	for (uint32_t i = 0; i < levels->count; i++)
		if (levels->plants[i].plant == plant)
			return &levels->plants[i];
	return NULL;
}

enum eco_code eco_levels_count(struct eco_levels *levels, uint32_t plant, double height_m, const char *path,
	struct eco_error *error)
{
	const struct plant_levels *l = levels_of(levels, plant);
	uint32_t *bin;
	if (!l) {
		if (levels->count == PLANTS_MAX)
			return eco_fail(error, ECO_TOO_LARGE, "%.200s: \"levels\" works for up to %u plants",
				path, PLANTS_MAX);
		bin = calloc(BINS, sizeof *bin);
		if (!bin)
			return eco_fail(error, ECO_NO_MEMORY, "%.200s: out of memory", path);
		levels->plants[levels->count] = (struct plant_levels){ plant, bin };
		l = &levels->plants[levels->count++];
	}
	l->bin[centimetres(height_m)]++;
	return ECO_OK;
}

/* Replaces the counts of [first, end) by the mean height there. */
static void average(uint32_t *bin, uint32_t first, uint32_t end)
{
	uint64_t sum = 0, members = 0, mean;
	for (uint32_t i = first; i < end; i++) {
		sum += (uint64_t)bin[i] * i;
		members += bin[i];
	}
	mean = members > 0 ? (sum + members / 2) / members : 0;
	for (uint32_t i = first; i < end; i++)
		bin[i] = (uint32_t)mean;
}

static void make_levels(uint32_t *bin, uint32_t levels)
{
	uint32_t low = 0, high = BINS - 1, first;
	while (low < BINS - 1 && bin[low] == 0)
		low++;
	while (high > low && bin[high] == 0)
		high--;
	first = low;
	for (uint32_t i = 1; i <= levels; i++) {
		uint32_t end = i == levels ? high + 1
			: (uint32_t)(low * pow((double)high / low, (double)i / levels) + 0.5);
		if (end <= first)
			continue;
		average(bin, first, end);
		first = end;
	}
}

void eco_levels_make(struct eco_levels *levels, uint32_t count)
{
	for (uint32_t i = 0; i < levels->count; i++)
		make_levels(levels->plants[i].bin, count);
}

double eco_levels_height(const struct eco_levels *levels, uint32_t plant, double height_m)
{
	const struct plant_levels *l = levels_of(levels, plant);
	uint32_t level = l ? l->bin[centimetres(height_m)] : 0;
	return level > 0 ? level / 100.0 : height_m;
}

void eco_levels_close(struct eco_levels *levels)
{
	for (uint32_t i = 0; levels && i < levels->count; i++)
		free(levels->plants[i].bin);
	free(levels);
}
