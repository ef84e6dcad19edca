/* Problems of requests, as RFC 9457 problem documents. One table: type, status, title; the detail is written
 * where the problem is found and says what, which parameter and what to do. */
#ifndef SRV_PROBLEM_H
#define SRV_PROBLEM_H

#include "ecofiles/base/status.h"
#include "server/request/json.h"

enum srv_problem {
	SRV_PROBLEM_NONE,
	SRV_PROBLEM_TARGET,          /* path or query malformed */
	/* lengths or headers that two parsers could read in two ways; the connection is closed */
	SRV_PROBLEM_FRAMING,
	SRV_PROBLEM_PARAMETER,
	SRV_PROBLEM_HOLDINGS,
	SRV_PROBLEM_TOKEN,           /* a scene is asked for without its token */
	SRV_PROBLEM_OPERATOR,        /* what is the operator's alone is asked for by someone else */
	SRV_PROBLEM_ROUTE,
	SRV_PROBLEM_SCENE,
	SRV_PROBLEM_CHUNK,
	SRV_PROBLEM_METHOD,
	SRV_PROBLEM_PACK_CHANGED,
	SRV_PROBLEM_LENGTH_REQUIRED,
	SRV_PROBLEM_PRECONDITION,
	SRV_PROBLEM_BODY_TOO_LARGE,
	SRV_PROBLEM_TARGET_TOO_LONG,
	SRV_PROBLEM_HEAD_TOO_LARGE,
	SRV_PROBLEM_MEDIA_TYPE,
	SRV_PROBLEM_RANGE,
	SRV_PROBLEM_LIMIT,           /* a plan or response beyond a stated bound */
	SRV_PROBLEM_VERSION,
	SRV_PROBLEM_BUSY,
	SRV_PROBLEM_STOPPING,
	SRV_PROBLEM_RELOAD,
	SRV_PROBLEM_DAMAGED,
	SRV_PROBLEM_INTERNAL,
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

#endif
