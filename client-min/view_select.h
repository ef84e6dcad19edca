/* Instances that each cut of a plan draws: the client's half of the rule in ecofiles/format/plan.h.
 *
 *   view_select_make(&selection, store, &eye, &error);   instances in sight, and for each the cuts that apply
 *                                                        to it
 *   ... members of cut c: selection.members[member_first[c] .. member_first[c+1])
 *         (to draw cut by cut, instanced)
 *   ... cuts of instance i: selection.cuts[cut_first[i] .. cut_first[i+1])
 *         (to draw plant by plant)
 *   view_select_free(&selection);
 *
 * The same pairs in both orders: the GPU wants few batches, the software rasteriser wants plants front to
 * back. */
#pragma once

#include "client-min/view_ground.h"
#include "client-min/view_store.h"
#include "client-min/view_table.h"
#include "lod/eye.h"

struct view_instance {
	struct lod_place place;
	/* eco_owner_instance; 0: a list drawn once, whose points carry their own owners */
	uint64_t owner;
	uint32_t plant;                  /* ECO_NONE: a list drawn once */
	uint32_t hash;                   /* share hash; varies colours too */
	uint32_t path;                   /* of the placement, for the owners of summary points */
	uint32_t tint;                   /* lod/tint.h */
	uint32_t list, index;            /* of the pack's plants: where it stands there, in each placement */
	double distance_m;               /* from the eye to the plant's centre; 0 for a list drawn once */
};

/* Representation that a cut draws, for pictures that tell representations apart. */
enum view_role {
	/* simple: triangles that are forms of others */
	VIEW_ROLE_TRIANGLES, VIEW_ROLE_SIMPLE, VIEW_ROLE_LINES, VIEW_ROLE_POINTS,
	VIEW_ROLE_BLEND_TRIANGLES, VIEW_ROLE_BLEND_SIMPLE, VIEW_ROLE_BLEND_LINES, VIEW_ROLE_BLEND_POINTS,
	                                                          /* the first elements of a list in one form,
	                                                           * those after them in another */
	VIEW_ROLE_SPLATS,            /* of a whole plant */
	VIEW_ROLE_IMPOSTORS,
	VIEW_ROLE_SUMMARY, VIEW_ROLE_COUNT
};
extern const char *const view_role_names[VIEW_ROLE_COUNT];

/* ---- Light of a picture: the sun, haze and shadows ---- */

enum view_shadows { VIEW_SHADOWS_NONE, VIEW_SHADOWS_STANDARD, VIEW_SHADOWS_PERSPECTIVE };
#define VIEW_SHADOW_SIZE 1024u           /* texels a side, unless others are asked for */
#define VIEW_SHADOW_SIZE_MIN 64u
#define VIEW_SHADOW_SIZE_MAX 8192u

struct view_sky {                        /* zero is the usual light */
	float sun[3];                    /* towards it (view_sun_at); all 0: the usual one */
	double haze_m;                   /* at sea level it hides all but 1/e of what is so far; 0: 20000 */
	enum view_shadows shadows;       /* by maps (draw/view_shadow.h) */
	uint32_t shadow_size;            /* texels a side of the map, in the limits above */
	const struct view_selection *casters;    /* view_select_casters; NULL: the plants in sight */
};

struct view_sun_place { double longitude_deg, latitude_deg, convergence_deg; };  /* openapi.yaml: origin */
/* Towards the sun in the scene's coordinates, of length 1; below the horizon sun[2] < 0. `unix_s`: seconds
 * since 1970, UTC. Source: Michalsky 1988, "The Astronomical Almanac's algorithm for approximate solar
 * position", Solar Energy 40(3); within 0.01 degrees from 1950 to 2050. */
void view_sun_at(const struct view_sun_place *place, double unix_s, float sun[3]);
/* At ten in the morning, mean solar time, of midsummer: 21 June, or 21 December south of the equator. */
void view_sun_usual(const struct view_sun_place *place, float sun[3]);

/* ---- Selections ---- */

struct view_selection {                  /* owns its arrays */
	struct view_instance *instances;
	uint32_t instance_count;
	/* the plan's, so that they can be drawn while another plan comes */
	struct eco_cut *plan_cuts;       uint32_t cut_count;
	uint32_t *cut_first, *cuts;      /* per instance (instance_count + 1), and cut indices */
	uint32_t *member_first, *members;        /* per cut (cut_count + 1), and instance indices */
	uint8_t *roles;                  /* per cut, enum view_role */
	struct view_ground ground;       /* its cuts have no members */
	struct view_image image;         /* on it */
	uint64_t visible_plants;
	uint64_t vertices;               /* what drawing it draws */
	uint64_t coarse;                 /* tiles drawn as points, and plants without their cells: 0 in full detail */
	struct view_sky sky;             /* set by who draws */
};

/* Evaluates the store's plan for this eye. A sum of vertices that differs from the plan's is ECO_DAMAGED, as
 * is a plan that names what is not held. Without a plan the selection is empty. */
enum eco_code view_select_make(struct view_selection *selection, const struct view_store *store,
	const struct lod_eye *eye, struct eco_error *error);
/* The same and, of the tiles that the plan looks at, the plants that are out of sight: all that is held that
 * may cast a shadow into the picture. Those out of sight have the cuts of the nearest band that has some. */
enum eco_code view_select_casters(struct view_selection *selection, const struct view_store *store,
	const struct lod_eye *eye, struct eco_error *error);
void view_select_free(struct view_selection *selection);

/* Instances by owner, the number that a picture's pixels hold. False: no memory. The caller frees the table.
 * */
bool view_owners_make(struct view_table *owners, const struct view_selection *selection);
/* NULL: no instance has that owner, such as a summary's point. */
const struct view_instance *view_owners_find(const struct view_table *owners,
	const struct view_selection *selection, uint64_t owner);

/* Owner of summary point `index` (an element of a list with ECO_ATTR_PLANT) in a placement. */
uint64_t view_summary_owner(const struct view_list *list, uint32_t index, uint32_t path);

/* Two hashes that say whether two clients hold and draw the same: all lists of the store, in any order of
 * arrival, and the instances of each cut of the selection. The work of a graphics driver is not in them. */
#define VIEW_DIGEST_BYTES 34             /* elements-cuts, 16 hexadecimal digits each, and 0 */
enum eco_code view_digest_write(char out[VIEW_DIGEST_BYTES], const struct view_store *store,
	const struct view_selection *selection, struct eco_error *error);
