/* State shared by the files of the planner. A rule makes entries: planner_optimal.c with allocation.c and
 * fill_budget.c, or planner_deussen.c. planner_emit.c turns entries into cuts. */
#pragma once

#include <assert.h>

#include "lod/seen/tuning.h"
#include "ecofiles/format/wire_body.h"
#include "lod/plan/explain.h"
#include "lod/plan/image_choice.h"
#include "lod/plan/planner.h"
#include "lod/plan/plan_tables.h"
#include "lod/plan/visible_tree.h"

struct lod_entry {                   /* what is drawn of one ladder for all plants of a slot, or of a tile's
                                      * summary */
	uint32_t slot;               /* ECO_NONE: a summary */
	uint32_t ladder;             /* of a summary: the node */
	uint64_t count;              /* plants */
	uint64_t vertices, full;     /* per plant: drawn, and at most */
	uint32_t first, end;         /* plants with a hash from `first` on and below `end` */
	uint64_t more;               /* per plant with a hash below `share`, instead of `vertices` */
	uint32_t share;
	double wanted;               /* points or lines to show of the whole region, cells included; of a
	                              * summary: points are sized as if so many were drawn */
	double pixels;               /* that one plant's organ is expected to cover */
	double owners;               /* of a summary: the part of `wrong` that wrong owners are */
	double wrong;                /* lod_rule_optimal: its part of the objective; of a plant as large as ... */
	uint32_t size;               /* ... this index of eco_seen says */
	uint32_t impostor;           /* level that one vertex is; ECO_NONE: no impostor */
	double among;                /* 1 - the weight of a false positive: 0 alone, towards 1 among others */
	struct lod_reason reason;    /* where an explanation is asked for */
};

struct lod_planner {
	const struct lod_planner_input *input;
	const struct eco_scene *scene;
	struct lod_visible_tree visible;
	uint32_t *gates;             /* per plant: where it ends, see struct eco_gate */
	struct lod_plan_tables *tables, *own; /* the input's; own: made for this plan */
	struct lod_entry *entries;
	uint32_t entry_count, entry_capacity;
	uint64_t vertices;
	bool ended;                  /* every curve has ended: nothing can be added */
	uint64_t cheapest;           /* vertices of the cheapest step of a hull; UINT64_MAX: none is left */
	uint32_t level;
	bool converged;              /* as in lod_planner_stats */
	double wrong;                /* lod_rule_optimal: the objective that the entries reach */
	double fill_lambda;          /* the same: what their last vertices saved; 0: everything fits */
	uint64_t looks;              /* as in lod_planner_stats */
	uint64_t work;               /* as in lod_planner_stats, without ... */
	uint64_t beside;             /* ... that of explanations and of counting bytes, which changes no plan */
	bool hidden;                 /* this level hides plants: the next may take what one without bytes may */
	uint64_t level_work;         /* the input's, or its work_max; 0: any */
	uint64_t work_most;          /* that the plan may take: the input's, less within bytes; 0: any */
	uint64_t bytes;              /* as in lod_planner_stats */
	uint32_t sized;
	double ground_px;            /* of the ground below the next plan that is sized */
	bool ground_settled;         /* it has given way */
	struct eco_wire_body body;   /* what counts them */
	double price;
	uint8_t *texture_levels;     /* per list, of textures: the most that bytes allow; 0: any. NULL: bytes
	                              * do not bind */
	struct lod_image image;      /* of the ground; what is shown of it at ... */
	double image_price;          /* ... wrong pixels that a byte must save; 0: bytes do not bind */
	struct eco_prediction prediction;
	double sample_distance;      /* lod_rule_deussen; only reported */
	struct lod_screen screen;    /* lod_rule_optimal */
	struct lod_lambda_search *search; /* the same, with the allocation of the last level; NULL: none */
};

/* `input` must outlive p. End p whatever begin returns. */
enum eco_code lod_planner_begin(struct lod_planner *p, const struct lod_planner_input *input,
	struct eco_error *error);
