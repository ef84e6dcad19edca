/* The daemon over a loopback socket: every route with its answers, and requests that it refuses. */
#include "tests/support/cases.h"
#include "tests/support/serve/serve_daemon.h"

#include <ctype.h>

#include "ecofiles/format/wire.h"
#include "server/request/json.h"
#include "server/request/target.h"
#include "tests/support/files.h"

UNIT_TEST(health_and_scenes_are_described)
{
	static const struct { const char *key; double value; } places[] = { { "height_m", 500.5 },
		{ "longitude_deg", 11.5621 }, { "latitude_deg", 48.129 }, { "convergence_deg", 1.9082 } };
	char etag[80], headers[120];
	http_expect(port, "GET", "/healthz", "", 200, "{\"status\":\"ok\",\"scenes\":1}");
	http_expect(port, "GET", "/v1/scenes", "", 200, "{\"scenes\":[{\"name\":\"sample\",");
	http_expect(port, "GET", "/v1/scenes", "", 200, "\"href\":\"" BASE "\"}]}");
	struct http_answer answer = http_get(port, BASE);
	json_t *json = json_of(&answer), *origin = json_object_get(json, "origin");
	assert_header(&answer, "Content-Type", "application/json");
	assert_int_equal(count_in(json, "instances"), 4 * SAMPLE_PLANTS);
	assert_int_equal(count_in(json, "chunks"), scene()->chunk_count);
	assert_int_equal(count_in(json, "plants"), 2);
	assert_true(json_real_value(json_object_get(json, "near_m")) == scene()->near_m);
	assert_true(json_is_true(json_object_get(json, "draft")));
	assert_int_equal(json_array_size(json_object_get(json, "needs")), 6);
	assert_string_equal(json_string_value(json_object_get(origin, "crs")), "EPSG:32632");
	assert_true(json_number_value(json_array_get(json_object_get(origin, "at"), 1)) == 5334000);
	for (size_t i = 0; i < sizeof places / sizeof *places; i++)
		assert_true(json_number_value(json_object_get(origin, places[i].key)) == places[i].value);
	assert_true(http_header(&answer, "ETag", etag, sizeof etag));
	json_decref(json);
	http_free(&answer);
	snprintf(headers, sizeof headers, "If-None-Match: %s\r\n", etag);
	assert_int_equal(http_status(port, "GET", BASE, headers), 304);
}

UNIT_TEST(a_plan_tells_what_the_stream_sends)
{
	struct http_answer plan = http_get(port, BASE "/plan?" VIEW_BY("50000")),
		stream = http_get(port, BASE "/stream?" VIEW_BY("50000"));
	char timing[128];
	json_t *json = json_of(&plan), *ground = json_object_get(json, "ground"),
		*q = json_object_get(json_object_get(json, "prediction"), "q"),
		*m16 = json_object_get(json_object_get(json, "prediction"), "m16");
	assert_true(plan.status == 200 && stream.status == 200);
	assert_int_equal(count_in(json, "bytes"), stream.size);
	assert_in_range(count_in(json, "vertices"), 2000, 50000);        /* the summary, if nothing else */
	assert_true(json_array_size(json_object_get(json, "cuts")) > 0);
	assert_true(json_is_true(json_object_get(json, "fits")));
	assert_true(count_in(ground, "tiles") == 1 && json_number_value(json_object_get(ground, "ground_px")) == 1);
	assert_true(json_is_null(json_object_get(json, "budget_bytes")));
	assert_true(json_is_number(q) && json_number_value(q) <= 1);
	assert_true(json_number_value(m16) > 0 && json_number_value(m16) < 20);
	json_decref(json);
	assert_true(http_header(&plan, "Server-Timing", timing, sizeof timing)
		&& strncmp(timing, "plan;dur=", 9) == 0);
	http_free(&plan);
	http_free(&stream);
	json = json_get(BASE "/plan?" VIEW_BY("50000") "&bytes=10");
	assert_true(json_is_false(json_object_get(json, "fits")) && count_in(json, "bytes") > 10);
	json_decref(json);
}

