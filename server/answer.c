#define XXH_STATIC_LINKING_ONLY
#include <xxhash.h>

#include "server/answer.h"

#include <fcntl.h>
#include <microhttpd.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "ecofiles/base/version.h"
#include "ecofiles/format/chunk/chunk.h"
#include "ecofiles/format/wire.h"
#include "server/access.h"
#include "server/log.h"
#include "server/request/query.h"

#define LARGE_BYTES (128u << 10)         /* chunks of so many are sent from their file */
#define IMMUTABLE "max-age=31536000, immutable"

void srv_answer_add(struct srv_answer *answer, const char *name, const char *value)
{
	if (answer->response && value && MHD_add_response_header(answer->response, name, value) != MHD_YES)
		/* an answer without a header it needs would be a wrong answer */
		srv_answer_free(answer);
}

static void add_validators(struct srv_answer *answer, const struct srv_validators *validators,
	const char *cache_control)
{
	char date[SRV_DATE_BYTES] = "";
	if (!validators->etag[0]) {
		srv_answer_add(answer, MHD_HTTP_HEADER_CACHE_CONTROL, "no-store");
		return;
	}
	srv_answer_add(answer, MHD_HTTP_HEADER_ETAG, validators->etag);
	if (validators->modified_s)
		srv_date_format(date, validators->modified_s);
	srv_answer_add(answer, MHD_HTTP_HEADER_LAST_MODIFIED, date[0] ? date : NULL);
	char text[80];
	snprintf(text, sizeof text, "private, %s", cache_control);
	srv_answer_add(answer, MHD_HTTP_HEADER_CACHE_CONTROL, validators->is_private ? text : cache_control);
}

/* Headers of a plan, a stream or a description. */
static void add_head(struct srv_answer *answer, const char *type, const struct srv_validators *validators,
	const char *timing)
{
	srv_answer_add(answer, MHD_HTTP_HEADER_CONTENT_TYPE, type);
	add_validators(answer, validators, "no-cache");
	srv_answer_add(answer, "Server-Timing", timing);
}

void srv_answer_allow_origin(struct srv_answer *answer, const char *origin, bool varies)
{
	if (varies)
		srv_answer_add(answer, MHD_HTTP_HEADER_VARY, MHD_HTTP_HEADER_ORIGIN);
	if (!origin)
		return;
	srv_answer_add(answer, "Access-Control-Allow-Origin", origin);
	srv_answer_add(answer, "Access-Control-Expose-Headers", "ETag, Server-Timing, X-Request-Id, Retry-After, "
		"Content-Range");
}

/* `bytes` outlive the answer. */
static void answer_bytes(struct srv_answer *answer, unsigned status, const void *bytes, size_t size, const char *type)
{
	*answer = (struct srv_answer){ .status = status, .size_bytes = size,
		.response = MHD_create_response_from_buffer(size, (void *)bytes, MHD_RESPMEM_PERSISTENT) };
	srv_answer_add(answer, MHD_HTTP_HEADER_CONTENT_TYPE, type);
}

/* Takes json->out, without what its buffer has left. */
static void answer_text(struct srv_answer *answer, unsigned status, struct srv_json *json, const char *type)
{
	uint8_t *bytes = realloc(json->out.bytes, json->out.size + 1);
	json->out.bytes = bytes ? bytes : json->out.bytes;
	*answer = (struct srv_answer){ .status = status, .size_bytes = json->out.size,
		.memory_bytes = status == MHD_HTTP_OK ? json->out.size : 0 };
	if (!json->out.failed)
		answer->response = MHD_create_response_from_buffer(json->out.size, json->out.bytes,
			MHD_RESPMEM_MUST_FREE);
	if (answer->response)
		json->out = (struct eco_writer){ 0 };
	eco_writer_free(&json->out);
	srv_answer_add(answer, MHD_HTTP_HEADER_CONTENT_TYPE, type);
}