void lod_planner_end(struct lod_planner *p);

/* Nobody waits for the plan: all searches end. */
static inline bool lod_planner_cancelled(const struct lod_planner *p)
{
	return p->input->cancelled && atomic_load_explicit(p->input->cancelled, memory_order_relaxed);
}

static inline enum eco_code lod_planner_check(const struct lod_planner *p, struct eco_error *error)
{
	return lod_planner_cancelled(p)
		? eco_fail(error, ECO_INTERRUPTED, "nobody waits for the plan any more") : ECO_OK;
}

/* Are so many quarters of the work done that the plan may take? */
static inline bool lod_planner_over(const struct lod_planner *p, uint64_t quarters)
{
	if (lod_planner_cancelled(p))
		return true;
	return p->work_most && p->work / quarters >= p->work_most / 4;
}

/* Is all of the work done that the input allows? Then all that is begun ends as cheaply as may be. */
static inline bool lod_planner_spent(const struct lod_planner *p)
{
	return lod_planner_cancelled(p) || (p->input->work_max && p->work >= p->input->work_max);
}

static inline void lod_planner_work(struct lod_planner *p, uint64_t done)
{
	p->work += done;
}

/* Opens the tiles and cells that the sample distances d' need, and counts plants: sets gates and slots. */
enum eco_code lod_planner_open(struct lod_planner *p, double tiles_distance, double cells_distance,
	struct eco_error *error);

enum eco_code lod_planner_add(struct lod_planner *p, const struct lod_entry *entry, struct eco_error *error);

/* Opens the scene at a level of lod_planner_stats and plans nothing, so that tests can make an allocation. */
enum eco_code lod_planner_open_level(struct lod_planner *p, uint32_t level, struct eco_error *error);

/* Makes the plan of the entries, without ground, and records reasons; why = NULL: of a trial. */
enum eco_code lod_planner_emit(const struct lod_planner *p, struct lod_explanation *why, struct eco_plan *plan,
	struct eco_error *error);

/* Puts ground below a plan, and finds the bytes of its answer: p->bytes. If these are too many for the first time, the
 * ground gives way as far as it may. */
enum eco_code lod_plan_size(struct lod_planner *p, struct eco_plan *plan, struct eco_error *error);
/* Puts ground below a coarser answer that takes its part of this answer's payloads; *missing: of all of these, as
 * lod_plan_missing. */
enum eco_code lod_plan_coarsen_ground(struct lod_planner *p, struct eco_plan *plan, uint64_t *missing,
	struct eco_error *error);

/* Expected error of an entry that draws `vertices` a plant. */
struct eco_curve lod_planner_curve(const struct lod_planner *p, const struct lod_entry *entry,
	uint64_t vertices);

/* Share of a plant's instances in a band that are before its gate. */
static inline double lod_planner_near(const struct lod_planner *p, uint32_t plant, uint8_t band)
{
	double share = ((double)p->gates[plant] - eco_gate_place(band, 0)) / ECO_SHARE_ONE;
	return share < 0 ? 0 : share > 1 ? 1 : share;
}

/* The way of a ladder that is in an entry or a ladder choice: its table exists. */
static inline const struct lod_way *lod_planner_way(const struct lod_planner *p, uint32_t ladder)
{
	const struct lod_plan_tables_ladder *table = lod_plan_tables_ladder(p->tables, ladder);
	assert(table);
	return &table->way;
}

/* Adds `count` times as many vertices as `each`, up to UINT64_MAX. */
static inline void lod_vertices_add(uint64_t *sum, uint64_t count, uint64_t each)
{
	uint64_t product;
	if (__builtin_mul_overflow(count, each, &product) || __builtin_add_overflow(*sum, product, sum))
		*sum = UINT64_MAX;
}

static inline uint64_t lod_planner_count(const struct eco_scene *scene, uint32_t list)
{
	return list == ECO_NONE ? 0 : scene->lists[list].primitive_count;
}
