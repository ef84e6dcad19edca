#include "client-min/view_fetch.h"

#include <jansson.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <time.h>

#include "client-min/view_exchange.h"
#include "client-min/view_query.h"
#include "ecofiles/base/order.h"
#include "ecofiles/base/random.h"
#include "ecofiles/base/options.h"
#include "ecofiles/base/version.h"

#define BODY_MAX_DEFAULT ((uint64_t)16 << 30)
/* bodies that are held whole: what is said of a scene or of plants, an explanation */
#define TEXT_MAX ((uint64_t)8 << 20)
#define EXPLANATION_MAX ((uint64_t)64 << 20)
#define PAUSE_MS 100.0           /* before an answer that broke off is asked for again; twice that then, ... */
#define PAUSE_MAX_MS 5000.0
#define WAIT_MS 100.0            /* the longest time between looks at whether it is to end */
#define CHUNK_STALL_S 10L
#define MARK_MOST (UINT64_C(1) << 50)

/* How far an answer has come in its marks. */
struct marks_at { uint32_t bytes, ms; };

struct view_fetch {
	struct view_fetch_options options;
	CURLM *multi;
	struct view_exchange *exchange;
	char *url;                               /* of the scene, without a final slash */
	/* of the request under way */
	struct eco_wire_parser *parser;
	struct view_fetch_result *result;        /* of the answer that comes */
	struct view_fetch_result before;         /* of those before it, to the same request */
	struct eco_writer *text;                 /* where the body goes if it is no stream; else NULL */
	uint64_t text_max;
	const char *below;                       /* behind the scene's URL, of a text that is of no view */
	struct view_fetch_watch watch;
	struct marks_at at;                      /* in its marks */
	const struct view_store *store;          /* of the stream that comes */
	double start_ms;
	bool stopped, turned;
	bool answered;                           /* the server has, once */
	bool lost;                               /* the answer: on its way, and may come the next time */
};

enum eco_code view_fetch_setup(struct eco_error *error)
{
	return curl_global_init(CURL_GLOBAL_DEFAULT) ? eco_fail(error, ECO_IO, "libcurl does not start")
		: ECO_OK;
}

void view_fetch_teardown(void)
{
	curl_global_cleanup();
}

/* ---- Marks ---- */

ECO_ORDER(ascending, uint64_t, [0])

/* Each once. */
static void sort_marks(uint64_t *marks, uint32_t *count)
{
	uint32_t kept = 0;
	qsort(marks, *count, sizeof *marks, ascending);
	for (uint32_t i = 0; i < *count; i++)
		if (!kept || marks[i] != marks[kept - 1])
			marks[kept++] = marks[i];
	*count = kept;
}

enum eco_code view_marks_read(struct view_marks *marks, const char *text, struct eco_error *error)
{
	*marks = (struct view_marks){ 0 };
	for (const char *at = text;; at++) {
		const char *end;
		uint64_t value;
		bool good = eco_count_read(at, ECO_OPTION_BYTES, &value, &end) && value;
		bool ms = good && end[-1] <= '9' && !strncmp(end, "ms", 2);
		if (!good || value > MARK_MOST || (end[ms ? 2 : 0] && end[ms ? 2 : 0] != ','))
			return eco_fail(error, ECO_BAD_USAGE, "'%.40s': must be numbers of bytes or of "
				"milliseconds, such as 20000,50k,200ms", at);
		if (marks->bytes_count + marks->ms_count == VIEW_MARKS_MAX)
			return eco_fail(error, ECO_BAD_USAGE, "more than %u marks", VIEW_MARKS_MAX);
		if (ms)
			marks->ms[marks->ms_count++] = value;
		else
			marks->bytes[marks->bytes_count++] = value;
		at = end + (ms ? 2 : 0);
		if (!*at)
			break;
	}
	sort_marks(marks->bytes, &marks->bytes_count);
	sort_marks(marks->ms, &marks->ms_count);
	return ECO_OK;
}

/* Bytes from `now` on up to the next mark: at least 1. UINT64_MAX: there is none. */
static uint64_t marks_room(const struct view_marks *marks, const struct marks_at *at, uint64_t now)
{
	for (uint32_t i = at->bytes; i < marks->bytes_count; i++)
		if (marks->bytes[i] > now)
			return marks->bytes[i] - now;
	return UINT64_MAX;
}