void srv_answer_problem(struct srv_answer *answer, const struct srv_problem_details *details)
{
	struct srv_json json = { 0 };
	srv_problem_write(&json, details->problem, details->detail, details->instance);
	answer_text(answer, srv_problem_rows[details->problem].status, &json, "application/problem+json");
	srv_answer_add(answer, MHD_HTTP_HEADER_CACHE_CONTROL, "no-store");
	srv_answer_add(answer, MHD_HTTP_HEADER_ALLOW, details->allow);
	if (answer->status == MHD_HTTP_SERVICE_UNAVAILABLE)
		srv_answer_add(answer, MHD_HTTP_HEADER_RETRY_AFTER, "1");
	if (answer->status == MHD_HTTP_UNAUTHORIZED)
		srv_answer_add(answer, MHD_HTTP_HEADER_WWW_AUTHENTICATE, "Bearer");
	if (details->close)
		srv_answer_add(answer, MHD_HTTP_HEADER_CONNECTION, "close");
}

void srv_answer_json(struct srv_answer *answer, struct srv_json *json, const struct srv_validators *validators)
{
	answer_text(answer, MHD_HTTP_OK, json, NULL);
	add_head(answer, "application/json", validators, NULL);
}

void srv_answer_metrics(struct srv_answer *answer, struct eco_writer *text)
{
	struct srv_json as_is = { .out = *text };
	*text = (struct eco_writer){ 0 };
	answer_text(answer, MHD_HTTP_OK, &as_is, "text/plain; version=0.0.4; charset=utf-8");
	srv_answer_add(answer, MHD_HTTP_HEADER_CACHE_CONTROL, "no-store");
}

void srv_answer_options(struct srv_answer *answer, const char *allow)
{
	answer_bytes(answer, MHD_HTTP_NO_CONTENT, "", 0, NULL);
	srv_answer_add(answer, MHD_HTTP_HEADER_ALLOW, allow);
	srv_answer_add(answer, "Access-Control-Allow-Methods", allow);
	srv_answer_add(answer, "Access-Control-Allow-Headers",
		"Authorization, Content-Type, If-None-Match, Range");
	srv_answer_add(answer, "Access-Control-Max-Age", "600");
}

static ssize_t read_nothing(void *ctx, uint64_t position, char *block, size_t room)
{
	(void)ctx;
	(void)position;
	(void)block;
	(void)room;
	return MHD_CONTENT_READER_END_WITH_ERROR;
}

void srv_answer_head(struct srv_answer *answer, unsigned status, uint64_t size_bytes, const char *type,
	const struct srv_validators *validators)
{
	uint64_t size = size_bytes == SRV_SIZE_UNKNOWN ? MHD_SIZE_UNKNOWN : size_bytes;
	*answer = (struct srv_answer){ .status = status,
		.response = MHD_create_response_from_callback(size, 1, read_nothing, NULL, NULL) };
	/* else the library would send the end of a chunked body behind a 304 */
	if (answer->response && size_bytes == SRV_SIZE_UNKNOWN)
		MHD_set_response_options(answer->response, MHD_RF_HTTP_1_0_COMPATIBLE_STRICT, MHD_RO_END);
	add_head(answer, type, validators, NULL);
}

void srv_answer_failed_condition(struct srv_answer *answer, const char *instance)
{
	srv_answer_problem(answer, &(struct srv_problem_details){ .problem = SRV_PROBLEM_PRECONDITION,
		.detail = "If-Match or If-Unmodified-Since does not hold of what is served; ask without it",
		.instance = instance });
}

/* A 304 is the 200 without its body: the library sends the head, with the length that the body would have, as
 * RFC 9110 wants it (an empty response would claim a length of 0). */
