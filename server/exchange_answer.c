/* Answers: of the routes that need no plan, and of the others. */
#define XXH_STATIC_LINKING_ONLY
#include <xxhash.h>

#include "server/exchange.h"

#include <microhttpd.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/version.h"
#include "ecofiles/format/chunk/chunk.h"
#include "ecofiles/format/wire.h"
#include "server/site.h"

static void tag_bytes(struct srv_exchange *exchange, const void *bytes, size_t size)
{
	struct eco_chunk_id id = eco_chunk_hash(bytes, size);
	srv_etag_of(exchange->etag, &id);
}

/* A document that is the same until a pack is replaced has a tag. */
static void answer_described(struct srv_exchange *exchange, bool validated, struct srv_json *json)
{
	if (exchange->scene)
		srv_answer_validate(exchange, exchange->scene);
	else
		exchange->is_private = exchange->daemon->config.access->token_count;
	if (validated && !json->out.failed)
		tag_bytes(exchange, json->out.bytes, json->out.size);
	srv_answer_text(exchange, MHD_HTTP_OK, &json->out, "application/json");
	srv_answer_add_validators(exchange, "no-cache");
	srv_answer_judge(exchange);
}

static void answer_chunk(struct srv_exchange *exchange)
{
	struct eco_chunk_id id;
	uint32_t chunk;
	const struct srv_scene *scene = srv_parse_id(exchange->variables[1], &id)
		? srv_edition_chunk(exchange->edition, exchange->variables[0], &id, &chunk) : NULL;
	if (scene)
		srv_answer_chunk(exchange, scene, chunk);
	else
		srv_exchange_problem(exchange, SRV_PROBLEM_CHUNK, "scene '%s' has no chunk '%.64s': ids are 32 "
			"lower-case hex digits, the hashes of their payloads", exchange->variables[0],
			exchange->variables[1]);
}

static bool is_another_pack(const struct srv_exchange *exchange, const struct srv_pack_named *named)
{
	const struct eco_chunk_id *pack = &exchange->scene->pack->id;
	return named->given && memcmp(&named->id, pack, sizeof *pack) != 0;
}

/* An error after a part was written replaces that part. `found`: plants that are looked for, else those of a list. */
static void answer_plants(struct srv_exchange *exchange, bool found)
{
	struct srv_plants_query query;
	struct srv_find_query find;
	struct srv_json json = { 0 };
	struct eco_error error = { 0 };
	uint32_t list = found ? 0 : srv_plants_list(exchange->scene, exchange->variables[1]);
	enum eco_code code = found ? srv_find_query_parse(&find, &exchange->target, &error)
		: srv_plants_query_parse(&query, &exchange->target, &error);
	if (!code && is_another_pack(exchange, found ? &find.pack : &query.pack)) {
		srv_exchange_problem(exchange, SRV_PROBLEM_PACK_CHANGED, "the pack is not the one that "
			"'pack' names, and its lists have other numbers: ask for the view again");
		return;
	}
	if (!code && list == ECO_NONE) {
		srv_exchange_problem(exchange, SRV_PROBLEM_ROUTE, "scene '%s' has no list of plants '%.64s'",
			exchange->variables[0], exchange->variables[1]);
		return;
	}
	if (!code)
		code = found ? srv_describe_found(&json, exchange->scene, NULL, &find, &error)
			: srv_describe_plants(&json, exchange->scene, list, &query, &error);
	if (!code) {
		answer_described(exchange, true, &json);
		return;
	}
	eco_writer_free(&json.out);
	srv_exchange_problem(exchange, srv_problem_of(code), "%s", error.text);
}

/* ---- The viewer ---- */

/* A page runs what this server sends, and nothing else. */
#define SITE_POLICY "default-src 'self'; script-src 'self' 'wasm-unsafe-eval'; img-src 'self' blob: data:; " \
	"connect-src 'self' data:; base-uri 'none'; form-action 'none'; frame-ancestors 'self'"