/* Steps over the next mark that has been reached, and sets *ms to where it is if it is one of milliseconds.
 * */
static bool marks_pass(const struct view_marks *marks, struct marks_at *at, uint64_t bytes, double *ms)
{
	bool by_ms = at->ms < marks->ms_count && (double)marks->ms[at->ms] <= *ms;
	bool by_bytes = !by_ms && at->bytes < marks->bytes_count && marks->bytes[at->bytes] <= bytes;
	if (by_ms)
		*ms = (double)marks->ms[at->ms];
	at->ms += by_ms;
	at->bytes += by_bytes;
	return by_ms || by_bytes;
}

/* ---- What comes ---- */

/* Adds the answers before it to the last one. */
static void add_result(struct view_fetch_result *last, const struct view_fetch_result *before)
{
	last->requests += before->requests;
	last->broken += before->broken;
	last->host_left |= before->host_left;
	last->bytes += before->bytes;
	last->cancelled += before->cancelled;
	last->named += before->named;
	last->named_bytes += before->named_bytes;
	last->plan_ms = isnan(last->plan_ms) ? before->plan_ms
		: isnan(before->plan_ms) ? last->plan_ms : last->plan_ms + before->plan_ms;
	last->first_byte_ms = before->bytes ? before->first_byte_ms : before->stream_ms + last->first_byte_ms;
	last->stream_ms += before->stream_ms;
	if (before->most_bytes > last->most_bytes)
		last->most_bytes = before->most_bytes;
}

/* The answer so far, and those before it. */
static struct view_fetch_result result_now(const struct view_fetch *fetch)
{
	struct view_fetch_result now = *fetch->result;
	now.stream_ms = view_clock_ms() - fetch->start_ms;
	add_result(&now, &fetch->before);
	return now;
}

/* Tells of each mark up to now, which is later once one has been told of. */
static enum eco_code reach(struct view_fetch *fetch, struct eco_error *error)
{
	struct view_fetch_result now = result_now(fetch);
	enum eco_code code = ECO_OK;
	for (; !code && marks_pass(fetch->watch.marks, &fetch->at, now.bytes, &now.stream_ms); now = result_now(fetch))
		code = fetch->watch.reached(fetch->watch.ctx, &now, error);
	return code;
}

/* Feeds what came, mark by mark: what comes now was not there at a time before. */
static enum eco_code feed(struct view_fetch *fetch, const uint8_t *bytes, size_t size,
	struct eco_error *error)
{
	struct view_fetch_result *result = fetch->result;
	const struct view_marks *marks = fetch->watch.marks;
	enum eco_code code = marks ? reach(fetch, error) : ECO_OK;
	while (size && !code) {
		uint64_t room = marks ? marks_room(marks, &fetch->at, fetch->before.bytes + result->bytes) : size;
		size_t take = room < size ? (size_t)room : size;
		code = eco_wire_feed(fetch->parser, bytes, take, error);
		bytes += take;
		size -= take;
		result->bytes += take;
		if (!code && marks)
			code = reach(fetch, error);
	}
	return code;
}

/* The rest of this answer is obsolete. */
static bool has_turned(struct view_fetch *fetch)
{
	fetch->turned = fetch->turned || (fetch->watch.turned && fetch->store && !fetch->options.chunks
		&& view_store_ahead(fetch->store) && !view_store_complete(fetch->store)
		&& fetch->watch.turned(fetch->watch.ctx));
	return fetch->turned;
}

static enum eco_code take(void *ctx, const uint8_t *bytes, size_t size, struct eco_error *error)
{
	struct view_fetch *fetch = ctx;
	if (!fetch->text) {
		enum eco_code code = feed(fetch, bytes, size, error);
		return code || !has_turned(fetch) ? code : ECO_INTERRUPTED;
	}
	eco_write_bytes(fetch->text, bytes, size);
	return fetch->text->failed ? eco_no_memory(error, "an answer") : ECO_OK;
}

/* ---- Life ---- */

