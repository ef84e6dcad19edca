/* Geometry saved against Cook's stochastic simplification at equal quality, for one plant (Neubert 2011,
 * section 5 and table 2).
 *
 *   d of 20 distances, normalised by the distance at which nothing would be left, spaced in two ways: evenly
 *   over [0, 1), as plants that stand
 *   anywhere do, and as the paper tabulates, 10 equidistant in [0, 0.1) and 10 in [0.1, 1), where half of all
 *   are close by
 *   lambda_Cook = (1 - d)^2, and the Q that Cook reaches there, seen from where no method was made for
 *   each method: the least lambda whose Q, at the scale that its table has, is no less
 *
 * lambda counts vertices of the foliage as the client draws them, 3 a triangle; wood is drawn whole by all
 * and not counted. Scales come from other views than those that Q is taken from, and orders from others
 * again. */
#ifndef TESTS_BENCH_SAVINGS_H
#define TESTS_BENCH_SAVINGS_H

#include "tests/bench/bench.h"

#define BENCH_DISTANCES 20u
#define BENCH_ELEMENTS_LEAST 500u

/* SMALL: with the little noise that the paper names; NOISY: with as much as suits our plants.
 * COLLAPSE: levels of leaf collapse with its textures, quads scaled. PLAIN: our order, made for leaves, drawn
 * without its growth codes. PRUNED: with one a leaf. TRIANGLES: and with leaves as one triangle where that
 * serves better. Packs draw the list's beginning as points, and their order is made for that (rank.h); here
 * it is not. */
enum bench_method { BENCH_STOCHASTIC, BENCH_DENSITY, BENCH_ORIENTATION_SMALL, BENCH_ORIENTATION_NOISY,
	BENCH_COMBINED_SMALL, BENCH_COMBINED_NOISY, BENCH_COLLAPSE, BENCH_PLAIN,
	BENCH_PRUNED, BENCH_TRIANGLES, BENCH_METHODS };
extern const char *const bench_method_names[BENCH_METHODS];

enum bench_spacing { BENCH_EVEN, BENCH_NEAR, BENCH_SPACINGS };

struct bench_reach { double cook_lambda[BENCH_DISTANCES], cook_q[BENCH_DISTANCES],
	lambda[BENCH_METHODS][BENCH_DISTANCES]; };

/* Shares of all vertices at which the Q of all methods is kept, beside what Cook reaches. */
#define BENCH_SHARES 6u
extern const double bench_shares[BENCH_SHARES];

struct bench_savings {
	uint32_t elements, vertices;         /* foliage; below BENCH_ELEMENTS_LEAST nothing else is set */
	double layers;                       /* of leaves: their projected area over what they cover */
	struct bench_reach at[BENCH_SPACINGS];
	double q[BENCH_METHODS][BENCH_SHARES];   /* each at its best scale; of test views */
	/* all doubles follow `layers` without a gap */
};

double bench_distance(enum bench_spacing spacing, uint32_t i);
/* Takes the model over. */
enum eco_code bench_savings_measure(struct bench *bench, struct bench_savings *savings,
	struct eco_model *model, struct eco_error *error);
/* The same as a unit, by the content of the file at `path`; reads the model only if that is not there. */
enum eco_code bench_savings_of(struct bench *bench, struct bench_savings *savings, const char *name,
	const char *path, struct eco_error *error);

/* Mean of 1 - lambda / lambda of Cook over the distances from `least` on; and of all vertices that are drawn
 * at the distances together. */
double bench_saving_beyond(const struct bench_savings *savings, enum bench_spacing spacing,
	enum bench_method method, double least);
double bench_saving_total(const struct bench_savings *savings, enum bench_spacing spacing,
	enum bench_method method);

#endif
