#include "server/exchange.h"

#include <assert.h>
#include <microhttpd.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "ecofiles/base/array_grow.h"
#include "ecofiles/base/random.h"
#include "server/log.h"
#define FORWARDED "X-Forwarded-For"
#define BODY_STAKE_BYTES (4u << 10)     /* what a body is given before any of it is there */
#define FREE_BYTES (16u << 10)          /* about what a connection takes itself */

static const char known_resources[] =
	"known are /, /healthz, /readyz, /metrics, /v1/scenes, and below a scene "
	"plan, stream, species, find, chunks/{id} and plants/{list}";
static const char bodies_are_many[] = "too many holdings are being received; ask again in a second";

/* A page takes no parameters: its path alone is read, and what others append to a link to it is ignored. */
static void read_target(struct srv_exchange *exchange)
{
	const char *raw = exchange->raw;
	exchange->target_code = srv_target_parse(&exchange->target, raw, strcspn(raw, "?"), &exchange->error);
	exchange->route = exchange->target_code ? NULL
		: srv_route_find(&exchange->target, exchange->variables);
	if (!exchange->target_code && !(exchange->route && exchange->route->is_page))
		exchange->target_code = srv_target_parse(&exchange->target, raw, strlen(raw),
			&exchange->error);
	if (exchange->target_code)
		exchange->route = NULL;
}

struct srv_exchange *srv_exchange_new(struct srv_daemon *daemon, struct MHD_Connection *connection,
	struct srv_lease *lease, const char *raw)
{
	struct srv_exchange *exchange = calloc(1, sizeof *exchange);
	if (!exchange)
		return NULL;
	exchange->daemon = daemon;
	exchange->connection = connection;
	exchange->lease = lease;
	exchange->client = lease->address;
	exchange->begun_us = srv_clock_us();
	exchange->raw = strdup(raw);
	if (!exchange->raw) {
		free(exchange);
		return NULL;
	}
	read_target(exchange);
	return exchange;
}

const char *srv_exchange_header(const struct srv_exchange *exchange, const char *name)
{
	return MHD_lookup_connection_value(exchange->connection, MHD_HEADER_KIND, name);
}

/* ---- Sending ---- */

static void add_common_headers(struct srv_exchange *exchange)
{
	const struct srv_access *access = exchange->daemon->config.access;
	const char *origin = srv_access_origin(access, exchange->origin);
	srv_answer_add(exchange, "X-Request-Id", exchange->id);
	if (srv_access_origins_vary(access))     /* the value depends on the request */
		srv_answer_add(exchange, MHD_HTTP_HEADER_VARY, MHD_HTTP_HEADER_ORIGIN);
	srv_answer_add(exchange, "Access-Control-Allow-Origin", origin);
	srv_answer_add(exchange, "Access-Control-Expose-Headers", origin
		? "ETag, Server-Timing, X-Request-Id, Retry-After, Content-Range" : NULL);
}

/* Answers that are being sent are held by who asked for them, within the bound of all. Small ones are not
 * counted, so that /healthz is always answered. */
static void hold_answer(struct srv_exchange *exchange)
{
	uint64_t bytes = exchange->answer.memory_bytes, most = exchange->daemon->config.answers_max;
	if (bytes <= FREE_BYTES || srv_reaper_hold(exchange->daemon->reaper, exchange->lease, SRV_HELD_ANSWERS,
			bytes))
		return;
	if (bytes > most)
		srv_exchange_problem(exchange, SRV_PROBLEM_LIMIT, "the answer takes %llu bytes of memory; at most %llu are "
			"given to all answers: ask for fewer vertices, or set 'bytes'", (unsigned long
			long)bytes, (unsigned long long)most);
	else
		srv_exchange_problem(exchange, SRV_PROBLEM_BUSY, "too many answers are being sent; ask again in a second");
}

static bool queue_answer(struct srv_exchange *exchange)
{
	struct srv_answer *answer = &exchange->answer;
	hold_answer(exchange);
	add_common_headers(exchange);
	if (!answer->response)
		return false;
	srv_reaper_await(exchange->daemon->reaper, exchange->lease, SRV_WAIT_SENDING);
	bool queued = MHD_queue_response(exchange->connection, answer->status, answer->response) == MHD_YES;
	exchange->phase = SRV_PHASE_DONE;
	srv_answer_free(exchange);
	return queued;
}

/* ---- Working ---- */

static void finish_work(void *argument)
{
	struct srv_exchange *exchange = argument;
	srv_reaper_watch(exchange->daemon->reaper, exchange->lease, NULL);
	exchange->phase = SRV_PHASE_DONE;
	MHD_resume_connection(exchange->connection);     /* from here on the exchange may be gone */
}