static enum eco_code check_url(const char *url, struct eco_error *error)
{
	if (strncmp(url, "http://", 7) != 0 && strncmp(url, "https://", 8) != 0)
		return eco_fail(error, ECO_BAD_USAGE, "'%s' is not a scene's URL: it should look like "
			"http://host:port/v1/scenes/NAME", url);
	if (strpbrk(url, "?# ") || strlen(url) > 2000)
		return eco_fail(error, ECO_BAD_USAGE, "a scene's URL has no query, fragment or space and at "
			"most 2000 characters");
	return ECO_OK;
}

enum eco_code view_fetch_new(struct view_fetch **out, const struct view_fetch_options *options,
	struct eco_error *error)
{
	*out = NULL;
	ECO_PASS(check_url(options->url, error));
	struct view_fetch *fetch = calloc(1, sizeof *fetch);
	if (!fetch)
		return eco_no_memory(error, "a connection");
	fetch->options = *options;
	if (!fetch->options.body_max)
		fetch->options.body_max = BODY_MAX_DEFAULT;
	long stall_s = options->stall_ms ? (options->stall_ms + 999) / 1000 : 120;
	enum eco_code code = options->chunks ? view_exchange_check_chunks(options->chunks, error) : ECO_OK;
	fetch->multi = curl_multi_init();
	if (!code && (!fetch->multi
			|| asprintf(&fetch->url, "%.*s", view_url_length(options->url), options->url) < 0))
		code = eco_no_memory(error, "a connection");
	if (!code)
		code = view_exchange_new(&fetch->exchange,
			&(struct view_exchange_options){ .multi = fetch->multi,
			.agent = "ecostream/" ECO_VERSION, .chunks = options->chunks,
			.connect_ms = options->connect_ms ? options->connect_ms : 10000, .stall_s = stall_s,
			.chunk_stall_s = stall_s < CHUNK_STALL_S ? stall_s : CHUNK_STALL_S }, error);
	if (code)
		view_fetch_free(fetch);
	else
		*out = fetch;
	return code;
}

void view_fetch_watch(struct view_fetch *fetch, const struct view_fetch_watch *watch)
{
	fetch->watch = *watch;
}

void view_fetch_free(struct view_fetch *fetch)
{
	if (!fetch)
		return;
	view_exchange_free(fetch->exchange);
	curl_multi_cleanup(fetch->multi);
	free(fetch->url);
	free(fetch);
}

/* ---- One request ---- */

/* An answer that is neither a stream nor a problem comes from some other server, or from one in between. */
static enum eco_code stranger(const struct view_fetch *fetch, enum eco_code code, const char *type,
	struct eco_error *error)
{
	return eco_fail(error, code, "%s: the server answered %ld%s%.60s, which is not an answer of "
		"ecoserve; a scene's URL is http://host:port/v1/scenes/NAME", fetch->options.url,
		fetch->result->status, type ? " with " : "", type ? type : "");
}

static enum eco_code problem(struct view_fetch *fetch, struct eco_error *error)
{
	long status = fetch->result->status;
	const struct eco_writer *said = &view_exchange_end(fetch->exchange)->problem;
	json_t *root = json_loadb((const char *)said->bytes, said->size, 0, NULL);
	const char *title = json_string_value(json_object_get(root, "title"));
	const char *detail = json_string_value(json_object_get(root, "detail"));
	enum eco_code code = status == 404 ? ECO_NOT_FOUND : status >= 500 ? ECO_IO : ECO_BAD_INPUT;
	if (title)
		eco_fail(error, code, "%s: the server answered %ld: %s%s%s%s", fetch->options.url, status,
			title, detail ? ": " : "", detail ? detail : "",
			strstr(fetch->options.url, "/v1/scenes/") ? ""
			: "; a scene's URL is http://host:port/v1/scenes/NAME");
	else
		stranger(fetch, code, NULL, error);
	json_decref(root);
	return code;
}

/* A server that is known is there again soon, or another in its place; of one that never answered the address
 * may be wrong. So it is with a host that had chunks. */
static bool is_lost(const struct view_fetch *fetch, const struct view_exchange_end *end)
{
	if (end->of_chunk)
		return end->known && end->error.code == ECO_IO;
	return fetch->answered && !end->error.code && (end->status == 502 || end->status == 503
		|| end->status == 504
		|| (end->rc && end->rc != CURLE_WRITE_ERROR));
}

