#include "server/exchange.h"

#include <assert.h>
#include <microhttpd.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "ecofiles/format/chunk/chunk.h"
#include "ecofiles/format/wire.h"
#include "server/describe.h"

#define PLAN_TEXT_MAX (64u << 20)
#define BODY_STAKE_BYTES (4u << 10)     /* what a body is given before any of it is there */

static const char known_resources[] = "known are /, /healthz, /v1/scenes, and below a scene plan, stream and "
	"chunks/{id}";
static const char bodies_are_many[] = "too many holdings are being received; ask again in a second";

struct srv_exchange *srv_exchange_new(struct srv_host *host, struct MHD_Connection *connection,
	struct srv_lease *lease, const char *raw)
{
	struct srv_exchange *exchange = calloc(1, sizeof *exchange);
	if (!exchange)
		return NULL;
	exchange->host = host;
	exchange->connection = connection;
	exchange->lease = lease;
	exchange->client = lease->address;
	exchange->begun_us = srv_clock_us();
	exchange->raw = strdup(raw);
	if (!exchange->raw) {
		free(exchange);
		return NULL;
	}
	exchange->target_code = srv_target_parse(&exchange->target, raw, strlen(raw), &exchange->error);
	return exchange;
}

/* A header of the request, or NULL. */
static const char *header(const struct srv_exchange *exchange, const char *name)
{
	return MHD_lookup_connection_value(exchange->connection, MHD_HEADER_KIND, name);
}

/* ---- Sending ---- */

static bool queue_answer(struct srv_exchange *exchange)
{
	struct srv_answer *answer = &exchange->answer;
	if (!answer->response)
		return false;
	srv_reaper_send(exchange->host->reaper, exchange->lease);
	bool queued = MHD_queue_response(exchange->connection, answer->status, answer->response) == MHD_YES;
	exchange->phase = SRV_PHASE_DONE;
	srv_answer_free(answer);
	return queued;
}

/* The path names the resource that a problem is about; NULL where it could not be parsed. */
static const char *path_of(const struct srv_exchange *exchange, char path[SRV_TARGET_BYTES_MAX])
{
	if (exchange->target_code)
		return NULL;
	snprintf(path, SRV_TARGET_BYTES_MAX, "%.*s", (int)strcspn(exchange->raw, "?"), exchange->raw);
	return path;
}

static void make_problem(struct srv_exchange *exchange, enum srv_problem problem, const char *detail,
	bool close)
{
	char path[SRV_TARGET_BYTES_MAX];
	srv_answer_problem(&exchange->answer, &(struct srv_problem_details){ .problem = problem,
		.detail = detail, .instance = path_of(exchange, path), .close = close,
		.allow = problem == SRV_PROBLEM_METHOD && exchange->route ? exchange->route->allow : NULL });
}

static bool queue_problem(struct srv_exchange *exchange, enum srv_problem problem, const char *detail,
	bool close)
{
	make_problem(exchange, problem, detail, close);
	return queue_answer(exchange);
}

static bool has_preconditions(const struct srv_exchange *exchange)
{
	const struct srv_conditions *conditions = &exchange->conditions;
	return conditions->if_match || conditions->if_none_match || conditions->if_unmodified_since;
}

static void judge_answer(struct srv_exchange *exchange, const struct srv_validators *validators)
{
	char path[SRV_TARGET_BYTES_MAX];
	if (exchange->answer.response && exchange->answer.status / 100 == 2 && has_preconditions(exchange))
		srv_answer_judge(&exchange->answer, &exchange->conditions, validators,
			path_of(exchange, path));
}

/* ---- Plans and streams, on a work thread ---- */

static void timing_text(char *text, size_t size, uint64_t begun_us, uint64_t planned_us)
{
	snprintf(text, size, "plan;dur=%.3f, build;dur=%.3f", (double)(planned_us - begun_us) / 1000.0,
		(double)(srv_clock_us() - planned_us) / 1000.0);
}

static const char *type_of(const struct srv_exchange *exchange)
{
	return exchange->route == &srv_routes[SRV_PLAN] ? "application/json" : "application/octet-stream";
}

static void keep_answer(struct srv_exchange *exchange, unsigned status, uint64_t size_bytes,
	struct srv_kept_body *body)
{
	if (exchange->validators.etag[0])
		srv_plan_cache_put(exchange->host->plans, exchange->validators.etag,
			&(struct srv_kept_answer){ status, size_bytes, body });
}

