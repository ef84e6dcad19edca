/* Responses of the HTTP library with their headers. */
#include "server/exchange.h"

#include <fcntl.h>
#include <microhttpd.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>


#define LARGE_BYTES (128u << 10)         /* chunks of so many are sent from their file */
#define BLOCK_BYTES (128u << 10)

void srv_answer_free(struct srv_exchange *exchange)
{
	if (exchange->answer.response)
		MHD_destroy_response(exchange->answer.response);
	exchange->answer.response = NULL;
}

void srv_answer_add(struct srv_exchange *exchange, const char *name, const char *value)
{
	struct MHD_Response *response = exchange->answer.response;
	if (response && value && MHD_add_response_header(response, name, value) != MHD_YES)
		/* an answer without a header it needs would be a wrong answer */
		srv_answer_free(exchange);
}

void srv_answer_add_validators(struct srv_exchange *exchange, const char *cache_control)
{
	char date[SRV_DATE_BYTES] = "", text[80];
	if (!exchange->etag[0]) {
		srv_answer_add(exchange, MHD_HTTP_HEADER_CACHE_CONTROL, "no-store");
		return;
	}
	srv_answer_add(exchange, MHD_HTTP_HEADER_ETAG, exchange->etag);
	if (exchange->modified_s)
		srv_date_format(date, exchange->modified_s);
	srv_answer_add(exchange, MHD_HTTP_HEADER_LAST_MODIFIED, date[0] ? date : NULL);
	snprintf(text, sizeof text, "private, %s", cache_control);
	srv_answer_add(exchange, MHD_HTTP_HEADER_CACHE_CONTROL, exchange->is_private ? text : cache_control);
}

static void set(struct srv_exchange *exchange, unsigned status, uint64_t size, struct MHD_Response *response,
	const char *type)
{
	exchange->answer = (struct srv_answer){ response, status, size, 0 };
	srv_answer_add(exchange, MHD_HTTP_HEADER_CONTENT_TYPE, type);
}

void srv_answer_bytes(struct srv_exchange *exchange, unsigned status, const void *bytes, size_t size, const char *type)
{
	set(exchange, status, size, MHD_create_response_from_buffer(size, (void *)bytes, MHD_RESPMEM_PERSISTENT), type);
}

void srv_answer_text(struct srv_exchange *exchange, unsigned status, struct eco_writer *text, const char *type)
{
	uint8_t *bytes = realloc(text->bytes, text->size + 1);   /* without what its buffer has left */
	text->bytes = bytes ? bytes : text->bytes;
	struct MHD_Response *response = text->failed ? NULL : MHD_create_response_from_buffer(text->size,
		text->bytes, MHD_RESPMEM_MUST_FREE);
	set(exchange, status, text->size, response, type);
	exchange->answer.memory_bytes = status == MHD_HTTP_OK ? text->size : 0;
	if (response)
		*text = (struct eco_writer){ 0 };
	eco_writer_free(text);
}

void srv_exchange_problem(struct srv_exchange *exchange, enum srv_problem problem, const char *format, ...)
{
	char path[SRV_TARGET_BYTES_MAX], detail[SRV_TARGET_BYTES_MAX];
	struct srv_json json = { 0 };
	unsigned status = srv_problem_rows[problem].status;
	va_list arguments;
	va_start(arguments, format);
	vsnprintf(detail, sizeof detail, format, arguments);
	va_end(arguments);
	snprintf(path, sizeof path, "%.*s", (int)strcspn(exchange->raw, "?"), exchange->raw);
	srv_problem_write(&json, problem, detail, exchange->target_code ? NULL : path);
	srv_answer_free(exchange);
	srv_answer_text(exchange, status, &json.out, "application/problem+json");
	srv_answer_add(exchange, MHD_HTTP_HEADER_CACHE_CONTROL, "no-store");
	if (problem == SRV_PROBLEM_METHOD && exchange->route)
		srv_answer_add(exchange, MHD_HTTP_HEADER_ALLOW, exchange->route->allow);
	if (status == MHD_HTTP_SERVICE_UNAVAILABLE)
		srv_answer_add(exchange, MHD_HTTP_HEADER_RETRY_AFTER, "1");
	if (status == MHD_HTTP_UNAUTHORIZED)
		srv_answer_add(exchange, MHD_HTTP_HEADER_WWW_AUTHENTICATE, "Bearer");
	if (exchange->closes)
		srv_answer_add(exchange, MHD_HTTP_HEADER_CONNECTION, "close");
}