static void answer_file(struct srv_exchange *exchange, const struct srv_site_file *file, bool immutable)
{
	char policy[sizeof SITE_POLICY + SRV_FRAMES_BYTES];
	enum srv_form form = srv_site_form(file, srv_exchange_header(exchange, MHD_HTTP_HEADER_ACCEPT_ENCODING));
	const uint8_t *bytes = file->forms[form].bytes;
	size_t size = file->forms[form].size;
	snprintf(policy, sizeof policy, SITE_POLICY "%s", exchange->daemon->config.access->frames);
	tag_bytes(exchange, bytes, size);
	srv_answer_bytes(exchange, MHD_HTTP_OK, bytes, size, file->type);
	srv_answer_add(exchange, MHD_HTTP_HEADER_CONTENT_ENCODING, srv_form_names[form]);
	srv_answer_add(exchange, MHD_HTTP_HEADER_VARY, MHD_HTTP_HEADER_ACCEPT_ENCODING);
	srv_answer_add(exchange, "Content-Security-Policy", policy);
	srv_answer_add(exchange, "X-Content-Type-Options", "nosniff");
	srv_answer_add_validators(exchange, immutable ? "public, " SRV_IMMUTABLE : "no-cache");
	srv_answer_judge(exchange);
}

/* A temporary redirect. */
static void answer_elsewhere(struct srv_exchange *exchange, const char *location)
{
	srv_answer_bytes(exchange, MHD_HTTP_TEMPORARY_REDIRECT, "", 0, NULL);
	srv_answer_add(exchange, MHD_HTTP_HEADER_LOCATION, location);
	srv_answer_add(exchange, MHD_HTTP_HEADER_CACHE_CONTROL, "no-cache");
}

/* `version`: of an address that has one, else NULL: that leads to the one that has. */
static void answer_viewer(struct srv_exchange *exchange, const char *version, const char *name)
{
	const struct srv_site *site = exchange->daemon->config.site;
	const struct srv_site_file *file = site ? srv_site_find(site, name) : NULL;
	bool page = exchange->route == &srv_routes[SRV_INDEX];
	const char *folder = exchange->route == &srv_routes[SRV_ICON] ? "viewer/" : "";
	char location[16 + SRV_SITE_VERSION_BYTES + SRV_SITE_NAME_BYTES];
	if (!file && page) {
		srv_answer_bytes(exchange, MHD_HTTP_NOT_FOUND, srv_site_missing, strlen(srv_site_missing),
			"text/html; charset=utf-8");
		srv_answer_add(exchange, MHD_HTTP_HEADER_CACHE_CONTROL, "no-store");
		srv_answer_add(exchange, "Content-Security-Policy",
			"default-src 'none'; base-uri 'none'; form-action 'none'");
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
		answer_elsewhere(exchange, version ? "../../" : "../");
	} else if (page || version || !site->version[0]) {
		answer_file(exchange, file, version);
	} else {
		snprintf(location, sizeof location, "%s%s/%s", folder, site->version, name);
		answer_elsewhere(exchange, location);
	}
}

/* ---- For operators ---- */

static void answer_ready(struct srv_exchange *exchange)
{
	struct srv_json json = { 0 };
	const struct srv_gauges gauges = srv_daemon_gauges(exchange->daemon);
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
	const struct srv_gauges gauges = srv_daemon_gauges(exchange->daemon);
	srv_metrics_write(&text, &exchange->daemon->metrics, &gauges);
	srv_answer_text(exchange, MHD_HTTP_OK, &text, "text/plain; version=0.0.4; charset=utf-8");
	srv_answer_add(exchange, MHD_HTTP_HEADER_CACHE_CONTROL, "no-store");
}

/* Only scenes that the client may open are listed. */
static bool may_see(const struct srv_scene *scene, const void *exchange)
{
	const struct srv_exchange *asks = exchange;
	return srv_access_scene(asks->daemon->config.access, scene->name, asks->authorization);
}

void srv_exchange_reload(void *argument)
{
	struct srv_exchange *exchange = argument;
	struct srv_reload report;
	struct eco_error error = { 0 };
	struct srv_json json = { 0 };
	enum eco_code code = srv_daemon_reload_now(exchange->daemon, &report, &error);
	if (code || report.bad) {
		srv_exchange_problem(exchange, SRV_PROBLEM_RELOAD, "%s", code ? error.text : report.why);
		return;
	}
	srv_json_add(&json, "{opened:%u same:%u gone:%u}", report.opened, report.same, report.gone);
	answer_described(exchange, false, &json);
}