static enum eco_code outcome(struct view_fetch *fetch, struct eco_error *error)
{
	struct view_fetch_result *result = fetch->result;
	const struct view_exchange_end *end = view_exchange_end(fetch->exchange);
	const char *wanted = fetch->text ? "application/json" : "application/octet-stream",
		*url = fetch->options.url;
	if (fetch->turned) {             /* how much of it will not come */
		result->cancelled = end->length > end->bytes ? end->length - end->bytes : 0;
		return ECO_OK;
	}
	if (fetch->stopped)
		return eco_fail(error, ECO_INTERRUPTED, "interrupted");
	fetch->lost = is_lost(fetch, end);
	if (fetch->lost && !fetch->text && fetch->options.chunks)
		view_exchange_salvage(fetch->exchange);
	if (end->of_chunk)
		return eco_fail(error, end->error.code, "%s", end->error.text);
	if (end->status == 200 && end->type && strncasecmp(end->type, wanted, strlen(wanted)) != 0)
		return stranger(fetch, ECO_BAD_INPUT, end->type, error);
	if (end->error.code)
		return eco_fail(error, end->error.code, "%s: %s", url, end->error.text);
	if (end->rc)
		return eco_fail(error, ECO_IO, "%s: %s%s", url, end->text, end->rc == CURLE_COULDNT_CONNECT
			? "; start ecoserve there, or take the URL that it printed" : "");
	result->nothing = end->status == 204;
	if (end->status != 200)
		return result->nothing ? ECO_OK : problem(fetch, error);
	if (fetch->text)
		return ECO_OK;
	/* an answer that was cut short by somebody in between is lost */
	enum eco_code code = eco_wire_finish(fetch->parser, error);
	fetch->lost = code != ECO_OK;
	return code;
}

/* Moves the exchange on until it is done, or is to end. */
static void run(struct view_fetch *fetch)
{
	struct view_exchange *x = fetch->exchange;
	int running, left;
	for (;;) {
		curl_multi_perform(fetch->multi, &running);
		for (CURLMsg *message; (message = curl_multi_info_read(fetch->multi, &left));) {
			CURL *curl = message->easy_handle;
			view_exchange_transferred(curl, message->data.result);
		}
		view_exchange_wake(x);
		if (view_exchange_end(x)->done)
			return;
		fetch->stopped = fetch->options.stop && *fetch->options.stop;
		if (fetch->stopped || has_turned(fetch)) {
			view_exchange_cancel(x);
			return;
		}
		double wait_ms = fmin(view_exchange_wakes_ms(x) - view_clock_ms(), WAIT_MS);
		curl_multi_poll(fetch->multi, NULL, 0, wait_ms > 0 ? (int)ceil(wait_ms) : 0, NULL);
	}
}

/* A stream if there is a body to post, which is of `pack` (NULL: of none), else an explanation. */
static enum eco_code perform(struct view_fetch *fetch, const struct eco_request *request,
	const struct eco_writer *body, const struct eco_chunk_id *pack, struct eco_error *error)
{
	char query[VIEW_QUERY_BYTES], *url;
	const struct view_fetch_options *o = &fetch->options;
	struct eco_request now = request ? *request : (struct eco_request){ 0 };
	now.name_from = !body || !o->chunks ? 0 : o->name_from ? o->name_from : ECO_NAME_FROM;
	bool made = !request ? asprintf(&url, "%s%s", fetch->url, fetch->below) >= 0
		: view_query_write(&now, pack, query, sizeof query) < sizeof query
			&& asprintf(&url, "%s/%s?%s%s%s%s", fetch->url, body ? "stream" : "plan", query,
			o->rule ? "&rule=" : "", o->rule ? o->rule : "", body ? "" : "&explain=1") >= 0;
	if (!made)
		return eco_no_memory(error, "a request");
	uint64_t most = fetch->text ? fetch->text_max : UINT64_MAX;
	struct view_exchange_job job = { url, body, now.name_from > 0, most < fetch->options.body_max ? most
		: fetch->options.body_max, take, fetch };
	fetch->start_ms = view_clock_ms();
	enum eco_code code = view_exchange_begin(fetch->exchange, &job, error);
	free(url);
	if (code)
		return code;
	run(fetch);
	struct view_fetch_result *result = fetch->result;
	const struct view_exchange_end *end = view_exchange_end(fetch->exchange);
	fetch->answered |= end->status && !end->of_chunk;
	result->status = end->status;
	result->bytes = result->most_bytes = end->bytes;
	result->named = end->named;
	result->named_bytes = end->named_bytes;
	result->plan_ms = end->plan_ms;
	result->retry_ms = end->retry_ms;
	code = outcome(fetch, error);
	result->stream_ms = view_clock_ms() - fetch->start_ms;
	result->first_byte_ms = isnan(end->first_byte_ms) ? result->stream_ms
		: end->first_byte_ms - fetch->start_ms;
	return code;
}

