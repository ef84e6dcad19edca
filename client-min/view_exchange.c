/* Transfers are lanes: the first is the answer's, the others are those of chunks. A stream with names is read
 * twice: for names, in whose order chunks are fetched, and for the store when all of them are here. A
 * transfer cannot begin within the callback of another, so lanes begin in view_exchange_wake. */
#include "client-min/view_exchange.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>

#include "client-min/view_query.h"
#include "ecofiles/base/array_grow.h"

#define LANES 7u
#define STREAM_MAX ((uint64_t)256 << 20)         /* of a stream with names, which is held */
#define PROBLEM_MAX 16384u
#define SLOW_BYTES_S 1024L
#define SLOW_BLOCK 16384L        /* of a line with a bandwidth: how much is read, and kept by the system */
#define RETRY_MAX_S 30
#define RETRY_MIN_MS 100.0
#define URL_MOST 2000u

struct lane {
	struct view_exchange *x;
	CURL *curl;                      /* NULL: not opened yet */
	uint32_t wanted;
	bool busy;
	double free_ms;                  /* when it may ask next */
	double comes_ms;                 /* when what it waits with is through the line; INFINITY: nothing */
	char text[CURL_ERROR_SIZE];
};
struct wanted { struct eco_chunk_id id; uint8_t *bytes; uint32_t size, have; };

struct view_exchange {
	struct view_exchange_options options;
	struct view_exchange_job job;
	struct view_exchange_end end;
	struct lane lanes[LANES];
	struct curl_slist *headers;
	char *chunks;                            /* of the options, without a final slash */
	struct eco_wire_parser *names;
	struct eco_writer stream;                /* with names, until all chunks are here */
	struct wanted *wanted;
	uint32_t room, next, here, taken;        /* of end.named: begun, here, found by the store */
	bool whole;                              /* the stream is here */
	double line_ms;                          /* when the line has carried all that came so far */
};

/* ---- Headers and URLs ---- */

static const char *header_of(CURL *curl, const char *name)
{
	struct curl_header *header;
	return curl_easy_header(curl, name, 0, CURLH_HEADER, -1, &header) ? "" : header->value;
}

static double retry_ms(CURL *curl)
{
	char *end;
	const char *value = header_of(curl, "Retry-After");
	double s = strtod(value, &end);
	return end > value && s >= 0 && s <= RETRY_MAX_S ? fmax(s * 1e3, RETRY_MIN_MS) : 0;
}

double view_plan_ms_read(const char *value)
{
	char *end;
	const char *found = strstr(value, "plan;dur=");
	if (!found || (found != value && !strchr(" ,\t", found[-1])))
		return NAN;
	double ms = strtod(found + 9, &end);
	return end == found + 9 || !isfinite(ms) || ms < 0 ? NAN : ms;
}

int view_url_length(const char *url)
{
	size_t length = strlen(url);
	while (length && url[length - 1] == '/')
		length--;
	return (int)length;
}

enum eco_code view_exchange_check_chunks(const char *url, struct eco_error *error)
{
	if ((strncmp(url, "http://", 7) != 0 && strncmp(url, "https://", 8) != 0) || strpbrk(url, "?# ")
			|| strlen(url) > URL_MOST)
		return eco_fail(error, ECO_BAD_USAGE, "'%.200s' cannot be the base URL of chunks: it "
			"should look like http://host/chunks", url);
	return ECO_OK;
}

static void write_url(const struct view_exchange *x, const struct wanted *w, char url[URL_MOST + 40])
{
	snprintf(url, URL_MOST + 40, "%s/%s", x->chunks, eco_id_text(w->id.bytes).hex);
}

/* ---- What comes ---- */

/* A block is there when the line, which all lanes share, has carried it: until then its transfer pauses. */
static bool is_through(struct view_exchange *x, struct lane *lane, size_t size)
{
	double rate = (double)x->options.bandwidth_bytes_s, now = view_clock_ms();
	if (!(rate > 0))
		return true;
	if (isinf(lane->comes_ms))
		lane->comes_ms = x->line_ms = fmax(x->line_ms, now) + 1e3 * (double)size / rate;
	if (now < lane->comes_ms)
		return false;
	lane->comes_ms = INFINITY;
	return true;
}

