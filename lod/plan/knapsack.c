#include "lod/plan/knapsack.h"

#include <math.h>
#include <stdlib.h>

/* The least that is wrong with at most so many bins: from[] before a class, to[] with it. */
static void add_class(const struct lod_knapsack_option *options, const struct lod_knapsack_class *class, uint64_t bins,
	const double *from, double *to, uint32_t *pick)
{
	for (uint64_t b = 0; b <= bins; b++)
		to[b] = INFINITY;
	for (uint32_t o = class->first; o < class->end; o++)
		for (uint64_t b = options[o].bins; b <= bins; b++) {
			double wrong = from[b - options[o].bins] + options[o].wrong;
			if (wrong < to[b]) {
				to[b] = wrong;
				pick[b] = o;
			}
		}
}

bool lod_knapsack_solve(struct lod_planner *p, const struct lod_knapsack_option *options,
	const struct lod_knapsack_class *classes, uint32_t class_count, uint64_t bins, uint32_t *chosen)
{
	const size_t row = bins + 1;
	double *least = calloc((class_count + 2) * row, sizeof *least), *other = least + (class_count + 1) * row;
	uint32_t *picks = malloc((class_count * row + 1) * sizeof *picks);
	bool good = least && picks;
	for (uint32_t c = 0; good && c < class_count; c++) {
		const double *before = least + c * row;
		double *next = least + (c + 1) * row;
		uint32_t *pick = picks + c * row;
		add_class(options, &classes[c], bins, classes[c].instead ? least + classes[c].from * row : before,
			classes[c].instead ? other : next, pick);
		for (uint64_t b = 0; classes[c].instead && b < row; b++) {
			pick[b] = other[b] < before[b] ? pick[b] : ECO_NONE;
			next[b] = fmin(other[b], before[b]);
		}
		lod_planner_work(p, (uint64_t)(classes[c].end - classes[c].first) * row / 8);
	}
	good = good && least[class_count * row + bins] < INFINITY;
	for (uint32_t c = class_count; good && c-- > 0;) {
		chosen[c] = picks[c * row + bins];
		if (chosen[c] == ECO_NONE)
			continue;
		bins -= options[chosen[c]].bins;
		for (uint32_t from = classes[c].instead ? classes[c].from : c; c > from;)
			chosen[--c] = ECO_NONE;
	}
	free(least);
	free(picks);
	return good;
}