void srv_answer_judge(struct srv_answer *answer, const struct srv_conditions *conditions,
	const struct srv_validators *validators, const char *instance)
{
	const char *etag = validators->etag[0] ? validators->etag : NULL;
	enum srv_verdict verdict = srv_conditions_judge(conditions, etag, validators->modified_s);
	if (verdict == SRV_VERDICT_NOT_MODIFIED) {
		answer->status = MHD_HTTP_NOT_MODIFIED;
		answer->size_bytes = 0;
	} else if (verdict == SRV_VERDICT_FAILED) {
		srv_answer_free(answer);
		srv_answer_failed_condition(answer, instance);
	}
}

/* A page runs what this server sends, and nothing else. */
#define SITE_POLICY "default-src 'self'; script-src 'self' 'wasm-unsafe-eval'; img-src 'self' blob: data:; " \
	"connect-src 'self' data:; base-uri 'none'; form-action 'none'; frame-ancestors 'self'"

void srv_answer_file(struct srv_answer *answer, const struct srv_site_file *file, enum srv_form form,
	bool immutable, const char *frames, const struct srv_validators *validators)
{
	char policy[sizeof SITE_POLICY + SRV_FRAMES_BYTES];
	snprintf(policy, sizeof policy, SITE_POLICY "%s", frames);
	answer_bytes(answer, MHD_HTTP_OK, file->forms[form].bytes, file->forms[form].size, file->type);
	srv_answer_add(answer, MHD_HTTP_HEADER_CONTENT_ENCODING, srv_form_names[form]);
	srv_answer_add(answer, MHD_HTTP_HEADER_VARY, MHD_HTTP_HEADER_ACCEPT_ENCODING);
	srv_answer_add(answer, "Content-Security-Policy", policy);
	srv_answer_add(answer, "X-Content-Type-Options", "nosniff");
	add_validators(answer, validators, immutable ? "public, " IMMUTABLE : "no-cache");
}

void srv_answer_no_page(struct srv_answer *answer, const char *html)
{
	answer_bytes(answer, MHD_HTTP_NOT_FOUND, html, strlen(html), "text/html; charset=utf-8");
	srv_answer_add(answer, MHD_HTTP_HEADER_CACHE_CONTROL, "no-store");
	srv_answer_add(answer, "Content-Security-Policy",
		"default-src 'none'; base-uri 'none'; form-action 'none'");
}

void srv_answer_elsewhere(struct srv_answer *answer, const char *location)
{
	answer_bytes(answer, MHD_HTTP_TEMPORARY_REDIRECT, "", 0, NULL);
	srv_answer_add(answer, MHD_HTTP_HEADER_LOCATION, location);
	srv_answer_add(answer, MHD_HTTP_HEADER_CACHE_CONTROL, "no-cache");
}

/* ---- Streams ---- */

#define BLOCK_BYTES (128u << 10)

/* Source of a response's body: its pieces, and the position in them. */
struct body_reader {
	struct srv_body body;
	uint32_t piece;
	size_t at;
};

static void free_reader(void *reader)
{
	srv_body_free(&((struct body_reader *)reader)->body);
	free(reader);
}

/* The library asks for consecutive blocks, since the response is sent once. */
static ssize_t read_body(void *ctx, uint64_t position, char *block, size_t room)
{
	struct body_reader *reader = ctx;
	size_t size = 0;
	(void)position;
	while (size < room && reader->piece < reader->body.piece_count) {
		const struct srv_piece *piece = &reader->body.pieces[reader->piece];
		size_t part = piece->size - reader->at < room - size ? piece->size - reader->at : room - size;
		if (part)
			memcpy(block + size, (const char *)piece->bytes + reader->at, part);
		size += part;
		reader->at += part;
		if (reader->at == piece->size) {
			reader->piece++;
			reader->at = 0;
		}
	}
	return size ? (ssize_t)size : MHD_CONTENT_READER_END_OF_STREAM;
}

/* By blocks and not by MHD_create_response_from_iovec: that copies its vector into the connection's 16 KiB,
 * and where it does not fit (500 chunks) libmicrohttpd 0.9.75 unlocks a mutex that is not locked and aborts
 * later. One copy into a block costs little beside the sending. */
