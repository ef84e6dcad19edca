/* Shared by the files of `ecopack link`. */
#ifndef ECO_MAIN_LINK_PART_H
#define ECO_MAIN_LINK_PART_H

#include <jansson.h>

#include "ecofiles/ecopack/make.h"

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
	struct eco_inventory_block rows;     /* the block that was read last */
};

struct link_known { struct eco_chunk_id id; };       /* hash of a plant without its name */

struct link {
	struct make m;
	struct link_part *parts;     uint32_t count;
	struct link_known *known;    /* per plant of the whole */
	uint32_t plant_room;
	json_t *plants;              /* plants in META of the whole */
};

/* Adds the textures of all parts, once those that are shared (make_textures.h). */
enum eco_code link_textures(struct link *l);
/* Adds a part's plants, except those already known. */
enum eco_code link_plants(struct link *l, struct link_part *part);
/* The whole's record of a part's list, with references to plants, colours and lists renumbered. */
struct eco_list link_list(const struct link_part *part, uint32_t list);
enum eco_code link_copy(struct link *l, struct link_part *part, uint32_t list, const struct eco_list *record);

#endif