static enum eco_code hold(struct view_exchange *x, const uint8_t *bytes, size_t size)
{
	enum eco_code code = eco_wire_feed(x->names, bytes, size, &x->end.error);
	eco_write_bytes(&x->stream, bytes, size);
	return code || !x->stream.failed ? code : eco_no_memory(&x->end.error, "a stream that names chunks");
}

static size_t on_answer(struct view_exchange *x, const char *bytes, size_t size)
{
	struct view_exchange_end *end = &x->end;
	uint64_t most = x->names && STREAM_MAX < x->job.most_bytes ? STREAM_MAX : x->job.most_bytes;
	if (isnan(end->first_byte_ms)) {
		curl_easy_getinfo(x->lanes[0].curl, CURLINFO_RESPONSE_CODE, &end->status);
		end->first_byte_ms = view_clock_ms();
	}
	if (end->status != 200) {
		size_t left = PROBLEM_MAX - end->problem.size;
		end->bytes += size;
		eco_write_bytes(&end->problem, bytes, size < left ? size : left);
		return size < left ? size : 0;
	}
	if (end->bytes + size > most) {
		eco_fail(&end->error, ECO_TOO_LARGE, "the answer is longer than %llu bytes",
			(unsigned long long)most);
		return 0;
	}
	end->bytes += size;
	return (x->names ? hold(x, (const uint8_t *)bytes, size)
		: x->job.take(x->job.ctx, (const uint8_t *)bytes, size, &end->error)) ? 0 : size;
}

static size_t on_body(char *bytes, size_t one, size_t size, void *ctx)
{
	struct lane *lane = ctx;
	struct view_exchange *x = lane->x;
	size *= one;
	if (!is_through(x, lane, size))
		return CURL_WRITEFUNC_PAUSE;
	if (lane == x->lanes)
		return on_answer(x, bytes, size);
	struct wanted *w = &x->wanted[lane->wanted];
	if (size > w->size - w->have)
		return 0;
	memcpy(w->bytes + w->have, bytes, size);
	w->have += (uint32_t)size;
	x->end.bytes += size;
	return size;
}

/* A name is found. */
static enum eco_code on_name(void *ctx, const struct eco_chunk *chunk, const uint8_t **payload,
	struct eco_error *error)
{
	struct view_exchange *x = ctx;
	struct view_exchange_end *end = &x->end;
	double free_ms = view_clock_ms() + x->options.latency_ms;
	(void)payload;
	for (uint32_t i = 1; i < LANES && !end->named; i++)
		x->lanes[i].free_ms = free_ms;
	end->named_bytes += chunk->size_bytes;
	if (end->named_bytes > x->job.most_bytes)
		return eco_fail(error, ECO_TOO_LARGE,
			"the chunks that the answer names are longer than %llu bytes",
			(unsigned long long)x->job.most_bytes);
	if (!eco_array_grow(&x->wanted, &x->room, (uint32_t)end->named, sizeof *x->wanted))
		return eco_no_memory(error, "a named chunk");
	x->wanted[end->named++] = (struct wanted){ .id = chunk->id, .size = chunk->size_bytes };
	return ECO_OK;
}

/* ---- Transfers ---- */

static int on_socket(void *ctx, curl_socket_t fd, curlsocktype purpose)
{
	int size = (int)SLOW_BLOCK;
	(void)ctx, (void)purpose;
	setsockopt(fd, SOL_SOCKET, SO_RCVBUF, &size, sizeof size);
	return CURL_SOCKOPT_OK;
}