void srv_exchange_answer_direct(struct srv_exchange *exchange)
{
	const int resource = (int)(exchange->route - srv_routes);
	struct srv_most most;
	struct srv_json json = { 0 };
	struct eco_error error = { 0 };
	/* networks append parameters of their own to links: the page takes any */
	if (resource != SRV_PLANTS && resource != SRV_FIND && resource != SRV_INDEX && srv_query_none(&exchange->target, &error)) {
		srv_exchange_problem(exchange, SRV_PROBLEM_PARAMETER, "%s", error.text);
		return;
	}
	switch (resource) {
	case SRV_HEALTH:
		srv_json_add(&json, "{status:%s scenes:%u}", "ok", exchange->edition->store.count);
		break;
	case SRV_SCENES:
		srv_describe_scenes(&json, &exchange->edition->store, may_see, exchange);
		break;
	case SRV_SCENE:
		most = srv_caps_of(exchange->daemon->config.access, exchange->scene->name);
		srv_describe_scene(&json, exchange->scene, &most);
		break;
	case SRV_SPECIES:
		srv_describe_species(&json, exchange->scene);
		break;
	case SRV_READY:
		answer_ready(exchange);
		return;
	case SRV_METRICS:
		answer_metrics(exchange);
		return;
	case SRV_PLANTS:
	case SRV_FIND:
		answer_plants(exchange, resource == SRV_FIND);
		return;
	case SRV_INDEX:
	case SRV_ICON:
		answer_viewer(exchange, NULL, resource == SRV_INDEX ? SRV_SITE_INDEX : SRV_SITE_ICON);
		return;
	case SRV_VIEWER:
		answer_viewer(exchange, NULL, exchange->variables[0]);
		return;
	case SRV_VIEWER_FILE:
		answer_viewer(exchange, exchange->variables[0], exchange->variables[1]);
		return;
	default:
		answer_chunk(exchange);
		return;
	}
	answer_described(exchange, resource != SRV_HEALTH, &json);
}

/* ---- Plans and streams: from the parameters to an answer, which a work thread makes or the cache has ---- */

#define PLAN_TEXT_MAX (64u << 20)        /* or --answer-bytes, if that is less */

static const char *type_of(const struct srv_exchange *exchange)
{
	return exchange->route == &srv_routes[SRV_PLAN] ? "application/json" : "application/octet-stream";
}

static void answer_no_stream(struct srv_exchange *exchange)
{
	srv_answer_bytes(exchange, MHD_HTTP_NO_CONTENT, "", 0, NULL);
	srv_answer_add(exchange, MHD_HTTP_HEADER_CACHE_CONTROL, "no-store");
}

/* The plan as JSON, in one piece. */
static enum eco_code describe(struct srv_exchange *exchange, const struct srv_stream *stream, struct srv_body
	*body, struct eco_error *error)
{
	uint64_t most = exchange->daemon->config.response_max < PLAN_TEXT_MAX ?
		exchange->daemon->config.response_max : PLAN_TEXT_MAX;
	struct srv_json json = { .most = most, .cancelled = &exchange->cancelled };
	srv_describe_plan(&json, stream);
	enum eco_code code = srv_json_end(&json);
	*body = (struct srv_body){ .frames = json.out, .size_bytes = json.out.size, .piece_count = 1 };
	if (!code && !(body->pieces = malloc(sizeof *body->pieces)))
		code = ECO_NO_MEMORY;
	if (!code) {
		body->pieces[0] = (struct srv_piece){ json.out.bytes, json.out.size };
		return ECO_OK;
	}
	srv_body_free(body);
	return code == ECO_TOO_LARGE ? eco_fail(error, code, "the plan has %u cuts, and its text more than %llu bytes; "
		"ask for fewer vertices, or for the stream", stream->steps[stream->step_count -
		1].plan.cut_count, (unsigned long long)most)
		: eco_fail(error, code, "the plan could not be written; ask again in a moment");
}

/* A small body is kept in one piece, and sent from there. Answers that follow from other requests than GET
 * and HEAD have no tag, and are not kept. */
