/* Longer than 600 lines: one state machine of a client, whose struct view_session no other file sees. */
#include "client-min/load/view_load.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>

#include "client-min/view_fetch.h"
#include "client-min/view_query.h"
#include "client-min/view_select.h"
#include "ecofiles/base/random.h"
#include "ecofiles/base/array_grow.h"
#include "ecofiles/base/version.h"

#define LANES 7u                 /* connections: one for streams, the others for chunks that are named */
#define DEADLINE_MS 120000.0
#define CONNECT_MS 10000L
#define PAUSE_MS 100.0           /* before something is asked for again */
#define PROBLEM_BYTES 400u
#define SLOW_BLOCK 16384L        /* of a line with a bandwidth: how much is read, and kept by the system */
#define PACK_CHANGED 409

enum phase { PHASE_IDLE, PHASE_ON_ITS_WAY, PHASE_ASKED, PHASE_NAMED, PHASE_OVER };

struct lane {
	struct view_session *session;
	CURL *curl;
	uint32_t wanted;
	bool busy;
	double free_ms;                  /* when it may ask next: its line's latency */
	double comes_ms;                 /* when what it waits with is through the line; INFINITY: nothing */
};
struct wanted { struct eco_chunk_id id; uint8_t *bytes; uint32_t size, have; };

struct view_session {
	struct view_session_host *host;
	uint32_t number, frame;
	bool cold;
	enum phase phase;
	double wakes_ms, due_ms, asked_ms, until_ms;
	double line_ms;                          /* when the line has carried all that came so far */
	uint64_t random;                         /* of its arrivals */
	bool decodes;
	struct view_store *store;
	struct view_answer answer;               /* under way */
	struct eco_wire_parser *parser, *names;
	struct eco_writer body, stream;          /* of the request; the answer's, where chunks are named */
	struct eco_error error;                  /* of the stream */
	struct wanted *wanted;
	uint32_t wanted_count, wanted_room, wanted_next, wanted_here, taken;
	struct lane lanes[LANES];
	struct curl_slist *headers;
	double retry_ms;
	char problem[PROBLEM_BYTES];
	size_t problem_size;
};

static void on_plan(void *ctx, double predicted_q);
static view_store_find find_named;

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
		view_store_find_by(s->store, find_named, s);
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

static size_t on_stream(struct view_session *s, const char *bytes, size_t size)
{
	long status;
	curl_easy_getinfo(s->lanes[0].curl, CURLINFO_RESPONSE_CODE, &status);
	if (isnan(s->answer.first_byte_ms))
		s->answer.first_byte_ms = since_due(s);
	s->answer.bytes += size;
	if (status != 200) {
		size_t room = sizeof s->problem - 1 - s->problem_size, take = size < room ? size : room;
		memcpy(s->problem + s->problem_size, bytes, take);
		s->problem_size += take;
		return size;
	}
	if (s->names && s->stream.size + size > VIEW_NAMED_STREAM_MAX) {
		eco_fail(&s->error, ECO_TOO_LARGE, "a stream with names is longer than %llu bytes",
			(unsigned long long)VIEW_NAMED_STREAM_MAX);
		return 0;
	}
	if (s->names)
		eco_write_bytes(&s->stream, bytes, size);
	return eco_wire_feed(s->names ? s->names : s->parser, (const uint8_t *)bytes, size, &s->error)
		|| s->stream.failed ? 0 : size;
}

/* A block is there when the line, which all lanes share, has carried it: until then its transfer pauses. */
static bool is_through(struct view_session *s, struct lane *lane, size_t size)
{
	double rate = (double)s->host->options->bandwidth_bytes_s, now = view_clock_ms();
	if (!(rate > 0))
		return true;
	if (isinf(lane->comes_ms))
		lane->comes_ms = s->line_ms = fmax(s->line_ms, now) + 1e3 * (double)size / rate;
	if (now < lane->comes_ms)
		return false;
	lane->comes_ms = INFINITY;
	return true;
}

