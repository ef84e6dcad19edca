/* A multiple-choice knapsack [K 11.5], solved by dynamic programming: of each class one option, so that the least is
 * wrong within so many bins. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "lod/plan/planner_state.h"

struct lod_knapsack_option { double wrong; uint64_t bins; };
/* Options [first, end). `instead`: the class may have an option in place of those of all classes from `from` on. */
struct lod_knapsack_class { uint32_t first, end, from; bool instead; };

/* Sets each class's option; ECO_NONE: another class has one in its place. Counts its work as the planner's. False: no
 * choice fits, or there is no memory. */
bool lod_knapsack_solve(struct lod_planner *p, const struct lod_knapsack_option *options,
	const struct lod_knapsack_class *classes, uint32_t class_count, uint64_t bins, uint32_t *chosen);
