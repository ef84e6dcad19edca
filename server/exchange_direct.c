/* The routes that need no plan. */
#include "server/exchange_parts.h"

#include <microhttpd.h>
#include <stdio.h>

#include "ecofiles/format/chunk/chunk.h"
#include "server/describe.h"

static void answer_described(struct srv_exchange *exchange, bool validated, struct srv_json *json)
{
	const struct srv_scene *scene = exchange->scene;
	struct srv_validators validators = { .modified_s = scene ? scene->modified_s : 0 };
	if (validated && !json->out.failed) {
		struct eco_chunk_id id = eco_chunk_hash(json->out.bytes, json->out.size);
		srv_etag_of(validators.etag, &id);
	}
	srv_answer_json(&exchange->answer, json, &validators, NULL);
	srv_exchange_judge(exchange, &validators);
}

static void answer_chunk(struct srv_exchange *exchange)
{
	struct eco_chunk_id id;
	char detail[256], path[SRV_TARGET_BYTES_MAX];
	uint32_t chunk;
	struct srv_scene *scene = srv_parse_id(exchange->variables[1], &id)
		? srv_edition_chunk(exchange->edition, exchange->variables[0], &id, &chunk) : NULL;
	if (scene) {
		srv_answer_chunk(&exchange->answer, scene, chunk, &exchange->conditions,
			exchange->method == SRV_METHOD_GET, srv_exchange_path(exchange, path));
		return;
	}
	snprintf(detail, sizeof detail, "scene '%s' has no chunk '%.64s': ids are 32 lower-case hex digits, "
		"the hashes of their payloads", exchange->variables[0], exchange->variables[1]);
	srv_exchange_problem(exchange, SRV_PROBLEM_CHUNK, detail, false);
}

static void answer_file(struct srv_exchange *exchange, const struct srv_site_file *file)
{
	enum srv_form form = srv_site_form(file, srv_exchange_header(exchange,
		MHD_HTTP_HEADER_ACCEPT_ENCODING));
	struct eco_chunk_id id = eco_chunk_hash(file->forms[form].bytes, file->forms[form].size);
	struct srv_validators validators = { .modified_s = 0 };
	srv_etag_of(validators.etag, &id);
	srv_answer_file(&exchange->answer, file, form, &validators);
	srv_exchange_judge(exchange, &validators);
}

static void answer_viewer(struct srv_exchange *exchange, const char *name)
{
	const struct srv_site *site = exchange->host->config.site;
	const struct srv_site_file *file = site ? srv_site_find(site, name) : NULL;
	if (file)
		answer_file(exchange, file);
	else
		srv_exchange_problem(exchange, SRV_PROBLEM_ROUTE, site && site->count
			? "the viewer has no such file" : "the viewer is not built: say `make web`, then start ecoserve again (or with "
			"--viewer DIR); /v1/scenes lists the scenes", false);
}

void srv_exchange_answer_direct(struct srv_exchange *exchange)
{
	struct srv_json json = { 0 };
	struct eco_error error = { 0 };
	if (srv_query_none(&exchange->target, &error)) {
		srv_exchange_problem(exchange, SRV_PROBLEM_PARAMETER, error.text, false);
		return;
	}
	switch (exchange->route - srv_routes) {
	case SRV_HEALTH:
		srv_describe_health(&json, &exchange->edition->store);
		answer_described(exchange, false, &json);
		break;
	case SRV_SCENES:
		srv_describe_scenes(&json, &exchange->edition->store);
		answer_described(exchange, true, &json);
		break;
	case SRV_SCENE:
		srv_describe_scene(&json, exchange->scene);
		answer_described(exchange, true, &json);
		break;
	case SRV_INDEX:
		answer_viewer(exchange, SRV_SITE_INDEX);
		break;
	case SRV_VIEWER:
		answer_viewer(exchange, exchange->variables[0]);
		break;
	default:
		answer_chunk(exchange);
	}
}