static ssize_t read_nothing(void *ctx, uint64_t position, char *block, size_t room)
{
	(void)ctx, (void)position, (void)block, (void)room;
	return MHD_CONTENT_READER_END_WITH_ERROR;
}

void srv_answer_head(struct srv_exchange *exchange, unsigned status, uint64_t size_bytes, const char *type)
{
	uint64_t size = size_bytes == SRV_SIZE_UNKNOWN ? MHD_SIZE_UNKNOWN : size_bytes;
	struct MHD_Response *response = MHD_create_response_from_callback(size, 1, read_nothing, NULL, NULL);
	/* else the library would send the end of a chunked body behind a 304 */
	if (response && size_bytes == SRV_SIZE_UNKNOWN)
		MHD_set_response_options(response, MHD_RF_HTTP_1_0_COMPATIBLE_STRICT, MHD_RO_END);
	set(exchange, status, 0, response, type);
	srv_answer_add_validators(exchange, "no-cache");
}

/* A 304 is the 200 without its body: the library sends the head, with the length that the body would have, as
 * RFC 9110 wants it (an empty response would claim a length of 0). */
void srv_answer_judge(struct srv_exchange *exchange)
{
	struct srv_answer *answer = &exchange->answer;
	if (!answer->response || answer->status / 100 != 2)
		return;
	enum srv_verdict verdict = srv_conditions_judge(&exchange->conditions, exchange->etag[0] ? exchange->etag
		: NULL, exchange->modified_s);
	if (verdict == SRV_VERDICT_NOT_MODIFIED) {
		answer->status = MHD_HTTP_NOT_MODIFIED;
		answer->size_bytes = 0;
	} else if (verdict == SRV_VERDICT_FAILED) {
		srv_exchange_problem(exchange, SRV_PROBLEM_PRECONDITION,
			"If-Match or If-Unmodified-Since does not hold of what is served; ask without it");
	}
}

void srv_answer_validate(struct srv_exchange *exchange, const struct srv_scene *scene)
{
	exchange->etag[0] = 0;
	exchange->modified_s = scene->modified_s;
	exchange->is_private = srv_access_is_private(exchange->daemon->config.access, scene->name);
}

void srv_etag_of(char etag[SRV_ETAG_BYTES], const struct eco_chunk_id *id)
{
	snprintf(etag, SRV_ETAG_BYTES, "\"%s\"", eco_id_text(id->bytes).hex);
}

/* ---- Streams ---- */

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
void srv_answer_body(struct srv_exchange *exchange, struct srv_body *body, const char *type)
{
	uint64_t size = body->size_bytes, memory = body->frames.capacity + body->piece_count * sizeof *body->pieces
		+ BLOCK_BYTES;
	struct body_reader *reader = malloc(sizeof *reader);
	struct MHD_Response *response = NULL;
	if (reader) {
		*reader = (struct body_reader){ .body = *body };
		response = MHD_create_response_from_callback(size, BLOCK_BYTES, read_body, reader, free_reader);
	}
	if (response) {
		*body = (struct srv_body){ 0 };
	} else {
		free(reader);
		srv_body_free(body);
	}
	set(exchange, MHD_HTTP_OK, size, response, type);
	exchange->answer.memory_bytes = memory;
	srv_answer_add_validators(exchange, "no-cache");
}

