/* The price of bytes that a number of bytes asks for: see lod/plan/byte_price.h.
 *
 * log2 of two prices: of what plants share, and of tiles and levels of textures. They differ where no one
 * price uses the bytes: plants' lists come at once, for all tiles, so limits are those of a price at which
 * there are too many bytes, and tiles and levels pay more. */
#ifndef LOD_PRICE_SEARCH_H
#define LOD_PRICE_SEARCH_H

#include "lod/plan/allocation.h"

#define LOD_PRICE_LOWEST -30.0   /* wrong pixels a byte: nothing is worth so little, ... */
#define LOD_PRICE_HIGHEST 30.0   /* ... or so much */
#define LOD_PRICE_SLACK 0.03     /* share of the bytes that may be left */

struct lod_price { double lists, tiles; };

/* Relaxes at prices; lod_prices_make came before. Returns the bytes. */
double lod_price_relax(struct lod_allocation *allocation, double lambda, const struct lod_price *at);
/* The same at one price for both, with the organs of all plants: it is remembered for lod_price_find. */
double lod_price_relax_alike(struct lod_allocation *allocation, double lambda, double octave);
/* Relaxes at one price for both whose bytes are at most `target`, and returns these bytes. `over` becomes a
 * price at which there are too many bytes. */
struct lod_price_near {
	double octave;               /* a price that nearly fits; NAN: not known */
	bool is_enough;              /* to fit so: within .5 octaves, or a tenth of the bytes */
};
double lod_price_find(struct lod_allocation *allocation, double lambda, double target,
	const struct lod_price_near *near, struct lod_price *at, double *over);
/* The same where that leaves many bytes, gap after gap: two prices, or organs of plants that are kept, or
 * left out. Vertices stay within the request's. */
double lod_price_fill(struct lod_allocation *allocation, double lambda, double target, struct lod_price *at,
	double over, int gaps);
/* Wrong pixels that the last relaxation leaves. */
double lod_price_wrong(const struct lod_allocation *allocation);

#endif