UNIT_TEST(a_plan_is_explained_when_asked)
{
	json_t *json = json_get(BASE "/plan?" VIEW_BY("50000") "&explain=1"),
		*without = json_get(BASE "/plan?" VIEW_BY("50000")), *row;
	json_t *why = json_object_get(json, "explanation"), *rows = json_object_get(why, "rows");
	json_int_t vertices = 0;
	size_t i;
	assert_null(json_object_get(without, "explanation"));
	assert_int_equal(count_in(why, "omitted"), 0);
	assert_true(json_array_size(rows) >= json_array_size(json_object_get(json, "cuts")));
	json_array_foreach(rows, i, row) {
		vertices += count_in(row, "vertices");
		assert_true(strlen(json_string_value(json_object_get(row, "reason"))) > 8);
	}
	assert_int_equal(vertices, count_in(json, "vertices"));
	json_object_del(json, "explanation");
	assert_true(json_equal(json, without));
	json_decref(json);
	json_decref(without);
	http_expect(port, "GET", BASE "/plan?" VIEW_BY("50000") "&explain=2", "", 400, "neither 0 nor 1");
	http_expect(port, "GET", BASE "/stream?" VIEW_BY("50000") "&explain=1", "", 400, "explains nothing");
}

/* As an answer has the tag of its request, what one rule answered is never taken for what another would. */
UNIT_TEST(a_plan_follows_the_rule_that_is_asked_for)
{
	static const struct { const char *target; bool deussen; } rows[] =
		{ { BASE "/plan?" VIEW_BY("50000"), false },
		{ BASE "/plan?" VIEW_BY("50000") "&rule=optimal", false },
		{ BASE "/plan?" VIEW_BY("50000") "&rule=deussen", true },
		{ BASE "/plan?" VIEW_BY("50000") "&rule=deussen&bytes=12000", true } };
	char etags[4][80];
	json_t *plans[4];
	for (size_t i = 0; i < 4; i++) {
		struct http_answer answer = http_get(port, rows[i].target);
		assert_int_equal(answer.status, 200);
		assert_true(http_header(&answer, "ETag", etags[i], sizeof etags[i]));
		for (size_t k = 0; k < i; k++)
			assert_string_not_equal(etags[i], etags[k]);
		plans[i] = json_of(&answer);
		assert_true(count_in(plans[i], "vertices") <= 50000);
		assert_true((json_number_value(json_object_get(plans[i], "sample_distance_rad")) > 0)
			== rows[i].deussen);
		assert_true(json_is_true(json_object_get(plans[i], "fits")));
		http_free(&answer);
	}
	assert_true(json_equal(plans[0], plans[1]));
	assert_false(json_equal(json_object_get(plans[0], "cuts"), json_object_get(plans[2], "cuts")));
	assert_true(count_in(plans[2], "bytes") > 12000);
	assert_in_range(count_in(plans[3], "bytes"), 6000, 12000);
	for (size_t i = 0; i < 4; i++)
		json_decref(plans[i]);
}

UNIT_TEST(same_request_same_bytes)
{
	static const char *const targets[] = { BASE "/stream?" VIEW_BY("100000"),
		BASE "/stream?" VIEW_BY("100000") "&bytes=60000", BASE "/plan?" VIEW_BY("100000"),
		BASE "/stream?" VIEW_BY("0"), BASE "/stream?" VIEW_BY("100000") "&rule=deussen" };
	for (size_t i = 0; i < sizeof targets / sizeof *targets; i++) {
		struct http_answer one = http_get(port, targets[i]), two = http_get(port, targets[i]);
		char etag[80], headers[120];
		assert_true(one.status == 200 && one.size == two.size);
		assert_memory_equal(one.body, two.body, one.size);
		assert_true(http_header(&one, "ETag", etag, sizeof etag));
		assert_header(&two, "ETag", etag);
		if (strstr(targets[i], "/stream")) {     /* that of a POST is always planned */
			struct http_answer planned = http_ask(port, "POST", targets[i], OCTETS, NOTHING_HELD);
			assert_int_equal(planned.size, one.size);
			assert_memory_equal(planned.body, one.body, one.size);
			http_free(&planned);
		}
		snprintf(headers, sizeof headers, "If-None-Match: %s\r\n", etag);
		struct http_answer known = http_ask(port, "GET", targets[i], headers, NULL, 0);
		assert_true(known.status == 304 && known.size == 0);
		struct http_answer head = http_ask(port, "HEAD", targets[i], "", NULL, 0);
		char length[32], size[32];
		snprintf(size, sizeof size, "%zu", one.size);
		assert_header(&known, "Content-Length", size);
		assert_true(head.status == 200 && head.size == 0
			&& http_header(&head, "Content-Length", length, sizeof length));
		assert_string_equal(length, size);
		http_free(&one);
		http_free(&two);
		http_free(&known);
		http_free(&head);
	}
}

