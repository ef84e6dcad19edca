#include "ecofiles/import/places/spread.h"

#include <math.h>
#include <stdlib.h>

bool eco_spread_add(struct eco_spread *spread, double number)
{
	if (!spread->kept) {
		spread->kept = malloc(ECO_SPREAD_KEPT * sizeof *spread->kept);
		spread->stride = 1;
		if (!spread->kept)
			return false;
	}
	if (spread->seen++ % spread->stride != 0)
		return true;
	if (spread->count == ECO_SPREAD_KEPT) {      /* every second one leaves */
		spread->count /= 2;
		spread->stride *= 2;
		for (uint32_t i = 0; i < spread->count; i++)
			spread->kept[i] = spread->kept[2 * i];
	}
	spread->kept[spread->count++] = (float)number;
	spread->sorted = false;
	return true;
}

static int compare(const void *a, const void *b)
{
	float p = *(const float *)a, q = *(const float *)b;
	return (p > q) - (p < q);
}

double eco_spread_quantile(struct eco_spread *spread, double share)
{
	if (spread->count == 0)
		return NAN;
	if (!spread->sorted)
		qsort(spread->kept, spread->count, sizeof *spread->kept, compare);
	spread->sorted = true;
	return (double)spread->kept[(uint32_t)lround(share * (spread->count - 1))];
}

void eco_spread_free(struct eco_spread *spread)
{
	free(spread->kept);
	*spread = (struct eco_spread){ 0 };
}
