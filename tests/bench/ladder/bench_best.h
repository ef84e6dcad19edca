/* The best plan for a budget, by exhaustive search in small scenes: the measure of the planner. */
#ifndef TESTS_BENCH_BEST_H
#define TESTS_BENCH_BEST_H

#include <stdbool.h>
#include <stdint.h>

#include "ecofiles/base/status.h"

struct bench_best {
	/* seen wrong pixels: of the plan, of the best there is, of nothing drawn */
	double planner, best, empty;
	uint64_t vertices;                   /* the budget */
	/* choices of tiles and gates that were tried; plants and summaries in the last */
	uint32_t structures, things;
	uint32_t whole_slots;                /* that could draw their plants whole */
};

/* A random tree of tiles with a few plants, some with cells, from a random eye; the same for the same seed.
 * `empty` is 0 where nothing is in view. The search tries every choice of open tiles and of bands whose
 * plants draw their cells. For each, dynamic programming over vertices finds the best amounts of every plant
 * and summary, of all amounts that a ladder can draw, by the planner's own objective. With `splats` scenes
 * are smaller, some plants have a ladder of splats for the whole plant, and each slot is tried with it and
 * without. The planner itself keeps splats where organs have the lower Q. */
enum eco_code bench_best_find(uint64_t seed, bool splats, struct bench_best *best, struct eco_error *error);

#endif
