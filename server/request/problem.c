#include "server/request/problem.h"

const struct srv_problem_row srv_problem_rows[SRV_PROBLEM_COUNT] = {
	[SRV_PROBLEM_NONE] = { "about:blank", "No problem", 200 },
#define X(name, type, status, title) [SRV_PROBLEM_##name] = { "urn:ecostream:problem:" type, title, status },
	SRV_PROBLEMS(X)
#undef X
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