void srv_answer_body(struct srv_answer *answer, struct srv_body *body, const char *type,
	const struct srv_validators *validators, const char *timing)
{
	*answer = (struct srv_answer){ .status = MHD_HTTP_OK, .size_bytes = body->size_bytes,
		.memory_bytes = body->frames.capacity + body->piece_count * sizeof *body->pieces + BLOCK_BYTES };
	struct body_reader *reader = malloc(sizeof *reader);
	if (reader) {
		*reader = (struct body_reader){ .body = *body };
		answer->response = MHD_create_response_from_callback(body->size_bytes, BLOCK_BYTES, read_body,
			reader, free_reader);
	}
	if (answer->response) {
		*body = (struct srv_body){ 0 };
	} else {
		free(reader);
		srv_body_free(body);
	}
	add_head(answer, type, validators, timing);
}

static void release_kept(void *body)
{
	srv_kept_body_release(body);
}

void srv_answer_kept(struct srv_answer *answer, struct srv_kept_body *body, const char *type,
	const struct srv_validators *validators, const char *timing)
{
	*answer = (struct srv_answer){ .status = MHD_HTTP_OK, .size_bytes = body->size,
		.memory_bytes = body->size };
	answer->response = MHD_create_response_from_buffer_with_free_callback_cls(body->size, body->bytes,
		release_kept, body);
	if (answer->response)
		srv_kept_body_hold(body);
	add_head(answer, type, validators, timing);
}

struct srv_kept_body *srv_kept_body_copy(const struct srv_piece *pieces, uint32_t count, uint64_t size)
{
	struct srv_kept_body *body = srv_kept_body_make(size);
	uint8_t *at = body ? body->bytes : NULL;
	for (uint32_t i = 0; body && i < count; i++) {
		if (pieces[i].size)
			memcpy(at, pieces[i].bytes, pieces[i].size);
		at += pieces[i].size;
	}
	return body;
}

void srv_answer_no_stream(struct srv_answer *answer, const char *timing)
{
	answer_bytes(answer, MHD_HTTP_NO_CONTENT, "", 0, NULL);
	srv_answer_add(answer, MHD_HTTP_HEADER_CACHE_CONTROL, "no-store");
	srv_answer_add(answer, "Server-Timing", timing);
}

/* ---- Chunks ---- */

void srv_etag_of(char etag[SRV_ETAG_BYTES], const struct eco_chunk_id *id)
{
	char text[SRV_ID_TEXT_BYTES];
	srv_format_id(text, id);
	snprintf(etag, SRV_ETAG_BYTES, "\"%s\"", text);
}

void srv_etag_request(char etag[SRV_ETAG_BYTES], const struct srv_scene *scene, const uint64_t limits[3],
	const char *target)
{
	struct eco_chunk_id id;
	XXH3_state_t state;
	XXH128_canonical_t hash;
	XXH3_INITSTATE(&state);
	XXH3_128bits_reset(&state);
	XXH3_128bits_update(&state, scene->pack->id.bytes, sizeof scene->pack->id.bytes);
	XXH3_128bits_update(&state, ECO_VERSION, sizeof ECO_VERSION);
	XXH3_128bits_update(&state, limits, 3 * sizeof *limits);
	XXH3_128bits_update(&state, target, strlen(target));
	XXH128_canonicalFromHash(&hash, XXH3_128bits_digest(&state));
	memcpy(id.bytes, hash.digest, sizeof id.bytes);
	srv_etag_of(etag, &id);
}

/* Large chunks are sent from their pack's private copy, which spares a copy (sendfile; lod/EXPERIMENTS.md,
 * Chunks by sendfile). Without a descriptor they are sent from memory. */
