/* Scenes and plans as JSON, for people and scripts; the fields are specified in openapi.yaml. */
#ifndef SRV_DESCRIBE_H
#define SRV_DESCRIBE_H

#include "server/json.h"
#include "server/stream.h"

void srv_describe_health(struct srv_json *json, const struct srv_store *store);
void srv_describe_scenes(struct srv_json *json, const struct srv_store *store);
void srv_describe_scene(struct srv_json *json, const struct srv_scene *scene);
/* may be NULL */
void srv_describe_plan(struct srv_json *json, const struct srv_stream *stream,
	const struct lod_explanation *explanation);

#endif
