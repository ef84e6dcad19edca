/* What the planner can buy: for each slot the hull points of its ladders, for each tile its summary or its plants, and what all of it comes to
 * at a lambda (wrong pixels that a vertex must save).
 *
 *   lod_allocation_make(&allocation, p, &error);                 after lod_planner_open: worth and tiles; nothing of it depends on the budget
 *   lod_allocation_relax(&allocation, lambda)                     the best at this lambda: gates, which tiles are open, wrong pixels, vertices
 *   lod_allocation_predict(&allocation, &prediction, &error)      the picture at that lambda
 *
 * At a lambda everything decides for itself: a slot's ladder takes the steps that gain more than they cost; a band of a plant draws its
 * cells where they are worth more than the whole plant's lists; a tile, from the leaves up, draws its plants and its
 * children's best where that beats its summary. This is the Lagrangian of the one objective: the hull points found at a lambda are
 * the best there are for the vertices they come to. Lower lambdas buy more.
 *
 * Where both choices of a tile are worth nearly the same, it is open in part: so many of its plants are drawn, by their hashes, and its
 * summary, whose points go as the last plants come. So a tile does not change at once from one picture to the next. Nor does a gate: where
 * cells are worth nearly the same as the whole plant's lists, so many plants draw them, the nearest bands first, and in one band by their
 * hashes. */
#ifndef LOD_ALLOCATION_H
#define LOD_ALLOCATION_H

#include "lod/plan/planner_state.h"
#include "lod/plan/summary_hull.h"

enum lod_when { LOD_ALWAYS, LOD_FAR, LOD_NEAR };         /* near: the plant's cells are drawn */

struct lod_cost {                    /* wrong pixels, of those seen, and as they are from above; of a slot choice: fp is not weighed by `extra` yet */
	double fp, fn, vertices;
	double above_fp, above_fn;
};

struct lod_ladder_choice {                   /* a ladder for the plants of one slot */
	uint32_t slot, ladder;
	uint8_t when;
	double weight_px;                /* seen pixels of one plant that the ladder draws, times its importance: wrong by this much at an error of 1 */
	struct lod_hull hull;
	double position;             /* at the last lambda */
};

struct lod_slot_choice {                     /* a slot, per plant; [0]: as far plants are drawn, [1]: as near ones are */
	uint32_t ladder_choice_first, ladder_choice_count;
	double seen, unoccluded;           /* means over its plants, or cells: pixels that are seen; of these, bare ones (struct lod_visibility) */
	double fp_weight;                /* bare / seen: what a pixel too many weighs */
	double own, parts;           /* while it is made: what its own lists show beside cells; what cells would, before it is scaled to what is seen */
	double weight_px[2];             /* wrong where nothing is drawn: of a far plant; of a near one but for its cells */
	double absent;               /* what counts besides where nothing of it is drawn (lod/plan/hull.h) */
	struct lod_cost cost[2];     /* at the last lambda */
	struct lod_cost cells;       /* at the last lambda: of all its plants' cells */
	double cells_weight_px;          /* of these */
};

enum lod_fixed { LOD_FREE, LOD_FIXED_OPEN, LOD_FIXED_CLOSED };

struct lod_tile_choice {                   /* a tile */
	enum lod_fixed fixed;          /* the caller's: not for its lambda to decide */
	bool open, has_summary;          /* its plants are known; it has a summary */
	double closed_most;            /* so many of its plants may be left to its summary, as a share */
	bool opened;                 /* at the last lambda: more than half */
	double share;                /* at the last lambda: how far its summary has given way to its plants and children, 0 to 1 */
	double weight;               /* and how far those above it have given way to it */
	struct lod_hull_point partial[2];   /* of a summary that is drawn beside plants: its points once the allocation is settled, and all that the lambda has */
	struct lod_hull partial_hull;      /* these as steps */
	double weight_px;                /* wrong when nothing of it is drawn, its children's too */
	double pixels, unoccluded;         /* pixels of that; of these, bare ones */
	double mean_seen, plants;         /* while it is made: seen pixels if each plant were seen as its slot is; plants */
	double factor;               /* how much more, or less, of its plants is seen than of others in their slots */
	struct lod_summary_view view;
	struct lod_summary_hull summary;    /* its summary's hull points */
	double position;             /* at the last lambda */
	struct lod_cost cost;        /* of the better choice */
};

struct lod_allocation {
	struct lod_planner *p;
	struct lod_slot_choice *slot_choices;                /* per slot */
	struct lod_ladder_choice *ladder_choices;            uint32_t ladder_choice_count, ladder_choice_capacity;
	struct lod_tile_choice *tile_choices;            /* per node */
	uint32_t *drawn_by;                  /* per node: whose choice it is drawn by, when last expected or settled */
	uint64_t *counts;                    /* per slot: plants, all that is open being drawn */
	double *scratch;                     /* per slot */
	struct lod_hull_point **blocks;          uint32_t block_count, block_capacity, block_used;
	uint32_t *slot_of;                   /* per plant and whole band: slot + 1 */
	uint8_t *gates_counted;                 /* per plant: bands whose cells have been counted */
	uint16_t *gates_fixed;                /* the caller's, per plant: a gate + 1 that is not for lambdas to decide, or 0 */
	bool few_plants;                          /* tiles open all at once: where single plants decide */
	double lambda;
	struct lod_cost cost;                /* at the last lambda */
};

enum eco_code lod_allocation_make(struct lod_allocation *allocation, struct lod_planner *p, struct eco_error *error);
void lod_allocation_free(struct lod_allocation *allocation);

/* The slot of a plant's whole plants in a band; ECO_NONE where there is none. */
static inline uint32_t lod_allocation_slot(const struct lod_allocation *allocation, uint32_t plant, uint8_t band)
{
	return allocation->slot_of[plant * (size_t)ECO_BANDS + band] - 1;
}

/* Calls fn for each tally of cells in tiles that are open, with the cell's slot choice and that of the whole plants it is part of. */
typedef void (*lod_allocation_cell_fn)(struct lod_allocation *allocation, const struct lod_tally *tally, struct lod_slot_choice *cell, struct lod_slot_choice *whole);
void lod_allocation_cells(struct lod_allocation *allocation, lod_allocation_cell_fn fn);

/* Above the first lambda nothing is bought, below the second nearly all that gains. */
void lod_allocation_lambda_range(const struct lod_allocation *allocation, double *high, double *low);

/* Sets p->gates too. Price 0 takes every step. */
void lod_allocation_relax(struct lod_allocation *allocation, double lambda);
enum eco_code lod_allocation_predict(struct lod_allocation *allocation, struct eco_prediction *prediction, struct eco_error *error);

/* After lod_allocation_relax: what a tile's plants and children save together, vertices paid, and what its summary does at most. The tile is
 * open and has a summary. */
void lod_allocation_compare(const struct lod_allocation *allocation, uint32_t node, double *plants, double *summary);

/* Makes p's nodes and gates what the last lambda decided, and counts plants. */
void lod_allocation_fix(struct lod_allocation *allocation);

#endif