static size_t on_body(char *bytes, size_t one, size_t size, void *ctx)
{
	struct lane *lane = ctx;
	struct view_session *s = lane->session;
	size *= one;
	if (!is_through(s, lane, size))
		return CURL_WRITEFUNC_PAUSE;
	if (lane == &s->lanes[0])
		return on_stream(s, bytes, size);
	struct wanted *w = &s->wanted[lane->wanted];
	if (size > w->size - w->have)
		return 0;
	memcpy(w->bytes + w->have, bytes, size);
	w->have += (uint32_t)size;
	s->answer.bytes += size;
	return size;
}

/* ---- Transfers ---- */

static int on_socket(void *ctx, curl_socket_t fd, curlsocktype purpose)
{
	int size = (int)SLOW_BLOCK;
	(void)ctx, (void)purpose;
	setsockopt(fd, SOL_SOCKET, SO_RCVBUF, &size, sizeof size);
	return CURL_SOCKOPT_OK;
}

/* NULL: no memory. */
static CURL *open_lane(struct view_session *s, struct lane *lane)
{
	const struct view_load_options *o = s->host->options;
	CURL *c = lane->curl;
	if (c || !(c = lane->curl = view_curl_new("ecoload/" ECO_VERSION, CONNECT_MS)))
		return c;
	lane->session = s;
	curl_easy_setopt(c, CURLOPT_FOLLOWLOCATION, lane == &s->lanes[0] ? 0L : 1L);
	curl_easy_setopt(c, CURLOPT_WRITEFUNCTION, on_body);
	curl_easy_setopt(c, CURLOPT_WRITEDATA, lane);
	curl_easy_setopt(c, CURLOPT_PRIVATE, lane);
	curl_easy_setopt(c, CURLOPT_FORBID_REUSE, s->cold ? 1L : 0L);
	curl_easy_setopt(c, CURLOPT_FRESH_CONNECT, s->cold ? 1L : 0L);
	if (o->bandwidth_bytes_s) {
		curl_easy_setopt(c, CURLOPT_BUFFERSIZE, SLOW_BLOCK);
		curl_easy_setopt(c, CURLOPT_SOCKOPTFUNCTION, on_socket);
	}
	return c;
}

static void begin_transfer(struct view_session *s, struct lane *lane, const char *url)
{
	curl_easy_setopt(lane->curl, CURLOPT_URL, url);
	lane->comes_ms = INFINITY;
	lane->busy = curl_multi_add_handle(s->host->multi, lane->curl) == CURLM_OK;
}

static void end_transfer(struct view_session *s, struct lane *lane)
{
	if (lane->busy)
		curl_multi_remove_handle(s->host->multi, lane->curl);
	lane->busy = false;
}

/* Nothing of the last try stays but what is held. */
static void clear(struct view_session *s)
{
	for (uint32_t i = 0; i < LANES; i++)
		end_transfer(s, &s->lanes[i]);
	for (uint32_t i = 0; i < s->wanted_count; i++)
		free(s->wanted[i].bytes);
	s->wanted_count = s->wanted_next = s->wanted_here = s->taken = 0;
	eco_wire_parser_free(s->parser);
	eco_wire_parser_free(s->names);
	s->parser = s->names = NULL;
	eco_writer_free(&s->stream);
	eco_writer_free(&s->body);
	s->error = (struct eco_error){ 0 };
	s->problem_size = 0;
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
	a->done_ms = (float)(now - s->due_ms);
	a->service_ms = (float)(now - s->asked_ms);
	a->outcome = (uint8_t)outcome;
	report->outcomes[outcome]++;
	report->bytes += a->bytes;
	report->resumed += a->resumed && !outcome;
	report->nothing += a->nothing;
	report->chunks_named += s->wanted_count;
	if (!view_answers_add(&report->answers, a))
		note(s, "no memory for a record of an answer");
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
	bool gone = outcome == VIEW_CONNECTION || outcome == VIEW_BROKEN || s->answer.status == 502
		|| s->answer.status == 504;
	if (gone && s->answer.resumed < s->host->options->resumes) {
		s->answer.resumed++;
		send_after(s, PAUSE_MS);
		return;
	}
	record(s, outcome);
	note(s, text);
	double pause_ms = fmax(s->retry_ms, PAUSE_MS);
	clear(s);
	if (outcome == VIEW_DAMAGED || outcome == VIEW_OTHER)
		forget(s, NULL);
	wait_for_next(s, view_clock_ms() + pause_ms);
}

