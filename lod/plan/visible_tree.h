/* The part of a scene that a view sees, opened as far as asked and remembered: the planner tries many detail levels, and each
 * needs the tile tree only down to where summaries suffice.
 *
 *   lod_visible_tree_init(&v, scene, view, ...);
 *   lod_visible_tree_count(&v, sample_distance, gates, &error)   opens what this level needs, counts plants by (anchor, band)
 *   ... v.slots, v.nodes[i].active ...                      what the planner turns into cuts
 *   lod_visible_tree_free(&v);
 *
 * Plants are counted in slots: all visible instances whose anchor lies in one distance band are alike to the planner, so its
 * work grows with species x bands, not with plants. */
#ifndef LOD_VISIBLE_TREE_H
#define LOD_VISIBLE_TREE_H

#include "ecofiles/format/plan.h"
#include "lod/plan/visibility.h"
#include "lod/eye.h"

struct lod_tally {               /* plants of one leaf tile in one slot */
	uint32_t slot, count;
	uint8_t whole_band;          /* of the plant itself: cells count only where it is before the plant's gate */
};

enum lod_state { LOD_CLOSED, LOD_SUMMARY, LOD_OPEN };

struct lod_node {                /* a tile in a placement */
	uint32_t tile, placement;
	bool seen, expanded;
	enum lod_state state;        /* at the last count */
	double distance;             /* metres from the eye to the nearest point of its box */
	double area;                 /* m^2, scaled to the scene */
	uint32_t child_first, child_count;       /* nodes */
	struct lod_tally *tallies;   uint32_t tally_count, tally_capacity;
	uint8_t *gate_done;          /* per group: plants in bands below it have their cells counted */
	uint64_t plants;
	uint32_t left;               /* LOD_OPEN: of its own plants, those whose lod_open_hash is below are left to its summary */
	double points;               /* of its summary this share is drawn: 1 where it is LOD_SUMMARY, and less where it gives way to plants */
};

struct lod_slot {
	uint32_t anchor, plant;
	uint8_t band;
	bool cell;                   /* anchor is not the whole plant */
	uint64_t count;              /* at the last lod_visible_tree_count */
	uint64_t near;               /* of whole plants: so many of them draw their cells */
	double above, above_count;        /* of so many plants, ever: the sum of how far from above they are seen (lod_seen_above) */
	uint32_t last_node, last_tally;      /* where this slot was counted last */
};

struct lod_visible_tree {
	const struct eco_scene *scene;
	struct lod_eye eye;
	struct lod_node *nodes;              uint32_t node_count, node_capacity;
	struct eco_placement *placements;    uint32_t placement_count, placement_capacity;
	struct lod_slot *slots;              uint32_t slot_count, slot_capacity;
	uint32_t *slot_table;                uint32_t slot_table_size;     /* open addressing: slot index + 1 */
	struct lod_anchor_band *scratch;
	uint64_t nodes_max, placements_max;
	uint64_t plants;                     /* visible, at the last count */
	uint64_t places;                     /* plants looked at, ever */
	uint64_t places_walked, places_max;         /* plants looked at since the start; 0: no bound */
	struct lod_screen *screen;           /* may be NULL; every plant that is seen is added to it, once: with its node and slot */
	const struct lod_proxy_shape *proxy_shapes;       /* with screen: per plant, at scale 1 */
};

enum eco_code lod_visible_tree_init(struct lod_visible_tree *visible, const struct eco_scene *scene, const struct eco_view *view,
	uint64_t nodes_max, uint64_t placements_max, struct eco_error *error);
void lod_visible_tree_free(struct lod_visible_tree *visible);
/* Forgets all but the root: after a walk that was too large, so that a coarser one has all the room there is. */
enum eco_code lod_visible_tree_restart(struct lod_visible_tree *visible, struct eco_error *error);

/* Splat points that a tile's summary needs at sample distance d' (Deussen 2002, eq. 1), not bounded by what it has. */
double lod_summary_points(const struct lod_node *node, double sample_distance);

/* Walks the tree: a tile whose summary has enough points for `sample_distance` (radians; 0: never) is LOD_SUMMARY; other tiles are
 * opened, their plants counted into the slots; cells of plants before gates[plant], which is whole bands. ECO_TOO_LARGE when the walk would
 * exceed its bounds. */
enum eco_code lod_visible_tree_count(struct lod_visible_tree *visible, double sample_distance, const uint32_t *gates,
	struct eco_error *error);

/* Counts again after the caller changed states of nodes or lowered gates, be it to within a band. */
void lod_visible_tree_recount(struct lod_visible_tree *visible, const uint32_t *gates);

/* The slot of plants whose `anchor` lies in `band`, or ECO_NONE. */
uint32_t lod_visible_tree_slot(struct lod_visible_tree *visible, uint32_t anchor, uint8_t band);

/* A tile's box in the world: its middle, and half of it across (mean of both sides) and upwards. */
void lod_visible_tree_box(const struct lod_visible_tree *visible, const struct lod_node *node, double center[3], double *across, double *up);

/* Calls back for every visible plant of the open tiles, with its run's placement: for shares and for tests. */
typedef void (*lod_visible_tree_fn)(void *ctx, const struct lod_anchor_band *anchors, uint32_t anchor_count, uint32_t plant,
	uint32_t share_hash);
void lod_visible_tree_each(struct lod_visible_tree *visible, uint32_t plant, const uint32_t *gates, lod_visible_tree_fn fn, void *ctx);

#endif
