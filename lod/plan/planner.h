/* From a view and a budget to a plan.
 *
 *   lod_plan(&plan, &input, &error);
 *
 * It culls the tile tree, counts plants by anchor and band, lets a rule spend the budget and emits cuts.
 * Method and words: lod/plan/README.md. No clock, no I/O, no globals. */
#pragma once

#include <stdatomic.h>
#include <stdbool.h>

#include "ecofiles/format/plan.h"

/* A rule decides how much of each plant and summary in view is drawn within the budget: it fills the
 * planner's entries and its prediction (lod/plan/planner_state.h). Set-up and cuts are common to rules. */
struct lod_planner;
typedef enum eco_code lod_rule(struct lod_planner *planner, struct eco_error *error);
lod_rule lod_rule_optimal;           /* fewest expected wrong pixels: measured error x area x visibility */
lod_rule lod_rule_deussen;           /* one sample distance d' (Deussen 2002, section 5); ignores occlusion */

/* The effort of planning, in counts. All but places, work and converged: lod_rule_optimal. */
struct lod_planner_stats {
	uint64_t looks;              /* hulls searched for a lambda: choices in view x lambdas tried */
	uint64_t places;             /* plants looked at one by one */
	uint64_t work;               /* all of it, in units of about 7 ns */
	uint64_t cheapest;           /* vertices of the cheapest step of a hull; UINT64_MAX: none is left */
	uint32_t level;              /* level of detail: finer where every curve of a coarser one had ended */
	bool converged;              /* the search ended by its tolerance, not by its bound of tries */
	uint64_t bytes;              /* of the answer; above request->bytes: not even the smallest fits */
	uint32_t sized;              /* how often bytes were counted */
	double price;                /* wrong pixels that a byte had to save; 0: bytes did not bind */
	double wrong;                /* the objective that this plan reaches: visible wrong pixels, summed
	                              * over plants. plan->prediction: of the picture, where plants hide
	                              * plants */
};

struct lod_explanation;

/* Coarser answers to the same request, made after the answer by the same allocation at higher prices of a
 * byte. From fine to coarse, each with about 1 / ratio of the bytes of plants that the one before it has, and on
 * ground that takes at most a quarter of its bytes. Only lod_rule_optimal makes any, of a plan that is sent. */
struct lod_planner_coarser {
	double ratio;                /* above 1 */
	uint64_t least;              /* payloads in bytes that the client lacks: each answer has fewer than the one
	                              * before it, and none follows one of so few, or of half as many without ground */
	uint32_t most;               /* answers */
	struct eco_plan *plans;      /* room for these; the caller frees each, also after an error */
	uint32_t count;              /* set by lod_plan */
};

/* Everything the planner needs of a scene that depends on no view (lod/plan/plan_tables.h), for plans of any
 * number of threads. `scene` must outlive the tables. */
struct lod_plan_tables;
enum eco_code lod_plan_tables_make(struct lod_plan_tables **tables, const struct eco_scene *scene,
	struct eco_error *error);
void lod_plan_tables_free(struct lod_plan_tables *tables);       /* NULL is allowed */

/* Whether the places of a group's plants are there, where they come later than the rest of a scene. */
enum lod_places { LOD_PLACES_MISSING, LOD_PLACES_WANTED, LOD_PLACES_KNOWN };

struct lod_planner_input {
	const struct eco_scene *scene;
	struct lod_plan_tables *tables;              /* of this scene, kept from plan to plan; NULL: made
	                                              * for this plan, which takes a multiple of the time */
	const struct eco_request *request;
	const struct eco_holdings *holdings;         /* of lists that the scene has; may be NULL; cuts depend on
	                                              * no other history */
	uint64_t tiles_max, placements_max;          /* bounds of the walk; 0: 1,000,000 and 100,000 */
	lod_rule *rule;                              /* NULL: lod_rule_optimal */
	bool ignore_occlusion;                       /* every plant counts as wholly visible: to measure */
	/* Work that the plan may take, in units of stats->work; 0: any. It is counted, not timed, so that the same
	 * request ends the same everywhere; lod/plan/README.md, Work, says what ends first. A rule that knows no
	 * bytes is asked for several plans within them, each with an eighth of the work. */
	uint64_t work_max;
	uint64_t level_work;                         /* the same for the level alone, so that plans of one
	                                              * request that share work have one; 0: work_max */
	const atomic_bool *cancelled;                /* ends the plan: ECO_INTERRUPTED; may be NULL */
	/* enum lod_places per group; NULL: all are known. A plan that would look at missing ones marks them as
	 * wanted and ends with ECO_INTERRUPTED. Made again once they are known, it is the plan of the whole scene */
	uint8_t *places;
	struct lod_planner_stats *stats;             /* may be NULL */
	struct lod_explanation *explanation;         /* lod/plan/explain.h, empty; NULL: no reasons */
	struct lod_planner_coarser *coarser;         /* NULL: none */
	/* The plan is sent: the bytes of its answer (ecofiles/format/wire_body.h) are counted, and are at most
	 * request->bytes. The ground gives way first, then plants; if nothing else fits the plan draws nothing on the
	 * coarsest ground. false: bytes do not count */
	bool sent;
	/* Chunks per list, sorted, that the answer would need if bytes did not bind: for callers that have bytes
	 * left. No items where they do not bind. The caller frees items. NULL: not asked for */
	struct eco_holdings *wanted;
};

/* Never above request->vertices; nor above request->bytes, if the plan is sent and anything fits. */
enum eco_code lod_plan(struct eco_plan *plan, const struct lod_planner_input *input, struct eco_error *error);

/* Replaces the ground of a plan by the tiles that `ground_px` asks for (0: ECO_GROUND_PX). lod_plan ends
 * with it. */
enum eco_code lod_plan_ground(struct eco_plan *plan, const struct eco_scene *scene,
	const struct eco_view *view, double ground_px, struct eco_error *error);

/* The fewest chunks of a list that hold its first `end` primitives. */
uint32_t lod_plan_chunks_for(const struct eco_scene *scene, uint32_t list, uint32_t end);
/* Per list of the plan, sorted: the number of chunks that its largest cut needs. The caller frees items. */
enum eco_code lod_plan_needs(const struct eco_scene *scene, const struct eco_plan *plan,
	struct eco_holdings *needs, struct eco_error *error);
/* Payloads of these in bytes that a client with these holdings (NULL: none) lacks; *ground, where it is not NULL: those
 * of ground. */
uint64_t lod_plan_missing(const struct eco_scene *scene, const struct eco_holdings *holdings,
	const struct eco_holdings *needs, uint64_t *ground);