/* Answers from `body` (NULL: false) and keeps it for who asks again. What follows from a request that is not
 * a GET or HEAD has no tag, and is not kept. */
static bool answer_kept(struct srv_exchange *exchange, struct srv_kept_body *body, const char *timing)
{
	if (!body)
		return false;
	srv_answer_kept(&exchange->answer, body, type_of(exchange), &exchange->validators, timing);
	keep_answer(exchange, MHD_HTTP_OK, body->size, body);
	srv_kept_body_release(body);
	return true;
}

static enum eco_code answer_plan(struct srv_exchange *exchange, struct srv_stream *stream, uint64_t begun_us,
	struct eco_error *error)
{
	uint64_t planned_us = srv_clock_us();
	char timing[96];
	struct srv_json json = { 0 };
	struct lod_explanation why = { 0 };
	bool explain = exchange->query.explain;
	enum eco_code code = explain ? srv_stream_explain(stream, &why, error) : ECO_OK;
	if (!code)
		srv_describe_plan(&json, stream, explain ? &why : NULL);
	lod_explanation_free(&why);
	if (code)
		return code;
	if (json.out.size > PLAN_TEXT_MAX) {
		eco_writer_free(&json.out);
		return eco_fail(error, ECO_TOO_LARGE, "the plan has %u cuts, too many to read; ask "
			"for fewer vertices, or for the stream",
			stream->steps[stream->step_count - 1].plan.cut_count);
	}
	timing_text(timing, sizeof timing, begun_us, planned_us);
	const struct srv_piece text = { json.out.bytes, json.out.size };
	if (!json.out.failed && answer_kept(exchange, srv_kept_body_copy(&text, 1, text.size), timing)) {
		eco_writer_free(&json.out);
		return ECO_OK;
	}
	keep_answer(exchange, MHD_HTTP_OK, json.out.size, NULL);
	srv_answer_json(&exchange->answer, &json, &exchange->validators, timing);
	return ECO_OK;
}

static enum eco_code answer_stream(struct srv_exchange *exchange, struct srv_stream *stream,
	uint64_t begun_us, struct eco_error *error)
{
	uint64_t planned_us = srv_clock_us();
	char timing[96];
	struct srv_body body;
	if (!stream->fits) {
		timing_text(timing, sizeof timing, begun_us, planned_us);
		keep_answer(exchange, MHD_HTTP_NO_CONTENT, 0, NULL);
		srv_answer_no_stream(&exchange->answer, timing);
		return ECO_OK;
	}
	enum eco_code code = srv_stream_write(stream, &body, error);
	if (code)
		return code;
	timing_text(timing, sizeof timing, begun_us, planned_us);
	if (exchange->validators.etag[0] && answer_kept(exchange,
			srv_kept_body_copy(body.pieces, body.piece_count, body.size_bytes), timing)) {
		srv_body_free(&body);
		return ECO_OK;
	}
	keep_answer(exchange, MHD_HTTP_OK, body.size_bytes, NULL);
	srv_answer_stream(&exchange->answer, &body, &exchange->validators, timing);
	return ECO_OK;
}

static void plan_job(void *argument)
{
	struct srv_exchange *exchange = argument;
	struct srv_host *host = exchange->host;
	struct srv_stream_input input = { .scene = exchange->scene, .request = &exchange->query.request,
		.rule = exchange->query.rule, .holdings = &exchange->holdings,
		.body_max = host->config.response_max, .tiles_max = host->config.tiles_max,
		.placements_max = host->config.placements_max, .cancelled = &exchange->cancelled };
	struct srv_stream stream;
	struct eco_error error = { 0 };
	uint64_t begun_us = srv_clock_us();
	enum eco_code code = srv_stream_plan(&stream, &input, &error);
	if (!code) {
		code = (exchange->route == &srv_routes[SRV_PLAN] ? answer_plan : answer_stream)(exchange,
			&stream, begun_us, &error);
		srv_stream_free(&stream);
	}
	if (code)
		make_problem(exchange, srv_problem_of(code), error.text, false);
	else
		judge_answer(exchange, &exchange->validators);
}

static void plan_done(void *argument)
{
	struct srv_exchange *exchange = argument;
	srv_reaper_watch(exchange->host->reaper, exchange->lease, NULL);
	exchange->phase = SRV_PHASE_DONE;
	MHD_resume_connection(exchange->connection);     /* from here on the exchange may be gone */
}