/* A daemon that can plan nothing answers by the tag alone; "*" does need a plan. */
UNIT_TEST(a_tag_that_matches_needs_no_plan)
{
	static const char *const targets[] = { BASE "/stream?" VIEW_BY("100000"),
		BASE "/plan?" VIEW_BY("100000") };
	struct srv_daemon *daemon = SERVE_ANOTHER(.response_max = 1, .plan_times = SAMPLE_PLAN_TIMES);
	for (size_t i = 0; i < 2; i++) {
		struct http_answer answer = http_get(port, targets[i]);
		char etag[80], headers[120];
		assert_true(http_header(&answer, "ETag", etag, sizeof etag));
		http_free(&answer);
		const struct {
			const char *form;
			unsigned status;
		} rows[] = { { "If-None-Match: %s\r\n", 304 }, { "If-None-Match: *\r\n", 422 },
			{ "If-None-Match: \"x\"\r\n", 422 }, { "", 422 }, { "If-Match: \"x\"\r\n", 412 },
			{ "If-Match: %s\r\n", 422 } };
		for (size_t r = 0; r < sizeof rows / sizeof *rows; r++) {
			snprintf(headers, sizeof headers, rows[r].form, etag);
			answer = http_ask(srv_daemon_port(daemon), "GET", targets[i], headers, NULL, 0);
			if (answer.status != rows[r].status || (answer.status == 304 && answer.size))
				fail_msg("%s: %u\n%s", headers, answer.status, answer.head);
			http_free(&answer);
		}
	}
	srv_daemon_stop(daemon);
}

/* A planned answer has Server-Timing; a kept one has none. */
UNIT_TEST(what_was_answered_is_kept)
{
	struct row { const char *method, *target; bool planned; unsigned status; };
	uint32_t count;
	const struct row *rows = cases_rows("tests/server/cases/kept.tsv", "ssbu", sizeof *rows, &count);
	for (size_t i = 0; i < count; i++) {
		struct http_answer answer = http_ask(port, rows[i].method, rows[i].target, "", NULL, 0);
		char timing[128], length[32] = "0";
		bool head = strcmp(rows[i].method, "HEAD") == 0;
		assert_int_equal(answer.status, rows[i].status);
		if (http_header(&answer, "Server-Timing", timing, sizeof timing) != rows[i].planned)
			fail_msg("row %zu:\n%s", i, answer.head);
		assert_int_equal(http_header(&answer, "Content-Length", length, sizeof length),
			answer.status == 200);
		assert_true(head ? answer.size == 0 : answer.size == strtoul(length, NULL, 10));
		http_free(&answer);
	}
}