static void fail_stream(struct view_session *s)
{
	char text[sizeof s->error.text];
	snprintf(text, sizeof text, "%s", s->error.text[0] ? s->error.text : "no memory for a stream");
	fail(s, s->error.code == ECO_DAMAGED ? VIEW_DAMAGED : VIEW_OTHER, text);
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
		fail_stream(s);
		return;
	}
	record(s, VIEW_ANSWERED);
	check_budgets(s);
	clear(s);
	wait_for_next(s, 0);
}

static void fail_status(struct view_session *s)
{
	char text[PROBLEM_BYTES + 32];
	s->problem[s->problem_size] = 0;
	if (s->answer.status == PACK_CHANGED && view_store_pack(s->store)) {
		s->host->report->renewed++;
		forget(s, NULL);
		send_after(s, 0);
		return;
	}
	snprintf(text, sizeof text, "%u %s", s->answer.status, s->problem);
	fail(s, s->answer.status == 503 || s->answer.status == 429 ? VIEW_BUSY : VIEW_REFUSED, text);
}

static void fail_transfer(struct view_session *s, CURLcode rc)
{
	bool connected = rc != CURLE_COULDNT_CONNECT && rc != CURLE_COULDNT_RESOLVE_HOST
		&& rc != CURLE_OPERATION_TIMEDOUT && rc != CURLE_SSL_CONNECT_ERROR;
	if (s->error.code || s->stream.failed)
		fail_stream(s);
	else
		fail(s, connected ? VIEW_BROKEN : VIEW_CONNECTION, curl_easy_strerror(rc));
}

/* ---- Chunks that are named ---- */

/* A name is found. */
static enum eco_code on_name(void *ctx, const struct eco_chunk *chunk, const uint8_t **payload,
	struct eco_error *error)
{
	struct view_session *s = ctx;
	double free_ms = view_clock_ms() + s->host->options->latency_ms;
	(void)payload;
	for (uint32_t i = 1; i < LANES && !s->wanted_count; i++)
		s->lanes[i].free_ms = free_ms;
	s->wakes_ms = 0;                 /* a transfer cannot begin within another's callback */
	if (!eco_array_grow(&s->wanted, &s->wanted_room, s->wanted_count, sizeof *s->wanted))
		return eco_no_memory(error, "a named chunk");
	s->wanted[s->wanted_count++] = (struct wanted){ .id = chunk->id, .size = chunk->size_bytes };
	return ECO_OK;
}

/* They are asked for again in the order in which their names were found. */
static enum eco_code find_named(void *ctx, const struct eco_chunk *chunk, const uint8_t **payload,
	struct eco_error *error)
{
	struct view_session *s = ctx;
	(void)chunk, (void)error;
	assert(s->taken < s->wanted_count);
	*payload = s->wanted[s->taken++].bytes;
	return ECO_OK;
}

static bool fetch_one(struct view_session *s, struct lane *lane)
{
	struct wanted *w = &s->wanted[s->wanted_next];
	char url[2100], id[VIEW_ID_BYTES];
	const char *below = s->host->options->chunks;
	snprintf(url, sizeof url, "%.*s/%s", view_url_length(below), below, view_id_write(&w->id, id));
	w->bytes = malloc(w->size);
	if (!w->bytes || !open_lane(s, lane))
		return false;
	lane->wanted = s->wanted_next++;
	begin_transfer(s, lane, url);
	return lane->busy;
}

