/* The price of bytes that a number of bytes asks for: see lod/plan/byte_price.h. Prices are log2. */
#pragma once

#include "lod/plan/allocation.h"
#include <stdbool.h>
#include "ecofiles/format/plan.h"

struct lod_mix;
/* Relaxes at a price, with its own limits or, if `mix` is used, with those; lod_prices_make came before. Returns the
 * bytes. */
double lod_price_relax(struct lod_allocation *allocation, double lambda, double octave, const struct lod_mix *mix);
/* Relaxes at a price whose bytes are at most `target`, and returns these bytes. near: log2 of a price that nearly fits;
 * NAN: not known. */
double lod_price_find(struct lod_allocation *allocation, double lambda, double target, double near, double *octave);
/* Wrong pixels that the last relaxation leaves. */
double lod_price_wrong(const struct lod_allocation *allocation);
