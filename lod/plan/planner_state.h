/* Inside the planner: what its files share. By the rule that was asked for, planner_deussen.c with planner_fill.c, or planner_optimal.c with
 * allocation.c (what things gain and cost) and budget.c (down to the last vertex) find the hull points; planner_emit.c writes
 * the cuts. An entry is what is decided as one: a ladder for all plants of a slot, or a tile's summary. */
#ifndef LOD_PLANNER_STATE_H
#define LOD_PLANNER_STATE_H

#include <assert.h>

#include "lod/plan/explain.h"
#include "lod/plan/planner.h"
#include "lod/plan/plan_tables.h"
#include "lod/plan/visible_tree.h"

struct lod_entry {                   /* one ladder for all plants of one slot, or a tile's summary */
	uint32_t slot;               /* ECO_NONE: a summary */
	uint32_t ladder;             /* summary: the node */
	uint64_t count;              /* plants */
	uint64_t vertices, full;     /* per plant */
	uint32_t first, end;         /* of plants whose hash is from `first` on and below `end` */
	uint64_t more;               /* per plant whose hash is below `share`: this many instead */
	uint32_t share;
	uint64_t middle;             /* per plant whose hash is from `share` on and below `between`: so many */
	uint32_t between;            /* 0: there are none */
	double wanted;               /* points or lines of the whole region that d' asked for; summary: as large as if so many were drawn */
	double pixels;               /* expected covered pixels of one plant's organ */
	double among;                /* how much less a pixel too many of it weighs than one that is missing: 0 alone, towards 1 among others */
	struct lod_reason reason;    /* where an explanation is asked for */
};

struct lod_planner {
	const struct lod_planner_input *input;
	const struct eco_scene *scene;
	struct lod_visible_tree visible;
	uint32_t *gates;             /* per plant: where it ends, see struct eco_gate */
	struct lod_plan_tables *tables, *own;     /* the input's; or its own */
	struct lod_entry *entries;
	uint32_t entry_count, entry_capacity;
	uint64_t vertices;
	bool ended;                  /* every curve has ended: nothing could be added */
	uint64_t cheapest;           /* vertices of the cheapest step that would still gain; UINT64_MAX: none would */
	uint32_t level;
	bool converged;              /* as lod_planner_stats */
	double wrong;                /* what the optimiser's entries leave of its objective */
	uint64_t candidates, gains, looks;   /* as struct lod_planner_stats says */
	struct eco_prediction prediction;        /* of the optimiser; the other rule's is made from its entries */
	struct lod_screen screen;    /* the optimiser's */
};

/* `input` must outlive p, which is to be ended whatever comes of it. */
enum eco_code lod_planner_begin(struct lod_planner *p, const struct lod_planner_input *input, struct eco_error *error);
void lod_planner_end(struct lod_planner *p);

/* Opens tiles, and plants' cells, as sample distances d' need them, and counts plants: sets gates and slots. */
enum eco_code lod_planner_open(struct lod_planner *p, double tiles_distance, double cells_distance, struct eco_error *error);

enum eco_code lod_planner_add(struct lod_planner *p, const struct lod_entry *entry, struct eco_error *error);

/* The two rules: entries and vertices within the budget. */
enum eco_code lod_planner_deussen(struct lod_planner *p, double *sample_distance, struct eco_error *error);
enum eco_code lod_planner_optimal(struct lod_planner *p, struct eco_error *error);
/* Only looks, at a level as lod_planner_stats names it: then a allocation can be made of it (for tests). */
enum eco_code lod_planner_open_level(struct lod_planner *p, uint32_t level, struct eco_error *error);

/* Vertices to add, of plans p->vertices <= budget: sets entries' vertices, more and share, and p->vertices. */
enum eco_code lod_planner_fill(struct lod_planner *p, struct eco_error *error);

/* The plan of the entries as they are; `sample_distance` is only reported. */
enum eco_code lod_planner_emit(const struct lod_planner *p, double sample_distance, struct eco_plan *plan, struct eco_error *error);

/* Expected error of an entry that draws `vertices` a plant. */
struct eco_curve lod_planner_curve(const struct lod_planner *p, const struct lod_entry *entry, uint64_t vertices);

/* How many of a plant's instances in a band are before its gate, as a share. */
static inline double lod_planner_near(const struct lod_planner *p, uint32_t plant, uint8_t band)
{
	double share = ((double)p->gates[plant] - eco_gate_place(band, 0)) / ECO_SHARE_ONE;
	return share < 0 ? 0 : share > 1 ? 1 : share;
}

/* Of a ladder that is in an entry or an ladder choice. */
static inline const struct lod_way *lod_planner_way(const struct lod_planner *p, uint32_t ladder)
{
	const struct lod_plan_tables_ladder *table = lod_plan_tables_ladder(p->tables, ladder);
	assert(table);
	return &table->way;
}

static inline uint64_t lod_planner_count(const struct eco_scene *scene, uint32_t list)
{
	return list == ECO_NONE ? 0 : scene->lists[list].primitive_count;
}

#endif
