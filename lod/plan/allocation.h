/* The Lagrangian relaxation of a plan: what each slot, gate and tile chooses at a lambda, and what all of it
 * comes to.
 *
 * A plan is a multiple-choice knapsack: from each ladder of a slot one hull point, from each tile its summary
 * or its plants, such that the fewest expected wrong pixels remain within a budget of vertices. lambda, the
 * Lagrangian multiplier, is the number of wrong pixels that a vertex must save. With it in place of the
 * budget the problem falls apart into choices that do not depend on each other (Everett 1963, Geoffrion
 * 1974):
 *
 * - a ladder of a slot takes the steps of its hull whose slope is above lambda
 * - plants of a slot draw a ladder that shows the whole plant where that saves more than their organs do
 * - a band of a plant draws its cells where they save more than that
 * - a tile, from the leaves of the tree up, draws its plants and its children's choices where these beat its
 *   summary
 *
 * The result is optimal for the number of vertices that it happens to use. A lower lambda uses more.
 *
 *   lod_allocation_make(&allocation, p, &error);             after lod_planner_open: weights, hulls, tiles
 *   lod_allocation_relax(&allocation, lambda)                gates, open tiles, wrong pixels, vertices
 *   lod_allocation_predict(&allocation, &prediction, &error) the whole picture at that lambda
 *   lod_allocation_fix(&allocation)                          makes these gates and tiles the planner's
 *
 * Ties are blended. If a tile's plants and its summary save nearly the same, the tile is open in part: a
 * share of its plants is drawn, chosen by hash, beside its summary, whose points disappear as the last plants
 * appear. A gate blends in the same way: a share of the plants draws cells, the nearest bands first, within a
 * band by hash. So does a ladder that shows the whole plant: of a slot's plants beyond the gate those of the
 * greatest hashes draw it. So no tile, gate or slot switches at once between two pictures of a moving
 * camera. */
#pragma once

#include <math.h>

#include "ecofiles/format/impostor.h"
#include "lod/arena.h"
#include "lod/plan/planner_state.h"
#include "lod/seen/summary_hull.h"

enum lod_when {
	LOD_ALWAYS,
	LOD_FAR, LOD_NEAR,           /* only where the plant's cells are not drawn; only where they are */
	LOD_WHOLE                    /* in place of all else that is drawn of a plant whose cells are not */
};

struct lod_cost {                    /* errors seen (hull.h); a slot choice's open one is without its weight */
	double alike, open, vertices;
	double bytes;                /* of tiles, where these have a price; not of what plants share */
};

/* Adds the cost of `times` plants; errors times `seen`, the open one times its weight. */
static inline void lod_cost_add(struct lod_cost *sum, const struct lod_cost *cost, double open,
	double times, double seen)
{
	sum->alike += seen * cost->alike;
	sum->open += seen * open * cost->open;
	sum->vertices += times * cost->vertices;
	sum->bytes += cost->bytes;
}

struct lod_ladder_choice {           /* one ladder for all plants of a slot: a class of the knapsack */
	uint32_t slot, ladder;
	uint8_t when;
	double weight_px;            /* wrong pixels at an error of 1: pixels of one plant seen, times
	                              * importance */
	struct lod_hull hull;
	uint32_t hull_count;         /* of its points, where bytes do not limit them */
	double position;             /* on the hull, at the last lambda */
};

struct lod_slot_choice {             /* per plant of a slot; [0]: a far plant, [1]: a near one, which draws
                                      * cells */
	uint32_t ladder_choice_first, ladder_choice_count;
	uint32_t whole_count;        /* the last of these are LOD_WHOLE */
	double seen, unoccluded;     /* mean pixels seen of a plant or cell; of these, unoccluded ones */
	double open;                 /* how far they are seen before ground and sky: unoccluded / seen */
	double wood_nearer, wood_behind;     /* as of visibilities, mean of a plant; of a cell, 1 and by its
	                              * distance */
	double own, parts;           /* only in lod_allocation_make: seen of its own lists beside cells; of
	                              * its cells, before scaling */
	double weight_px[2];         /* wrong pixels where nothing is drawn; [1] without the cells' */
	struct lod_cost nothing;     /* of a far plant where nothing of it is drawn */
	struct lod_cost cost[2];     /* at the last lambda; [0] blends what draws organs and what does not */
	uint32_t whole;              /* at the last lambda: the ladder choice that shows the whole plant best;
	                              * ECO_NONE: there is none */
	double whole_share;          /* of far plants that draw it */
	double whole_saved;          /* at the last lambda: what it saves of a far plant, 0 without one; ... */
	double organs_saved;         /* ... what the plant's organs save over it; ... */
	double near_saved;           /* ... and what cells save over far plants, of all plants of the slot */
	double lambda;               /* at which all this was chosen; not a number: its hulls
	                              * changed since */
	bool organs_off;             /* lod_prices_organs_off then */
	struct lod_cost cells;       /* at the last lambda: all cells of all its plants */
};

