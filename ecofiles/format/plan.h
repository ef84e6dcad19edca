/* A plan: the cuts that answer a view. The planner returns it, the wire carries it and the client draws
 * it.
 *
 * A cut says: draw primitives [first, end) of a list at a scale, for certain instances, and hold the
 * list's prefix [0, end). A cut without an anchor draws a tile's own list (a summary, or ground). A cut
 * with an anchor is a rule that server and client evaluate alike from the same integers (lod/eye.h): it
 * applies to every visible instance of the plant, in the plan's runs, whose anchor lies in the distance
 * bands [band_first, band_end) and whose hash lies in [share_first, share_end). So a plan's size does not
 * grow with the number of plants. Switches are spread over like plants: a plant's distance is blurred by
 * its hash before it is put in a band, so that they cross a border one after the other as the eye moves;
 * and a share gives some of them more detail.
 *
 * A ground tile is a cut of its own list, all of it, at scale 1 in the scene's own placement. The ground
 * tiles of a plan do not overlap and together cover all ground in view. Where tiles of different levels
 * touch, the finer one gives way (lod/ground_choice.h). Ground counts no vertices.
 *
 * A summary's points may be scattered: each is drawn as 2^halvings points around it, which together have its
 * area (lod/scattered.h). So few points look like leaves, not like balls, for no bytes.
 *
 * Vertices of a plan = sum over cuts of eco_cut_vertices * matching instances: exactly those drawn. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "ecofiles/format/pack.h"
#include "ecofiles/format/view.h"

#define ECO_BANDS 160u           /* distance bands: four an octave, blurred by half a band; lod_eye_band */
#define ECO_SHARE_ONE 65536u
#define ECO_GATE_OPEN (ECO_BANDS * ECO_SHARE_ONE)      /* gate: every band is near, cells are always drawn */

struct eco_cut {
	uint32_t list, first, end;   /* primitives */
	float scale;                 /* area factor; points: of the list's unit_area */
	uint32_t placement;          /* for a tile's own list; rules: unused (0) */
	/* rule: scene's anchor index; ECO_NONE: the list is drawn once, in its placement */
	uint32_t anchor;
	uint8_t band_first, band_end;
	uint8_t halvings;            /* of a summary's points, at most ECO_HALVINGS_MAX; 0 for all others */
	uint32_t share_first, share_end;     /* of ECO_SHARE_ONE */
};
#define ECO_HALVINGS_MAX 6u
#define ECO_CUT_PRIMITIVES_MAX (1u << 28)

/* Primitives and vertices that a cut of `list` draws for one instance. */
static inline uint64_t eco_cut_primitives(const struct eco_cut *cut)
{
	return (uint64_t)(cut->end - cut->first) << cut->halvings;
}
static inline uint64_t eco_cut_vertices(const struct eco_cut *cut, const struct eco_list *list)
{
	return eco_cut_primitives(cut) * eco_list_vertices(list);
}

/* how a nested eco file's coordinates become the scene's: world = at + scale * turn(p) */
struct eco_placement {
	double at[3];
	uint16_t turn;
	double scale;
	uint32_t path;               /* names this occurrence, see owners below */
};
/* The placement of what `child` places, inside `outer`; its path is still that of `outer`. */
struct eco_placement eco_placement_inside(const struct eco_placement *outer, const struct eco_child *child);
/* world and p may be the same. */
void eco_placement_point(const struct eco_placement *placement, const double p[3], double world[3]);

/* instance lists [list_first, list_end), whose visible plants are drawn by the rules */
struct eco_run {
	uint32_t placement, list_first, list_end;
	/* of ECO_SHARE_ONE: plants whose lod_open_hash is below are left to their tile's summary; 0: all are
	 * drawn */
	uint32_t left;
};

/* a plant's cells are drawn where eco_gate_place is below `end`; no gate without cells */
struct eco_gate {
	uint32_t plant, end;
};
/* An instance's rank at its plant's gate: lower bands first, and within a band lower hashes first. Ranks
 * below the gate's `end` draw cells. So a moving gate passes like plants one after the other, and in the
 * band where it ends cuts tell the two kinds apart by share. */
