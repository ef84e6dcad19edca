/* The routes that need no plan. */
#include "server/exchange.h"

#include <microhttpd.h>
#include <stdio.h>
#include <string.h>

#include "ecofiles/format/chunk/chunk.h"
#include "server/access.h"
#include "server/describe.h"

static void answer_described(struct srv_exchange *exchange, bool validated, struct srv_json *json)
{
	const struct srv_scene *scene = exchange->scene;
	const struct srv_access *access = exchange->host->config.access;
	struct srv_validators validators = { .modified_s = scene ? scene->modified_s : 0,
		.is_private = scene ? srv_access_is_private(access, scene->name)
		: access && access->token_count };
	if (validated && !json->out.failed) {
		struct eco_chunk_id id = eco_chunk_hash(json->out.bytes, json->out.size);
		srv_etag_of(validators.etag, &id);
	}
	srv_answer_json(&exchange->answer, json, &validators);
	srv_exchange_judge(exchange, &validators);
}

static void answer_chunk(struct srv_exchange *exchange)
{
	struct eco_chunk_id id;
	char path[SRV_TARGET_BYTES_MAX];
	uint32_t chunk;
	struct srv_scene *scene = srv_parse_id(exchange->variables[1], &id)
		? srv_edition_chunk(exchange->edition, exchange->variables[0], &id, &chunk) : NULL;
	if (scene) {
		srv_answer_chunk(&exchange->answer, scene, chunk, &exchange->conditions, (struct srv_chunk_terms){
			exchange->method == SRV_METHOD_GET, srv_access_is_private(exchange->host->config.access,
			scene->name) }, srv_exchange_path(exchange, path));
		return;
	}
	srv_exchange_problem(exchange, SRV_PROBLEM_CHUNK, "scene '%s' has no chunk '%.64s': ids are 32 lower-case hex digits, "
		"the hashes of their payloads", exchange->variables[0], exchange->variables[1]);
}

/* An error after a part was written replaces that part. */
static void answer_plants(struct srv_exchange *exchange)
{
	struct srv_plants_query query;
	struct srv_json json = { 0 };
	struct eco_error error = { 0 };
	const struct eco_chunk_id *pack = &exchange->scene->pack->id;
	uint32_t list = srv_plants_list(exchange->scene, exchange->variables[1]);
	enum eco_code code = srv_plants_query_parse(&query, &exchange->target, &error);
	if (!code && query.pack.given && memcmp(&query.pack.id, pack, sizeof *pack) != 0) {
		srv_exchange_problem(exchange, SRV_PROBLEM_PACK_CHANGED, "the pack is not the one that "
			"'pack' names, and its lists have other numbers: ask for the view again");
		return;
	}
	if (!code && list == ECO_NONE) {
		srv_exchange_problem(exchange, SRV_PROBLEM_ROUTE, "scene '%s' has no list of plants '%.64s'",
			exchange->variables[0], exchange->variables[1]);
		return;
	}
	code = code ? code : srv_describe_plants(&json, exchange->scene, list, &query, &error);
	if (!code) {
		answer_described(exchange, true, &json);
		return;
	}
	eco_writer_free(&json.out);
	srv_exchange_problem(exchange, srv_problem_of(code), "%s", error.text);
}

static void answer_file(struct srv_exchange *exchange, const struct srv_site_file *file, bool immutable)
{
	enum srv_form form = srv_site_form(file, srv_exchange_header(exchange,
		MHD_HTTP_HEADER_ACCEPT_ENCODING));
	struct eco_chunk_id id = eco_chunk_hash(file->forms[form].bytes, file->forms[form].size);
	struct srv_validators validators = { .modified_s = 0 };
	srv_etag_of(validators.etag, &id);
	const struct srv_access *access = exchange->host->config.access;
	srv_answer_file(&exchange->answer, file, form, immutable, access ? access->frames : "", &validators);
	srv_exchange_judge(exchange, &validators);
}