/* False: no memory. */
static bool open_lane(struct view_exchange *x, struct lane *lane)
{
	const struct view_exchange_options *o = &x->options;
	bool first = lane == x->lanes;
	CURL *c = lane->curl;
	if (c || !(c = lane->curl = curl_easy_init()))
		return c;
	lane->x = x;
	curl_easy_setopt(c, CURLOPT_NOSIGNAL, 1L);
	curl_easy_setopt(c, CURLOPT_TCP_NODELAY, 1L);
	curl_easy_setopt(c, CURLOPT_CONNECTTIMEOUT_MS, o->connect_ms);
	curl_easy_setopt(c, CURLOPT_USERAGENT, o->agent);
	curl_easy_setopt(c, CURLOPT_PROTOCOLS_STR, "http,https");
	curl_easy_setopt(c, CURLOPT_FOLLOWLOCATION, first ? 0L : 1L);
	/* to where a host keeps a file: of buckets, CDNs, to https */
	curl_easy_setopt(c, CURLOPT_MAXREDIRS, 5L);
	curl_easy_setopt(c, CURLOPT_FAILONERROR, first ? 0L : 1L);
	curl_easy_setopt(c, CURLOPT_HTTPHEADER, first ? x->headers : NULL);
	curl_easy_setopt(c, CURLOPT_LOW_SPEED_LIMIT, first ? SLOW_BYTES_S : SLOW_BYTES_S / (long)LANES);
	curl_easy_setopt(c, CURLOPT_LOW_SPEED_TIME, first ? o->stall_s : o->chunk_stall_s);
	curl_easy_setopt(c, CURLOPT_FORBID_REUSE, o->fresh ? 1L : 0L);
	curl_easy_setopt(c, CURLOPT_FRESH_CONNECT, o->fresh ? 1L : 0L);
	curl_easy_setopt(c, CURLOPT_WRITEFUNCTION, on_body);
	curl_easy_setopt(c, CURLOPT_WRITEDATA, lane);
	curl_easy_setopt(c, CURLOPT_PRIVATE, lane);
	curl_easy_setopt(c, CURLOPT_ERRORBUFFER, lane->text);
	curl_easy_setopt(c, CURLOPT_BUFFERSIZE, o->bandwidth_bytes_s ? SLOW_BLOCK : 256L << 10);
	if (o->bandwidth_bytes_s)
		curl_easy_setopt(c, CURLOPT_SOCKOPTFUNCTION, on_socket);
	return c;
}

static enum eco_code start(struct view_exchange *x, struct lane *lane, const char *url,
	struct eco_error *error)
{
	lane->text[0] = 0;
	lane->comes_ms = INFINITY;
	curl_easy_setopt(lane->curl, CURLOPT_URL, url);
	lane->busy = curl_multi_add_handle(x->options.multi, lane->curl) == CURLM_OK;
	return lane->busy ? ECO_OK : eco_fail(error, ECO_NO_MEMORY, "libcurl takes no further request");
}

static void stop(struct view_exchange *x, struct lane *lane)
{
	if (lane->busy)
		curl_multi_remove_handle(x->options.multi, lane->curl);
	lane->busy = false;
}

void view_exchange_cancel(struct view_exchange *x)
{
	curl_off_t length = 0;
	for (uint32_t i = 0; i < LANES; i++)
		stop(x, &x->lanes[i]);
	if (x->lanes[0].curl)
		curl_easy_getinfo(x->lanes[0].curl, CURLINFO_CONTENT_LENGTH_DOWNLOAD_T, &length);
	x->end.length = length > 0 ? (uint64_t)length : 0;
	x->end.done = true;
}

static void finish(struct view_exchange *x)
{
	view_exchange_cancel(x);
	if (x->options.ended)
		x->options.ended(x->options.ctx);
}

/* ---- Ends ---- */

/* Too much to do, or asked too much: nothing is wrong with the address. */
static bool is_trouble(long status)
{
	return status >= 500 || status == 408 || status == 429;
}

static void note_end(struct view_exchange *x, const struct lane *lane, CURLcode rc)
{
	struct view_exchange_end *end = &x->end;
	end->rc = rc;
	end->text = lane->text[0] ? lane->text : curl_easy_strerror(rc);
	end->retry_ms = retry_ms(lane->curl);
	curl_easy_getinfo(lane->curl, CURLINFO_RESPONSE_CODE, &end->status);
}

