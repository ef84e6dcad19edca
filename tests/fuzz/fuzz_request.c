/* A request: target, headers, body, as the daemon takes them apart. First line the target, then "name: value"
 * lines, an empty line, the body. An accepted request must be within all bounds that later code relies on. */
#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/format/wire.h"
#include "server/request/condition.h"
#include "server/request/problem.h"
#include "server/request/query.h"
#include "server/request/route.h"
#include "server/stream.h"

static void check_query(const struct srv_target *target)
{
	struct srv_query query;
	struct eco_error error = { 0 };
	enum eco_code code = srv_query_parse(&query, target, &error);
	assert(code == error.code && (code == ECO_OK || code == ECO_BAD_INPUT));
	if (code)
		return;
	const struct eco_view *view = &query.request.view;
	assert(eco_view_check(view, NULL) == ECO_OK && query.request.vertices <= ECO_VERTICES_MAX);
	for (int i = 0; i < 3; i++)
		assert(isfinite(view->eye[i]) && isfinite(view->target[i]) && isfinite(view->up[i]));
	assert(view->width >= 1 && view->width <= ECO_IMAGE_MAX && view->height >= 1
		&& view->height <= ECO_IMAGE_MAX);
}

static void check_target(const char *raw, size_t size)
{
	struct srv_target target;
	const char *variables[2];
	struct eco_error error = { 0 };
	enum eco_code code = srv_target_parse(&target, raw, size, &error);
	assert(code == error.code && (code == ECO_OK || code == ECO_BAD_INPUT || code == ECO_TOO_LARGE));
	if (code)
		return;
	for (uint32_t i = 0; i < target.segment_count; i++)
		assert(target.segments[i] >= target.text && target.segments[i][0] && target.segments[i][0]
			!= '.' && !strpbrk(target.segments[i], "/%\\ ")
			&& target.segments[i] + strlen(target.segments[i]) < target.text
			+ sizeof target.text);
	for (uint32_t i = 0; i < target.param_count; i++) {
		const char *value = target.params[i].value;
		assert(target.params[i].name[0] && value[0] && value + strlen(value) < target.text
			+ sizeof target.text);
		assert(srv_target_param(&target, target.params[i].name) == value);
		for (; *value; value++)
			assert(*value > 0x20 && *value < 0x7f);
	}
	const struct srv_route *route = srv_route_find(&target, variables);
	assert(!route || !variables[0] || variables[0][0]);
	check_query(&target);
	assert(srv_query_none(&target, NULL) == (target.param_count ? ECO_BAD_INPUT : ECO_OK));
}

static void check_conditions(const struct srv_conditions *conditions)
{
	static const uint64_t sizes[] = { 1, 100, UINT64_MAX };
	for (int i = 0; i < 3; i++) {
		struct srv_range range = srv_range_parse(conditions->range, sizes[i]);
		assert(range.kind != SRV_RANGE_PART || (range.first < range.end && range.end <= sizes[i]));
	}
	srv_etag_match(conditions->if_none_match, "\"0123456789abcdef0123456789abcdef\"");
	struct srv_json json = { 0 };
	srv_problem_write(&json, SRV_PROBLEM_TARGET, conditions->if_range, conditions->if_none_match);
	assert(!json.out.failed && json.out.size > 20);
	for (size_t i = 0; i < json.out.size; i++)
		assert(json.out.bytes[i] >= 0x20 && json.out.bytes[i] != 0x7f);
	eco_writer_free(&json.out);
}

static void check_holdings(const uint8_t *bytes, size_t size)
{
	static const struct eco_list lists[4] = { { .chunk_count = 1 }, { .chunk_count = 300 },
		{ .chunk_count = 0 }, { .chunk_count = 7 } };
	const struct eco_scene scene = { .lists = lists, .list_count = 4 };
	struct eco_holdings holdings;
	if (eco_wire_read_holdings(bytes, size, &holdings, NULL))
		return;
	if (!srv_holdings_check(&scene, &holdings, NULL))
		for (uint32_t i = 0; i < holdings.count; i++)
			assert(holdings.items[i].chunks <= lists[holdings.items[i].list].chunk_count);
	free(holdings.items);
}

/* One line of `text` from *at on, ended by a 0 in place of its newline; NULL at the end. */
static char *next_line(char *text, size_t size, size_t *at)
{
	if (*at >= size)
		return NULL;
	char *line = text + *at, *newline = memchr(line, '\n', size - *at);
	size_t length = newline ? (size_t)(newline - line) : size - *at;
	line[length] = 0;
	*at += length + 1;
	return line;
}

static void take_condition(struct srv_conditions *conditions, const char *name, const char *value)
{
	if (strcmp(name, "Range") == 0)
		conditions->range = value;
	else if (strcmp(name, "If-Range") == 0)
		conditions->if_range = value;
	else if (strcmp(name, "If-None-Match") == 0)
		conditions->if_none_match = value;
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
	struct srv_conditions conditions = { 0 };
	char *text = malloc(size + 1);
	size_t at = 0;
	memcpy(text, bytes, size);
	text[size] = 0;
	const uint8_t *newline = memchr(bytes, '\n', size);
	check_target(text, newline ? (size_t)(newline - bytes) : size);
	next_line(text, size, &at);
	for (char *line; (line = next_line(text, size, &at)) && *line;) {
		char *colon = strchr(line, ':');
		if (!colon)
			continue;
		*colon++ = 0;
		colon += strspn(colon, " ");
		take_condition(&conditions, line, colon);
	}
	check_conditions(&conditions);
	if (at < size)
		check_holdings(bytes + at, size - at);
	free(text);
	return 0;
}
