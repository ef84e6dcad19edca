/* Writes JSON into a growing buffer by formats that look like it:
 *
 *   srv_json_add(&json, "{scene:%s at:[%g %g] cuts:[", name, x, y);
 *   for (...) srv_json_add(&json, "{list:%u scale:%.9g}", cut->list, cut->scale);
 *   srv_json_add(&json, "]}");
 *
 * A writer of our own, because counts go up to 2^64 and plans have ten thousands of cuts, which a tree of
 * objects would hold twice. Nothing more is written once json.out.failed is set: without memory, beyond
 * `most`, or when it is cancelled. Long loops end then; srv_json_end says why. */
#pragma once

#include <stdatomic.h>

#include "ecofiles/base/bytes.h"
#include "ecofiles/base/status.h"

struct srv_json {
	struct eco_writer out;
	bool comma;                  /* the next value or key follows another */
	size_t most;                 /* bytes, about; 0: any number */
	const atomic_bool *cancelled;        /* or NULL */
};

/* Adds what `format` shows: brackets; keys of a-z and '_', with ':'; null; and values:
 *   %s text, NULL is null; bytes that are not UTF-8 become U+FFFD     %d bool
 *   %u, %lu count (unsigned, uint64_t)     %lx the same, null if it is UINT64_MAX
 *   %g the shortest number that reads back the same     %.9g nine digits, in a third of the time
 * Numbers that are not finite are null. Quotes and commas come by themselves; spaces separate words. */
void srv_json_add(struct srv_json *json, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* ECO_INTERRUPTED, ECO_TOO_LARGE or ECO_NO_MEMORY where it is not whole; frees it then. */
enum eco_code srv_json_end(struct srv_json *json);

/* ---- Problems ---- */

/* RFC 9457 problem documents. The detail is written where the problem is found:
 * what, which parameter, and what to do. */

/* Name, type, status and title of each. */
#define SRV_PROBLEMS(X) \
	X(TARGET, "malformed-target", 400, "The request target is malformed") \
	/* two parsers could read lengths or headers in two ways; the connection is closed */ \
	X(FRAMING, "ambiguous-framing", 400, "The request's headers or body length are not acceptable") \
	X(PARAMETER, "bad-parameter", 400, "A parameter is missing, unknown or impossible") \
	X(HOLDINGS, "bad-holdings", 400, "The holdings in the body cannot be true of this scene") \
	X(TOKEN, "token-needed", 401, "The scene needs a token, or is not there") \
	X(OPERATOR, "not-the-operator", 403, "This is for the server's operator") \
	X(ROUTE, "no-such-resource", 404, "There is no such resource") \
	X(SCENE, "no-such-scene", 404, "There is no scene of this name") \
	X(CHUNK, "no-such-chunk", 404, "The scene has no chunk of this id") \
	X(METHOD, "method-not-allowed", 405, "The resource does not support this method") \
	X(PACK_CHANGED, "pack-changed", 409, "The scene has been rebuilt since") \
	X(LENGTH_REQUIRED, "length-required", 411, "The body needs a Content-Length") \
	X(PRECONDITION, "precondition-failed", 412, "The condition of the request does not hold") \
	X(BODY_TOO_LARGE, "body-too-large", 413, "The body is too large") \
	X(TARGET_TOO_LONG, "target-too-long", 414, "The request target is too long") \
	X(MEDIA_TYPE, "unsupported-media-type", 415, "The body is of a type that is not understood") \
	X(RANGE, "range-not-satisfiable", 416, "The range lies outside the chunk") \
	X(LIMIT, "beyond-limit", 422, "The answer would exceed a limit of this server") \
	X(HEAD_TOO_LARGE, "head-too-large", 431, "The request's head is too large") \
	X(RELOAD, "reload-failed", 500, "Not all scenes could be loaded again") \
	X(DAMAGED, "pack-damaged", 500, "Stored data that the answer needs is damaged") \
	X(INTERNAL, "internal", 500, "The server failed") \
	X(BUSY, "busy", 503, "Too many plans are being made") \
	X(STOPPING, "stopping", 503, "The server is stopping") \
	X(VERSION, "unsupported-version", 505, "The version of HTTP is not supported")

enum srv_problem {
	SRV_PROBLEM_NONE,
#define X(name, type, status, title) SRV_PROBLEM_##name,
	SRV_PROBLEMS(X)
#undef X
	SRV_PROBLEM_COUNT
};

struct srv_problem_row { const char *type, *title; unsigned status; };
extern const struct srv_problem_row srv_problem_rows[SRV_PROBLEM_COUNT];

/* The problem that a failed plan, stream or payload is for the client. */
enum srv_problem srv_problem_of(enum eco_code code);

/* Writes the document (application/problem+json): type, title, status, detail, instance (may be NULL: left
 * out). */
void srv_problem_write(struct srv_json *json, enum srv_problem problem, const char *detail,
	const char *instance);
