/* The best that there is for a budget, by trying everything, in scenes so small that this can be done: what
 * the planner is held against. */
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

/* A random tree of tiles with a few plants, some with cells, from a random eye. `empty` is 0 where nothing is
 * in view. The same for the same seed. Every choice of tiles opened and of bands whose plants draw their
 * cells is tried, and for each the best amounts of every single plant and summary are found by dynamic
 * programming over vertices: all amounts that a ladder can draw, by the planner's own objective. With
 * `splats` scenes are smaller still, some plants have a ladder of splats for the whole plant, and for each
 * slot both choices are tried: all its plants draw that, or none. The planner itself keeps splats where
 * organs have the lower Q. */
enum eco_code bench_best_find(uint64_t seed, bool splats, struct bench_best *best, struct eco_error *error);

#endif