static void answer_body(struct srv_exchange *exchange, struct srv_body *body)
{
	struct srv_kept_body *kept = exchange->etag[0] ? srv_kept_body_make(body->size_bytes) : NULL;
	uint8_t *at = kept ? kept->bytes : NULL;
	for (uint32_t i = 0; kept && i < body->piece_count; at += body->pieces[i++].size)
		if (body->pieces[i].size)
			memcpy(at, body->pieces[i].bytes, body->pieces[i].size);
	srv_plan_cache_put(exchange->daemon->plans, exchange->etag,
		&(struct srv_kept_answer){ MHD_HTTP_OK, body->size_bytes, kept });
	if (!kept) {
		srv_answer_body(exchange, body, type_of(exchange));
		return;
	}
	srv_answer_kept(exchange, kept, type_of(exchange));
	srv_kept_body_release(kept);
	srv_body_free(body);
}

static enum eco_code answer_planned(struct srv_exchange *exchange, struct srv_stream *stream, uint64_t
	begun_us, struct eco_error *error)
{
	uint64_t planned_us = srv_clock_us();
	char timing[96];
	struct srv_body body = { .size_bytes = 0 };
	bool is_stream = exchange->route == &srv_routes[SRV_STREAM], fits = stream->fits || !is_stream;
	ECO_PASS(!fits ? ECO_OK : is_stream ? srv_stream_write(stream, &body, error)
		: describe(exchange, stream, &body, error));
	snprintf(timing, sizeof timing, "plan;dur=%.3f, build;dur=%.3f", (double)(planned_us - begun_us) /
		1000.0, (double)(srv_clock_us() - planned_us) / 1000.0);
	if (fits) {
		answer_body(exchange, &body);
	} else {
		srv_plan_cache_put(exchange->daemon->plans, exchange->etag,
			&(struct srv_kept_answer){ MHD_HTTP_NO_CONTENT, 0, NULL });
		answer_no_stream(exchange);
	}
	srv_answer_add(exchange, "Server-Timing", timing);
	srv_answer_judge(exchange);
	return ECO_OK;
}

void srv_exchange_make_plan(void *argument)
{
	struct srv_exchange *exchange = argument;
	struct srv_daemon *daemon = exchange->daemon;
	struct srv_stream_input input = { .scene = exchange->scene, .request = &exchange->query.request,
		.rule = exchange->query.rule, .explain = exchange->query.explain, .holdings =
		&exchange->holdings, .body_max = daemon->config.response_max, .cancelled = &exchange->cancelled,
		.work_max = daemon->config.plan_times * srv_typical_find(exchange->scene, NULL) };
	struct srv_stream stream;
	struct eco_error error = { 0 };
	uint64_t begun_us = srv_clock_us();
	srv_trace_capture(daemon->config.slow_ms ? &exchange->trace : NULL);
	enum eco_code code = srv_stream_plan(&stream, &input, &error);
	srv_trace_capture(NULL);
	if (!code) {
		exchange->plan_work = stream.work;
		exchange->cut_short = stream.cut_short;
		code = answer_planned(exchange, &stream, begun_us, &error);
		srv_stream_free(&stream);
	}
	exchange->plan_us = srv_clock_us() - begun_us + 1;
	srv_count_plan(&daemon->metrics, exchange->plan_us, exchange->plan_work, exchange->cut_short);
	srv_count(&daemon->metrics, SRV_COUNT_PLANS_CANCELLED, atomic_load(&exchange->cancelled));
	if (code)
		srv_exchange_problem(exchange, srv_problem_of(code), "%s", error.text);
}

/* A tag for what a server of this version, with these limits of work, vertices and bytes, answers to this
 * target from this pack: the same request gives the same bytes. */
