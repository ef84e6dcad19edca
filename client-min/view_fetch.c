/* Longer than 600 lines: a transfer's callbacks, deadlines, repetitions and problems look at one state. */
#include "client-min/view_fetch.h"

#include <jansson.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <time.h>

#include "client-min/view_query.h"
#include "ecofiles/base/random.h"
#include "ecofiles/base/options.h"
#include "ecofiles/base/version.h"

#define RATE_MIN_BYTES_S 1024u
#define BODY_MAX_DEFAULT ((uint64_t)16 << 30)
/* bodies that are held whole: what is said of a scene or of plants, an explanation, a stream with names */
#define TEXT_MAX ((uint64_t)8 << 20)
#define EXPLANATION_MAX ((uint64_t)64 << 20)
#define PROBLEM_MAX 16384u
#define PAUSE_MS 100.0           /* before an answer that broke off is asked for again; twice that then, ... */
#define PAUSE_MAX_MS 5000.0
#define MARK_MOST (UINT64_C(1) << 50)

/* How far an answer has come in its marks. */
struct marks_at { uint32_t bytes, ms; };

struct view_fetch {
	struct view_fetch_options options;
	CURL *curl;
	struct curl_slist *headers;
	char *url;                               /* of the scene, without a final slash */
	char curl_text[CURL_ERROR_SIZE];
	/* of the request under way */
	struct eco_wire_parser *parser;
	struct view_fetch_result *result;        /* of the answer that comes */
	struct view_fetch_result before;         /* of those before it, to the same request */
	struct eco_writer *text;                 /* where the body goes if it is no stream; else NULL */
	uint64_t text_max;
	const char *below;                       /* behind the scene's URL, of a text that is of no view */
	struct eco_error stream_error;
	/* where chunks are named: the host of them; finds names; the stream so far */
	struct view_chunks *chunks;
	struct eco_wire_parser *names;
	struct eco_writer stream;
	const struct view_marks *marks;          /* NULL: none */
	struct marks_at at;                 /* in them */
	view_fetch_reached *reached;
	void *reached_ctx;
	view_fetch_turned *turned_by;            /* NULL: it never is */
	void *turned_ctx;
	const struct view_store *store;          /* of the stream that comes */
	char problem[PROBLEM_MAX];
	size_t problem_size;
	double start_ms, heard_ms;               /* heard: when enough had come, the last time */
	uint64_t heard_bytes;                    /* since then */
	bool stalled, stopped, turned;
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

static int ascending(const void *a, const void *b)
{
	uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
	return (x > y) - (x < y);
}

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

/* ---- curl's callbacks ---- */

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
static enum eco_code reach(struct view_fetch *fetch)
{
	struct view_fetch_result now = result_now(fetch);
	enum eco_code code = ECO_OK;
	for (; !code && marks_pass(fetch->marks, &fetch->at, now.bytes, &now.stream_ms); now = result_now(fetch))
		code = fetch->reached(fetch->reached_ctx, &now, &fetch->stream_error);
	return code;
}

/* Feeds what came, mark by mark: what comes now was not there at a time before. */
static enum eco_code feed(struct view_fetch *fetch, const uint8_t *bytes, size_t size)
{
	struct view_fetch_result *result = fetch->result;
	enum eco_code code = fetch->marks ? reach(fetch) : ECO_OK;
	while (size && !code) {
		uint64_t room = fetch->marks ? marks_room(fetch->marks, &fetch->at,
			fetch->before.bytes + result->bytes) : size;
		size_t take = room < size ? (size_t)room : size;
		code = eco_wire_feed(fetch->parser, bytes, take, &fetch->stream_error);
		bytes += take;
		size -= take;
		result->bytes += take;
		if (!code && fetch->marks)
			code = reach(fetch);
	}
	return code;
}

/* Finds names in what came, and keeps it until they can be looked up. */
static enum eco_code scan(struct view_fetch *fetch, const uint8_t *bytes, size_t size)
{
	enum eco_code code = eco_wire_feed(fetch->names, bytes, size, &fetch->stream_error);
	eco_write_bytes(&fetch->stream, bytes, size);
	fetch->result->bytes += size;
	return code || !fetch->stream.failed ? code : eco_fail(&fetch->stream_error, ECO_NO_MEMORY,
		"no memory for a stream of %llu bytes", (unsigned long long)fetch->result->bytes);
}

/* Once a stream with names has come, or what came of it. */
static enum eco_code feed_named(struct view_fetch *fetch, struct eco_error *error)
{
	struct view_fetch_result *result = fetch->result;
	result->bytes = 0;
	enum eco_code code = feed(fetch, fetch->stream.bytes, fetch->stream.size) ? eco_fail(error,
		fetch->stream_error.code, "%s", fetch->stream_error.text) : ECO_OK;
	result->bytes += result->named_bytes;
	return code;
}

/* A body that drips is a stall, too: only so many bytes are heard. */
static void hear(struct view_fetch *fetch, size_t size)
{
	fetch->heard_bytes += size;
	if (fetch->heard_bytes < (uint64_t)fetch->options.stall_ms * RATE_MIN_BYTES_S / 1000)
		return;
	fetch->heard_ms = view_clock_ms();
	fetch->heard_bytes = 0;
}

/* The rest of this answer is obsolete. */
static bool has_turned(struct view_fetch *fetch)
{
	fetch->turned = fetch->turned || (fetch->turned_by && fetch->store && !fetch->chunks
		&& view_store_ahead(fetch->store) && !view_store_complete(fetch->store)
		&& fetch->turned_by(fetch->turned_ctx));
	return fetch->turned;
}

/* Bytes of a body, less where it is held whole. */
static uint64_t body_most(const struct view_fetch *fetch)
{
	uint64_t whole = fetch->text ? fetch->text_max : fetch->chunks ? VIEW_NAMED_STREAM_MAX : UINT64_MAX;
	return whole < fetch->options.body_max ? whole : fetch->options.body_max;
}

static size_t on_body(char *bytes, size_t one, size_t size, void *ctx)
{
	struct view_fetch *fetch = ctx;
	size *= one;
	hear(fetch, size);
	if (fetch->result->status == 0) {
		curl_easy_getinfo(fetch->curl, CURLINFO_RESPONSE_CODE, &fetch->result->status);
		fetch->heard_ms = view_clock_ms();
		fetch->result->first_byte_ms = fetch->heard_ms - fetch->start_ms;
	}
	if (fetch->result->status != 200) {
		fetch->result->bytes += size;
		size_t room = PROBLEM_MAX - 1 - fetch->problem_size, take = size < room ? size : room;
		memcpy(fetch->problem + fetch->problem_size, bytes, take);
		fetch->problem_size += take;
		return take == size ? size : 0;
	}
	if (fetch->result->bytes + size > body_most(fetch)) {
		eco_fail(&fetch->stream_error, ECO_TOO_LARGE, "the answer is longer than %llu bytes",
			(unsigned long long)body_most(fetch));
		return 0;
	}
	if (fetch->text) {
		fetch->result->bytes += size;
		eco_write_bytes(fetch->text, bytes, size);
		return fetch->text->failed ? 0 : size;
	}
	return (fetch->chunks ? scan : feed)(fetch, (const uint8_t *)bytes, size) || has_turned(fetch)
		? 0 : size;
}

static int on_progress(void *ctx, curl_off_t a, curl_off_t b, curl_off_t c, curl_off_t d)
{
	(void)a, (void)b, (void)c, (void)d;
	struct view_fetch *fetch = ctx;
	fetch->stopped = fetch->options.stop && *fetch->options.stop;
	fetch->stalled = view_clock_ms() - fetch->heard_ms > (double)fetch->options.stall_ms;
	return fetch->stopped || fetch->stalled || has_turned(fetch);
}

/* ---- Life ---- */

static void set_options(struct view_fetch *fetch)
{
	CURL *c = fetch->curl;
	curl_easy_setopt(c, CURLOPT_HTTPHEADER, fetch->headers);
	curl_easy_setopt(c, CURLOPT_ERRORBUFFER, fetch->curl_text);
	curl_easy_setopt(c, CURLOPT_BUFFERSIZE, 256L << 10);
	curl_easy_setopt(c, CURLOPT_WRITEFUNCTION, on_body);
	curl_easy_setopt(c, CURLOPT_WRITEDATA, fetch);
	curl_easy_setopt(c, CURLOPT_NOPROGRESS, 0L);
	curl_easy_setopt(c, CURLOPT_XFERINFOFUNCTION, on_progress);
	curl_easy_setopt(c, CURLOPT_XFERINFODATA, fetch);
}

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
	enum eco_code code = check_url(options->url, error);
	if (code)
		return code;
	struct view_fetch *fetch = calloc(1, sizeof *fetch);
	if (!fetch)
		return eco_no_memory(error, "a connection");
	fetch->options = *options;
	if (!fetch->options.body_max)
		fetch->options.body_max = BODY_MAX_DEFAULT;
	if (!fetch->options.connect_ms)
		fetch->options.connect_ms = 10000;
	if (!fetch->options.stall_ms)
		fetch->options.stall_ms = 120000;
	fetch->curl = view_curl_new("ecostream/" ECO_VERSION, fetch->options.connect_ms);
	fetch->headers = curl_slist_append(NULL, "Content-Type: application/octet-stream");
	if (!fetch->curl || !fetch->headers || !curl_slist_append(fetch->headers, "Expect:") ||
		asprintf(&fetch->url, "%.*s", view_url_length(options->url), options->url) < 0) {
		view_fetch_free(fetch);
		return eco_no_memory(error, "a connection");
	}
	set_options(fetch);
	if (options->chunks)
		code = view_chunks_new(&fetch->chunks, &(struct view_chunks_options){ options->chunks,
			fetch->options.connect_ms, fetch->options.stall_ms, options->patience_ms,
			options->stop }, error);
	if (code)
		view_fetch_free(fetch);
	else
		*out = fetch;
	return code;
}