static bool start_plan(struct srv_exchange *exchange)
{
	exchange->phase = SRV_PHASE_WORKING;
	MHD_suspend_connection(exchange->connection);    /* first: the job may end before submit returns */
	srv_reaper_watch(exchange->host->reaper, exchange->lease, &exchange->cancelled);
	if (srv_work_submit(exchange->host->work, &(struct srv_job){ .run = plan_job, .finish = plan_done,
			.argument = exchange, .cancelled = &exchange->cancelled, .owner = exchange->client }))
		return true;
	srv_reaper_watch(exchange->host->reaper, exchange->lease, NULL);
	make_problem(exchange, SRV_PROBLEM_BUSY,
		"too many plans wait, or too many from this address; ask again in a second", false);
	exchange->phase = SRV_PHASE_DONE;
	MHD_resume_connection(exchange->connection);
	return true;
}

/* What was answered before to the same request. */
static bool answer_again(struct srv_exchange *exchange)
{
	struct srv_kept_answer kept;
	if (!srv_plan_cache_get(exchange->host->plans, exchange->validators.etag, &kept))
		return false;
	bool answered = true;
	if (kept.status == MHD_HTTP_NO_CONTENT)
		srv_answer_no_stream(&exchange->answer, NULL);
	else if (kept.body)
		srv_answer_kept(&exchange->answer, kept.body, type_of(exchange), &exchange->validators, NULL);
	else if (exchange->method == SRV_METHOD_HEAD)
		srv_answer_head(&exchange->answer, kept.status, kept.size_bytes, type_of(exchange),
			&exchange->validators);
	else
		answered = false;
	srv_kept_body_release(kept.body);
	if (answered)
		judge_answer(exchange, &exchange->validators);
	return answered;
}

/* A tag takes the pack and the target alone: whether one is named is known without a plan. "*" names whatever
 * there is, so that does need one. */
static bool answer_by_tag(struct srv_exchange *exchange)
{
	const struct srv_conditions *conditions = &exchange->conditions;
	char path[SRV_TARGET_BYTES_MAX];
	struct srv_kept_answer kept = { .size_bytes = SRV_SIZE_UNKNOWN };
	enum srv_verdict verdict = srv_conditions_judge(conditions, exchange->validators.etag,
		exchange->validators.modified_s);
	if (verdict == SRV_VERDICT_FAILED) {
		srv_answer_failed_condition(&exchange->answer, path_of(exchange, path));
		return true;
	}
	if (verdict == SRV_VERDICT_GO || srv_etag_any(conditions->if_none_match))
		return false;
	if (srv_plan_cache_get(exchange->host->plans, exchange->validators.etag, &kept))
		srv_kept_body_release(kept.body);
	srv_answer_head(&exchange->answer, MHD_HTTP_NOT_MODIFIED, kept.size_bytes, type_of(exchange),
		&exchange->validators);
	return true;
}

static bool answer_unplanned(struct srv_exchange *exchange)
{
	srv_etag_request(exchange->validators.etag, exchange->scene, exchange->raw);
	exchange->validators.modified_s = exchange->scene->modified_s;
	return answer_by_tag(exchange) || answer_again(exchange);
}

/* Reads the parameters and the body; true if there is something to plan, else an answer has been made. */
static bool prepare_plan(struct srv_exchange *exchange)
{
	struct eco_error error = { 0 };
	if (srv_query_parse(&exchange->query, &exchange->target, &error)) {
		make_problem(exchange, SRV_PROBLEM_PARAMETER, error.text, false);
		return false;
	}
	if (exchange->query.explain && exchange->route != &srv_routes[SRV_PLAN]) {
		make_problem(exchange, SRV_PROBLEM_PARAMETER, "parameter 'explain': a stream explains "
			"nothing; ask .../plan with the same parameters", false);
		return false;
	}
	const struct eco_chunk_id *pack = &exchange->scene->pack->id;
	if (exchange->query.has_pack && memcmp(pack->bytes, exchange->query.pack.bytes, sizeof pack->bytes)
			!= 0) {
		make_problem(exchange, SRV_PROBLEM_PACK_CHANGED, "the pack is not the one that 'pack' names: "
			"forget what was held of it and ask again without holdings", false);
		return false;
	}
	if (exchange->method != SRV_METHOD_POST)
		return !answer_unplanned(exchange);
	enum eco_code code = eco_wire_read_holdings(exchange->body, exchange->body_size, &exchange->holdings,
		&error);
	if (!code)
		code = srv_holdings_check(&exchange->scene->pack->scene, &exchange->holdings, &error);
	if (code)
		make_problem(exchange, code == ECO_NO_MEMORY ? SRV_PROBLEM_BUSY : SRV_PROBLEM_HOLDINGS,
			error.text, false);
	return !code;
}