static void tag_request(struct srv_exchange *exchange, const struct srv_most *most)
{
	const struct eco_chunk_id *pack = &exchange->scene->pack->id;
	const uint64_t limits[3] = { exchange->daemon->config.plan_times, most->vertices, most->bytes };
	struct eco_chunk_id id;
	XXH3_state_t state;
	XXH128_canonical_t hash;
	XXH3_INITSTATE(&state);
	XXH3_128bits_reset(&state);
	XXH3_128bits_update(&state, pack->bytes, sizeof pack->bytes);
	XXH3_128bits_update(&state, ECO_VERSION, sizeof ECO_VERSION);
	XXH3_128bits_update(&state, limits, sizeof limits);
	XXH3_128bits_update(&state, exchange->raw, strlen(exchange->raw));
	XXH128_canonicalFromHash(&hash, XXH3_128bits_digest(&state));
	memcpy(id.bytes, hash.digest, sizeof id.bytes);
	srv_etag_of(exchange->etag, &id);
}

/* A tag takes the pack and the target alone: whether one is named is known without a plan. "*" names whatever
 * there is, so that does need one, or an earlier answer to the same request. */
static bool answer_unplanned(struct srv_exchange *exchange, const struct srv_most *most)
{
	const char *none_match = exchange->conditions.if_none_match;
	struct srv_kept_answer kept = { .size_bytes = SRV_SIZE_UNKNOWN };
	srv_answer_validate(exchange, exchange->scene);
	tag_request(exchange, most);
	bool known = srv_plan_cache_get(exchange->daemon->plans, exchange->etag, &kept), answered = true;
	enum srv_verdict verdict = srv_conditions_judge(&exchange->conditions, exchange->etag, exchange->modified_s);
	if (verdict == SRV_VERDICT_FAILED)
		srv_answer_bytes(exchange, MHD_HTTP_OK, "", 0, NULL);    /* which the judge replaces */
	else if (verdict == SRV_VERDICT_NOT_MODIFIED && !srv_etag_any(none_match))
		srv_answer_head(exchange, MHD_HTTP_NOT_MODIFIED, kept.size_bytes, type_of(exchange));
	else if (known && kept.status == MHD_HTTP_NO_CONTENT)
		answer_no_stream(exchange);
	else if (known && kept.body)
		srv_answer_kept(exchange, kept.body, type_of(exchange));
	else if (known && exchange->method == SRV_METHOD_HEAD)
		srv_answer_head(exchange, kept.status, kept.size_bytes, type_of(exchange));
	else
		answered = false;
	srv_kept_body_release(kept.body);
	srv_count(&exchange->daemon->metrics, SRV_COUNT_KEPT, answered);
	if (answered) {
		srv_answer_judge(exchange);
		srv_trace(SRV_TRACE_CACHE, "%s: answered without a plan: %s", exchange->scene->name, exchange->etag);
	}
	return answered;
}

bool srv_exchange_prepare_plan(struct srv_exchange *exchange)
{
	struct eco_error error = { 0 };
	const struct srv_most most = srv_caps_of(exchange->daemon->config.access, exchange->scene->name);
	if (srv_query_parse(&exchange->query, &exchange->target, &error)) {
		srv_exchange_problem(exchange, SRV_PROBLEM_PARAMETER, "%s", error.text);
		return false;
	}
	struct eco_request *request = &exchange->query.request;
	request->vertices = request->vertices < most.vertices ? request->vertices : most.vertices;
	request->bytes = request->bytes < most.bytes ? request->bytes : most.bytes;
	if (exchange->query.explain && exchange->route != &srv_routes[SRV_PLAN]) {
		srv_exchange_problem(exchange, SRV_PROBLEM_PARAMETER,
			"parameter 'explain': a stream explains nothing; ask .../plan with the same parameters");
		return false;
	}
	if (is_another_pack(exchange, &exchange->query.pack)) {
		srv_exchange_problem(exchange, SRV_PROBLEM_PACK_CHANGED, "the pack is not the one that "
			"'pack' names: forget what was held of it and ask again without holdings");
		return false;
	}
	if (exchange->method != SRV_METHOD_POST)
		return !answer_unplanned(exchange, &most);
	enum eco_code code = eco_wire_read_holdings(exchange->body, exchange->body_size, &exchange->holdings,
		&error);
	if (!code)
		code = srv_holdings_check(&exchange->scene->pack->scene, &exchange->holdings, &error);
	if (code)
		srv_exchange_problem(exchange, code == ECO_NO_MEMORY ? SRV_PROBLEM_BUSY :
			SRV_PROBLEM_HOLDINGS, "%s", error.text);
	return !code;
}
