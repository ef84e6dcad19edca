#include "server/request/problem.h"

#define URN "urn:ecostream:problem:"

const struct srv_problem_row srv_problem_rows[SRV_PROBLEM_COUNT] = {
	[SRV_PROBLEM_NONE] = { "about:blank", "No problem", 200 },
	[SRV_PROBLEM_TARGET] = { URN "malformed-target", "The request target is malformed", 400 },
	[SRV_PROBLEM_FRAMING] = { URN "ambiguous-framing", "The request's headers or body length are not "
	"acceptable", 400 }, [SRV_PROBLEM_PARAMETER] = { URN "bad-parameter", "A parameter is missing, "
	"unknown or impossible", 400 },
	[SRV_PROBLEM_HOLDINGS] = { URN "bad-holdings", "The holdings in the body cannot be true of this "
	"scene", 400 }, [SRV_PROBLEM_ROUTE] = { URN "no-such-resource", "There is no such resource", 404 },
	[SRV_PROBLEM_SCENE] = { URN "no-such-scene", "There is no scene of this name", 404 },
	[SRV_PROBLEM_CHUNK] = { URN "no-such-chunk", "The scene has no chunk of this id", 404 },
	[SRV_PROBLEM_TOKEN] = { URN "token-needed", "The scene needs a token, or is not there", 401 },
	[SRV_PROBLEM_OPERATOR] = { URN "not-the-operator", "This is for the server's operator", 403 },
	[SRV_PROBLEM_METHOD] = { URN "method-not-allowed", "The resource does not support this method", 405 },
	[SRV_PROBLEM_PACK_CHANGED] = { URN "pack-changed", "The scene has been rebuilt since", 409 },
	[SRV_PROBLEM_LENGTH_REQUIRED] = { URN "length-required", "The body needs a Content-Length", 411 },
	[SRV_PROBLEM_PRECONDITION] = { URN "precondition-failed",
		"The condition of the request does not hold", 412 },
	[SRV_PROBLEM_BODY_TOO_LARGE] = { URN "body-too-large", "The body is too large", 413 },
	[SRV_PROBLEM_TARGET_TOO_LONG] = { URN "target-too-long", "The request target is too long", 414 },
	[SRV_PROBLEM_HEAD_TOO_LARGE] = { URN "head-too-large", "The request's head is too large", 431 },
	[SRV_PROBLEM_MEDIA_TYPE] = { URN "unsupported-media-type", "The body is of a type that is not "
	"understood", 415 },
	[SRV_PROBLEM_RANGE] = { URN "range-not-satisfiable", "The range lies outside the chunk", 416 },
	[SRV_PROBLEM_LIMIT] = { URN "beyond-limit", "The answer would exceed a limit of this server", 422 },
	[SRV_PROBLEM_VERSION] = { URN "unsupported-version", "The version of HTTP is not supported", 505 },
	[SRV_PROBLEM_BUSY] = { URN "busy", "Too many plans are being made", 503 },
	[SRV_PROBLEM_STOPPING] = { URN "stopping", "The server is stopping", 503 },
	[SRV_PROBLEM_RELOAD] = { URN "reload-failed", "Not all scenes could be loaded again", 500 },
	[SRV_PROBLEM_DAMAGED] = { URN "pack-damaged", "Stored data that the answer needs is damaged", 500 },
	[SRV_PROBLEM_INTERNAL] = { URN "internal", "The server failed", 500 },
};

enum srv_problem srv_problem_of(enum eco_code code)
{
	switch (code) {
	case ECO_OK: return SRV_PROBLEM_NONE;
	case ECO_BAD_INPUT: return SRV_PROBLEM_PARAMETER;
	case ECO_TOO_LARGE: return SRV_PROBLEM_LIMIT;
	case ECO_NO_MEMORY: return SRV_PROBLEM_BUSY;
	case ECO_INTERRUPTED: return SRV_PROBLEM_STOPPING;
	case ECO_DAMAGED: return SRV_PROBLEM_DAMAGED;
	default: return SRV_PROBLEM_INTERNAL;
	}
}

void srv_problem_write(struct srv_json *json, enum srv_problem problem, const char *detail,
	const char *instance)
{
	const struct srv_problem_row *row = &srv_problem_rows[problem];
	srv_json_add(json, "{type:%s title:%s status:%u detail:%s", row->type, row->title, row->status, detail);
	if (instance)
		srv_json_add(json, "instance:%s", instance);
	srv_json_add(json, "}");
}