/* ---- The other routes ---- */

static void answer_described(struct srv_exchange *exchange, bool validated, struct srv_json *json)
{
	const struct srv_scene *scene = exchange->scene;
	struct srv_validators validators = { .modified_s = scene ? scene->modified_s : 0 };
	if (validated && !json->out.failed) {
		struct eco_chunk_id id = eco_chunk_hash(json->out.bytes, json->out.size);
		srv_etag_of(validators.etag, &id);
	}
	srv_answer_json(&exchange->answer, json, &validators, NULL);
	judge_answer(exchange, &validators);
}

static void answer_chunk(struct srv_exchange *exchange)
{
	struct eco_chunk_id id;
	char detail[256], path[SRV_TARGET_BYTES_MAX];
	uint32_t chunk = srv_parse_id(exchange->variables[1], &id) ? srv_scene_chunk(exchange->scene, &id)
		: ECO_NONE;
	if (chunk != ECO_NONE) {
		srv_answer_chunk(&exchange->answer, exchange->scene, chunk, &exchange->conditions,
			exchange->method == SRV_METHOD_GET, path_of(exchange, path));
		return;
	}
	snprintf(detail, sizeof detail, "scene '%s' has no chunk '%.64s': ids are 32 lower-case hex digits, "
		"the hashes of their payloads", exchange->scene->name, exchange->variables[1]);
	make_problem(exchange, SRV_PROBLEM_CHUNK, detail, false);
}

static void answer_file(struct srv_exchange *exchange, const struct srv_site_file *file)
{
	enum srv_form form = srv_site_form(file, header(exchange, MHD_HTTP_HEADER_ACCEPT_ENCODING));
	struct eco_chunk_id id = eco_chunk_hash(file->forms[form].bytes, file->forms[form].size);
	struct srv_validators validators = { .modified_s = 0 };
	srv_etag_of(validators.etag, &id);
	srv_answer_file(&exchange->answer, file, form, &validators);
	judge_answer(exchange, &validators);
}

static void answer_viewer(struct srv_exchange *exchange, const char *name)
{
	const struct srv_site *site = exchange->host->config.site;
	const struct srv_site_file *file = site ? srv_site_find(site, name) : NULL;
	if (file)
		answer_file(exchange, file);
	else
		make_problem(exchange, SRV_PROBLEM_ROUTE, site && site->count ? "the viewer has no such file"
			: "the viewer is not built: say `make web`, then start ecoserve again (or with "
			"--viewer DIR); /v1/scenes lists the scenes", false);
}

