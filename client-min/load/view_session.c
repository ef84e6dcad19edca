#include "client-min/load/view_load.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "client-min/view_exchange.h"
#include "client-min/view_query.h"
#include "client-min/view_select.h"
#include "ecofiles/base/memory.h"
#include "ecofiles/base/random.h"
#include "ecofiles/base/version.h"

#define DEADLINE_MS 120000.0
#define CONNECT_MS 10000L
#define PAUSE_MS 100.0           /* before something is asked for again */
#define PACK_CHANGED 409

enum phase { PHASE_IDLE, PHASE_ON_ITS_WAY, PHASE_ASKED, PHASE_OVER };

struct view_session {
	struct view_session_host *host;
	uint32_t number, frame;
	bool cold;
	enum phase phase;
	double wakes_ms, due_ms, asked_ms, until_ms;
	uint64_t random;                         /* of its arrivals */
	bool decodes;
	struct view_store *store;
	struct view_answer answer;               /* under way */
	struct view_exchange *exchange;
	struct eco_wire_parser *parser;
	struct eco_writer body;                  /* of the request */
	struct eco_error error;                  /* of the stream */
	double retry_ms;
};

static void on_plan(void *ctx, double predicted_q);

static void end_store(struct view_session *s)
{
	struct view_load_report *report = s->host->report;
	if (!s->store)
		return;
	struct view_store_stats stats = view_store_stats(s->store);
	report->chunks += stats.chunks;
	report->chunks_decoded += s->decodes ? stats.chunks : 0;
	report->chunks_twice += stats.chunks_twice;
	view_store_free(s->store);
	s->store = NULL;
}

/* Holds nothing from then on. */
static enum eco_code forget(struct view_session *s, struct eco_error *error)
{
	end_store(s);
	enum eco_code code = view_store_new(&s->store, &(struct view_store_options){ .counts = !s->decodes,
		.planned = on_plan, .ctx = s }, error);
	if (!code && s->host->options->chunks)
		view_store_find_by(s->store, view_exchange_find, s->exchange);
	return code;
}

/* ---- What comes ---- */

static float since_due(const struct view_session *s)
{
	return (float)(view_clock_ms() - s->due_ms);
}

static void on_plan(void *ctx, double predicted_q)
{
	struct view_session *s = ctx;
	struct view_answer *a = &s->answer;
	float now = since_due(s);
	a->predicted_q = (float)predicted_q;
	if (isnan(a->picture_ms))
		a->picture_ms = now;
	if (isnan(a->q80_ms) && predicted_q >= 0.8)
		a->q80_ms = now;
	if (isnan(a->q90_ms) && predicted_q >= 0.9)
		a->q90_ms = now;
}

static enum eco_code take(void *ctx, const uint8_t *bytes, size_t size, struct eco_error *error)
{
	struct view_session *s = ctx;
	return eco_wire_feed(s->parser, bytes, size, error);
}

/* Adds the exchange under way to the answer, once. */
static void collect(struct view_session *s)
{
	const struct view_exchange_end *end = view_exchange_end(s->exchange);
	struct view_answer *a = &s->answer;
	if (!s->parser)
		return;
	a->bytes += end->bytes;
	a->status = (uint16_t)end->status;
	a->plan_ms = (float)end->plan_ms;
	s->retry_ms = end->retry_ms;
	s->host->report->chunks_named += end->named;
	if (isnan(a->first_byte_ms))
		a->first_byte_ms = (float)(end->first_byte_ms - s->due_ms);
	eco_wire_parser_free(s->parser);
	s->parser = NULL;
}

/* Nothing of the last try stays but what is held. */
static void clear(struct view_session *s)
{
	view_exchange_cancel(s->exchange);
	collect(s);
	eco_writer_free(&s->body);
	s->error = (struct eco_error){ 0 };
	s->retry_ms = 0;
}

/* ---- An answer's end ---- */

static void note(struct view_session *s, const char *text)
{
	struct view_load_report *report = s->host->report;
	if (!report->first_failure[0])
		snprintf(report->first_failure, sizeof report->first_failure, "client %u, view %u: %s",
			s->number, s->frame, text);
}

static double gap_ms(struct view_session *s)
{
	const struct view_load_options *o = s->host->options;
	double mean = 1e3 * o->clients / o->rate;
	return o->random_arrivals ? -mean * log(1 - eco_random_unit(eco_random_next(&s->random))) : mean;
}

static void wait_for_next(struct view_session *s, double not_before_ms)
{
	s->frame = (s->frame + 1) % s->host->options->view_count;
	if (s->host->options->rate > 0)
		s->due_ms += gap_ms(s);
	else
		s->due_ms = fmax(view_clock_ms(), not_before_ms);
	s->phase = s->due_ms < s->host->end_ms ? PHASE_IDLE : PHASE_OVER;
	s->wakes_ms = s->phase == PHASE_OVER ? INFINITY : fmax(s->due_ms, not_before_ms);
}