static void begin(struct view_fetch *fetch)
{
	*fetch->result = (struct view_fetch_result){ .plan_ms = NAN, .requests = 1 };
	fetch->stopped = fetch->turned = fetch->lost = false;
}

static enum eco_code attempt(struct view_fetch *fetch, struct view_store *store,
	const struct eco_request *request, struct eco_error *error)
{
	begin(fetch);
	struct eco_writer body = { 0 };
	enum eco_code code = view_store_write_holdings(store, &body, error);
	if (!code)
		code = eco_wire_parser_new(&fetch->parser, &view_store_events, store, error);
	if (!code) {
		fetch->store = store;
		view_store_find_by(store, view_exchange_find, fetch->exchange);
		code = perform(fetch, request, &body, view_store_pack(store), error);
		view_store_find_by(store, NULL, NULL);
		fetch->store = NULL;
		eco_wire_parser_free(fetch->parser);
		fetch->parser = NULL;
	}
	/* of an answer that broke off a picture may be there already, within which nothing more fits */
	if (fetch->turned || fetch->result->nothing)
		fetch->result->nothing = !view_store_settle(store);
	eco_writer_free(&body);
	return code;
}

static void wait_until(const struct view_fetch *fetch, double end_ms)
{
	while (view_clock_ms() < end_ms && !(fetch->options.stop && *fetch->options.stop))
		nanosleep(&(struct timespec){ 0, 20000000 }, NULL);
}

static bool wait_for_retry(const struct view_fetch *fetch, double until_ms)
{
	double end_ms = view_clock_ms() + fetch->result->retry_ms;
	long status = fetch->result->status;
	if ((status != 503 && status != 429) || !(fetch->result->retry_ms > 0) || end_ms > until_ms)
		return false;
	wait_until(fetch, end_ms);
	return true;
}

/* After an answer, and what came of it is counted: true if it is to be asked for again, now. All clients of a
 * server that was lost ask at once, so each waits for a while of its own. */
static bool wait_for_another(struct view_fetch *fetch, uint32_t broken)
{
	double begun_ms = view_clock_ms(), pause_ms = fmin(ldexp(PAUSE_MS, (int)broken), PAUSE_MAX_MS);
	uint64_t self = eco_random((uint64_t)(begun_ms * 1e3), (uint64_t)(uintptr_t)fetch);
	if (!fetch->lost || broken == fetch->options.resumes)
		return false;
	pause_ms *= 0.5 + 0.5 * eco_random_unit(self);
	wait_until(fetch, begun_ms + fmax(pause_ms, fetch->result->retry_ms));
	fetch->before.broken++;
	fetch->before.stream_ms += view_clock_ms() - begun_ms;
	return true;
}

/* The rest of a budget of bytes; all of it while there is no picture yet. */
static uint64_t bytes_left(const struct view_store *store, uint64_t most, uint64_t came)
{
	return most == ECO_BYTES_UNBOUNDED || !view_store_plan(store) ? most : most > came ? most - came : 0;
}

/* A host of chunks that hangs is asked no more: chunks come with the streams of the scene's server. */
static bool leave_host(struct view_fetch *fetch)
{
	if (!view_exchange_end(fetch->exchange)->hangs)
		return false;
	fetch->options.chunks = NULL;
	fetch->before.host_left = true;
	return true;
}