void view_fetch_mark(struct view_fetch *fetch, const struct view_marks *marks, view_fetch_reached *reached,
	void *ctx)
{
	fetch->marks = marks;
	fetch->reached = reached;
	fetch->reached_ctx = ctx;
}

void view_fetch_turn(struct view_fetch *fetch, view_fetch_turned *turned, void *ctx)
{
	fetch->turned_by = turned;
	fetch->turned_ctx = ctx;
}

void view_fetch_free(struct view_fetch *fetch)
{
	if (!fetch)
		return;
	view_chunks_free(fetch->chunks);
	curl_easy_cleanup(fetch->curl);
	curl_slist_free_all(fetch->headers);
	free(fetch->url);
	free(fetch);
}

/* ---- One request ---- */

/* An answer that is neither a stream nor a problem comes from some other server, or from one in between. */
static enum eco_code stranger(const struct view_fetch *fetch, enum eco_code code, const char *type,
	struct eco_error *error)
{
	return eco_fail(error, code, "%s: the server answered %ld%s%.60s, as no ecoserve does; a scene's "
		"URL is http://host:port/v1/scenes/NAME", fetch->options.url, fetch->result->status,
		type ? " with " : "", type ? type : "");
}

static enum eco_code problem(struct view_fetch *fetch, struct eco_error *error)
{
	long status = fetch->result->status;
	json_t *root = json_loadb(fetch->problem, fetch->problem_size, 0, NULL);
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
 * may be wrong. */
static bool is_lost(const struct view_fetch *fetch, CURLcode rc)
{
	long status = fetch->result->status;
	return fetch->answered && !fetch->stopped && !fetch->stream_error.code
		&& (fetch->stalled || status == 502 || status == 503 || status == 504
		|| (rc && rc != CURLE_WRITE_ERROR));
}

/* A whole answer; one that was cut short by somebody in between is lost. */
static enum eco_code finish_stream(struct view_fetch *fetch, struct eco_error *error)
{
	enum eco_code code = fetch->chunks ? feed_named(fetch, error) : ECO_OK;
	/* a chunk that is named and did not come */
	fetch->lost = code == ECO_IO && view_chunks_known(fetch->chunks);
	if (code)
		return code;
	code = eco_wire_finish(fetch->parser, error);
	fetch->lost = code != ECO_OK;
	return code;
}

/* The answer was left: how much of it will not come. */
static void count_cancelled(struct view_fetch *fetch)
{
	curl_off_t whole = 0;
	curl_easy_getinfo(fetch->curl, CURLINFO_CONTENT_LENGTH_DOWNLOAD_T, &whole);
	if (whole > 0 && (uint64_t)whole > fetch->result->bytes)
		fetch->result->cancelled = (uint64_t)whole - fetch->result->bytes;
}

static enum eco_code outcome(struct view_fetch *fetch, CURLcode rc, struct eco_error *error)
{
	if (fetch->turned) {
		count_cancelled(fetch);
		return ECO_OK;
	}
	fetch->lost = is_lost(fetch, rc);
	if (fetch->stopped)
		return eco_fail(error, ECO_INTERRUPTED, "interrupted");
	if (fetch->lost && fetch->chunks && !fetch->text && fetch->result->status == 200)
		feed_named(fetch, NULL);
	if (fetch->stalled)
		return eco_fail(error, ECO_IO, "%s: less than %u bytes a second came for %ld s",
			fetch->options.url, RATE_MIN_BYTES_S, fetch->options.stall_ms / 1000);
	const char *type = NULL;
	curl_easy_getinfo(fetch->curl, CURLINFO_CONTENT_TYPE, &type);
	const char *wanted = fetch->text ? "application/json" : "application/octet-stream";
	if (fetch->result->status == 200 && type && strncasecmp(type, wanted, strlen(wanted)) != 0)
		return stranger(fetch, ECO_BAD_INPUT, type, error);
	if (fetch->stream_error.code)
		return eco_fail(error, fetch->stream_error.code, "%s: %s", fetch->options.url,
			fetch->stream_error.text);
	if (rc && !(rc == CURLE_WRITE_ERROR && fetch->result->status >= 400))
		return eco_fail(error, ECO_IO, "%s: %s%s", fetch->options.url,
			fetch->curl_text[0] ? fetch->curl_text : curl_easy_strerror(rc),
			rc == CURLE_COULDNT_CONNECT ? "; start ecoserve there, or take the URL that it "
			"printed" : "");
	if (fetch->result->status == 204) {
		fetch->result->nothing = true;
		return ECO_OK;
	}
	if (fetch->result->status != 200)
		return problem(fetch, error);
	return fetch->text ? ECO_OK : finish_stream(fetch, error);
}

/* A stream if there is a body to post, which is of `pack` (NULL: of none), else an explanation. */
static enum eco_code perform(struct view_fetch *fetch, const struct eco_request *request,
	const struct eco_writer *body, const struct eco_chunk_id *pack, struct eco_error *error)
{
	char query[VIEW_QUERY_BYTES], *url;
	const char *rule = fetch->options.rule;
	bool made = !request ? asprintf(&url, "%s%s", fetch->url, fetch->below) >= 0
		: view_query_write(request, pack, query, sizeof query) < sizeof query
			&& asprintf(&url, "%s/%s?%s%s%s%s", fetch->url, body ? "stream" : "plan", query,
			rule ? "&rule=" : "", rule ? rule : "", body ? "" : "&explain=1") >= 0;
	if (!made)
		return eco_no_memory(error, "a request");
	curl_easy_setopt(fetch->curl, CURLOPT_URL, url);
	if (body) {
		curl_easy_setopt(fetch->curl, CURLOPT_POSTFIELDS, body->bytes ? (const char *)body->bytes
			: "");
		curl_easy_setopt(fetch->curl, CURLOPT_POSTFIELDSIZE_LARGE, (curl_off_t)body->size);
	} else {
		curl_easy_setopt(fetch->curl, CURLOPT_HTTPGET, 1L);
	}
	fetch->start_ms = fetch->heard_ms = view_clock_ms();
	fetch->heard_bytes = 0;
	CURLcode rc = curl_easy_perform(fetch->curl);
	free(url);
	struct view_fetch_result *result = fetch->result;
	curl_easy_getinfo(fetch->curl, CURLINFO_RESPONSE_CODE, &result->status);
	fetch->answered |= result->status != 0;
	result->plan_ms = view_plan_ms(fetch->curl);
	result->retry_ms = view_retry_ms(fetch->curl);
	result->stream_ms = view_clock_ms() - fetch->start_ms;
	if (result->bytes == 0)
		result->first_byte_ms = result->stream_ms;
	enum eco_code code = outcome(fetch, rc, error);
	result->most_bytes = result->bytes;
	return code;
}

static void begin(struct view_fetch *fetch)
{
	*fetch->result = (struct view_fetch_result){ .plan_ms = NAN, .requests = 1 };
	fetch->problem_size = 0;
	fetch->stopped = fetch->stalled = fetch->turned = fetch->lost = false;
	fetch->stream_error = (struct eco_error){ 0 };
	fetch->curl_text[0] = '\0';
}

/* A name is found: its chunk begins to come. */
static enum eco_code on_name(void *ctx, const struct eco_chunk *chunk, const uint8_t **payload,
	struct eco_error *error)
{
	struct view_fetch *fetch = ctx;
	struct view_fetch_result *result = fetch->result;
	(void)payload;
	result->named++;
	result->named_bytes += chunk->size_bytes;
	return result->bytes + result->named_bytes > fetch->options.body_max ? eco_fail(error, ECO_TOO_LARGE,
		"the answer and the chunks that it names are longer than %llu bytes",
		(unsigned long long)fetch->options.body_max)
		: view_chunks_want(fetch->chunks, &chunk->id, chunk->size_bytes, error);
}

static enum eco_code find_named(void *ctx, const struct eco_chunk *chunk, const uint8_t **payload,
	struct eco_error *error)
{
	struct view_fetch *fetch = ctx;
	return view_chunks_take(fetch->chunks, &chunk->id, chunk->size_bytes, payload, error);
}

static void end_names(struct view_fetch *fetch, struct view_store *store)
{
	view_store_find_by(store, NULL, NULL);
	view_chunks_forget(fetch->chunks);
	eco_wire_parser_free(fetch->names);
	fetch->names = NULL;
	eco_writer_free(&fetch->stream);
}

/* As perform, by names where chunks have a host. */
static enum eco_code perform_named(struct view_fetch *fetch, struct view_store *store,
	const struct eco_request *request, const struct eco_writer *body, struct eco_error *error)
{
	static const struct eco_wire_events names = { .fetch = on_name };
	struct eco_request named = *request;
	if (!fetch->chunks)
		return perform(fetch, request, body, view_store_pack(store), error);
	named.name_from = fetch->options.name_from ? fetch->options.name_from : ECO_NAME_FROM;
	view_store_find_by(store, find_named, fetch);
	enum eco_code code = eco_wire_parser_new(&fetch->names, &names, fetch, error);
	if (!code)
		code = perform(fetch, &named, body, view_store_pack(store), error);
	end_names(fetch, store);
	return code;
}

static enum eco_code attempt(struct view_fetch *fetch, struct view_store *store,
	const struct eco_request *request, struct eco_error *error)
{
	begin(fetch);
	struct eco_holdings holdings;
	enum eco_code code = view_store_holdings(store, &holdings, error);
	if (code)
		return code;
	struct eco_writer body = { 0 };
	eco_wire_write_holdings(&body, &holdings);
	free(holdings.items);
	code = body.failed ? eco_no_memory(error, "a request")
		: eco_wire_parser_new(&fetch->parser, &view_store_events, store, error);
	if (!code) {
		fetch->store = store;
		code = perform_named(fetch, store, request, &body, error);
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
	if (!fetch->chunks || !view_chunks_hangs(fetch->chunks) || fetch->stopped)
		return false;
	view_chunks_free(fetch->chunks);
	fetch->chunks = NULL;
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
static enum eco_code fetch_text(struct view_fetch *fetch, const struct eco_request *request, const char *below,
	uint64_t most, char **text, struct eco_error *error)
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
	char below[128], id[VIEW_ID_BYTES];
	snprintf(below, sizeof below, "/plants/%u?first=%u&count=%u%s%s", list, first, count, pack ? "&pack=" : "",
		pack ? view_id_write(pack, id) : "");
	return fetch_text(fetch, NULL, below, TEXT_MAX, text, error);
}
