/* Means with intervals. */
#ifndef TESTS_BENCH_INTERVAL_H
#define TESTS_BENCH_INTERVAL_H

#include <stdint.h>

/* The mean of values[0..count) and the middle 95 % of the means of `count` values drawn again and again, with
 * a fixed seed (bootstrap over plants). */
struct bench_interval {
	double mean, low, high;
};
struct bench_interval bench_interval_of(const double *values, uint32_t count);

#endif