static enum eco_code fail_asked(const struct eco_error *one, enum eco_code code, uint32_t broken,
	struct eco_error *error)
{
	if (!code)
		return ECO_OK;
	return broken ? eco_fail(error, code, "%s (asked %u times)", one->text, broken + 1)
		: eco_fail(error, code, "%s", one->text);
}

/* One answer, from a server that may be busy at first, and in parts if it breaks off. */
static enum eco_code ask(struct view_fetch *fetch, struct view_store *store,
	const struct eco_request *request, double until_ms, struct eco_error *error)
{
	struct eco_request now = *request;
	uint64_t came = fetch->before.bytes;
	for (uint32_t broken = 0;;) {
		struct eco_error one = { 0 };
		enum eco_code code = attempt(fetch, store, &now, &one);
		if (code && wait_for_retry(fetch, until_ms))
			continue;
		add_result(fetch->result, &fetch->before);
		fetch->before = *fetch->result;
		bool left = code == ECO_IO && leave_host(fetch);
		if (!left && (!code || !wait_for_another(fetch, broken)))
			return fail_asked(&one, code, broken, error);
		broken += !left;
		view_store_resume(store);
		/* of the chunks that a host was to send few have come */
		now.bytes = left ? request->bytes
			: bytes_left(store, request->bytes, fetch->before.bytes - came);
	}
}

enum eco_code view_fetch_stream(struct view_fetch *fetch, struct view_store *store,
	const struct eco_request *request, struct view_fetch_result *result, struct eco_error *error)
{
	double until_ms = view_clock_ms() + (double)fetch->options.patience_ms;
	struct eco_request now = *request;
	fetch->result = result;
	fetch->before = (struct view_fetch_result){ .plan_ms = NAN };
	fetch->at = (struct marks_at){ 0 };
	view_store_begin(store);
	enum eco_code code = ask(fetch, store, &now, until_ms, error);
	for (uint64_t vertices; !code && view_store_again(store, &vertices);) {
		now.vertices = request->bytes == ECO_BYTES_UNBOUNDED ? request->vertices : vertices;
		code = ask(fetch, store, &now, until_ms, error);
	}
	return code;
}

/* Without a request: what the server says of the scene, or of what is `below` it. */
static enum eco_code fetch_text(struct view_fetch *fetch, const struct eco_request *request,
	const char *below, uint64_t most, char **text, struct eco_error *error)
{
	double until_ms = view_clock_ms() + (double)fetch->options.patience_ms;
	struct view_fetch_result result;
	struct eco_writer body = { 0 };
	struct eco_error one;
	enum eco_code code;
	uint32_t broken = 0;
	fetch->result = &result;
	fetch->text = &body;
	fetch->text_max = most;
	fetch->below = below;
	do {
		begin(fetch);
		eco_writer_free(&body);
		one = (struct eco_error){ 0 };
		code = perform(fetch, request, NULL, NULL, &one);
	} while (code && (wait_for_retry(fetch, until_ms) || wait_for_another(fetch, broken++)));
	fetch->text = NULL;
	eco_write_u8(&body, 0);
	if (!code && body.failed)
		code = eco_fail(&one, ECO_NO_MEMORY, "no memory for an answer of %llu bytes",
			(unsigned long long)result.bytes);
	*text = code ? NULL : (char *)body.bytes;
	if (code)
		eco_writer_free(&body);
	return fail_asked(&one, code, 0, error);
}

enum eco_code view_fetch_explanation(struct view_fetch *fetch, const struct eco_request *request, char **text,
	struct eco_error *error)
{
	return fetch_text(fetch, request, "", EXPLANATION_MAX, text, error);
}

enum eco_code view_fetch_scene(struct view_fetch *fetch, char **text, struct eco_error *error)
{
	return fetch_text(fetch, NULL, "", TEXT_MAX, text, error);
}

enum eco_code view_fetch_plants(struct view_fetch *fetch, const struct eco_chunk_id *pack, uint32_t list,
	uint32_t first, uint32_t count, char **text, struct eco_error *error)
{
	char below[128];
	snprintf(below, sizeof below, "/plants/%u?first=%u&count=%u%s%s", list, first, count,
		pack ? "&pack=" : "", pack ? eco_id_text(pack->bytes).hex : "");
	return fetch_text(fetch, NULL, below, TEXT_MAX, text, error);
}
