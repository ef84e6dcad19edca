/* The price of bytes that a number of bytes asks for: see lod/plan/byte_price.h. Prices are log2. */
#ifndef LOD_PRICE_SEARCH_H
#define LOD_PRICE_SEARCH_H

#include "lod/plan/allocation.h"
#include <stdbool.h>
#include "ecofiles/format/plan.h"

struct lod_mix;
/* Relaxes at a price, with its own limits or, if `mix` is used, with those; lod_prices_make came before. Returns the
 * bytes. */
double lod_price_relax(struct lod_allocation *allocation, double lambda, double octave, const struct lod_mix *mix);
/* The same without a mix: it is remembered for lod_price_find. */
double lod_price_relax_alike(struct lod_allocation *allocation, double lambda, double octave);
/* Relaxes at a price whose bytes are at most `target`, and returns these bytes. */
struct lod_price_near {
	double octave;               /* a price that nearly fits; NAN: not known */
	bool is_enough;              /* to fit so: within .5 octaves, or a tenth of the bytes */
};
double lod_price_find(struct lod_allocation *allocation, double lambda, double target,
	const struct lod_price_near *near, double *octave);
/* Wrong pixels that the last relaxation leaves. */
double lod_price_wrong(const struct lod_allocation *allocation);

/* The quality expected of a number of bytes, before any are spent: read off a grid of prices that do not depend
 * on the bytes, as planner_optimal.c reads the prediction off a grid of lambdas. Along the grid bytes never
 * fall, errors never rise and Q never falls, and between two prices all are linear. So more bytes never predict a
 * worse picture, whatever the search for their price finds. */

struct lod_price_point {
	struct eco_prediction prediction;
	double octave;               /* log2 of a price of the grid whose bytes are at most these, ... */
	double lowest;               /* ... and vertices at the lowest lambda there */
};

/* Within so many vertices: at the lambda `low` where they hold what it draws, else between that and `high`,
 * at which they hold it whatever a byte costs. lod_prices_make came before. */
struct lod_price_bounds { double low, high, vertices; };
enum eco_code lod_price_curve(struct lod_allocation *allocation, const struct lod_price_bounds *bounds,
	double bytes, struct lod_price_point *point, struct eco_error *error);

/* Predictions of one view in order: which expects the better picture, and what lies between two of them.
 *
 * Pictures are compared by Q. The number of wrong pixels is another order: where half of a meadow is missed
 * and little is too much, fewer pixels may be wrong than where less is missed and as much is too much, and
 * yet Q is lower. */

/* No picture is worse. That of zeros has Q 1: none is better. */
#define LOD_EXPECTED_WORST { .fp = 1, .fn = 1 }

/* Is the Q of `a` below that of `b`? */
bool lod_expected_worse(const struct eco_prediction *a, const struct eco_prediction *b);

/* Interpolates by Q between `worse` and `better`; part: 0 to 1. */
struct eco_prediction lod_expected_between(const struct eco_prediction *worse,
	const struct eco_prediction *better, double part);

/* Makes a prediction no worse than `worse` and no better than `better`. */
void lod_expected_clamp(struct eco_prediction *prediction, const struct eco_prediction *worse,
	const struct eco_prediction *better);

#endif