static inline uint32_t eco_gate_place(uint8_t band, uint32_t hash) { return band * ECO_SHARE_ONE + hash; }

struct eco_prediction {          /* pixels expected right and wrong, over the whole picture */
	double tp, fp, fn;
};
/* Q of Neubert 2011, section 2.2, from expected pixels; lod_score takes it from counted ones
 * (lod/raster/raster.h). */
double eco_predicted_q(const struct eco_prediction *prediction);

struct eco_plan {                /* owns its arrays */
	uint64_t vertices;           /* exactly the vertices drawn */
	uint64_t visible_plants;     /* instances that pass the view test */
	/* d' of Deussen 2002, radians (image plane at distance 1); 0: everything */
	double sample_distance;
	double ground_px;            /* how far its ground may be from where it is; not sent */
	struct eco_prediction prediction;
	/* expected mean CIELAB distance, to full detail, of mean colors of blocks of 16 x 16 pixels; 0 with
	 * Deussen's rule, which knows no errors that are seen */
	double m16;
	struct eco_placement *placements; uint32_t placement_count;   /* [0] is the scene itself */
	struct eco_run *runs;             uint32_t run_count;
	struct eco_gate *gates;           uint32_t gate_count;
	/* summaries and ground first; see eco_plan_sort */
	struct eco_cut *cuts;             uint32_t cut_count;
};
#define ECO_PLAN_ITEMS_MAX (1u << 22)   /* of each array */
void eco_plan_free(struct eco_plan *plan);

/* Puts the arrays in the order in which they are sent: runs by placement and list, gates by plant; cuts
 * drawn once by placement and list, then rules by anchor, list and band; ties by all other fields. Drawing
 * does not depend on it. */
void eco_plan_sort(struct eco_plan *plan);

/* Checks a sorted plan as far as possible without its scene: order, runs that do not overlap, one gate a
 * plant, ranges that are not empty, bands, shares, placements that exist, finite numbers (scales of cuts
 * in [0, 1e12], of placements above 0). The text names the item. */
enum eco_code eco_plan_check(const struct eco_plan *plan, struct eco_error *error);

/* A client's holdings: whole chunks of a prefix, per list. Sorted by list, no list twice. */
struct eco_holding { uint32_t list, chunks; };
struct eco_holdings { struct eco_holding *items; uint32_t count; };
#define ECO_HOLDINGS_MAX (1u << 20)
/* 0 if none; NULL holdings allowed */
uint32_t eco_holdings_chunks(const struct eco_holdings *holdings, uint32_t list);

/* Owners, for owner_q: 64 bits that name a plant or a summary point, 0 is "nothing" (layout in plan.c). A
 * plant's owner has the key of its leaf tile, its species and its index in the instance list. A summary
 * point's has the leaf tile's key (16 bits) and the species, and matches any such plant. A key is a sum of
 * hashes: of the leaf tile and of every eco_child with `placed` above it. So it can be built from the leaf up
 * (when summaries are merged) and from the root down (eco_placement.path is the sum over the children).
 * Summaries store keys relative to their own tile's, which needs only differences of tile ids (eco_owner_leaf
 * is linear): so a summary stays true where tiles before it come or go, as when packs are linked. */
uint32_t eco_owner_leaf(uint32_t tile);
uint32_t eco_owner_child(uint32_t number);
/* The step that `child` of `tile` adds to a key: 0 if it is not placed, or is all that the root has (so
 * that moving a whole scene renames no plant and changes no share and no blur, lod/eye.h). Else a hash of
 * the child's index within its tile and of the distance, in the table, to the tile it places. */
uint32_t eco_owner_step(const struct eco_scene *scene, uint32_t tile, uint32_t child);
uint64_t eco_owner_instance(uint32_t key, uint32_t plant, uint32_t index);
/* only the low 16 bits of the key count */
uint64_t eco_owner_summary(uint32_t key, uint32_t plant);
bool eco_owner_match(uint64_t a, uint64_t b);
/* The low 16 bits of the species' id. */
uint32_t eco_owner_plant(uint64_t owner);