static void record(struct view_session *s, enum view_outcome outcome)
{
	struct view_load_report *report = s->host->report;
	struct view_answer *a = &s->answer;
	double now = view_clock_ms();
	collect(s);
	a->done_ms = (float)(now - s->due_ms);
	a->service_ms = (float)(now - s->asked_ms);
	a->outcome = (uint8_t)outcome;
	report->outcomes[outcome]++;
	report->bytes += a->bytes;
	report->resumed += a->resumed && !outcome;
	report->nothing += a->nothing;
	view_answers_add(&report->answers, a);
}

static void check_budgets(struct view_session *s)
{
	const struct view_load_options *o = s->host->options;
	struct view_load_report *report = s->host->report;
	struct view_answer *a = &s->answer;
	report->vertices += a->vertices;
	if (a->vertices > o->vertices) {
		report->vertex_violations++;
		note(s, "a plan drew more vertices than allowed");
	}
	if (a->bytes > o->bytes && !a->resumed) {
		report->byte_violations++;
		note(s, "a response took more bytes than allowed");
	}
}

static void send_after(struct view_session *s, double pause_ms)
{
	clear(s);
	s->phase = PHASE_ON_ITS_WAY;
	s->wakes_ms = view_clock_ms() + pause_ms + s->host->options->latency_ms;
}

/* An answer that broke on its way may come the next time; a refusal stays one. */
static void fail(struct view_session *s, enum view_outcome outcome, const char *text)
{
	collect(s);
	double pause_ms = fmax(s->retry_ms, PAUSE_MS);
	bool gone = outcome == VIEW_CONNECTION || outcome == VIEW_BROKEN || s->answer.status == 502
		|| s->answer.status == 504;
	if (gone && s->answer.resumed < s->host->options->resumes) {
		s->answer.resumed++;
		send_after(s, PAUSE_MS);
		return;
	}
	record(s, outcome);
	note(s, text);
	clear(s);
	if (outcome == VIEW_DAMAGED || outcome == VIEW_OTHER)
		forget(s, NULL);
	wait_for_next(s, view_clock_ms() + pause_ms);
}

static void fail_stream(struct view_session *s, const struct eco_error *error)
{
	fail(s, error->code == ECO_DAMAGED ? VIEW_DAMAGED : VIEW_OTHER, error->text);
}

/* Vertices of the last plan; a client that decodes counts them anew from the selection, which may find
 * damage. */
static enum eco_code count_vertices(struct view_session *s, const struct eco_view *view)
{
	const struct eco_plan *plan = view_store_plan(s->store);
	struct view_selection selection;
	struct lod_eye eye;
	s->answer.vertices = plan ? plan->vertices : 0;
	if (!s->decodes)
		return ECO_OK;
	lod_eye_make(&eye, view);
	enum eco_code code = view_select_make(&selection, s->store, &eye, &s->error);
	if (!code)
		s->answer.vertices = selection.vertices;
	view_select_free(&selection);
	return code;
}

static void succeed(struct view_session *s)
{
	const struct eco_view *view = &s->host->options->views[s->frame];
	if (!s->answer.nothing && count_vertices(s, view)) {
		fail_stream(s, &s->error);
		return;
	}
	record(s, VIEW_ANSWERED);
	check_budgets(s);
	clear(s);
	wait_for_next(s, 0);
}

static void fail_status(struct view_session *s, const struct view_exchange_end *end)
{
	char text[400];
	if (end->status == PACK_CHANGED && view_store_pack(s->store)) {
		s->host->report->renewed++;
		forget(s, NULL);
		send_after(s, 0);
		return;
	}
	snprintf(text, sizeof text, "%ld %.*s", end->status, (int)end->problem.size,
		(const char *)end->problem.bytes);
	fail(s, end->status == 503 || end->status == 429 ? VIEW_BUSY : VIEW_REFUSED, text);
}

static void fail_transfer(struct view_session *s, const struct view_exchange_end *end)
{
	bool connected = end->rc != CURLE_COULDNT_CONNECT && end->rc != CURLE_COULDNT_RESOLVE_HOST
		&& end->rc != CURLE_OPERATION_TIMEDOUT && end->rc != CURLE_SSL_CONNECT_ERROR;
	if (end->rc != CURLE_HTTP_RETURNED_ERROR)
		fail(s, connected ? VIEW_BROKEN : VIEW_CONNECTION, end->text);
	else
		fail(s, end->status == 503 ? VIEW_BUSY : VIEW_REFUSED, end->error.text);
}

static void on_end(void *ctx)
{
	struct view_session *s = ctx;
	const struct view_exchange_end *end = view_exchange_end(s->exchange);
	if (end->error.code && end->error.code != ECO_IO)
		fail_stream(s, &end->error);
	else if (end->rc)
		fail_transfer(s, end);
	else if (end->status == 204 || (end->status == 200 && !eco_wire_finish(s->parser, &s->error))) {
		s->answer.nothing = end->status == 204;
		succeed(s);
	} else if (end->status == 200)
		fail_stream(s, &s->error);
	else
		fail_status(s, end);
}