static void refuse_work(void *argument)
{
	struct srv_exchange *exchange = argument;
	srv_count(&exchange->daemon->metrics, SRV_COUNT_PLANS_REFUSED, 1);
	srv_exchange_problem(exchange, SRV_PROBLEM_BUSY,
		"too many plans wait, or too many from this address; ask again in a second");
	finish_work(exchange);
}

/* Suspends the connection until `run` has made exchange->answer on a thread of `work`; a problem where there
 * is no room for it. */
static void work_on(struct srv_exchange *exchange, struct srv_work *work, void (*run)(void *exchange))
{
	exchange->phase = SRV_PHASE_WORKING;
	MHD_suspend_connection(exchange->connection);    /* first: the job may end before submit returns */
	srv_reaper_watch(exchange->daemon->reaper, exchange->lease, &exchange->cancelled);
	if (!srv_work_submit(work, &(struct srv_job){ .run = run, .finish = finish_work,
			.displaced = refuse_work, .argument = exchange,
			.cancelled = &exchange->cancelled, .owner = exchange->client }))
		refuse_work(exchange);
}

/* ---- Who may ---- */

static const char *const proxy_headers[] = { FORWARDED, "Forwarded", "Via" };

/* On this machine, and speaks for nobody else: neither a proxy, as far as it says so, nor a page of a
 * browser. A page whose name was led to this machine after it was loaded sends no origin, but its name. */
static bool is_local(const struct srv_exchange *exchange)
{
	const char *host = srv_exchange_header(exchange, MHD_HTTP_HEADER_HOST);
	if (!srv_address_is_loopback(&exchange->client) || exchange->lease->is_proxy || exchange->origin
			|| (host && !srv_host_is_loopback(host)))
		return false;
	for (size_t i = 0; i < sizeof proxy_headers / sizeof *proxy_headers; i++)
		if (srv_exchange_header(exchange, proxy_headers[i]))
			return false;
	return true;
}

static bool may_operate(struct srv_exchange *exchange)
{
	const struct srv_access *access = exchange->daemon->config.access;
	bool by_token = srv_access_is_private(access, "");
	if (by_token ? srv_access_scene(access, "", exchange->authorization) : is_local(exchange))
		return true;
	srv_exchange_problem(exchange, SRV_PROBLEM_OPERATOR, "%s", by_token
		? "send the operator's token: Authorization: Bearer TOKEN"
		: "ask from the server's machine by localhost or its address, not by a proxy; or start it "
		"with --admin-token");
	return false;
}

/* Sets the scene of a path that names one; false if an answer says why there is none. If scenes have tokens,
 * one that is not there is answered as one whose token was not sent, so that nobody learns their names. */
static bool find_scene(struct srv_exchange *exchange)
{
	const char *name = exchange->variables[0];
	if (!name || exchange->route->is_page)
		return true;
	exchange->scene =
		srv_edition_find(exchange->edition, name, exchange->route == &srv_routes[SRV_CHUNK]);
	const struct srv_access *access = exchange->daemon->config.access;
	bool may = srv_access_scene(access, name, exchange->authorization),
		may_know = may && (exchange->scene || !srv_access_has_private(access)
		|| srv_access_is_private(access, name) || (srv_access_is_private(access, "") && srv_access_scene(access, "", exchange->authorization)));
	if (exchange->scene && may)
		return true;
	exchange->scene = NULL;
	srv_exchange_problem(exchange, may_know ? SRV_PROBLEM_SCENE : SRV_PROBLEM_TOKEN,
		"there is no scene '%.64s'%s", name, may_know ? "; /v1/scenes lists what there is"
		: ", or it is opened by its token: Authorization: Bearer TOKEN");
	return false;
}

/* Methods and headers that the resource takes. */
static void answer_options(struct srv_exchange *exchange)
{
	srv_answer_bytes(exchange, MHD_HTTP_NO_CONTENT, "", 0, NULL);
	srv_answer_add(exchange, MHD_HTTP_HEADER_ALLOW, exchange->route->allow);
	srv_answer_add(exchange, "Access-Control-Allow-Methods", exchange->route->allow);
	srv_answer_add(exchange, "Access-Control-Allow-Headers",
		"Authorization, Content-Type, If-None-Match, Range");
	srv_answer_add(exchange, "Access-Control-Max-Age", "600");
}