/* While a picture is predicted: pixels that a plant or cell of a slot covers, and wrong ones, seen from the side and
 * from above; in the end wrong ones of whole plants are over those that they cover. [1]: those with a hash below
 * near_end, which draw cells. */
struct lod_slot_wrong { uint32_t near_end; double px[2]; struct lod_wrong at[2], above[2]; };

struct lod_impostor_use {            /* levels of a plant's impostor, lod/plan/texture_levels.h */
	uint32_t levels;             /* that some plant may draw */
	double from_px[ECO_IMPOSTOR_LEVELS]; /* of each, across: it shows plants that are larger */
};

struct lod_tile_choice {
	bool open, has_summary;      /* its plants were counted; it has a summary that can be drawn */
	double closed_most;          /* share of its plants that may be left to the summary */
	bool opened;                 /* at the last lambda: share is at least a half */
	double share;                /* at the last lambda: how far the summary has given way to plants and
	                              * children, 0 to 1 */
	double weight;               /* product of the shares of all tiles above it */
	/* of a summary beside plants, after fixing: its points, as a hull; those before plants took their place */
	struct lod_hull_point partial;
	struct lod_hull partial_hull;
	uint64_t all_points;
	double weight_px;            /* wrong pixels where nothing of it or its children is drawn */
	double pixels, unoccluded;   /* pixels seen of it; of these, unoccluded ones */
	double mean_seen, plants;    /* while it is made: pixels seen if its plants showed as their slots'
	                              * means; number of plants */
	double factor;               /* pixels seen of its plants over mean_seen */
	struct lod_summary_view view;
	struct lod_summary_hull summary;
	double position;             /* on the summary's hull, at the last lambda */
	double points;               /* the same in points, where bytes have a price: ends of chunks */
	struct lod_hull limited;     /* after fixing, where bytes have a price: the hull up to these */
	struct lod_cost cost;        /* of the blend that is chosen */
	bool moved;                  /* it is another one since the last relaxation */
	struct lod_splats splats;    /* of its summary, while a picture is predicted; ... */
	double leaves;               /* ... pixels of all leaves that it draws */
};

/* Plants of a slot in an open tile, or in all of them. */
struct lod_use {
	uint32_t slot;
	uint32_t whole;              /* of a cell: the slot of whole plants whose gate decides; else itself */
	double count;
};

struct lod_uses {
	struct lod_use *items;       /* by node */
	uint32_t *first;             /* per node, and one more: in items */
	/* of all open tiles: cells, by their whole plants */
	struct lod_use *cells;       uint32_t cell_count;
	/* per slot, at the last lambda: the share of whole plants before their gate; what a plant costs in
	 * the mean, or a cell where it is drawn */
	double *near;
	struct lod_cost *each;
	struct lod_cost *own;        /* per node: what its own plants cost, ... */
	bool *stale;                 /* ... unless one of its slots costs something else since */
	/* per slot, as lod_uses_sum_drawn left them: plants in open tiles; the same, times their factors */
	double *drawn, *seen;
	bool *moved;                 /* per slot, while `near` and `each` are set: they are others */
	double *reach;               /* per node: the share of it that is drawn */
};

#define LOD_PRICE_TRIES 128      /* more are not kept */

/* Results of one price for all bytes. */
struct lod_price_tries {
	uint32_t count;
	struct { double lambda, octave, bytes; } at[LOD_PRICE_TRIES];        /* log2 of the price */
};

struct lod_allocation {
	struct lod_planner *p;
	struct lod_slot_choice *slot_choices; /* per slot */
	struct lod_ladder_choice *ladder_choices;            uint32_t ladder_choice_count,
		ladder_choice_capacity;
	struct lod_tile_choice *tile_choices; /* per node */
	uint64_t tallies, cells;     /* of open tiles; of the screen, as lod_screen_cells */
	uint32_t *drawn_by;          /* per node: the tile whose choice draws it; set by predict and fix */
	bool *drawn_here;            /* per node, while a picture is predicted: plants of it are drawn */
	struct lod_slot_wrong *slot_wrong;   /* per slot, then */
	uint64_t *counts;            /* per slot: plants if all open tiles are drawn */
	struct lod_uses uses;        /* plant_uses.c */
	double *scratch;             /* per slot */
	struct lod_arena memory;     /* of all of these but ladder_choices */
	uint32_t *slot_of;           /* per plant and band: slot of whole plants + 1 */
	double *plant_seen;          /* per plant: pixels of those that may be drawn as impostors */
	struct lod_impostor_use *impostors;  /* per plant */
	uint8_t *gates_counted;      /* per plant: bands whose cells were counted */
	bool few_plants;             /* in view: tiles and gates are not blended, single plants decide */
	bool has_whole;              /* some plants in view have a ladder that shows the whole plant */
	double lambda;
	double price;                /* wrong pixels that a byte must save; 0: bytes do not count */
	bool limited;                /* limits stay as they are, whatever the price */
	/* what the last relaxation was made for; lambda not a number: something has changed since.
	 * limits: the price that limits were made at */
	struct { double lambda, price, limits; } relaxed;
	struct { double lambda, price; } tiles;      /* what tiles have chosen for; likewise */
	struct lod_prices *prices;   /* lod/plan/byte_price.h; NULL: not made */
	struct lod_price_tries tries;        /* since these were made */
	struct lod_cost cost;        /* at the last lambda */
};

