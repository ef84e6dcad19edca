#include "tests/bench/ladder/bench_interval.h"

#include <math.h>
#include <stdlib.h>

#include "lod/sort.h"

#define DRAWS 2000u
#define DRAW_SEED UINT64_C(20111)

static int by_size(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;
	return x < y ? -1 : x > y;
}

struct bench_interval bench_interval_of(const double *values, uint32_t count)
{
	static double means[DRAWS];
	struct bench_interval interval = { NAN, NAN, NAN };
	double sum = 0;
	if (!count)
		return interval;
	for (uint32_t i = 0; i < count; i++)
		sum += values[i];
	for (uint32_t draw = 0; draw < DRAWS; draw++) {
		means[draw] = 0;
		for (uint32_t i = 0; i < count; i++)
			means[draw] +=
				values[lod_mix(DRAW_SEED + (uint64_t)draw * count + i) % count] / count;
	}
	qsort(means, DRAWS, sizeof *means, by_size);
	return (struct bench_interval){ sum / count, means[DRAWS / 40], means[DRAWS - 1 - DRAWS / 40] };
}
