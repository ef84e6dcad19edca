/* Errors in sections of ecobench: the first one ends the section by a jump to its caller, so that steps in
 * between neither return nor check codes. What the section holds then stays taken until the program ends.
 *
 *   must(bench_plot(bench, &plot, must_error));
 *   json_t *unit = must_unit(bench, name, stamp, study, ctx); */
#ifndef TESTS_BENCH_MUST_H
#define TESTS_BENCH_MUST_H

#include "lod/arena.h"
#include "tests/bench/bench.h"

/* Runs the steps of a section to their end or to their first error, which it returns. */
enum eco_code must_do(void (*steps)(struct bench *bench), struct bench *bench, struct eco_error *error);

extern struct eco_error *const must_error;       /* for the call within must() */
void must(enum eco_code code);
void must_go_on(const struct bench *bench);      /* Ctrl-C ends the section */
/* What is taken from the arena ends the section where there is no memory. */
void must_have(struct lod_arena *arena);

/* bench_unit, and bench_unit under a stamp of a file's bytes. `make` returns the unit. */
json_t *must_unit(struct bench *bench, const char *name, const char *stamp, json_t *(*make)(void *ctx),
	void *ctx);
const char *must_stamp(const char *path);        /* borrowed until the next call */

/* Plants that a section studies:
 *
 *   struct bench_walk walk = { .bench = bench, .leaves = 500, .most = 12, .quick = 4 };
 *   for (const struct bench_model *model; (model = bench_walk(&walk));)
 *     ... walk.found[model->generated]++; */
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
