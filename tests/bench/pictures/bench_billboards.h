/* A field of plants whose clouds have fewer billboards the further away they stand (Kratt 2014, figure 4,
 * right), as a picture and a table. */
#pragma once

#include "tests/bench/bench_leaves.h"

void bench_billboards_field(struct bench *bench, const struct bench_model *model);
