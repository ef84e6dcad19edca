/* Scenes, plans and plants as JSON; the fields are specified in openapi.yaml. */
#pragma once

#include "server/request/json.h"
#include "server/request/query.h"
#include "server/stream.h"

/* Caps of a scene's answers; UINT64_MAX: no cap. */
struct srv_most { uint64_t vertices, bytes; };

/* Those that `may_see` (NULL: all). */
void srv_describe_scenes(struct srv_json *json, const struct srv_store *store,
	bool (*may_see)(const struct srv_scene *scene, const void *ctx), const void *ctx);
void srv_describe_scene(struct srv_json *json, const struct srv_scene *scene, const struct srv_most *most);
/* With its explanation, if that was asked for. */
void srv_describe_plan(struct srv_json *json, const struct srv_stream *stream);

/* The scene's list of plants that a path names; ECO_NONE: it has none of that number. */
uint32_t srv_plants_list(const struct srv_scene *scene, const char *text);
/* Inventory rows of a tile's plants; reads at most two blocks. ECO_BAD_INPUT: the list ends before
 * query->first; ECO_DAMAGED: a block is. */
enum eco_code srv_describe_plants(struct srv_json *json, const struct srv_scene *scene, uint32_t list,
	const struct srv_plants_query *query, struct eco_error *error);
/* Plants whose species, name in the pack or cells have the text, or whose row it is, of places [query->first,
 * ...) in their order; reads at most SRV_FIND_BLOCKS blocks, and says where to go on. Those of nested files
 * once. `known`: enum lod_places per group, NULL: all are known; ECO_INTERRUPTED: others are marked, and it
 * is to be asked for again once they are. ECO_BAD_INPUT: the scene ends before query->first. */
enum eco_code srv_describe_found(struct srv_json *json, const struct srv_scene *scene, uint8_t *known,
	const struct srv_find_query *query, struct eco_error *error);
/* Species that each plant stands for, by the pack's META; a plant without any stands for the species of its name. */
void srv_describe_species(struct srv_json *json, const struct srv_scene *scene);
