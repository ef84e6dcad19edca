/* Plans and streams: from the parameters to an answer, which a work thread makes or the cache has. */
#include "server/exchange.h"

#include <microhttpd.h>
#include <stdio.h>
#include <string.h>

#include "ecofiles/format/wire.h"
#include "server/access.h"
#include "server/describe.h"
#include "server/log.h"
#include "server/typical.h"

#define PLAN_TEXT_MAX (64u << 20)        /* or --answer-bytes, if that is less */

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

static enum eco_code json_end(struct srv_json *json, const struct srv_stream *stream, struct eco_error *error)
{
	unsigned long long most = json->most;
	enum eco_code code = srv_json_end(json);
	if (code == ECO_TOO_LARGE)
		eco_fail(error, code, "the plan has %u cuts, and its text more than %llu bytes; ask for fewer "
			"vertices, or for the stream", stream->steps[stream->step_count - 1].plan.cut_count, most);
	else if (code)
		eco_fail(error, code, "the plan could not be written; ask again in a moment");
	return code;
}

static enum eco_code answer_plan(struct srv_exchange *exchange, struct srv_stream *stream, uint64_t begun_us,
	struct eco_error *error)
{
	uint64_t planned_us = srv_clock_us(), most = exchange->host->config.response_max;
	char timing[96];
	struct srv_json json = { .most = most < PLAN_TEXT_MAX ? most : PLAN_TEXT_MAX,
		.cancelled = &exchange->cancelled };
	srv_describe_plan(&json, stream);
	enum eco_code code = json_end(&json, stream, error);
	if (code)
		return code;
	timing_text(timing, sizeof timing, begun_us, planned_us);
	const struct srv_piece text = { json.out.bytes, json.out.size };
	if (answer_kept(exchange, srv_kept_body_copy(&text, 1, text.size), timing)) {
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

void srv_exchange_make_plan(void *argument)
{
	struct srv_exchange *exchange = argument;
	struct srv_host *host = exchange->host;
	struct srv_stream_input input = { .scene = exchange->scene, .request = &exchange->query.request,
		.rule = exchange->query.rule, .explain = exchange->query.explain, .holdings = &exchange->holdings,
		.body_max = host->config.response_max, .cancelled = &exchange->cancelled,
		.work_max = host->config.plan_times * srv_typical_work(exchange->scene) };
	struct srv_stream stream;
	struct eco_error error = { 0 };
	uint64_t begun_us = srv_clock_us();
	srv_trace_capture(host->config.slow_ms ? &exchange->trace : NULL);
	enum eco_code code = srv_stream_plan(&stream, &input, &error);
	srv_trace_capture(NULL);
	if (!code) {
		exchange->plan_work = stream.work;
		exchange->cut_short = stream.cut_short;
		code = (exchange->route == &srv_routes[SRV_PLAN] ? answer_plan : answer_stream)(exchange,
			&stream, begun_us, &error);
		srv_stream_free(&stream);
	}
	exchange->plan_us = srv_clock_us() - begun_us + 1;
	srv_count_plan(&host->metrics, exchange->plan_us, exchange->plan_work, exchange->cut_short);
	srv_count(&host->metrics, SRV_COUNT_PLANS_CANCELLED, atomic_load(&exchange->cancelled));
	if (code)
		srv_exchange_problem(exchange, srv_problem_of(code), error.text, false);
	else
		srv_exchange_judge(exchange, &exchange->validators);
}

/* Repeats an earlier answer to the same request. */
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
		srv_exchange_judge(exchange, &exchange->validators);
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
		srv_answer_failed_condition(&exchange->answer, srv_exchange_path(exchange, path));
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
	const struct srv_most most = srv_caps_of(exchange->host->config.caps, exchange->scene->name);
	srv_etag_request(exchange->validators.etag, exchange->scene,
		(const uint64_t[3]){ exchange->host->config.plan_times, most.vertices, most.bytes }, exchange->raw);
	exchange->validators.modified_s = exchange->scene->modified_s;
	exchange->validators.is_private = srv_access_is_private(exchange->host->config.access,
		exchange->scene->name);
	bool answered = answer_by_tag(exchange) || answer_again(exchange);
	srv_count(&exchange->host->metrics, SRV_COUNT_KEPT, answered);
	if (answered)
		srv_trace(SRV_TRACE_CACHE, "%s: answered without a plan: %s", exchange->scene->name,
			exchange->validators.etag);
	return answered;
}

bool srv_exchange_prepare_plan(struct srv_exchange *exchange)
{
	struct eco_error error = { 0 };
	if (srv_query_parse(&exchange->query, &exchange->target, &error)) {
		srv_exchange_problem(exchange, SRV_PROBLEM_PARAMETER, error.text, false);
		return false;
	}
	const struct srv_most most = srv_caps_of(exchange->host->config.caps, exchange->scene->name);
	srv_caps_apply(&most, &exchange->query.request);
	if (exchange->query.explain && exchange->route != &srv_routes[SRV_PLAN]) {
		srv_exchange_problem(exchange, SRV_PROBLEM_PARAMETER,
			"parameter 'explain': a stream explains "
			"nothing; ask .../plan with the same parameters",
			false);
		return false;
	}
	const struct eco_chunk_id *pack = &exchange->scene->pack->id;
	if (exchange->query.pack.given && memcmp(pack->bytes, exchange->query.pack.id.bytes, sizeof pack->bytes) != 0) {
		srv_exchange_problem(exchange, SRV_PROBLEM_PACK_CHANGED, "the pack is not the one that 'pack' "
			"names: forget what was held of it and ask again without holdings", false);
		return false;
	}
	if (exchange->method != SRV_METHOD_POST)
		return !answer_unplanned(exchange);
	enum eco_code code = eco_wire_read_holdings(exchange->body, exchange->body_size, &exchange->holdings,
		&error);
	if (!code)
		code = srv_holdings_check(&exchange->scene->pack->scene, &exchange->holdings, &error);
	if (code)
		srv_exchange_problem(exchange,
			code == ECO_NO_MEMORY ? SRV_PROBLEM_BUSY : SRV_PROBLEM_HOLDINGS, error.text, false);
	return !code;
}