/* Once all is here. */
static void take_named(struct view_exchange *x)
{
	if (!x->whole || x->here < x->end.named)
		return;
	x->job.take(x->job.ctx, x->stream.bytes, x->stream.size, &x->end.error);
	finish(x);
}

static void end_answer(struct view_exchange *x, CURLcode rc)
{
	struct view_exchange_end *end = &x->end;
	CURL *curl = x->lanes[0].curl;
	note_end(x, &x->lanes[0], rc);
	if (rc == CURLE_WRITE_ERROR && end->status >= 400)
		end->rc = CURLE_OK;              /* a problem that is too long */
	end->plan_ms = view_plan_ms_read(header_of(curl, "Server-Timing"));
	curl_easy_getinfo(curl, CURLINFO_CONTENT_TYPE, &end->type);
	x->whole = !rc && end->status == 200;
	if (x->whole && x->names)
		take_named(x);
	else
		finish(x);
}

static void fail_chunk(struct view_exchange *x, const struct wanted *w, bool came)
{
	struct view_exchange_end *end = &x->end;
	char url[URL_MOST + 40];
	end->of_chunk = true;
	end->known |= is_trouble(end->status);
	/* one that had chunks is down; of one that never had any the address may be wrong */
	end->hangs = end->rc == CURLE_OPERATION_TIMEDOUT || (end->rc == CURLE_COULDNT_CONNECT && end->known);
	write_url(x, w, url);
	if (came)
		eco_fail(&end->error, ECO_DAMAGED, "%.250s: its bytes do not have the hash that names it; "
			"remove it there, and export it again", url);
	else if (end->rc == CURLE_HTTP_RETURNED_ERROR)
		eco_fail(&end->error, ECO_IO, "%.250s: its host answered %ld%s", url, end->status,
			is_trouble(end->status) ? ""
			: "; it needs the chunks of the pack that is served, named by their ids");
	else if (end->rc && end->rc != CURLE_WRITE_ERROR)
		eco_fail(&end->error, ECO_IO, "%.250s: %s", url, end->text);
	else
		eco_fail(&end->error, ECO_DAMAGED, "%.250s: it has not the %u bytes that the stream names",
			url,
			w->size);
	finish(x);
}

static void end_chunk(struct view_exchange *x, struct lane *lane, CURLcode rc)
{
	const struct wanted *w = &x->wanted[lane->wanted];
	bool came = !rc && w->have == w->size;
	struct eco_chunk_id id = came ? eco_chunk_hash(w->bytes, w->size) : w->id;
	lane->free_ms = view_clock_ms() + x->options.latency_ms;
	if (!came || memcmp(&id, &w->id, sizeof id) != 0) {
		note_end(x, lane, rc);
		fail_chunk(x, w, came);
		return;
	}
	x->end.known = true;
	x->here++;
	take_named(x);
}

void view_exchange_transferred(CURL *curl, CURLcode rc)
{
	struct lane *lane;
	curl_easy_getinfo(curl, CURLINFO_PRIVATE, (char **)&lane);
	struct view_exchange *x = lane->x;
	stop(x, lane);
	if (lane == x->lanes)
		end_answer(x, rc);
	else
		end_chunk(x, lane, rc);
}

double view_exchange_wakes_ms(const struct view_exchange *x)
{
	double wakes_ms = INFINITY;
	for (uint32_t i = 0; i < LANES && !x->end.done; i++) {
		const struct lane *lane = &x->lanes[i];
		if (lane->busy)
			wakes_ms = fmin(wakes_ms, lane->comes_ms);
		else if (i && x->next < x->end.named)
			wakes_ms = fmin(wakes_ms, lane->free_ms);
	}
	return wakes_ms;
}

/* Memory is taken here, not where a stream only says a size. */
static enum eco_code fetch_next(struct view_exchange *x, struct lane *lane)
{
	struct wanted *w = &x->wanted[x->next];
	char url[URL_MOST + 40];
	write_url(x, w, url);
	w->bytes = malloc(w->size);
	if (!w->bytes || !open_lane(x, lane))
		return eco_no_memory(&x->end.error, "a named chunk");
	lane->wanted = x->next++;
	return start(x, lane, url, &x->end.error);
}

