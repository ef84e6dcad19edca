/* Scenes and plans as JSON, for people and scripts; the fields are specified in openapi.yaml. */
#ifndef SRV_DESCRIBE_H
#define SRV_DESCRIBE_H

#include "server/caps.h"
#include "server/request/json.h"
#include "server/stream.h"

void srv_describe_health(struct srv_json *json, const struct srv_store *store);
/* Those that `may_see` (NULL: all). */
void srv_describe_scenes(struct srv_json *json, const struct srv_store *store,
	bool (*may_see)(const struct srv_scene *scene, const void *ctx), const void *ctx);
void srv_describe_scene(struct srv_json *json, const struct srv_scene *scene, const struct srv_most *most);
/* With its explanation, if that was asked for. */
void srv_describe_plan(struct srv_json *json, const struct srv_stream *stream);

#endif