/* The whole request is here: answers it, or has it worked on, which is answered later. False: later. */
static bool answer_whole_request(struct srv_exchange *exchange)
{
	const struct srv_route *route = exchange->route;
	if (exchange->body_lost) {
		exchange->closes = true;
		srv_exchange_problem(exchange, SRV_PROBLEM_BUSY, "%s", bodies_are_many);
	} else if (!route) {
		srv_exchange_problem(exchange, SRV_PROBLEM_ROUTE, "%s", known_resources);
	} else if (!(route->methods & exchange->method)) {
		srv_exchange_problem(exchange, SRV_PROBLEM_METHOD, "use one of %s", route->allow);
	} else if (exchange->method == SRV_METHOD_OPTIONS) {
		answer_options(exchange);
	} else if ((route->is_operators && !may_operate(exchange)) || !find_scene(exchange)) {
		return true;
	} else if (route == &srv_routes[SRV_RELOAD]) {
		work_on(exchange, exchange->daemon->chores, srv_exchange_reload);
		return false;
	} else if (route != &srv_routes[SRV_PLAN] && route != &srv_routes[SRV_STREAM]) {
		srv_exchange_answer_direct(exchange);
	} else if (srv_exchange_prepare_plan(exchange)) {
		work_on(exchange, exchange->daemon->work, srv_exchange_make_plan);
		return false;
	}
	return true;
}

static bool answer_request(struct srv_exchange *exchange)
{
	srv_reaper_await(exchange->daemon->reaper, exchange->lease, SRV_WAIT_WORK);
	srv_gate_answering(&exchange->lease->gate, true);
	return answer_whole_request(exchange) ? queue_answer(exchange) : true;
}

/* ---- Receiving ---- */

/* A proxy's, where it is short and of harmless characters; else one that no other request of this process
 * has. */