UNIT_TEST(chunks_are_immutable_and_partial)
{
	const struct eco_chunk *chunk = &scene()->chunks[3];
	const uint8_t *payload = store.scenes[0]->pack->map + chunk->offset;
	char target[128], etag[SRV_ETAG_BYTES], last[64], whole_range[64], half[64], match[64];
	uint32_t size = chunk->size_bytes;
	chunk_target(target, scene(), 3);
	snprintf(etag, sizeof etag, "\"%s\"", strrchr(target, '/') + 1);
	snprintf(last, sizeof last, "Range: bytes=%u-%u\r\n", size - 1, size + 100);
	snprintf(whole_range, sizeof whole_range, "If-None-Match: \"x\", %s\r\n", etag);
	snprintf(match, sizeof match, "If-Match: %s\r\n", etag);
	snprintf(half, sizeof half, "Range: bytes=0-3\r\nIf-Range: %s\r\n", "\"other\"");
	const struct { const char *method, *headers; unsigned status; uint32_t first, end; } rows[] = {
		{ "GET", "", 200, 0, size }, { "GET", "", 200, 0, size },
			{ "GET", "Range: bytes=0-3\r\n", 206, 0, 4 },
		{ "GET", "Range: bytes=5-\r\n", 206, 5, size },
		{ "GET", "Range: bytes=-7\r\n", 206, size - 7, size },
		{ "GET", last, 206, size - 1, size }, { "GET", "Range: bytes=0-1,3-4\r\n", 200, 0, size },
		{ "GET", "Range: bytes=99999999-\r\n", 416, 0, 0 },
		{ "GET", "Range: nonsense\r\n", 200, 0, size },
		{ "GET", whole_range, 304, 0, 0 },
		{ "GET", match, 200, 0, size }, { "GET", "If-Match: *\r\nRange: bytes=0-3\r\n", 206, 0, 4 },
		{ "GET", "If-Match: \"x\"\r\n", 412, 0, 0 },
		{ "GET", "If-Unmodified-Since: Sun, 06 Nov 1994 08:49:37 GMT\r\n", 412, 0, 0 },
		{ "GET", "If-Unmodified-Since: Sat, 06 Nov 2094 08:49:37 GMT\r\n", 200, 0, size },
		{ "GET", "If-None-Match: *\r\nRange: bytes=0-3\r\n", 304, 0, 0 },
		{ "GET", "If-None-Match: \"x\"\r\n", 200, 0, size }, { "GET", half, 200, 0, size },
		{ "HEAD", "", 200, 0, 0 }, { "HEAD", "Range: bytes=0-3\r\n", 200, 0, 0 },
	};
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
		struct http_answer answer = http_ask(port, rows[i].method, target, rows[i].headers, NULL, 0);
		assert_int_equal(answer.status, rows[i].status);
		if (rows[i].status == 416) {
			char range[64];
			snprintf(range, sizeof range, "bytes */%u", size);
			assert_header(&answer, "Content-Range", range);
		} else if (rows[i].status == 412) {
			assert_non_null(strstr(answer.body, "precondition-failed"));
		} else {
			assert_header(&answer, "ETag", etag);
			assert_header(&answer, "Cache-Control", "public, max-age=31536000, immutable");
			assert_int_equal(answer.size, rows[i].end - rows[i].first);
			assert_memory_equal(answer.body, payload + rows[i].first, answer.size);
		}
		if (rows[i].status == 206) {
			char range[64];
			snprintf(range, sizeof range, "bytes %u-%u/%u", rows[i].first, rows[i].end - 1, size);
			assert_header(&answer, "Content-Range", range);
		}
		http_free(&answer);
	}
}

/* ---- The description ---- */

/* Its paths; the text stays for ever. */
static const char *paths(void)
{
	static char *text;
	size_t size;
	if (!text) {
		text = (char *)file_read("server/openapi.yaml", &size);
		text[size - 1] = 0;
		char *end = strstr(text, "\ncomponents:");
		if (end)
			*end = 0;
	}
	return strstr(text, "\npaths:");
}

/* Text behind the line of this indentation and key, or NULL. */
static const char *find_key(const char *from, const char *end, unsigned indent, const char *key)
{
	char line[128];
	snprintf(line, sizeof line, "\n%*s%s:", (int)indent, "", key);
	const char *at = strstr(from, line);
	return at && at < end ? at + strlen(line) : NULL;
}

static const char *end_of(const char *from, unsigned indent)
{
	for (const char *at = from; (at = strchr(at, '\n')); at++)
		if (at[1] != '\n' && strspn(at + 1, " ") <= indent)
			return at;
	return from + strlen(from);
}

/* server/openapi.yaml, read by its indentation, which is part of its style: whether it describes this status
 * of an operation (0: any); `method` in capitals. */
