/* Wanted chunks stand in an array in the order of their names in the stream, found by the first bytes of
 * their ids in a table; a few of them at a time are being fetched. */
#include "client-min/view_chunks.h"

#include <curl/curl.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "client-min/view_query.h"
#include "client-min/view_store.h"
#include "client-min/view_table.h"
#include "ecofiles/base/array_grow.h"
#include "ecofiles/base/version.h"
#include "ecofiles/format/chunk/chunk.h"

#define URL_MOST 2000u
#define URL_ROOM (URL_MOST + 40)
#define AT_ONCE 8u                       /* chunks that are being fetched */
#define WAIT_MS 100
#define SLOW_BYTES_S 1024L
#define RETRY_MAX_S 30                   /* that a server or a host may ask to wait */
#define RETRY_MIN_MS 100.0
#define SILENT_MS 10000.0                /* of a host that hangs; no longer than stall_ms */

enum phase { PHASE_WAITS, PHASE_COMES, PHASE_HERE, PHASE_FAILED };

struct wanted {
	struct eco_chunk_id id;
	uint8_t *bytes;
	uint32_t size, have;
	enum phase phase;
	bool again;                              /* it failed once, and is asked for again */
	bool damaged;                            /* a failure: other bytes came; else: */
	long status;                             /* HTTP; 0: `text` says what happened */
	char text[160];
};

struct lane {
	CURL *curl;
	struct view_chunks *chunks;
	uint32_t wanted;
	bool busy, rests;                        /* rests: busy, until the host wants to be asked */
	char text[CURL_ERROR_SIZE];              /* of a failure: how long, how much, to where */
};

struct view_chunks {
	struct view_chunks_options options;
	char *url;
	CURLM *multi;
	struct lane lanes[AT_ONCE];
	struct wanted *wanted;           uint32_t count, room;
	struct view_table table;         /* first 8 bytes of an id -> index in `wanted` */
	uint32_t next;                   /* those before it have been begun */
	bool known;                      /* the host has sent a chunk, or said that it has trouble, once */
	/* the host is not asked before; since when it only says so, 0: it does not */
	double rest_until_ms, resting_ms;
	double waited_ms;                /* for the bytes that come next */
	uint64_t heard_bytes;            /* meanwhile */
	bool hangs;
};

/* A host that drips hangs, too: only so many bytes are heard. */
static double silent_ms(const struct view_chunks *chunks)
{
	return fmin((double)chunks->options.stall_ms, SILENT_MS);
}

static void hear(struct view_chunks *chunks, size_t size)
{
	chunks->heard_bytes += size;
	if ((double)chunks->heard_bytes < silent_ms(chunks) * SLOW_BYTES_S / 1000)
		return;
	chunks->waited_ms = 0;
	chunks->heard_bytes = 0;
}

static size_t on_bytes(char *bytes, size_t one, size_t size, void *ctx)
{
	const struct lane *lane = ctx;
	struct wanted *w = &lane->chunks->wanted[lane->wanted];
	size *= one;
	if (size > w->size - w->have)
		return 0;
	hear(lane->chunks, size);
	memcpy(w->bytes + w->have, bytes, size);
	w->have += (uint32_t)size;
	return size;
}

CURL *view_curl_new(const char *agent, long connect_ms)
{
	CURL *c = curl_easy_init();
	if (!c)
		return NULL;
	curl_easy_setopt(c, CURLOPT_NOSIGNAL, 1L);
	curl_easy_setopt(c, CURLOPT_TCP_NODELAY, 1L);
	curl_easy_setopt(c, CURLOPT_CONNECTTIMEOUT_MS, connect_ms);
	curl_easy_setopt(c, CURLOPT_USERAGENT, agent);
	curl_easy_setopt(c, CURLOPT_PROTOCOLS_STR, "http,https");
	curl_easy_setopt(c, CURLOPT_MAXREDIRS, 5L);      /* to where a host keeps a file: of buckets, CDNs, to https */
	return c;
}

static const char *header_of(CURL *curl, const char *name)
{
	struct curl_header *header;
	return curl_easy_header(curl, name, 0, CURLH_HEADER, -1, &header) ? "" : header->value;
}