static bool answer_direct(struct srv_exchange *exchange)
{
	struct srv_json json = { 0 };
	struct eco_error error = { 0 };
	if (srv_query_none(&exchange->target, &error))
		return queue_problem(exchange, SRV_PROBLEM_PARAMETER, error.text, false);
	switch (exchange->route - srv_routes) {
	case SRV_HEALTH:
		srv_describe_health(&json, exchange->host->store);
		answer_described(exchange, false, &json);
		break;
	case SRV_SCENES:
		srv_describe_scenes(&json, exchange->host->store);
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
	return queue_answer(exchange);
}

/* The whole request is here. */
static bool answer_request(struct srv_exchange *exchange)
{
	char detail[256];
	srv_reaper_clear(exchange->host->reaper, exchange->lease);
	if (exchange->body_lost)
		return queue_problem(exchange, SRV_PROBLEM_BUSY, bodies_are_many, true);
	if (!exchange->route)
		return queue_problem(exchange, SRV_PROBLEM_ROUTE, known_resources, false);
	if (!(exchange->route->methods & exchange->method)) {
		snprintf(detail, sizeof detail, "use one of %s", exchange->route->allow);
		return queue_problem(exchange, SRV_PROBLEM_METHOD, detail, false);
	}
	if (exchange->variables[0] && exchange->route != &srv_routes[SRV_VIEWER]) {
		exchange->scene = srv_store_find(exchange->host->store, exchange->variables[0]);
		if (!exchange->scene) {
			snprintf(detail, sizeof detail, "there is no scene '%.64s'; /v1/scenes lists what "
				"there is", exchange->variables[0]);
			return queue_problem(exchange, SRV_PROBLEM_SCENE, detail, false);
		}
	}
	if (exchange->route != &srv_routes[SRV_PLAN] && exchange->route != &srv_routes[SRV_STREAM])
		return answer_direct(exchange);
	return prepare_plan(exchange) ? start_plan(exchange) : queue_answer(exchange);
}

/* ---- Receiving ---- */

/* The head has passed the gate: what occurs is well formed, and once. */
static void read_headers(struct srv_exchange *exchange)
{
	const char *length = header(exchange, MHD_HTTP_HEADER_CONTENT_LENGTH);
	assert(exchange->lease->gate.framing.heads > 0);
	exchange->conditions = (struct srv_conditions){ .range = header(exchange, MHD_HTTP_HEADER_RANGE),
		.if_range = header(exchange, MHD_HTTP_HEADER_IF_RANGE),
		.if_match = header(exchange, MHD_HTTP_HEADER_IF_MATCH),
		.if_none_match = header(exchange, MHD_HTTP_HEADER_IF_NONE_MATCH),
		.if_unmodified_since = header(exchange, MHD_HTTP_HEADER_IF_UNMODIFIED_SINCE) };
	if (exchange->lease->is_proxy)
		exchange->client = srv_networks_client(&exchange->host->config.trusted,
			&exchange->lease->address, header(exchange, "X-Forwarded-For"));
	exchange->has_length = length && srv_parse_count(length, &exchange->length);
}

/* application/octet-stream, with or without parameters. */
static bool is_octets(const char *type)
{
	static const char octets[] = "application/octet-stream";
	return type && strncasecmp(type, octets, sizeof octets - 1) == 0
		&& strchr(" \t;", type[sizeof octets - 1]);
}

static enum srv_problem judge_body(const struct srv_exchange *exchange, struct eco_error *error)
{
	if (!exchange->has_length) {
		eco_fail(error, ECO_BAD_INPUT, "send the holdings as the body, with a Content-Length");
		return SRV_PROBLEM_LENGTH_REQUIRED;
	}
	if (exchange->length > exchange->host->config.body_max) {
		eco_fail(error, ECO_TOO_LARGE, "the body has %llu bytes; at most %llu are accepted",
			(unsigned long long)exchange->length,
			(unsigned long long)exchange->host->config.body_max);
		return SRV_PROBLEM_BODY_TOO_LARGE;
	}
	if (!is_octets(header(exchange, MHD_HTTP_HEADER_CONTENT_TYPE))) {
		eco_fail(error, ECO_UNSUPPORTED, "send the holdings as Content-Type: "
			"application/octet-stream");
		return SRV_PROBLEM_MEDIA_TYPE;
	}
	return SRV_PROBLEM_NONE;
}

/* The worst problem of the head alone: target first, then route and method. Without a body the latter two
 * wait for answer_request, which keeps the connection. */
static enum srv_problem judge_head(struct srv_exchange *exchange, bool takes_body, struct eco_error *error)
{
	if (exchange->target_code) {
		eco_fail(error, exchange->target_code, "%s", exchange->error.text);
		return exchange->target_code == ECO_TOO_LARGE ? SRV_PROBLEM_TARGET_TOO_LONG
			: SRV_PROBLEM_TARGET;
	}
	if (takes_body)
		return judge_body(exchange, error);
	if (exchange->length == 0)
		return SRV_PROBLEM_NONE;
	if (!exchange->route) {
		eco_fail(error, ECO_NOT_FOUND, "%s; only .../stream takes a body", known_resources);
		return SRV_PROBLEM_ROUTE;
	}
	if (!(exchange->route->methods & exchange->method)) {
		eco_fail(error, ECO_BAD_INPUT, "use one of %s", exchange->route->allow);
		return SRV_PROBLEM_METHOD;
	}
	eco_fail(error, ECO_BAD_INPUT, "this resource takes no body with this method");
	return SRV_PROBLEM_FRAMING;
}

/* Room for `size` bytes of the body. It grows with what arrives, since what is declared costs a client
 * nothing. False if there is no memory, or too much is held for others. */
static bool grow_body(struct srv_exchange *exchange, size_t size)
{
	struct srv_host *host = exchange->host;
	size_t length = (size_t)exchange->length, room = exchange->body_room;
	if (size <= room)
		return true;
	while (room < size)
		room = room ? 2 * room : BODY_STAKE_BYTES;
	room = room < length ? room : length + 1;
	size_t more = room - exchange->body_room;
	uint64_t held = atomic_fetch_add(&host->bodies_bytes, more) + more;
	uint8_t *body = held <= host->config.bodies_max ? realloc(exchange->body, room) : NULL;
	if (!body) {
		atomic_fetch_sub(&host->bodies_bytes, more);
		return false;
	}
	exchange->body = body;
	exchange->body_room = room;
	return true;
}

/* The head is complete: either the request goes on, or it is refused and the connection closed, since what
 * follows may be a body. */
static bool handle_head(struct srv_exchange *exchange, const char *method)
{
	struct srv_host *host = exchange->host;
	struct eco_error error = { 0 };
	exchange->counted = true;
	atomic_fetch_add(&host->busy, 1);
	exchange->method = srv_method_of(method);
	read_headers(exchange);
	if (atomic_load(&host->draining))
		return queue_problem(exchange, SRV_PROBLEM_STOPPING,
			"the server is stopping; ask again in a moment", true);
	exchange->route = exchange->target_code ? NULL
		: srv_route_find(&exchange->target, exchange->variables);
	bool takes_body = exchange->method == SRV_METHOD_POST && exchange->route
		&& (exchange->route->methods & SRV_METHOD_POST);
	enum srv_problem problem = judge_head(exchange, takes_body, &error);
	if (problem)
		return queue_problem(exchange, problem, error.text, true);
	exchange->phase = SRV_PHASE_BODY;
	if (!takes_body)
		return true;
	srv_reaper_arm(host->reaper, exchange->lease, host->config.body_ms);
	return grow_body(exchange, 1) || queue_problem(exchange, SRV_PROBLEM_BUSY, bodies_are_many, true);
}

/* The library takes no answer within a body: the rest of this one is read, kept nowhere, and then refused. */
static void lose_body(struct srv_exchange *exchange)
{
	atomic_fetch_sub(&exchange->host->bodies_bytes, exchange->body_room);
	free(exchange->body);
	exchange->body = NULL;
	exchange->body_room = 0;
	exchange->body_lost = true;
}

static bool take_body(struct srv_exchange *exchange, const char *bytes, size_t *size)
{
	if (*size > exchange->length - exchange->body_size)
		return false;            /* the library promised not to deliver more than the length */
	if (!exchange->body_lost && !grow_body(exchange, exchange->body_size + *size))
		lose_body(exchange);
	if (!exchange->body_lost)
		memcpy(exchange->body + exchange->body_size, bytes, *size);
	exchange->body_size += *size;
	*size = 0;
	return true;
}

bool srv_exchange_handle(struct srv_exchange *exchange, const char *method, const char *bytes, size_t *size)
{
	switch (exchange->phase) {
	case SRV_PHASE_HEAD:
		return handle_head(exchange, method);
	case SRV_PHASE_BODY:
		return *size ? take_body(exchange, bytes, size) : answer_request(exchange);
	case SRV_PHASE_WORKING:
		return true;
	case SRV_PHASE_DONE:
		return queue_answer(exchange);
	}
	return false;
}

/* ---- The end ---- */

static void log_line(const struct srv_exchange *exchange)
{
	static const char *const methods[] = { [SRV_METHOD_OTHER] = "?", [SRV_METHOD_GET] = "GET",
		[SRV_METHOD_HEAD] = "HEAD", [SRV_METHOD_POST] = "POST" };
	char host[SRV_ADDRESS_TEXT_BYTES], target[256];
	size_t size = 0;
	srv_address_format(host, &exchange->client);
	for (; exchange->raw[size] && size < sizeof target - 1; size++)
		target[size] = exchange->raw[size] > 0x20 && exchange->raw[size] < 0x7f ? exchange->raw[size]
			: '?';
	target[size] = 0;
	fprintf(stderr, "%s %s %s %u %llu %.3f ms\n", host, methods[exchange->method], target,
		exchange->answer.status,
		(unsigned long long)(exchange->method == SRV_METHOD_HEAD ? 0 : exchange->answer.size_bytes),
		(double)(srv_clock_us() - exchange->begun_us) / 1000.0);
}

void srv_exchange_end(struct srv_exchange *exchange)
{
	if (exchange->host->config.log)
		log_line(exchange);
	if (exchange->counted)
		atomic_fetch_sub(&exchange->host->busy, 1);
	atomic_fetch_sub(&exchange->host->bodies_bytes, exchange->body_room);
	srv_reaper_await(exchange->host->reaper, exchange->lease);
	srv_answer_free(&exchange->answer);
	free(exchange->holdings.items);
	free(exchange->body);
	free(exchange->raw);
	free(exchange);
}
