/* The part of a scene that a view sees. The tile tree is opened only as far as a level of detail needs, and
 * what was opened is kept for the next level.
 *
 *   lod_visible_tree_init(&v, scene, view, ...);
 *   lod_visible_tree_count(&v, d, gates, &error)    opens what a level needs, counts plants by anchor and
 *                                                   band
 *   ... v.slots, v.nodes ...                        rules turn these into cuts
 *   lod_visible_tree_free(&v);
 *
 * Plants are counted in slots: all visible instances of an anchor in one distance band are alike to the
 * planner, so its work grows with species x bands, not with plants. */
#pragma once

#include "ecofiles/format/plan.h"
#include "lod/seen/visibility.h"
#include "lod/eye.h"

struct lod_tally {                   /* plants of one tile in one slot */
	uint32_t slot, count;
	uint8_t whole_band;          /* of a cell: the whole plant's band; the cell counts only if that is
	                              * before the gate */
};

enum lod_state { LOD_CLOSED, LOD_SUMMARY, LOD_OPEN };

struct lod_node {                    /* a tile in a placement */
	uint32_t tile, placement;
	bool seen, expanded;
	enum lod_state state;        /* at the last count */
	double distance;             /* metres from the eye to the nearest point of its box */
	double area;                 /* m^2, scaled to the scene */
	uint32_t child_first, child_count; /* nodes */
	struct lod_tally *tallies;   uint32_t tally_count, tally_capacity;
	uint8_t *gate_done;          /* per group: cells of plants in bands below it were counted */
	uint64_t plants;
	uint32_t seen_first, *seen_end;      /* per group, once its plants were counted: those in view */
	uint32_t left;               /* LOD_OPEN: its own plants with a lod_open_hash below are left to its
	                              * summary */
	double points;               /* share of its summary that is drawn: 1 if LOD_SUMMARY, less where it
	                              * gives way to plants */
};

struct lod_slot {
	uint32_t anchor, plant;
	uint8_t band;
	bool cell;                   /* anchor is not the whole plant */
	uint64_t count;              /* at the last count */
	uint64_t near;               /* of whole plants, at the last count: those that draw cells */
	uint32_t whole_from;         /* beyond the gate, plants with a hash from here on draw a ladder that
	                              * shows the whole plant; ECO_SHARE_ONE: none */
	uint64_t whole;              /* at the last recount: how many */
	double above, above_count;   /* sum of lod_seen_above over plants ever counted; their number */
	uint32_t last_node, last_tally; /* where the slot was last counted */
};

struct lod_seen { uint32_t slot, index; uint16_t hash; };     /* a plant in view; index: in its group */

/* Bounds of a walk; 0: none. */
struct lod_walk_bounds {
	uint64_t nodes, places;      /* tiles; plants walked over since the start */
	uint64_t nodes_few, places_few;      /* beyond these, tiles that have a summary show it */
	uint64_t cells;              /* where all plants draw their cells: of all in open tiles */
};

struct lod_visible_tree {
	const struct eco_scene *scene;
	struct lod_eye eye;
	struct lod_node *nodes;              uint32_t node_count, node_capacity;
	struct eco_placement *placements;    uint32_t placement_count, placement_capacity;
	struct lod_slot *slots;              uint32_t slot_count, slot_capacity;
	uint32_t *slot_table;                uint32_t slot_table_size; /* open addressing: slot index + 1 */
	struct lod_seen *seen;               uint32_t seen_count, seen_capacity;   /* by tile and group */
	struct lod_anchor_band *scratch;
	uint8_t *known;              /* enum lod_places per group; NULL: all are known */
	uint64_t nodes_max, placements_max;
	struct lod_walk_bounds bounds;       /* of the next walk, the caller's */
	uint64_t plants;             /* visible, at the last count */
	uint64_t places;             /* plants walked over, ever */
	uint64_t places_walked;      /* the same since the start */
	uint64_t cells_most;         /* where any plants of a species may, of all of it; 0: no bound */
	struct lod_screen *screen;   /* may be NULL; every visible plant is added once, with its node and
	                              * slot */
	const struct lod_proxy_shape *proxy_shapes; /* with screen: per plant, at scale 1 */
};

enum eco_code lod_visible_tree_init(struct lod_visible_tree *visible, const struct eco_scene *scene,
	const struct eco_view *view, uint64_t nodes_max, uint64_t placements_max, struct eco_error *error);
void lod_visible_tree_free(struct lod_visible_tree *visible);
/* Forgets all but the root, so that a coarser walk can follow one that was too large. */
enum eco_code lod_visible_tree_restart(struct lod_visible_tree *visible, struct eco_error *error);

/* Splat points that a tile's summary needs at sample distance d' (Deussen 2002, eq. 1); may exceed the points
 * it has. */
double lod_summary_points(const struct lod_node *node, double sample_distance);

/* Walks the tree. A tile whose summary has enough points for `sample_distance` (radians; 0: never) becomes
 * LOD_SUMMARY; other tiles are opened and their plants counted into slots, and cells of plants before
 * gates[plant], a multiple of ECO_SHARE_ONE. ECO_TOO_LARGE beyond the bounds: all is as it was. */
enum eco_code lod_visible_tree_count(struct lod_visible_tree *visible, double sample_distance,
	const uint32_t *gates, struct eco_error *error);

/* In a band, plants with a hash below this are before the gate. */
static inline uint32_t lod_near_end(uint32_t gate, uint8_t band)
{
	uint32_t place = eco_gate_place(band, 0);
	return gate < place ? 0 : gate - place < ECO_SHARE_ONE ? gate - place : ECO_SHARE_ONE;
}

/* Counts again after the caller changed nodes' states, slots' whole_from, or lowered gates, to any place in a
 * band. */
void lod_visible_tree_recount(struct lod_visible_tree *visible, const uint32_t *gates);

/* The slot of an anchor in a band, or ECO_NONE. */
uint32_t lod_visible_tree_slot(const struct lod_visible_tree *visible, uint32_t anchor, uint8_t band);

/* A tile's box in the world: its middle, half of it across (mean of both sides) and half of it upwards. */
void lod_visible_tree_box(const struct lod_visible_tree *visible, const struct lod_node *node,
	double center[3], double *across, double *up);

/* Calls fn for every visible instance of `plant` in open tiles that is not left to a summary. */
typedef void (*lod_visible_tree_fn)(void *ctx, const struct lod_anchor_band *anchors, uint32_t anchor_count,
	uint32_t plant, uint32_t share_hash);
void lod_visible_tree_each(struct lod_visible_tree *visible, uint32_t plant, const uint32_t *gates,
	lod_visible_tree_fn fn, void *ctx);
