/* Inside `ecopack link`: what its files share. */
#ifndef ECO_MAIN_LINK_PART_H
#define ECO_MAIN_LINK_PART_H

#include <jansson.h>

#include "ecofiles/ecopack/make.h"

struct link_part {
	const char *path;
	struct eco_pack *pack;
	json_t *meta;
	double at[3];                /* its origin in the whole */
	uint32_t *plant_of;          /* per plant of the part: in the whole */
	uint32_t *color_of;          /* per colour */
	uint32_t *list_of;           /* per list; ECO_NONE: not taken (yet) */
	bool renamed;                /* plants or colours have other numbers in the whole: summaries must say so */
	uint32_t tile_first;
};

struct link_known { struct eco_chunk_id id; };       /* a plant by all that it is but its name */

struct link {
	struct make m;
	struct link_part *parts;     uint32_t count;
	struct link_known *known;    /* per plant of the whole */
	uint32_t plant_room;
	json_t *plants;              /* of the whole's META */
};

/* The plants of a part, but for those that are known already. */
enum eco_code link_plants(struct link *l, struct link_part *part);
/* The record of the whole for a list of a part, as far as references go to plants, colours and lists. */
struct eco_list link_list(const struct link_part *part, uint32_t list);
enum eco_code link_copy(struct link *l, struct link_part *part, uint32_t list, const struct eco_list *record);

#endif