/* ---- Asking ---- */

static void write_url(struct view_session *s, char *url, size_t size)
{
	const struct view_load_options *o = s->host->options;
	char query[VIEW_QUERY_BYTES];
	struct eco_request request = { .view = o->views[s->frame], .vertices = o->vertices, .bytes = o->bytes,
		.name_from = o->chunks ? o->name_from ? o->name_from : ECO_NAME_FROM : 0 };
	view_query_write(&request, view_store_pack(s->store), query, sizeof query);
	snprintf(url, size, "%.*s/stream?%s", view_url_length(o->url), o->url, query);
}

static void ask(struct view_session *s)
{
	char url[4096];
	struct view_exchange_job job = { .url = url, .names = s->host->options->chunks,
		.most_bytes = UINT64_MAX,
		.take = take, .ctx = s };
	view_store_begin(s->store);
	write_url(s, url, sizeof url);
	/* a first visit may be had from a cache on the way, so it is a GET */
	bool first = s->cold && !view_store_pack(s->store);
	job.body = first ? NULL : &s->body;
	enum eco_code code = first ? ECO_OK : view_store_write_holdings(s->store, &s->body, &s->error);
	if (!code)
		code = eco_wire_parser_new(&s->parser, &view_store_events, s->store, &s->error);
	if (!code)
		code = view_exchange_begin(s->exchange, &job, &s->error);
	if (code) {
		fail_stream(s, &s->error);
		return;
	}
	s->phase = PHASE_ASKED;
	s->wakes_ms = s->until_ms;
}

static void begin(struct view_session *s)
{
	const struct view_load_options *o = s->host->options;
	s->asked_ms = view_clock_ms();
	s->until_ms = s->due_ms + (o->deadline_ms > 0 ? o->deadline_ms : DEADLINE_MS);
	s->answer = (struct view_answer){ .due_ms = s->due_ms - s->host->start_ms, .client = s->number,
		.frame = s->frame, .cold = s->cold, .asked_ms = (float)(s->asked_ms - s->due_ms),
		.first_byte_ms = NAN, .picture_ms = NAN, .q80_ms = NAN, .q90_ms = NAN, .plan_ms = NAN,
		.predicted_q = NAN };
	if (s->cold && forget(s, &s->error))
		fail_stream(s, &s->error);
	else if (s->asked_ms >= s->until_ms)
		fail(s, VIEW_LATE, "its deadline passed before it could be asked for");
	else
		send_after(s, 0);
}

/* ---- Life ---- */

double view_session_wakes_ms(const struct view_session *s)
{
	return fmin(s->wakes_ms, view_exchange_wakes_ms(s->exchange));
}

void view_session_wake(struct view_session *s)
{
	view_exchange_wake(s->exchange);
	if (view_clock_ms() < s->wakes_ms)
		return;
	if (s->phase == PHASE_IDLE)
		begin(s);
	else if (s->phase == PHASE_ON_ITS_WAY)
		ask(s);
	else if (s->phase == PHASE_ASKED)
		fail(s, VIEW_LATE, "it was not whole at its deadline");
}

void view_session_give_up(struct view_session *s)
{
	while (s->phase != PHASE_OVER) {
		if (s->phase == PHASE_IDLE)
			begin(s);
		record(s, VIEW_UNFINISHED);
		note(s, "due before the end, and not answered after it");
		clear(s);
		wait_for_next(s, 0);
	}
}

enum eco_code view_session_new(struct view_session **out, struct view_session_host *host, uint32_t number,
	bool decodes, struct eco_error *error)
{
	const struct view_load_options *o = host->options;
	struct view_session *s = *out = eco_alloc(1, sizeof *s);
	s->host = host;
	s->number = number;
	s->cold = view_load_is_one_of(number, o->cold, o->clients);
	s->frame = (uint32_t)((uint64_t)o->view_count * number / o->clients);
	s->random = eco_random(o->seed, number);
	s->due_ms = host->start_ms + (o->rate <= 0 ? 0 : o->random_arrivals ? gap_ms(s)
		: 1e3 * number / o->rate);
	s->phase = s->due_ms < host->end_ms ? PHASE_IDLE : PHASE_OVER;
	s->wakes_ms = s->phase == PHASE_OVER ? INFINITY : s->due_ms;
	s->decodes = decodes;
	enum eco_code code = view_exchange_new(&s->exchange,
		&(struct view_exchange_options){ .multi = host->multi,
		.agent = "ecoload/" ECO_VERSION, .chunks = o->chunks, .connect_ms = CONNECT_MS,
			.fresh = s->cold,
		.bandwidth_bytes_s = o->bandwidth_bytes_s, .latency_ms = o->latency_ms, .ended = on_end,
			.ctx = s },
		error);
	return code ? code : forget(s, error);
}

void view_session_free(struct view_session *s)
{
	if (!s)
		return;
	if (s->exchange)
		clear(s);
	end_store(s);
	view_exchange_free(s->exchange);
	free(s);
}
