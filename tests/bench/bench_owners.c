#include "tests/bench/bench_owners.h"

#include <math.h>

#include "lod/sort.h"

#define ROUNDS 6                 /* of tangents, each where the list of the round before is */
#define INSIDE 0.999             /* of the most pixels that can be right: beyond, owner_q has no slope */

double bench_owner_q(double right, double shown, double wanted)
{
	double p = shown > 0 ? right / shown : 1, r = wanted > 0 ? right / wanted : 1;
	return 1 - sqrt((1 - p) * (1 - p) + (1 - r) * (1 - r));
}

static double slope(double right, double shown, double wanted)
{
	double lost_p = 1 - right / shown, lost_r = 1 - right / wanted;
	return (lost_p / shown + lost_r / wanted) / sqrt(lost_p * lost_p + lost_r * lost_r);
}

/* A bound by tangents at `right`, which becomes what the list has that reaches it: leaves by what they add a vertex, the last one in part. */
static double bound(const struct bench_owners *o, const double *shown, double vertices, const uint32_t *cost, double *right,
	struct lod_keyed *items, struct lod_arena *arena)
{
	double along[BENCH_OWNERS_VIEWS], sum = 0;
	for (uint32_t v = 0; v < o->views; v++) {
		along[v] = slope(right[v], shown[v], o->wanted[v]);
		sum += bench_owner_q(right[v], shown[v], o->wanted[v]) + along[v] * (o->wood[v] - right[v]);
		right[v] = o->wood[v];
	}
	for (uint32_t i = 0; i < o->leaves; i++) {
		double gain = 0;
		for (uint32_t v = 0; v < o->views; v++)
			gain += along[v] * o->own[i][v];
		items[i] = (struct lod_keyed){ ~lod_sort_key(gain / cost[i]), i };
	}
	lod_sort(arena, items, o->leaves);
	for (uint32_t k = 0; k < o->leaves && vertices > 0; k++) {
		uint32_t i = items[k].value;
		double part = fmin(1, vertices / cost[i]);
		for (uint32_t v = 0; v < o->views; v++) {
			sum += part * along[v] * o->own[i][v];
			right[v] += part * o->own[i][v];
		}
		vertices -= cost[i];
	}
	return sum / o->views;
}

double bench_owners_most(const struct bench_owners *o, const double *shown, double vertices, const uint32_t *cost, struct lod_arena *arena)
{
	struct lod_arena_piece *mark = arena->last;
	struct lod_keyed *items = lod_arena_take(arena, o->leaves, sizeof *items);
	double right[BENCH_OWNERS_VIEWS] = { 0 }, covered[BENCH_OWNERS_VIEWS], least = 1;
	for (uint32_t v = 0; v < o->views; v++)
		covered[v] = fmax(1, shown[v]);
	for (int round = 0; round < ROUNDS; round++) {
		least = fmin(least, bound(o, covered, vertices, cost, right, items, arena));
		for (uint32_t v = 0; v < o->views; v++)
			right[v] = fmin(right[v], INSIDE * fmin(covered[v], o->wanted[v]));
	}
	lod_arena_release(arena, mark);
	return least;
}