double view_retry_ms(CURL *curl)
{
	char *end;
	const char *value = header_of(curl, "Retry-After");
	double s = strtod(value, &end);
	return end > value && s >= 0 && s <= RETRY_MAX_S ? fmax(s * 1e3, RETRY_MIN_MS) : 0;
}

double view_plan_ms(CURL *curl)
{
	return view_plan_ms_read(header_of(curl, "Server-Timing"));
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

static bool make_lane(struct view_chunks *chunks, struct lane *lane)
{
	CURL *c = lane->curl = view_curl_new("ecostream/" ECO_VERSION, chunks->options.connect_ms);
	lane->chunks = chunks;
	if (!c)
		return false;
	curl_easy_setopt(c, CURLOPT_FAILONERROR, 1L);
	curl_easy_setopt(c, CURLOPT_LOW_SPEED_LIMIT, SLOW_BYTES_S);
	curl_easy_setopt(c, CURLOPT_LOW_SPEED_TIME, (chunks->options.stall_ms + 999) / 1000);
	curl_easy_setopt(c, CURLOPT_FOLLOWLOCATION, 1L);
	curl_easy_setopt(c, CURLOPT_WRITEFUNCTION, on_bytes);
	curl_easy_setopt(c, CURLOPT_WRITEDATA, lane);
	curl_easy_setopt(c, CURLOPT_PRIVATE, lane);
	curl_easy_setopt(c, CURLOPT_ERRORBUFFER, lane->text);
	return true;
}

enum eco_code view_chunks_check_url(const char *url, struct eco_error *error)
{
	if ((strncmp(url, "http://", 7) != 0 && strncmp(url, "https://", 8) != 0) || strpbrk(url, "?# ")
			|| strlen(url) > URL_MOST)
		return eco_fail(error, ECO_BAD_USAGE, "'%.200s' is no URL that chunks can lie below: it "
			"should look like http://host/chunks", url);
	return ECO_OK;
}

enum eco_code view_chunks_new(struct view_chunks **out, const struct view_chunks_options *options,
	struct eco_error *error)
{
	enum eco_code code = view_chunks_check_url(options->url, error);
	*out = NULL;
	if (code)
		return code;
	struct view_chunks *chunks = *out = calloc(1, sizeof *chunks);
	bool good = chunks && (chunks->multi = curl_multi_init())
		&& (chunks->url = strndup(options->url, (size_t)view_url_length(options->url)));
	if (good)
		chunks->options = *options;
	for (uint32_t i = 0; good && i < AT_ONCE; i++)
		good = make_lane(chunks, &chunks->lanes[i]);
	if (good)
		return ECO_OK;
	view_chunks_free(chunks);
	*out = NULL;
	return eco_no_memory(error, "connections");
}

void view_chunks_free(struct view_chunks *chunks)
{
	if (!chunks)
		return;
	view_chunks_forget(chunks);
	for (uint32_t i = 0; i < AT_ONCE; i++)
		curl_easy_cleanup(chunks->lanes[i].curl);
	curl_multi_cleanup(chunks->multi);
	free(chunks->wanted);
	free(chunks->url);
	free(chunks);
}

void view_chunks_forget(struct view_chunks *chunks)
{
	for (uint32_t i = 0; i < AT_ONCE; i++)
		if (chunks->lanes[i].busy) {
			if (!chunks->lanes[i].rests)
				curl_multi_remove_handle(chunks->multi, chunks->lanes[i].curl);
			chunks->lanes[i].busy = chunks->lanes[i].rests = false;
		}
	for (uint32_t i = 0; i < chunks->count; i++)
		free(chunks->wanted[i].bytes);
	view_table_free(&chunks->table);
	chunks->count = chunks->next = 0;
	chunks->waited_ms = 0;
	chunks->heard_bytes = 0;
}

/* ---- Fetching ---- */

static void url_of(const struct view_chunks *chunks, const struct eco_chunk_id *id, char *url, size_t room)
{
	char name[VIEW_ID_BYTES];
	snprintf(url, room, "%s/%s", chunks->url, view_id_write(id, name));
}

static void start(struct view_chunks *chunks, struct lane *lane)
{
	char url[URL_ROOM];
	lane->busy = true;
	lane->text[0] = 0;
	url_of(chunks, &chunks->wanted[lane->wanted].id, url, sizeof url);
	curl_easy_setopt(lane->curl, CURLOPT_URL, url);
	curl_multi_add_handle(chunks->multi, lane->curl);
}

/* Gives free lanes something to do, and those that have rested. Memory is taken here, not where a stream only
 * says a size. */
static void begin(struct view_chunks *chunks)
{
	if (view_clock_ms() < chunks->rest_until_ms)
		return;
	for (uint32_t i = 0; i < AT_ONCE; i++) {
		struct lane *lane = &chunks->lanes[i];
		if (lane->rests)
			start(chunks, lane);
		lane->rests = false;
	}
	for (uint32_t i = 0; i < AT_ONCE && chunks->next < chunks->count; i++) {
		struct lane *lane = &chunks->lanes[i];
		struct wanted *w = &chunks->wanted[chunks->next];
		if (lane->busy)
			continue;
		lane->wanted = chunks->next++;
		w->bytes = malloc(w->size);
		w->phase = w->bytes ? PHASE_COMES : PHASE_FAILED;
		if (w->bytes)
			start(chunks, lane);
		else
			snprintf(w->text, sizeof w->text, "no memory for %u bytes", w->size);
	}
}

static bool has_id(const struct wanted *w)
{
	struct eco_chunk_id id = eco_chunk_hash(w->bytes, w->size);
	return memcmp(id.bytes, w->id.bytes, sizeof id.bytes) == 0;
}

/* It has too much to do, or is asked too much: nothing is wrong with the address. */
static bool is_trouble(long status)
{
	return status >= 500 || status == 408 || status == 429;
}

/* A host that says when it wants to be asked again is not asked before, for as long as there is patience with
 * one that sends nothing but that. */
static bool rest(struct view_chunks *chunks, struct lane *lane)
{
	double now_ms = view_clock_ms(), wait_ms = view_retry_ms(lane->curl), until_ms = now_ms + wait_ms;
	long status = 0;
	curl_easy_getinfo(lane->curl, CURLINFO_RESPONSE_CODE, &status);
	if (!is_trouble(status) || !(wait_ms > 0))
		return false;
	if (!(chunks->resting_ms > 0))
		chunks->resting_ms = now_ms;
	if (until_ms > chunks->resting_ms + chunks->options.patience_ms)
		return false;
	chunks->rest_until_ms = fmax(chunks->rest_until_ms, until_ms);
	chunks->wanted[lane->wanted].have = 0;
	lane->busy = lane->rests = true;
	return true;
}

/* Once more at once: what fails then costs the rest of the stream again. */
static bool try_again(struct view_chunks *chunks, struct lane *lane)
{
	struct wanted *w = &chunks->wanted[lane->wanted];
	if (w->again)
		return false;
	w->again = true;
	w->have = 0;
	start(chunks, lane);
	return true;
}

static void end(struct view_chunks *chunks, struct lane *lane, CURLcode rc)
{
	struct wanted *w = &chunks->wanted[lane->wanted];
	bool came = !rc && w->have == w->size;
	curl_multi_remove_handle(chunks->multi, lane->curl);
	lane->busy = false;
	if (!came && (rest(chunks, lane) || try_again(chunks, lane)))
		return;
	if (came) {
		chunks->resting_ms = 0;
		w->damaged = !has_id(w);
	} else if (rc == CURLE_HTTP_RETURNED_ERROR)
		curl_easy_getinfo(lane->curl, CURLINFO_RESPONSE_CODE, &w->status);
	else if (rc && rc != CURLE_WRITE_ERROR)
		snprintf(w->text, sizeof w->text, "%.150s", lane->text[0] ? lane->text : curl_easy_strerror(rc));
	else
		snprintf(w->text, sizeof w->text, "it has not the %u bytes that the stream names", w->size);
	/* one that had chunks is down; of one that never had any the address may be wrong */
	chunks->hangs |= rc == CURLE_OPERATION_TIMEDOUT || (rc == CURLE_COULDNT_CONNECT && chunks->known);
	w->phase = came && !w->damaged ? PHASE_HERE : PHASE_FAILED;
	chunks->known |= w->phase == PHASE_HERE || is_trouble(w->status);
}

bool view_chunks_known(const struct view_chunks *chunks)
{
	return chunks->known;
}

bool view_chunks_hangs(const struct view_chunks *chunks)
{
	return chunks->hangs;
}

/* Moves on whatever has come. */
static void step(struct view_chunks *chunks)
{
	int running, left;
	begin(chunks);
	curl_multi_perform(chunks->multi, &running);
	for (CURLMsg *message; (message = curl_multi_info_read(chunks->multi, &left));) {
		struct lane *lane;
		CURLcode rc = message->data.result;
		curl_easy_getinfo(message->easy_handle, CURLINFO_PRIVATE, (char **)&lane);
		end(chunks, lane, rc);
	}
	begin(chunks);
}

/* ---- Wanted chunks ---- */

/* The index of a chunk that is wanted from now on; UINT32_MAX: no memory. */
static uint32_t index_of(struct view_chunks *chunks, const struct eco_chunk_id *id, uint32_t size)
{
	uint64_t key;
	memcpy(&key, id->bytes, sizeof key);
	uint32_t index = view_table_get(&chunks->table, key);
	if (index != UINT32_MAX || !eco_array_grow(&chunks->wanted, &chunks->room, chunks->count,
			sizeof *chunks->wanted) || !view_table_put(&chunks->table, key, chunks->count))
		return index;
	chunks->wanted[chunks->count] = (struct wanted){ .id = *id, .size = size };
	return chunks->count++;
}

enum eco_code view_chunks_want(struct view_chunks *chunks, const struct eco_chunk_id *id, uint32_t size,
	struct eco_error *error)
{
	if (index_of(chunks, id, size) == UINT32_MAX)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for %u named chunks", chunks->count);
	step(chunks);
	return ECO_OK;
}

static enum eco_code failed(const struct view_chunks *chunks, const struct wanted *w, struct eco_error *error)
{
	char url[URL_ROOM];
	url_of(chunks, &w->id, url, sizeof url);
	if (w->damaged)
		return eco_fail(error, ECO_DAMAGED, "%.250s: its bytes do not have the hash that names it; "
			"remove it there, and export it again", url);
	if (w->status)
		return eco_fail(error, ECO_IO, "%.250s: the host answered %ld%s", url, w->status,
			is_trouble(w->status) ? ""
			: "; it needs what `ecopack export` made of the pack that is served");
	return eco_fail(error, ECO_IO, "%.250s: %s", url, w->text);
}

enum eco_code view_chunks_take(struct view_chunks *chunks, const struct eco_chunk_id *id, uint32_t size,
	const uint8_t **bytes, struct eco_error *error)
{
	enum eco_code code = view_chunks_want(chunks, id, size, error);
	if (code)
		return code;
	const struct wanted *w = &chunks->wanted[index_of(chunks, id, size)];
	while (w->phase < PHASE_HERE) {
		double begun_ms = view_clock_ms();
		if (chunks->options.stop && *chunks->options.stop)
			return eco_fail(error, ECO_INTERRUPTED, "interrupted");
		chunks->hangs |= chunks->waited_ms > silent_ms(chunks);
		if (chunks->hangs)
			return eco_fail(error, ECO_IO, "%.250s: less than %ld bytes a second came for %g s",
				chunks->url, SLOW_BYTES_S, silent_ms(chunks) / 1000);
		curl_multi_poll(chunks->multi, NULL, 0, WAIT_MS, NULL);
		chunks->waited_ms += begun_ms < chunks->rest_until_ms ? 0 : view_clock_ms() - begun_ms;
		step(chunks);
	}
	if (w->phase == PHASE_FAILED)
		return failed(chunks, w, error);
	if (w->size != size || memcmp(&w->id, id, sizeof *id) != 0)
		return eco_fail(error, ECO_DAMAGED, "a chunk is named with %u bytes, then with %u "
			"or another name", w->size, size);
	*bytes = w->bytes;
	return ECO_OK;
}