void view_exchange_wake(struct view_exchange *x)
{
	double now = view_clock_ms();
	for (uint32_t i = 0; i < LANES && !x->end.done; i++) {
		struct lane *lane = &x->lanes[i];
		if (lane->busy && lane->comes_ms <= now) {
			curl_easy_pause(lane->curl, CURLPAUSE_CONT);
		} else if (i && !lane->busy && x->next < x->end.named && lane->free_ms <= now
				&& fetch_next(x, lane)) {
			finish(x);
			return;
		}
	}
}

enum eco_code view_exchange_find(void *ctx, const struct eco_chunk *chunk, const uint8_t **payload,
	struct eco_error *error)
{
	struct view_exchange *x = ctx;
	const struct wanted *w = x->taken < x->end.named ? &x->wanted[x->taken] : NULL;
	(void)chunk;
	if (!w || !w->bytes || w->have < w->size)
		return eco_fail(error, ECO_IO, "a chunk that the stream names did not come");
	x->taken++;
	*payload = w->bytes;
	return ECO_OK;
}

void view_exchange_salvage(struct view_exchange *x)
{
	struct eco_error ignored = { 0 };
	if (x->names && !x->taken)
		x->job.take(x->job.ctx, x->stream.bytes, x->stream.size, &ignored);
}

/* ---- Life ---- */

static void forget(struct view_exchange *x)
{
	view_exchange_cancel(x);
	for (uint32_t i = 0; i < x->end.named; i++)
		free(x->wanted[i].bytes);
	x->next = x->here = x->taken = 0;
	x->whole = false;
	eco_wire_parser_free(x->names);
	x->names = NULL;
	eco_writer_free(&x->stream);
	eco_writer_free(&x->end.problem);
	x->end = (struct view_exchange_end){ .done = true, .known = x->end.known, .text = "", .plan_ms = NAN,
		.first_byte_ms = NAN };
}

enum eco_code view_exchange_new(struct view_exchange **out, const struct view_exchange_options *options,
	struct eco_error *error)
{
	struct view_exchange *x = *out = calloc(1, sizeof *x);
	if (!x)
		return eco_no_memory(error, "a connection");
	x->options = *options;
	x->headers = curl_slist_append(NULL, "Content-Type: application/octet-stream");
	x->chunks = options->chunks ? strndup(options->chunks,
		(size_t)view_url_length(options->chunks)) : NULL;
	forget(x);
	if ((x->chunks || !options->chunks) && x->headers && curl_slist_append(x->headers, "Expect:")
			&& open_lane(x, &x->lanes[0]))
		return ECO_OK;
	view_exchange_free(x);
	*out = NULL;
	return eco_no_memory(error, "a connection");
}

void view_exchange_free(struct view_exchange *x)
{
	if (!x)
		return;
	forget(x);
	for (uint32_t i = 0; i < LANES; i++)
		curl_easy_cleanup(x->lanes[i].curl);
	curl_slist_free_all(x->headers);
	eco_free(x->wanted, x->chunks, x);
}

enum eco_code view_exchange_begin(struct view_exchange *x, const struct view_exchange_job *job,
	struct eco_error *error)
{
	static const struct eco_wire_events names = { .fetch = on_name };
	CURL *c = x->lanes[0].curl;
	forget(x);
	x->job = *job;
	enum eco_code code = job->names ? eco_wire_parser_new(&x->names, &names, x, error) : ECO_OK;
	if (job->body) {
		curl_easy_setopt(c, CURLOPT_POSTFIELDS,
			job->body->bytes ? (const char *)job->body->bytes : "");
		curl_easy_setopt(c, CURLOPT_POSTFIELDSIZE_LARGE, (curl_off_t)job->body->size);
	} else {
		curl_easy_setopt(c, CURLOPT_HTTPGET, 1L);
	}
	code = code ? code : start(x, &x->lanes[0], job->url, error);
	x->end.done = code != ECO_OK;
	return code;
}

const struct view_exchange_end *view_exchange_end(const struct view_exchange *x)
{
	return &x->end;
}
