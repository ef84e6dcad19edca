/* Savings from the curves of bench_ladder_plant.h. */
#include "tests/bench/ladder/bench_ladder_plant.h"

#include <math.h>

/* The highest tuned Q of points of at most that lambda; between points linear. */
static double tuned_at(const struct bench_ladder_curve *curve, double lambda)
{
	uint32_t i = 0;
	while (i < curve->count && curve->at[i].lambda > lambda)
		i++;
	if (i == curve->count)
		return -INFINITY;
	if (i == 0)
		return curve->at[0].tuned;
	const struct bench_ladder_point *high = &curve->at[i - 1], *low = &curve->at[i];
	double t = (lambda - low->lambda) / (high->lambda - low->lambda);
	return low->tuned + t * (high->tuned - low->tuned);
}

static double reach_one(const struct bench_ladder_curve *curve, const struct bench_ladder_curve *other,
	double q)
{
	double least = 1;
	for (uint32_t i = curve->count; i-- > 0;) {
		const struct bench_ladder_point *at = &curve->at[i], *below = at + 1;
		if (at->q < q || (other && tuned_at(other, at->lambda) > at->tuned))
			continue;
		least = at->lambda;
		if (i + 1 < curve->count && below->q < q && at->q > below->q &&
			(!other || tuned_at(other, below->lambda) <= below->tuned))
			least = below->lambda +
				(q - below->q) / (at->q - below->q) * (at->lambda - below->lambda);
		break;
	}
	return least;
}

double bench_ladder_reach(const struct bench_ladder_curve *lists, const struct bench_ladder_curve *splats,
	double q)
{
	if (!splats || !splats->count)
		return reach_one(lists, NULL, q);
	return fmin(reach_one(lists, splats, q), reach_one(splats, lists, q));
}

double bench_ladder_saving(const struct bench_ladder *ladder, const struct bench_ladder_curve *splats,
	enum bench_ladder_row row, enum bench_spacing spacing, bool total)
{
	static const enum bench_ladder_kind kinds[BENCH_LADDER_ROWS] = { BENCH_LADDER_GREEDY,
		BENCH_LADDER_GREEDY, BENCH_LADDER_SHUFFLED, BENCH_LADDER_SHUFFLED, BENCH_LADDER_BARE,
		BENCH_LADDER_ONE };
	bool all = row == BENCH_LADDER_OURS || row == BENCH_LADDER_RANDOM;
	double sum = 0, ours = 0, cook = 0;
	for (uint32_t d = 0; d < BENCH_DISTANCES; d++) {
		double left = 1 - bench_distance(spacing, d), lambda = left * left,
		       reached = bench_ladder_reach(&ladder->kind[kinds[row]], all ? splats : NULL,
			       ladder->cook_q[spacing][d]);
		sum += 1 - reached / lambda;
		ours += reached;
		cook += lambda;
	}
	return total ? 1 - ours / cook : sum / BENCH_DISTANCES;
}
