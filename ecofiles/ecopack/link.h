/* `ecopack link`: packs that were built apart become one. Stored lists are copied; only the tiles above
 * them are made. */
#pragma once

#include <jansson.h>

#include "ecofiles/ecopack/make.h"

#define LINK_PARTS_MAX 4095u

struct link_options {
	const char *pack;            /* the target */
	const char *const *parts;    /* packs, at least one */
	uint32_t count;
	uint32_t jobs;               /* threads; 0: as many as there are processors */
};

/* The result equals, byte for byte, the pack that `ecopack make` builds from a scene that nests the parts'
 * scene files in this order, provided that no two parts nest the same file and none has ground. On failure
 * the target is untouched. */
enum eco_code link_packs(const struct link_options *options, struct eco_error *error);

/* ---- Inside ---- */

struct link_part {
	const char *path;
	struct eco_pack *pack;
	json_t *meta;
	double at[3];                /* the part's origin in the whole */
	uint32_t *plant_of;          /* plant of the part -> plant of the whole */
	uint32_t *color_of;          /* the same for colours */
	uint32_t *list_of;           /* the same for lists; ECO_NONE: not taken (yet) */
	bool renamed;                /* plants are renumbered, so summaries must be rewritten */
	uint32_t tile_first;
	const struct eco_list *tinted;       /* the last instance list with tints, and its colours in the whole */
	uint32_t tint_first;
	struct eco_inventory_block rows;     /* the block that was read last */
	uint32_t cell_of[ECO_INVENTORY_CELLS];       /* the same for its rows' cells */
};

struct link_known { struct eco_chunk_id id; };       /* hash of a plant without its name */

struct link {
	struct make m;
	struct link_part *parts;     uint32_t count;
	struct link_known *known;    /* per plant of the whole */
	uint32_t plant_room;
	json_t *plants;              /* plants in META of the whole */
	json_t *drawn;               /* META's, of the part that gives the image of the ground; NULL: none */
	const struct link_options *options;
};

/* Adds the textures of all parts, once those that are shared. */
void link_textures(struct link *l);
/* Adds a part's plants, except those already known. */
void link_plants(struct link *l, struct link_part *part);
/* The whole's record of a part's list, with references to plants, colours and lists renumbered. */
struct eco_list link_list(const struct link_part *part, uint32_t list);
/* Copies a part's list without decoding it; part->list_of has its number then. */
void link_copy(struct link *l, struct link_part *part, uint32_t list, const struct eco_list *record);