static bool openapi_documents(const char *path, const char *method, unsigned status)
{
	char key[16] = "";
	const char *all = paths(), *at = find_key(all, all + strlen(all), 2, path);
	for (size_t i = 0; method[i] && i + 1 < sizeof key; i++)
		key[i] = (char)tolower(method[i]);
	at = at ? find_key(at, end_of(at, 2), 4, key) : NULL;
	snprintf(key, sizeof key, "\"%u\"", status);
	return at && (!status || find_key(at, end_of(at, 4), 8, key));
}

/* Its operations by GET and POST. */
static unsigned openapi_count(void)
{
	unsigned count = 0;
	for (const char *at = paths(); (at = strstr(at, "\n    ")); at++)
		count += strncmp(at + 5, "get:", 4) == 0 || strncmp(at + 5, "post:", 5) == 0;
	return count;
}

UNIT_TEST(every_route_is_described_and_every_description_is_served)
{
	static const struct { enum srv_method bit; const char *name; } methods[] =
		{ { SRV_METHOD_GET, "GET" }, { SRV_METHOD_POST, "POST" } };
	struct eco_id_text id = eco_id_text(scene()->chunks[0].id.bytes);
	char list[16], target[256];
	unsigned routed = 0;
	snprintf(list, sizeof list, "%u", scene()->groups[0].list);
	const char *const variables[][2] = { { "{scene}", "sample" }, { "{id}", id.hex }, { "{list}", list },
		{ "{version}", sample_site.version }, { "{file}", SRV_SITE_ICON } };
	for (int i = 0; i < 2 * SRV_RESOURCE_COUNT; i++) {
		const struct srv_route *route = &srv_routes[i / 2];
		const char *method = methods[i % 2].name;
		bool is_view = route == &srv_routes[SRV_PLAN] || route == &srv_routes[SRV_STREAM], post = i % 2 && is_view;
		if (!(route->methods & methods[i % 2].bit))
			continue;
		routed++;
		snprintf(target, sizeof target, "%s%s", route->pattern, is_view ? "?" VIEW_BY("100")
			: route == &srv_routes[SRV_FIND] ? "?text=oak" : "");
		for (size_t v = 0; v < sizeof variables / sizeof *variables; v++) {
			char *at = strstr(target, variables[v][0]), rest[128];
			if (!at)
				continue;
			strcpy(rest, at + strlen(variables[v][0]));
			sprintf(at, "%s%s", variables[v][1], rest);
		}
		/* without a version it leads to where one is */
		unsigned status = route == &srv_routes[SRV_VIEWER] || route == &srv_routes[SRV_ICON] ? 307 : 200;
		struct http_answer answer = http_ask(port, method, target, post ? OCTETS : "",
			post ? "\0\0\0\0" : NULL, post ? 4 : 0);
		if (answer.status != status || !openapi_documents(route->pattern, method, status))
			fail_msg("%s %s: %u\n%s", method, target, answer.status, answer.body);
		http_free(&answer);
	}
	assert_int_equal(routed, openapi_count());
}

/* ---- Refusals ---- */

/* Each answer of a described operation is among its described statuses. */
static void assert_described(const char *method, const char *raw, unsigned status)
{
	struct srv_target target;
	const char *variables[2];
	const struct srv_route *route = srv_target_parse(&target, raw, strlen(raw), NULL) ? NULL
		: srv_route_find(&target, variables);
	if (route && openapi_documents(route->pattern, method, 0) && !openapi_documents(route->pattern,
			method, status))
		fail_msg("%s %s: %u is not described", method, route->pattern, status);
}

