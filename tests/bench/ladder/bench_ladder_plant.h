/* Geometry that a pack's own ladder saves against Cook's stochastic simplification at equal quality, for
 * one plant: Neubert's protocol (2011, section 5), as in bench_species.c, but for lists as ecopack builds
 * them, at the scales and forms of their own curves, and with the splats and the impostor of the pack. The 20
 * distances are those that the paper tabulates: 10 in [0, 0.1) and 10 in [0.1, 1).
 *
 * Wood is drawn whole and not counted, except where splats or an impostor show the plant: these show wood,
 * too, and all their vertices count against those of the foliage. All cells of a plant draw the same share.
 * Lists and splats compete by their Q in tuning views; the Q that counts is that of other views. */
#ifndef TESTS_BENCH_LADDER_PLANT_H
#define TESTS_BENCH_LADDER_PLANT_H

#include "tests/bench/bench.h"

#define BENCH_DISTANCES 20u
#define BENCH_ELEMENTS_LEAST 500u

/* OURS: all that a pack has. LISTS: without splats and impostor. RANDOM, RANDOM_LISTS: the same with leaves
 * in random order and of one scale. */
enum bench_ladder_row { BENCH_LADDER_OURS, BENCH_LADDER_LISTS, BENCH_LADDER_RANDOM, BENCH_LADDER_RANDOM_LISTS,
	BENCH_LADDER_ROWS };
extern const char *const bench_ladder_names[BENCH_LADDER_ROWS];

#define BENCH_LADDER_POINTS 72u

/* Q of shares of the foliage's vertices, by falling lambda. */
struct bench_ladder_point {
	double lambda, tuned, q;
};
struct bench_ladder_curve {
	struct bench_ladder_point at[BENCH_LADDER_POINTS];
	double count;
};

enum bench_ladder_kind { BENCH_LADDER_GREEDY, BENCH_LADDER_SHUFFLED, BENCH_LADDER_KINDS };

struct bench_ladder {
	double elements; /* of the foliage */
	double cook_q[BENCH_DISTANCES];
	struct bench_ladder_curve kind[BENCH_LADDER_KINDS];
};

/* `seed`: of both orders. The caller keeps the model. */
void bench_ladder_measure(struct bench *bench, struct bench_ladder *ladder, const struct eco_model *model,
	uint32_t seed);
/* The splats, the impostor last; they do not depend on an order. Empty for a plant without. */
void bench_ladder_splats(struct bench *bench, struct bench_ladder_curve *curve, const struct eco_model *model);

/* Share of Cook's vertices that a row saves: mean of distances, or (`total`) of all distances together. */
double bench_ladder_saving(const struct bench_ladder *ladder, const struct bench_ladder_curve *splats,
	enum bench_ladder_row row, bool total);

#endif