/* `version`: of an address that has one, else NULL: that leads to the one that has. */
static void answer_viewer(struct srv_exchange *exchange, const char *version, const char *name)
{
	const struct srv_site *site = exchange->host->config.site;
	const struct srv_site_file *file = site ? srv_site_find(site, name) : NULL;
	bool page = exchange->route == &srv_routes[SRV_INDEX];
	const char *folder = exchange->route == &srv_routes[SRV_ICON] ? "viewer/" : "";
	char location[16 + SRV_SITE_VERSION_BYTES + SRV_SITE_NAME_BYTES];
	if (!file && page) {
		srv_answer_no_page(&exchange->answer, srv_site_missing);
	} else if (!file) {
		srv_exchange_problem(exchange, SRV_PROBLEM_ROUTE, "%s", site && site->count
			? "the viewer has no such file"
			: "the viewer is not built: say `make web`, then start ecoserve again (or "
			"with --viewer DIR); /v1/scenes lists the scenes");
	} else if (version && strcmp(version, site->version) != 0) {
		srv_exchange_problem(exchange, SRV_PROBLEM_ROUTE,
			"the server has another version of the viewer: load the page again");
	} else if (!page && strcmp(name, SRV_SITE_INDEX) == 0) {
		/* its addresses are relative to where it is served */
		srv_answer_elsewhere(&exchange->answer, version ? "../../" : "../");
	} else if (page || version || !site->version[0]) {
		answer_file(exchange, file, version);
	} else {
		snprintf(location, sizeof location, "%s%s/%s", folder, site->version, name);
		srv_answer_elsewhere(&exchange->answer, location);
	}
}

static void answer_ready(struct srv_exchange *exchange)
{
	struct srv_json json = { 0 };
	const struct srv_gauges gauges = srv_host_gauges(exchange->host);
	if (!gauges.ready) {
		srv_exchange_problem(exchange, SRV_PROBLEM_BUSY,
			"no further plan can wait now; send requests to another server for a moment");
		return;
	}
	srv_json_add(&json, "{status:%s bad_packs:%lu}", "ready", gauges.bad_packs);
	answer_described(exchange, false, &json);
}

static void answer_metrics(struct srv_exchange *exchange)
{
	struct eco_writer text = { 0 };
	const struct srv_gauges gauges = srv_host_gauges(exchange->host);
	srv_metrics_write(&text, &exchange->host->metrics, &gauges);
	srv_answer_metrics(&exchange->answer, &text);
}

/* Only scenes that the client may open are listed. */
static bool may_see(const struct srv_scene *scene, const void *exchange)
{
	const struct srv_exchange *asks = exchange;
	return srv_access_scene(asks->host->config.access, scene->name, asks->authorization);
}

void srv_exchange_reload(void *argument)
{
	struct srv_exchange *exchange = argument;
	struct srv_reload report;
	struct eco_error error = { 0 };
	struct srv_json json = { 0 };
	enum eco_code code = srv_host_reload(exchange->host, &report, &error);
	if (code || report.bad) {
		srv_exchange_problem(exchange, SRV_PROBLEM_RELOAD, "%s", code ? error.text : report.why);
		return;
	}
	srv_json_add(&json, "{opened:%u same:%u gone:%u}", report.opened, report.same, report.gone);
	answer_described(exchange, false, &json);
}

void srv_exchange_answer_direct(struct srv_exchange *exchange)
{
	struct srv_most most;
	struct srv_json json = { 0 };
	struct eco_error error = { 0 };
	if (exchange->route == &srv_routes[SRV_PLANTS]) {
		answer_plants(exchange);
		return;
	}
	if (srv_query_none(&exchange->target, &error)) {
		srv_exchange_problem(exchange, SRV_PROBLEM_PARAMETER, "%s", error.text);
		return;
	}
	switch (exchange->route - srv_routes) {
	case SRV_HEALTH:
		srv_json_add(&json, "{status:%s scenes:%u}", "ok", exchange->edition->store.count);
		answer_described(exchange, false, &json);
		break;
	case SRV_READY:
		answer_ready(exchange);
		break;
	case SRV_METRICS:
		answer_metrics(exchange);
		break;
	case SRV_SCENES:
		srv_describe_scenes(&json, &exchange->edition->store, may_see, exchange);
		answer_described(exchange, true, &json);
		break;
	case SRV_SCENE:
		most = srv_caps_of(exchange->host->config.caps, exchange->scene->name);
		srv_describe_scene(&json, exchange->scene, &most);
		answer_described(exchange, true, &json);
		break;
	case SRV_SPECIES:
		srv_describe_species(&json, exchange->scene);
		answer_described(exchange, true, &json);
		break;
	case SRV_INDEX:
		answer_viewer(exchange, NULL, SRV_SITE_INDEX);
		break;
	case SRV_ICON:
		answer_viewer(exchange, NULL, SRV_SITE_ICON);
		break;
	case SRV_VIEWER:
		answer_viewer(exchange, NULL, exchange->variables[0]);
		break;
	case SRV_VIEWER_FILE:
		answer_viewer(exchange, exchange->variables[0], exchange->variables[1]);
		break;
	default:
		answer_chunk(exchange);
	}
}