UNIT_TEST(bad_requests_are_problems)
{
	struct problem { const char *method, *target, *headers, *body, *status, *type; };
	uint32_t count;
	const struct problem *rows = cases_read("tests/server/cases/problems.tsv", sizeof *rows, &count);
	for (uint32_t i = 0; i < count; i++) {
		struct http_answer answer = http_ask(port, rows[i].method, rows[i].target, rows[i].headers,
			rows[i].body, rows[i].body ? strlen(rows[i].body) : 0);
		const unsigned status = (unsigned)cases_number(rows[i].status);
		char urn[80], allow[64];
		if (answer.status != status)
			fail_msg("%s %s: %u\n%s", rows[i].method, rows[i].target, answer.status, answer.head);
		assert_described(rows[i].method, rows[i].target, answer.status);
		assert_header(&answer, "Content-Type", "application/problem+json");
		if (rows[i].type) {
			json_t *json = json_of(&answer);
			snprintf(urn, sizeof urn, "urn:ecostream:problem:%s", rows[i].type);
			assert_string_equal(json_string_value(json_object_get(json, "type")), urn);
			assert_int_equal(json_integer_value(json_object_get(json, "status")), status);
			assert_true(json_is_string(json_object_get(json, "title")));
			assert_true(json_string_length(json_object_get(json, "detail")) > 10);
			json_decref(json);
		}
		assert_int_equal(http_header(&answer, "Allow", allow, sizeof allow), status == 405);
		http_free(&answer);
	}
}

/* A request that is refused by its head, and a body of `size` bytes. Returns how many were sent. */
static size_t send_refused(int fd, const char *head, size_t size)
{
	static const char zeros[1 << 16];
	size_t sent = 0;
	assert_true(http_send(fd, head, strlen(head)));
	while (sent < size && http_send(fd, zeros, sizeof zeros))
		sent += sizeof zeros;
	return sent;
}

/* A server that closes at once resets the connection, and the client, which still sends, loses the answer. */
UNIT_TEST(who_still_sends_a_refused_body_gets_the_answer)
{
	static const struct { const char *head; unsigned status; } rows[] = {
		{ STREAM "Content-Length: 6291456\r\n\r\n", 413 },
		{ "POST " BASE "/stream?" VIEW_BY("1") " HTTP/1.1\r\n" HOST "Content-Type: text/plain\r\n"
			"Content-Length: 4194304\r\n\r\n", 415 },
		{ "POST /nothing HTTP/1.1\r\n" HOST "Content-Length: 6291456\r\n\r\n", 404 },
		{ STREAM "Transfer-Encoding: chunked\r\n\r\n", 400 } };
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
		int fd = http_connect(port);
		size_t sent = send_refused(fd, rows[i].head, 4 << 20);
		if (sent < 4 << 20)
			fail_msg("only %zu bytes could be sent after %s", sent, rows[i].head);
		struct http_answer answer = http_receive(fd, false, true);
		assert_int_equal(answer.status, rows[i].status);
		assert_header(&answer, "Content-Type", "application/problem+json");
		http_free(&answer);
		close(fd);
	}
}

UNIT_TEST(a_refused_body_without_end_is_dropped_only_for_a_while)
{
	const size_t all = 256u << 20;
	int fd = http_connect(port);
	assert_in_range(send_refused(fd, STREAM "Content-Length: 1000000000\r\n\r\n", all), 4 << 20, all - 1);
	close(fd);
}

UNIT_TEST(refused_connections_that_are_kept_give_way)
{
	struct srv_daemon *small = SERVE_ANOTHER(.connections_per_address = 4);
	int fds[8];
	for (int i = 0; i < 8; i++) {
		fds[i] = http_connect(srv_daemon_port(small));
		send_refused(fds[i], STREAM "Content-Length: 6291456\r\n\r\n", 1 << 16);
		http_receive_status(fds[i], false, 413);
	}
	http_expect(srv_daemon_port(small), "GET", "/healthz", "", 200, NULL);
	for (int i = 0; i < 8; i++)
		close(fds[i]);
	srv_daemon_stop(small);
}

UNIT_TEST(holdings_of_another_scene_are_refused)
{
	struct eco_holding items[] = { { 0, 100000 }, { 1000000, 1 } };
	for (int i = 0; i < 2; i++) {
		struct eco_writer w = { 0 };
		eco_wire_write_holdings(&w, &(struct eco_holdings){ &items[i], 1 });
		struct http_answer answer = http_ask(port, "POST", BASE "/stream?" VIEW_BY("1"), OCTETS, w.bytes, w.size);
		assert_int_equal(answer.status, 400);
		assert_non_null(strstr(answer.body, "bad-holdings"));
		http_free(&answer);
		eco_writer_free(&w);
	}
}

UNIT_MAIN(serve_start, serve_stop)
