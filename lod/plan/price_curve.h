/* The quality expected of a number of bytes, before any are spent: read off a grid of prices that do not depend
 * on the bytes, as planner_optimal.c reads the prediction off a grid of lambdas. Along the grid bytes never
 * fall, errors never rise and Q never falls, and between two prices all are linear. So more bytes never predict a
 * worse picture, whatever the search for their price finds. */
#ifndef LOD_PRICE_CURVE_H
#define LOD_PRICE_CURVE_H

#include "lod/plan/allocation.h"

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

#endif