enum eco_code lod_allocation_make(struct lod_allocation *allocation, struct lod_planner *p,
	struct eco_error *error);
void lod_allocation_free(struct lod_allocation *allocation);

/* The slot of whole plants in a band; ECO_NONE where there is none. */
static inline uint32_t lod_allocation_slot(const struct lod_allocation *allocation, uint32_t plant,
	uint8_t band)
{
	return allocation->slot_of[plant * (size_t)ECO_BANDS + band] - 1;
}

/* A hull of the slot is another one: the next relaxation chooses anew. */
static inline void lod_allocation_unsettle(struct lod_allocation *allocation, uint32_t slot)
{
	allocation->slot_choices[slot].lambda = NAN;
	allocation->relaxed.lambda = NAN;
}

/* Levels of impostors for so many pixels seen, per slot: hulls of ladders that show a whole plant. */
void lod_allocation_set_impostors(struct lod_allocation *allocation, const double *seen);

/* Sets p->gates too. At lambda 0 every step is taken; above a price of 0, every one within the limits. Does
 * nothing where the last relaxation was the same. */
void lod_allocation_relax(struct lod_allocation *allocation, double lambda);
/* The same of slots and gates alone, within the limits that there are: tiles stay as they are. */
void lod_allocation_relax_plants(struct lod_allocation *allocation, double lambda);
/* The picture that is expected at the positions that choices have. */
enum eco_code lod_allocation_predict(struct lod_allocation *allocation, struct eco_prediction *prediction,
	struct eco_error *error);

/* After relax: what a tile's plants and children save at lambda, vertices paid, and what its summary saves. The tile
 * is open and has a summary. */
void lod_allocation_compare(const struct lod_allocation *allocation, uint32_t node, double *plants,
	double *summary);

/* Makes the gates and tiles of the last lambda those of p, and counts plants anew. */
void lod_allocation_fix(struct lod_allocation *allocation);

/* The search for the lambda that uses a budget of vertices, as planner_optimal.c leaves it, and what
 * planner_bytes.c does with it where bytes count. */

struct lod_lambda_search {
	struct lod_allocation *allocation;
	int index;                           /* the last lambda whose vertices fit the budget */
	double here;                         /* vertices there */
	double lambda;                       /* of the answer */
	bool exact;                          /* few plants: each fill solves the knapsack */
};

void lod_search_free(struct lod_lambda_search *s);       /* NULL is fine */
/* A lambda of the grid; 0 from LOD_LAMBDA_COUNT on. */
double lod_lambda_at(int index);
#define LOD_LAMBDA_LEAST lod_lambda_at(LOD_LAMBDA_COUNT - 1)

/* Bisects the grid for the last lambda whose vertices fit. */
enum eco_code lod_search_grid(struct lod_lambda_search *s, uint64_t budget, struct eco_error *error);
/* Entries for the structure of a lambda, within so many vertices. */
enum eco_code lod_search_fill(const struct lod_lambda_search *s, double lambda, uint64_t budget,
	struct eco_error *error);

/* Finds the bytes of the answer that carries the entries: p->bytes. */
enum eco_code lod_bytes_size(struct lod_planner *p, struct eco_error *error);
/* Entries whose answer has at most the bytes asked for, and the prediction. */
enum eco_code lod_bytes_fit(struct lod_lambda_search *s, uint64_t budget, struct eco_error *error);
/* After the answer: hands coarser ones to input->coarser. Entries are those of the last of them then. */
enum eco_code lod_bytes_coarser(const struct lod_lambda_search *s, const struct eco_plan *answer,
	struct eco_error *error);

/* Which plants stand in which open tiles, for sums over all of them at each lambda: the visible tree's
 * tallies, packed, and those of cells summed over tiles. Loops over them touch only what they need: a cost a slot,
 * not a slot_choice. From one relaxation to the next most slots cost the same, so a tile is summed again only if a
 * part of it is another one. */

/* After the tiles and slots of the allocation were made. */
enum eco_code lod_uses_make(struct lod_allocation *allocation, struct eco_error *error);

/* Adds up the cells of each slot's whole plants; the sums are 0 before: slot_choice.cells. */
void lod_uses_sum_cells(struct lod_allocation *allocation);
/* Sets near and each, once gates are. */
void lod_uses_set_each(struct lod_allocation *allocation);
/* The cost of a tile's own plants, without bytes. */
struct lod_cost lod_uses_cost(const struct lod_allocation *allocation, uint32_t node);
/* Sets drawn and seen, once tiles have chosen. */
void lod_uses_sum_drawn(struct lod_allocation *allocation);