static void set_id(struct srv_exchange *exchange, const char *given)
{
	struct srv_daemon *daemon = exchange->daemon;
	size_t size = given
		? strspn(given, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789._-")
		: 0;
	if (size && size < sizeof exchange->id && !given[size])
		memcpy(exchange->id, given, size + 1);
	else
		snprintf(exchange->id, sizeof exchange->id, "%016llx",
			(unsigned long long)eco_random(daemon->id_seed, atomic_fetch_add(&daemon->id_count, 1)));
}

struct lines { char text[SRV_HEAD_BYTES_MAX]; size_t size; };

static enum MHD_Result add_forwarded(void *context, enum MHD_ValueKind kind, const char *name,
	const char *value)
{
	struct lines *lines = context;
	size_t size = value ? strlen(value) : 0;
	(void)kind;
	if (strcasecmp(name, FORWARDED) != 0 || lines->size + size + 2 > sizeof lines->text)
		return MHD_YES;
	if (lines->size)
		lines->text[lines->size++] = ',';
	memcpy(lines->text + lines->size, value ? value : "", size + 1);
	lines->size += size;
	return MHD_YES;
}

/* A proxy may append a line to those of the client, which come first. */
static struct srv_address client_of(const struct srv_exchange *exchange)
{
	struct lines lines = { .size = 0 };
	MHD_get_connection_values(exchange->connection, MHD_HEADER_KIND, add_forwarded, &lines);
	return srv_networks_client(&exchange->daemon->config.trusted, &exchange->lease->address, lines.text);
}

/* The head has passed the gate: what it reads is well formed, and once. */
static void read_headers(struct srv_exchange *exchange)
{
	const char *length = srv_exchange_header(exchange, MHD_HTTP_HEADER_CONTENT_LENGTH);
	assert(exchange->lease->gate.framing.heads > 0);
	exchange->conditions = (struct srv_conditions){
		.range = srv_exchange_header(exchange, MHD_HTTP_HEADER_RANGE),
		.if_range = srv_exchange_header(exchange, MHD_HTTP_HEADER_IF_RANGE),
		.if_match = srv_exchange_header(exchange, MHD_HTTP_HEADER_IF_MATCH),
		.if_none_match = srv_exchange_header(exchange, MHD_HTTP_HEADER_IF_NONE_MATCH),
		.if_unmodified_since = srv_exchange_header(exchange, MHD_HTTP_HEADER_IF_UNMODIFIED_SINCE) };
	if (exchange->lease->is_proxy) {
		exchange->client = client_of(exchange);
		srv_reaper_speak_for(exchange->daemon->reaper, exchange->lease, &exchange->client);
	}
	exchange->authorization = srv_exchange_header(exchange, MHD_HTTP_HEADER_AUTHORIZATION);
	exchange->origin = srv_exchange_header(exchange, MHD_HTTP_HEADER_ORIGIN);
	set_id(exchange, exchange->lease->is_proxy ? srv_exchange_header(exchange, "X-Request-Id") : NULL);
	exchange->has_length = length && srv_parse_count(length, &exchange->length);
}

/* application/octet-stream, with or without parameters. */
static bool is_octets(const char *type)
{
	static const char octets[] = "application/octet-stream";
	return type && strncasecmp(type, octets, sizeof octets - 1) == 0
		&& strchr(" \t;", type[sizeof octets - 1]);
}

/* Answers the worst problem of the head alone: target first, then route and method. Without a body the latter
 * two wait for answer_request, which keeps the connection. False: there is none. */
static bool refuse_head(struct srv_exchange *exchange, bool takes_body)
{
	unsigned long long length = exchange->length, most = exchange->daemon->config.body_max;
	if (atomic_load(&exchange->daemon->draining))
		srv_exchange_problem(exchange, SRV_PROBLEM_STOPPING, "the server is stopping; ask again in a moment");
	else if (exchange->target_code)
		srv_exchange_problem(exchange, exchange->target_code == ECO_TOO_LARGE ? SRV_PROBLEM_TARGET_TOO_LONG
			: SRV_PROBLEM_TARGET, "%s", exchange->error.text);
	else if (takes_body && !exchange->has_length)
		srv_exchange_problem(exchange, SRV_PROBLEM_LENGTH_REQUIRED,
			"send the holdings as the body, with a Content-Length");
	else if (takes_body && length > most)
		srv_exchange_problem(exchange, SRV_PROBLEM_BODY_TOO_LARGE,
			"the body has %llu bytes; at most %llu are accepted", length, most);
	else if (takes_body && !is_octets(srv_exchange_header(exchange, MHD_HTTP_HEADER_CONTENT_TYPE)))
		srv_exchange_problem(exchange, SRV_PROBLEM_MEDIA_TYPE,
			"send the holdings as Content-Type: application/octet-stream");
	else if (takes_body || !length)
		return false;
	else if (!exchange->route)
		srv_exchange_problem(exchange, SRV_PROBLEM_ROUTE, "%s; only .../stream takes a body", known_resources);
	else if (!(exchange->route->methods & exchange->method))
		srv_exchange_problem(exchange, SRV_PROBLEM_METHOD, "use one of %s", exchange->route->allow);
	else
		srv_exchange_problem(exchange, SRV_PROBLEM_FRAMING, "this resource takes no body with this method");
	return true;
}

/* Room for `size` bytes of the body. It grows with what arrives, since what is declared costs a client
 * nothing. False if there is no memory, or too much is held for others. */
static bool grow_body(struct srv_exchange *exchange, size_t size)
{
	size_t length = (size_t)exchange->length, room = exchange->body_room;
	if (size <= room)
		return true;
	while (room < size)
		room = room ? 2 * room : BODY_STAKE_BYTES;
	room = room < length ? room : length + 1;
	if (!srv_reaper_hold(exchange->daemon->reaper, exchange->lease, SRV_HELD_BODIES, room))
		return false;
	uint8_t *body = realloc(exchange->body, room);
	if (!body)
		return false;
	exchange->body = body;
	exchange->body_room = room;
	return true;
}

/* The head is complete: either the request goes on, or it is refused, and the connection closes, since a body
 * may follow. */
static bool handle_head(struct srv_exchange *exchange, const char *method)
{
	struct srv_daemon *daemon = exchange->daemon;
	exchange->counted = true;
	atomic_fetch_add(&daemon->busy, 1);
	exchange->edition = srv_catalog_hold(&daemon->catalog);
	exchange->method = srv_method_of(method);
	read_headers(exchange);
	bool takes_body = exchange->method == SRV_METHOD_POST && exchange->route == &srv_routes[SRV_STREAM];
	exchange->closes = exchange->lease->is_refused = true;
	if (refuse_head(exchange, takes_body))
		return queue_answer(exchange);
	if (takes_body)
		srv_reaper_await(daemon->reaper, exchange->lease, SRV_WAIT_BODY);
	if (takes_body && !grow_body(exchange, 1)) {
		srv_exchange_problem(exchange, SRV_PROBLEM_BUSY, "%s", bodies_are_many);
		return queue_answer(exchange);
	}
	exchange->closes = exchange->lease->is_refused = false;
	exchange->phase = SRV_PHASE_BODY;
	return true;
}

/* The library takes no answer within a body: the rest of this one is read, kept nowhere, and then refused. */
static void lose_body(struct srv_exchange *exchange)
{
	srv_reaper_hold(exchange->daemon->reaper, exchange->lease, SRV_HELD_BODIES, 0);
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

static const char *const methods[] = { [SRV_METHOD_OTHER] = "?", [SRV_METHOD_GET] = "GET",
	[SRV_METHOD_HEAD] = "HEAD", [SRV_METHOD_POST] = "POST", [SRV_METHOD_OPTIONS] = "OPTIONS" };

static uint64_t sent_bytes(const struct srv_exchange *exchange)
{
	return exchange->method == SRV_METHOD_HEAD ? 0 : exchange->answer.size_bytes;
}

/* The next line of a trace; returns what follows it. */
static const char *next_line(char line[512], const char *trace)
{
	size_t size = strcspn(trace, "\n");
	snprintf(line, 512, "%.*s", (int)size, trace);
	return trace + size + (trace[size] == '\n');
}

/* `trace`: lines about a slow plan, or NULL. */
static void log_json(const struct srv_exchange *exchange, const char *client, const char *target, double ms,
	const char *trace)
{
	struct srv_json json = { 0 };
	char line[512];
	srv_log_begin(&json, trace ? "slow" : "request");
	srv_json_add(&json, "id:%s client:%s method:%s target:%s", exchange->id, client, methods[exchange->method],
		target);
	if (exchange->scene)
		srv_json_add(&json, "scene:%s", exchange->scene->name);
	srv_json_add(&json, "status:%u bytes:%lu ms:%g", exchange->answer.status, sent_bytes(exchange), ms);
	if (exchange->plan_us)
		srv_json_add(&json, "plan_ms:%g work:%lu cut_short:%d", (double)exchange->plan_us / 1000.0,
			exchange->plan_work, exchange->cut_short);
	if (trace)
		srv_json_add(&json, "trace:[");
	for (const char *at = trace; at && *at; srv_json_add(&json, "%s", line))
		at = next_line(line, at);
	srv_json_add(&json, trace ? "]}" : "}");
	srv_log_end(&json.out);
}

static void log_text(const struct srv_exchange *exchange, const char *client, const char *target, double ms,
	const char *trace)
{
	struct eco_writer out = { 0 };
	char line[512];
	eco_write_format(&out, "%s%s %s ", trace ? "slow: " : "", client, methods[exchange->method]);
	eco_write_format(&out, "%s %u %llu %.3f ms id=%s", target, exchange->answer.status,
		(unsigned long long)sent_bytes(exchange), ms, exchange->id);
	if (exchange->plan_us)
		eco_write_format(&out, " plan=%.3f ms work=%llu%s", (double)exchange->plan_us / 1000.0,
			(unsigned long long)exchange->plan_work, exchange->cut_short ? " cut-short" : "");
	for (const char *at = trace; at && *at; eco_write_format(&out, "\n  %.508s", line))
		at = next_line(line, at);
	srv_log_end(&out);
}

static void log_request(const struct srv_exchange *exchange, bool is_slow)
{
	const char *trace = !is_slow ? NULL : exchange->trace.size ? (const char *)exchange->trace.bytes : "";
	char client[SRV_ADDRESS_TEXT_BYTES], target[SRV_LOG_TARGET_BYTES];
	double ms = (double)(srv_clock_us() - exchange->begun_us) / 1000.0;
	srv_address_format(client, &exchange->client);
	srv_log_clean_target(target, exchange->raw);
	(exchange->daemon->config.log_form == SRV_LOG_JSON ? log_json : log_text)(exchange, client, target, ms, trace);
}

/* A request that was given up before its head was whole counts nowhere. The trace ends with a 0. */
static void count_and_log(struct srv_exchange *exchange)
{
	struct srv_daemon *daemon = exchange->daemon;
	bool slow = daemon->config.slow_ms && exchange->plan_us >= daemon->config.slow_ms * 1000;
	if (slow)
		eco_write_u8(&exchange->trace, 0);
	srv_count(&daemon->metrics, SRV_COUNT_SLOW, slow);
	if (exchange->counted) {
		srv_count_request(&daemon->metrics, exchange->route, exchange->answer.status);
		srv_count(&daemon->metrics, SRV_COUNT_BODY_BYTES, sent_bytes(exchange));
	}
	if (slow || daemon->config.log)
		log_request(exchange, slow);
}

void srv_exchange_end(struct srv_exchange *exchange)
{
	count_and_log(exchange);
	if (exchange->counted)
		atomic_fetch_sub(&exchange->daemon->busy, 1);
	srv_gate_answering(&exchange->lease->gate, false);
	srv_reaper_await(exchange->daemon->reaper, exchange->lease, SRV_WAIT_REQUEST);
	srv_answer_free(exchange);
	eco_writer_free(&exchange->trace);
	srv_edition_release(exchange->edition);
	eco_free(exchange->holdings.items, exchange->body, exchange->raw, exchange);
}
