/* A plan: the cuts that answer a view. What the planner returns, the wire carries and the client draws.
 *
 * A cut says: for those instances, draw primitives [first, end) of that list at that scale, and hold its prefix [0, end).
 * "Those instances" is either a tile's own list (a summary), or a rule that server and client evaluate alike from the same
 * integers (lod/eye.h): every visible instance of the plant in the plan's runs whose anchor lies in the distance bands
 * [band_first, band_end) and whose hash lies in [share_first, share_end). So a plan's size does not grow with the plants, and a
 * switch can be spread over them: a plant's distance is blurred by its hash before it is put in a band, so that like plants cross a
 * border one after the other as the eye moves; and a share lets a part of them have more.
 *
 * A tile of the ground is a cut of its own list, all of it, at scale 1 in the scene's own placement. The tiles of a plan do not overlap and
 * together cover all the ground that is in view. Where tiles of different levels touch, the finer one gives way (lod/ground_choice.h). Ground
 * counts no vertices.
 *
 * Vertices of a plan = sum over cuts of (end - first) * eco_list_vertices(list) * matching instances: exactly what is drawn. */
#ifndef ECO_PLAN_H
#define ECO_PLAN_H

#include <stdbool.h>
#include <stdint.h>

#include "ecofiles/format/pack.h"
#include "ecofiles/format/view.h"

#define ECO_BANDS 160u           /* distance bands: four an octave, blurred by half of one: see lod_eye_band */
#define ECO_SHARE_ONE 65536u
#define ECO_GATE_OPEN (ECO_BANDS * ECO_SHARE_ONE)      /* gate: every band is near, cells are always drawn */

struct eco_cut {
	uint32_t list, first, end;   /* primitives */
	float scale;                 /* area factor; points: of the list's unit_area */
	uint32_t placement;          /* of a tile's own list; for rules unused (0) */
	uint32_t anchor;             /* rule: scene's anchor index; ECO_NONE: the list is drawn once, in its placement */
	uint8_t band_first, band_end;
	uint32_t share_first, share_end;     /* of ECO_SHARE_ONE */
};

struct eco_placement {           /* how a nested eco file's coordinates become the scene's: world = at + scale * turn(p) */
	double at[3];
	uint16_t turn;
	double scale;
	uint32_t path;               /* names this occurrence, see owners below */
};

struct eco_run {                 /* instance lists [list_first, list_end), whose visible plants are drawn by the rules */
	uint32_t placement, list_first, list_end;
	uint32_t left;               /* of ECO_SHARE_ONE: plants whose lod_open_hash is below are not, but left to their tile's summary. 0:
	                              * all are drawn */
};

struct eco_gate {                /* plant's cells are drawn where eco_gate_place is below `end`; plants without cells are not listed */
	uint32_t plant, end;
};
/* Where an instance stands before its plant's gate: the nearer its band, and in one band the smaller its hash, the sooner it draws cells. So a
 * gate moves past like plants one after the other, and in the band where it ends cuts tell those that draw cells from all others by their share. */
static inline uint32_t eco_gate_place(uint8_t band, uint32_t hash) { return band * ECO_SHARE_ONE + hash; }

struct eco_prediction {          /* pixels expected right and wrong, over the whole picture */
	double tp, fp, fn;
};
/* Q of Neubert 2011, section 2.2, from expected pixels, as lod_score has it from counted ones (lod/raster/raster.h). */
double eco_predicted_q(const struct eco_prediction *prediction);

struct eco_plan {                /* owns its arrays */
	uint64_t vertices;           /* exactly what drawing it draws */
	uint64_t visible_plants;     /* instances that pass the view test */
	double sample_distance;      /* d' of Deussen 2002, radians (image plane at distance 1); 0: everything */
	struct eco_prediction prediction;
	struct eco_placement *placements; uint32_t placement_count;   /* [0] is the scene itself */
	struct eco_run *runs;             uint32_t run_count;
	struct eco_gate *gates;           uint32_t gate_count;
	struct eco_cut *cuts;             uint32_t cut_count;         /* summaries and ground first; see eco_plan_sort */
};
#define ECO_PLAN_ITEMS_MAX (1u << 22)   /* of each array */
void eco_plan_free(struct eco_plan *plan);

/* Puts the arrays in the one order that travels: runs by placement and list, gates by plant; lists drawn once by placement and list, then
 * rules by anchor, list and band; what is equal in these by all other fields. Drawing does not depend on it. */
void eco_plan_sort(struct eco_plan *plan);

/* What can be told of a sorted plan without its scene: order, runs that do not overlap, no plant with two gates, ranges that are not
 * empty, bands, shares, placements that exist, finite numbers (scales of cuts in [0, 1e12], of placements above 0). The text names
 * the item. */
enum eco_code eco_plan_check(const struct eco_plan *plan, struct eco_error *error);

/* What a client holds: whole chunks of a prefix, per list. Sorted by list, no list twice. */
struct eco_holding { uint32_t list, chunks; };
struct eco_holdings { struct eco_holding *items; uint32_t count; };
#define ECO_HOLDINGS_MAX (1u << 20)
uint32_t eco_holdings_chunks(const struct eco_holdings *holdings, uint32_t list);   /* 0 if none; NULL holdings allowed */

/* Owners, for owner_q: 64 bits, 0 is "nothing" (layout in plan.c). A plant is named by the key of its leaf tile, its species and
 * its index in the instance list; a summary point by leaf tile key (16 bits) and species, which matches any such plant. A key is a
 * sum of hashes, of the leaf tile and of every eco_child with `placed` above it, so that it can be built from the leaf up (when
 * summaries are merged) and from the root down (eco_placement.path is the sum over the children). What summaries store counts from their
 * own tile: eco_owner_leaf is linear, and steps depend on differences of tile ids alone. So a summary stays true where tiles before it
 * come or go, as when packs are linked. */
uint32_t eco_owner_leaf(uint32_t tile);
uint32_t eco_owner_child(uint32_t number);
/* What `child` of `tile` adds to a key: its hash where it is placed; but nothing where it is all that the root has, so that moving a whole
 * scene renames no plant (and so changes no share and no blur, lod/eye.h). The hash is of which child of its tile it is and of how far on
 * in the table the tile lies that it places. */
uint32_t eco_owner_step(const struct eco_scene *scene, uint32_t tile, uint32_t child);
uint64_t eco_owner_instance(uint32_t key, uint32_t plant, uint32_t index);
uint64_t eco_owner_summary(uint32_t key, uint32_t plant);                /* only the low 16 bits of the key count */
bool eco_owner_match(uint64_t a, uint64_t b);

#endif
