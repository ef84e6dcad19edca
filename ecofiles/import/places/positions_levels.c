/* Levels: a plant's heights are divided into classes of equal ratio between the least and the greatest,
 * and each becomes the mean of its class. So the relative error is bounded, and the few tall trees among
 * many shrubs keep their height (classes of equal counts would average them away). A first pass through
 * the file counts heights per centimetre. */
#include <math.h>
#include <stdlib.h>

#include "ecofiles/format/model.h"
#include "ecofiles/import/places/positions_parts.h"

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