static void release_kept(void *body)
{
	srv_kept_body_release(body);
}

void srv_answer_kept(struct srv_exchange *exchange, struct srv_kept_body *body, const char *type)
{
	struct MHD_Response *response = MHD_create_response_from_buffer_with_free_callback_cls(body->size,
		body->bytes, release_kept, body);
	if (response)
		srv_kept_body_hold(body);
	set(exchange, MHD_HTTP_OK, body->size, response, type);
	exchange->answer.memory_bytes = body->size;
	srv_answer_add_validators(exchange, "no-cache");
}

/* ---- Chunks ---- */

/* Large chunks are sent from their pack's private copy, which spares a copy (sendfile; lod/EXPERIMENTS.md,
 * Chunks by sendfile). NULL: without a descriptor they are sent from memory. */
static struct MHD_Response *file_part(const struct srv_scene *scene, uint64_t offset, size_t size)
{
	int file = size >= LARGE_BYTES && scene->pack->file >= 0 ? fcntl(scene->pack->file, F_DUPFD_CLOEXEC, 0) : -1;
	struct MHD_Response *response = file < 0 ? NULL : MHD_create_response_from_fd_at_offset64(size, file, offset);
	if (file >= 0 && !response)
		close(file);
	return response;
}

void srv_answer_chunk(struct srv_exchange *exchange, const struct srv_scene *scene, uint32_t chunk)
{
	static const char octets[] = "application/octet-stream", for_ever[] = "public, " SRV_IMMUTABLE;
	const struct srv_conditions *conditions = &exchange->conditions;
	const uint8_t *bytes;
	char text[80];
	size_t size;
	struct eco_error error = { 0 };
	enum eco_code code = srv_scene_payload(scene, chunk, &bytes, &size, &error);
	if (code) {
		srv_trace(SRV_TRACE_CACHE, "%s: chunk %u refused: %s", scene->name, chunk, error.text);
		srv_exchange_problem(exchange, srv_problem_of(code), "%s", error.text);
		return;
	}
	srv_answer_validate(exchange, scene);
	srv_etag_of(exchange->etag, &scene->pack->scene.chunks[chunk].id);
	/* If-Range compares strongly: only our own tag, as it is, lets the range count. */
	bool wants_part = exchange->method == SRV_METHOD_GET
		&& srv_conditions_judge(conditions, exchange->etag, exchange->modified_s) == SRV_VERDICT_GO
		&& (!conditions->if_range || strcmp(conditions->if_range, exchange->etag) == 0);
	struct srv_range range = srv_range_parse(wants_part ? conditions->range : NULL, size);
	bool outside = range.kind == SRV_RANGE_OUTSIDE, is_part = range.kind == SRV_RANGE_PART;
	size_t part = (size_t)(range.end - range.first);
	if (outside) {
		srv_exchange_problem(exchange, SRV_PROBLEM_RANGE, "the chunk has %zu bytes", size);
		snprintf(text, sizeof text, "bytes */%zu", size);
	} else {
		unsigned status = is_part ? MHD_HTTP_PARTIAL_CONTENT : MHD_HTTP_OK;
		struct MHD_Response *response = file_part(scene, scene->pack->scene.chunks[chunk].offset
			+ range.first, part);
		if (response)
			set(exchange, status, part, response, octets);
		else
			srv_answer_bytes(exchange, status, bytes + range.first, part, octets);
		srv_answer_add(exchange, MHD_HTTP_HEADER_ACCEPT_RANGES, "bytes");
		srv_answer_add_validators(exchange, exchange->is_private ? SRV_IMMUTABLE : for_ever);
		snprintf(text, sizeof text, "bytes %llu-%llu/%zu", (unsigned long long)range.first,
			(unsigned long long)range.end - 1, size);
	}
	srv_answer_add(exchange, MHD_HTTP_HEADER_CONTENT_RANGE, outside || is_part ? text : NULL);
	srv_answer_judge(exchange);
}
