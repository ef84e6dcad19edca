/* Cost of a plan in bytes that the client lacks, and the saving that a byte must bring.
 *
 * A second Lagrangian multiplier, allocation->price, is the number of wrong pixels that a byte must save. At
 * a price of 0 a plan is that of its vertices alone. Above it
 *
 * - a tile pays for its summary, chunk by chunk, and for its instance lists
 * - the bytes of a plant's lists are paid once, by all plants of the scene that draw them: a ladder is
 *   limited to where its next bytes save more, summed over plants, than they cost
 * - a plant's organs, which need many lists, are drawn by none of its plants unless they save more, over the
 *   ladder that shows the whole plant, than all their bytes cost
 * - a level of an impostor must set more right for each byte (lod/plan/texture_levels.h)
 *
 * A limit depends on which plants are drawn, and which are drawn depends on limits. Both are made in turn,
 * beginning without limits, a fixed number of times. All that is drawn then only becomes less, so the result
 * does not depend on what was asked before.
 *
 * Lists of a nested eco file are paid in equal parts by its visible occurrences. */
#pragma once

#include "lod/plan/allocation.h"

/* Finds what everything in view would cost. `kept`: chunks that come anyway, sooner or later, so that all
 * others count `times` their bytes; NULL: all count once. */
enum eco_code lod_prices_make(struct lod_allocation *allocation, const struct eco_holdings *kept,
	double times, struct eco_error *error);
void lod_prices_free(struct lod_allocation *allocation);      /* none made: fine */

/* Takes all limits away; sets them from what the last relaxation chose. The first time that was without
 * limits; before the last a ladder that shows a whole plant is kept as good as if no organs were drawn, so
 * that these have something to be compared with. */
void lod_prices_lift(struct lod_allocation *allocation);
void lod_prices_limit(struct lod_allocation *allocation, bool first, bool last);
/* Sets limits to what the last relaxation chose: filling a budget pays for no more. */
void lod_prices_tighten(struct lod_allocation *allocation);
/* Limits of all ladders in view; per plant, whether none of its organs is drawn, and which of LOD_KIND_TEXTURES its
 * textures pay. Set, they are those of the next relaxation that makes none. */
struct lod_mix { uint32_t *limits; bool *off; uint8_t *levels; bool used; };
#define LOD_KINDS_LEVELS 2u
void lod_kinds_set(struct lod_allocation *allocation, const struct lod_mix *mix);
/* The plant that a ladder in view is of. Adds to each plant's bytes those of its lists, as the last relaxation chose
 * them, and to its wrong pixels those for want of textures. */
uint32_t lod_prices_kind(const struct lod_allocation *allocation, uint32_t ladder);
void lod_prices_of_kinds(struct lod_allocation *allocation, double *bytes, double *wrong);
uint32_t lod_prices_ladders(const struct lod_allocation *allocation);
/* Finds the mix of limits that leaves least wrong within `target` bytes, where a price, log2, leaves some. Relaxes
 * with it, or without where it is no better, and returns the bytes. */
double lod_kinds_share(struct lod_allocation *allocation, double lambda, double target, double octave,
	struct lod_mix *mix);
/* Are no organs of this plant drawn, by any of its plants? */
bool lod_prices_organs_off(const struct lod_allocation *allocation, uint32_t plant);

/* Adds bytes of a tile's instance lists to a cost. */
void lod_prices_instances(const struct lod_allocation *allocation, uint32_t node, struct lod_cost *cost);
/* The first `points` of a tile's summary: bytes of the chunks that hold them, the points that these hold, and
 * those that all of them but the last do. The mean bytes of a point. */
struct lod_summary_price { double bytes, points, before; };
struct lod_summary_price lod_prices_summary(const struct lod_allocation *allocation, uint32_t node,
	double points);
double lod_prices_point(const struct lod_allocation *allocation, uint32_t node);

/* Sets levels of textures anew, from what the last relaxation chose and the allocation's price. */
void lod_prices_levels(struct lod_allocation *allocation);
/* Bytes of what the last relaxation chose; wrong pixels for want of textures, or of levels of them. */
double lod_prices_bytes(struct lod_allocation *allocation);
double lod_prices_lost(const struct lod_allocation *allocation);
/* Pixels of one plant, per slot, that are covered wrongly as outlines are coarse. */
void lod_prices_lost_of(const struct lod_allocation *allocation, double *lost);

/* ---- The price that a number of bytes asks for: prices are log2 ---- */

/* Relaxes at a price, with its own limits or, if `mix` is used, with those; lod_prices_make came before. Returns the
 * bytes. */
double lod_price_relax(struct lod_allocation *allocation, double lambda, double octave, const struct lod_mix *mix);
/* Relaxes at a price whose bytes are at most `target`, and returns these bytes. near: log2 of a price that nearly fits;
 * NAN: not known. */
double lod_price_find(struct lod_allocation *allocation, double lambda, double target, double near, double *octave);
/* Wrong pixels that the last relaxation leaves. */
double lod_price_wrong(const struct lod_allocation *allocation);
