/* From a view and a budget to a plan.
 *
 *   lod_plan(&plan, &input, &error);      cull the tile tree, count plants by anchor and band, see how much of each shows, find the
 *                                         lambda of a vertex at which the best hull points use the budget, emit cuts
 *
 * No clock, no I/O, no globals. */
#ifndef LOD_PLANNER_H
#define LOD_PLANNER_H

#include <stdbool.h>

#include "ecofiles/format/plan.h"

/* A rule decides how much of everything in view is drawn within the budget. It fills the planner's entries and its prediction
 * (lod/plan/planner_state.h); what is common to rules, such as culling and cuts, is around it. */
struct lod_planner;
typedef enum eco_code lod_rule(struct lod_planner *planner, struct eco_error *error);
lod_rule lod_rule_optimal;           /* one objective: expected wrong pixels from the curves x projected area x visible share */
lod_rule lod_rule_deussen;           /* one sample distance d' for everything (Deussen 2002, section 5); knows of no occlusion */

struct lod_planner_stats {           /* what planning took; counts, no times */
	uint64_t candidates;         /* steps that could be taken: of everything in view, from nothing to all of it */
	uint64_t gains;              /* of these, whose gain was computed for this plan: what comes next of all that is drawn, and what
	                              * lambdas asked of summaries */
	uint64_t looks;              /* how often it was looked up which steps are worth a lambda: things in view x lambdas tried */
	uint64_t places;             /* plants looked at one by one */
	uint64_t cheapest;           /* optimiser: vertices of the cheapest step that is left and would gain; UINT64_MAX: every curve has ended */
	uint32_t level;              /* optimiser: how far the scene was opened: further where all that was open had ended */
	bool converged;              /* the search for what uses the budget ended by itself, and not at a bound of tries; the plan is sound either way */
	double wrong;                /* optimiser, at that level: the objective, of this plan exactly: seen wrong pixels, each plant for
	                              * itself. plan->prediction is of the whole picture, where plants stand before plants */
};

struct lod_explanation;
struct lod_plan_tables;
struct lod_planner_input {
	const struct eco_scene *scene;
	struct lod_plan_tables *tables;                   /* of this scene (lod/plan/plan_tables.h), kept from plan to plan; NULL: made and thrown away, which
	                                              * takes a multiple of the time */
	const struct eco_request *request;
	const struct eco_holdings *holdings;         /* may be NULL; the optimiser may use them, cuts never depend on history otherwise */
	uint64_t tiles_max, placements_max;          /* bounds of the walk; 0: 1,000,000 and 100,000 */
	lod_rule *rule;                              /* NULL: lod_rule_optimal */
	bool ignore_occlusion;                       /* every plant counts as wholly visible: to measure what occlusion is worth */
	struct lod_planner_stats *stats;             /* may be NULL */
	struct lod_explanation *explanation;         /* lod/plan/explain.h, empty; NULL: reasons are not asked for and cost nothing */
};

/* Never above request->vertices. request->bytes is not looked at here: the server searches the vertex budget whose stream fits. */
enum eco_code lod_plan(struct eco_plan *plan, const struct lod_planner_input *input, struct eco_error *error);

/* Replaces the ground of a plan by the tiles that `ground_px` asks for (0: ECO_GROUND_PX); the rest stays. lod_plan ends with this. */
enum eco_code lod_plan_ground(struct eco_plan *plan, const struct eco_scene *scene, const struct eco_view *view, double ground_px,
	struct eco_error *error);

/* For each list in the plan, how many chunks its largest cut needs; sorted by list. Owned by the caller (free items). */
enum eco_code lod_plan_needs(const struct eco_scene *scene, const struct eco_plan *plan, struct eco_holdings *needs,
	struct eco_error *error);

#endif