static void fetch_named(struct view_session *s)
{
	double now = view_clock_ms();
	s->wakes_ms = s->until_ms;
	for (uint32_t i = 1; i < LANES && s->wanted_next < s->wanted_count; i++) {
		struct lane *lane = &s->lanes[i];
		if (!lane->busy && lane->free_ms > now) {
			s->wakes_ms = fmin(s->wakes_ms, lane->free_ms);
		} else if (!lane->busy && !fetch_one(s, lane)) {
			fail(s, VIEW_OTHER, "no memory for a named chunk");
			return;
		}
	}
	if (s->phase != PHASE_NAMED || s->wanted_here < s->wanted_count)
		return;
	if (eco_wire_feed(s->parser, s->stream.bytes, s->stream.size, &s->error)
			|| eco_wire_finish(s->parser, &s->error))
		fail_stream(s);
	else
		succeed(s);
}

static void end_named(struct view_session *s, struct lane *lane, CURLcode rc)
{
	const struct wanted *w = &s->wanted[lane->wanted];
	long status;
	curl_easy_getinfo(lane->curl, CURLINFO_RESPONSE_CODE, &status);
	s->wanted_here++;
	lane->free_ms = view_clock_ms() + s->host->options->latency_ms;
	if (rc && rc != CURLE_WRITE_ERROR) {
		fail_transfer(s, rc);
	} else if (status != 200) {
		s->answer.status = (uint16_t)status;
		s->retry_ms = view_retry_ms(lane->curl);
		fail(s, status == 503 ? VIEW_BUSY : VIEW_REFUSED, "a chunk that the stream names is refused");
	} else if (rc || w->have < w->size) {
		fail(s, VIEW_DAMAGED, "a chunk has not the bytes that the stream names");
	} else {
		fetch_named(s);
	}
}

/* ---- Asking ---- */

static bool write_url(struct view_session *s, char *url, size_t size)
{
	const struct view_load_options *o = s->host->options;
	char query[VIEW_QUERY_BYTES];
	struct eco_request request = { .view = o->views[s->frame], .vertices = o->vertices, .bytes = o->bytes,
		.name_from = o->chunks ? o->name_from ? o->name_from : ECO_NAME_FROM : 0 };
	view_query_write(&request, view_store_pack(s->store), query, sizeof query);
	return (size_t)snprintf(url, size, "%.*s/stream?%s", view_url_length(o->url), o->url, query) < size;
}

/* A first visit may be had from a cache on the way, so it is a GET. */
static enum eco_code write_body(struct view_session *s, struct eco_error *error)
{
	CURL *c = s->lanes[0].curl;
	struct eco_holdings holdings;
	if (s->cold && !view_store_pack(s->store)) {
		curl_easy_setopt(c, CURLOPT_HTTPGET, 1L);
		return ECO_OK;
	}
	enum eco_code code = view_store_holdings(s->store, &holdings, error);
	if (code)
		return code;
	eco_wire_write_holdings(&s->body, &holdings);
	free(holdings.items);
	curl_easy_setopt(c, CURLOPT_POSTFIELDS, s->body.bytes);
	curl_easy_setopt(c, CURLOPT_POSTFIELDSIZE_LARGE, (curl_off_t)s->body.size);
	return s->body.failed ? eco_no_memory(error, "a request") : ECO_OK;
}

static void ask(struct view_session *s)
{
	static const struct eco_wire_events names = { .fetch = on_name };
	char url[4096];
	struct lane *lane = &s->lanes[0];
	view_store_begin(s->store);
	enum eco_code code = write_body(s, &s->error);
	if (!code)
		code = eco_wire_parser_new(&s->parser, &view_store_events, s->store, &s->error);
	if (!code && s->host->options->chunks)
		code = eco_wire_parser_new(&s->names, &names, s, &s->error);
	if (code || !write_url(s, url, sizeof url)) {
		fail_stream(s);
		return;
	}
	begin_transfer(s, lane, url);
	s->phase = PHASE_ASKED;
	s->wakes_ms = s->until_ms;
	if (!lane->busy)
		fail(s, VIEW_OTHER, "libcurl takes no further request");
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
		fail_stream(s);
	else if (s->asked_ms >= s->until_ms)
		fail(s, VIEW_LATE, "its deadline passed before it could be asked for");
	else
		send_after(s, 0);
}