static bool answer_file_part(struct srv_answer *answer, const struct srv_scene *scene, uint64_t offset, size_t size)
{
	int file = size >= LARGE_BYTES && scene->pack->file >= 0 ? fcntl(scene->pack->file, F_DUPFD_CLOEXEC, 0) : -1;
	if (file < 0)
		return false;
	*answer = (struct srv_answer){ .size_bytes = size,
		.response = MHD_create_response_from_fd_at_offset64(size, file, offset) };
	if (!answer->response)
		close(file);
	return answer->response;
}

static void answer_range(struct srv_answer *answer, const struct srv_scene *scene, uint32_t chunk,
	const struct srv_range *range, const uint8_t *bytes, const struct srv_validators *validators)
{
	char text[80];
	size_t size = scene->pack->scene.chunks[chunk].size_bytes, part = (size_t)(range->end - range->first);
	if (!answer_file_part(answer, scene, scene->pack->scene.chunks[chunk].offset + range->first, part))
		answer_bytes(answer, 0, bytes + range->first, part, NULL);
	answer->status = range->kind == SRV_RANGE_PART ? MHD_HTTP_PARTIAL_CONTENT : MHD_HTTP_OK;
	srv_answer_add(answer, MHD_HTTP_HEADER_CONTENT_TYPE, "application/octet-stream");
	srv_answer_add(answer, MHD_HTTP_HEADER_ACCEPT_RANGES, "bytes");
	add_validators(answer, validators, validators->is_private ? IMMUTABLE : "public, " IMMUTABLE);
	snprintf(text, sizeof text, "bytes %llu-%llu/%zu", (unsigned long long)range->first,
		(unsigned long long)range->end - 1, size);
	srv_answer_add(answer, MHD_HTTP_HEADER_CONTENT_RANGE, range->kind == SRV_RANGE_PART ? text : NULL);
}

static void answer_outside(struct srv_answer *answer, size_t size, const char *instance)
{
	char text[80];
	snprintf(text, sizeof text, "the chunk has %zu bytes", size);
	srv_answer_problem(answer, &(struct srv_problem_details){ .problem = SRV_PROBLEM_RANGE,
		.detail = text, .instance = instance });
	snprintf(text, sizeof text, "bytes */%zu", size);
	srv_answer_add(answer, MHD_HTTP_HEADER_CONTENT_RANGE, text);
}

void srv_answer_chunk(struct srv_answer *answer, const struct srv_scene *scene, uint32_t chunk,
	const struct srv_conditions *conditions, struct srv_chunk_terms terms, const char *instance)
{
	struct srv_validators validators = { .modified_s = scene->modified_s, .is_private = terms.is_private };
	const uint8_t *bytes;
	size_t size;
	struct eco_error error = { 0 };
	enum eco_code code = srv_scene_payload(scene, chunk, &bytes, &size, &error);
	if (code) {
		srv_trace(SRV_TRACE_CACHE, "%s: chunk %u refused: %s", scene->name, chunk, error.text);
		srv_answer_problem(answer, &(struct srv_problem_details){ .problem = srv_problem_of(code),
			.detail = error.text, .instance = instance });
		return;
	}
	srv_etag_of(validators.etag, &scene->pack->scene.chunks[chunk].id);
	bool go = srv_conditions_judge(conditions, validators.etag, validators.modified_s) == SRV_VERDICT_GO;
	/* If-Range compares strongly: only our own tag, as it is, lets the range count. */
	bool wants_part = go && terms.get
		&& (!conditions->if_range || strcmp(conditions->if_range, validators.etag) == 0);
	struct srv_range range = srv_range_parse(wants_part ? conditions->range : NULL, size);
	if (range.kind == SRV_RANGE_OUTSIDE) {
		answer_outside(answer, size, instance);
		return;
	}
	answer_range(answer, scene, chunk, &range, bytes, &validators);
	srv_answer_judge(answer, conditions, &validators, instance);
}

void srv_answer_free(struct srv_answer *answer)
{
	if (answer->response)
		MHD_destroy_response(answer->response);
	answer->response = NULL;
}
