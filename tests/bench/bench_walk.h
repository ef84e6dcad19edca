/* The plants that sections study, and their units; errors end the section (must of bench.h).
 *
 *   struct bench_walk walk = { .bench = bench, .leaves = 500, .most = 12, .quick = 4 };
 *   for (const struct bench_model *model; (model = bench_walk(&walk));)
 *     ... walk.found[model->generated]++; */
#ifndef TESTS_BENCH_WALK_H
#define TESTS_BENCH_WALK_H

#include "tests/bench/bench.h"

/* A stamp of a file's bytes; borrowed until the next call. */
const char *must_stamp(const char *path);

struct bench_walk {
	struct bench *bench;
	uint32_t leaves;             /* at least */
	uint32_t most;               /* of the full bench */
	uint32_t quick, quick_made;  /* of the quick bench; quick_made: generated ones apart; 0: together */
	bool (*wants)(const struct bench *bench, const struct bench_model *model);   /* NULL: all */
	uint32_t found[2];           /* those that count: read, generated */
	/* private */
	struct bench_model *models;
	uint32_t count, next;
};
/* NULL after the last; the report names those that the quick bench leaves out. */
const struct bench_model *bench_walk(struct bench_walk *walk);

#endif