static void end_stream(struct view_session *s, CURLcode rc)
{
	long status = 0;
	curl_easy_getinfo(s->lanes[0].curl, CURLINFO_RESPONSE_CODE, &status);
	s->answer.status = (uint16_t)status;
	s->answer.plan_ms = (float)view_plan_ms(s->lanes[0].curl);
	s->retry_ms = view_retry_ms(s->lanes[0].curl);
	if (rc) {
		fail_transfer(s, rc);
	} else if (status == 204) {
		s->answer.nothing = true;
		succeed(s);
	} else if (status != 200) {
		fail_status(s);
	} else if (s->names) {
		s->phase = PHASE_NAMED;
		if (eco_wire_finish(s->names, &s->error))
			fail_stream(s);
		else
			fetch_named(s);
	} else if (eco_wire_finish(s->parser, &s->error)) {
		fail_stream(s);
	} else {
		succeed(s);
	}
}

void view_session_transferred(CURL *curl, CURLcode rc)
{
	struct lane *lane;
	curl_easy_getinfo(curl, CURLINFO_PRIVATE, (char **)&lane);
	struct view_session *s = lane->session;
	end_transfer(s, lane);
	if (lane == &s->lanes[0])
		end_stream(s, rc);
	else
		end_named(s, lane, rc);
}

/* ---- Life ---- */

double view_session_wakes_ms(const struct view_session *s)
{
	double wakes_ms = s->wakes_ms;
	for (uint32_t i = 0; i < LANES && s->host->options->bandwidth_bytes_s; i++)
		if (s->lanes[i].busy)
			wakes_ms = fmin(wakes_ms, s->lanes[i].comes_ms);
	return wakes_ms;
}

static void go_on(struct view_session *s, double now)
{
	for (uint32_t i = 0; i < LANES && s->host->options->bandwidth_bytes_s; i++)
		if (s->lanes[i].busy && s->lanes[i].comes_ms <= now)
			curl_easy_pause(s->lanes[i].curl, CURLPAUSE_CONT);
}

void view_session_wake(struct view_session *s)
{
	double now = view_clock_ms();
	go_on(s, now);
	if (now < s->wakes_ms)
		return;
	if (s->phase == PHASE_IDLE)
		begin(s);
	else if (s->phase == PHASE_ON_ITS_WAY)
		ask(s);
	else if (now < s->until_ms)
		fetch_named(s);
	else
		fail(s, VIEW_LATE, "it was not whole at its deadline");
}

void view_session_give_up(struct view_session *s)
{
	while (s->phase != PHASE_OVER) {
		if (s->phase == PHASE_IDLE)
			begin(s);
		record(s, VIEW_UNFINISHED);
		note(s, "it was due before the end, and not answered after it");
		clear(s);
		wait_for_next(s, 0);
	}
}

enum eco_code view_session_new(struct view_session **out, struct view_session_host *host, uint32_t number,
	bool decodes, struct eco_error *error)
{
	const struct view_load_options *o = host->options;
	struct view_session *s = *out = calloc(1, sizeof *s);
	if (!s)
		return eco_no_memory(error, "a client");
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
	enum eco_code code = forget(s, error);
	s->headers = curl_slist_append(NULL, "Content-Type: application/octet-stream");
	if (code || !s->headers || !curl_slist_append(s->headers, "Expect:") || !open_lane(s, &s->lanes[0]))
		return eco_no_memory(error, "a client");
	curl_easy_setopt(s->lanes[0].curl, CURLOPT_HTTPHEADER, s->headers);
	return ECO_OK;
}

void view_session_free(struct view_session *s)
{
	if (!s)
		return;
	clear(s);
	end_store(s);
	for (uint32_t i = 0; i < LANES; i++)
		curl_easy_cleanup(s->lanes[i].curl);
	curl_slist_free_all(s->headers);
	free(s->wanted);
	free(s);
}
