/* GET .../plants/{list}: what the plants of a tile are by the inventories that they come from;
 * GET .../species: the species that each plant of the pack stands for. */
#ifndef SRV_PLANTS_H
#define SRV_PLANTS_H

#include "server/request/json.h"
#include "server/request/target.h"
#include "server/store.h"

#define SRV_PLANTS_MAX 1024u /* of an answer */

struct srv_plants_query {
	uint64_t first, count;
	bool has_pack;
	struct eco_chunk_id pack;
};

/* ?first=N&count=N&pack=ID, all of which may be left out. */
enum eco_code srv_plants_query(struct srv_plants_query *query, const struct srv_target *target,
	struct eco_error *error);

/* The scene's list of plants that a path names; ECO_NONE: it has none of that number. */
uint32_t srv_plants_list(const struct srv_scene *scene, const char *text);

/* Reads at most two blocks of rows. ECO_BAD_INPUT: the list ends before query->first; ECO_DAMAGED: a block
 * is. */
enum eco_code srv_describe_plants(struct srv_json *json, const struct srv_scene *scene, uint32_t list,
	const struct srv_plants_query *query, struct eco_error *error);

/* By the pack's META; a plant of which it says nothing stands for the species of its name. */
void srv_describe_species(struct srv_json *json, const struct srv_scene *scene);

#endif
