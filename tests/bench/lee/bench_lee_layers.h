/* What Lee, Peng and Kuo leave open and what they show: the number of layers G, swept, and what "incorrect
 * pixels" are a share of; and the pictures of their figure 2. */
#ifndef TESTS_BENCH_LEE_LAYERS_H
#define TESTS_BENCH_LEE_LAYERS_H

#include "tests/bench/bench.h"

/* Tables, one picture and words for the crown of as many leaves as the paper's tree. */
enum eco_code bench_lee_layers(struct bench *bench, struct eco_error *error);

#endif
