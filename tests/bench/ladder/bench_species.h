/* Geometry that orders save against Cook at equal quality, plant by plant (bench_species.c); for sections
 * that set it beside something else. */
#pragma once

#include "tests/bench/bench.h"

#define BENCH_DISTANCES 20u
#define BENCH_ELEMENTS_LEAST 500u
#define BENCH_SHARES 6u
extern const double bench_shares[BENCH_SHARES];          /* of all vertices: .02 to .5 */

/* PLAIN: our order, made for leaves, without its growth codes; GREEDY: with them; PACK: a pack of the plant
 * as the planner draws it, with its forms, splats and impostor. */
enum bench_order { BENCH_STOCHASTIC, BENCH_DENSITY, BENCH_ORIENTATION_SMALL, BENCH_ORIENTATION_NOISY,
	BENCH_COMBINED_SMALL, BENCH_COMBINED_NOISY, BENCH_PLAIN, BENCH_GREEDY, BENCH_PACK,
	BENCH_ORDERS };
extern const char *const bench_order_names[BENCH_ORDERS];

struct bench_savings {
	uint32_t elements;           /* of the foliage; below BENCH_ELEMENTS_LEAST nothing else is set */
	double vertices, layers;     /* layers of leaves: their projected area over what they cover */
	/* lambda over Cook's, at distances evenly over [0, 1); Q at bench_shares, at the best scale */
	double ratio[BENCH_ORDERS][BENCH_DISTANCES], q[BENCH_ORDERS][BENCH_SHARES];
};
/* A unit by what the model's file holds; reads the model only if that is not there. An error ends the
 * section. */
void bench_savings_of(struct bench *bench, struct bench_savings *savings, const struct bench_model *model);
