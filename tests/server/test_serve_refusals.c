/* Requests that the daemon refuses, and that it says why; requests that must not get through. A table row for
 * each rule of HTTP. */
#include "tests/support/serve_daemon.h"

#include "ecofiles/format/wire.h"
#include "server/problem.h"
#include "server/route.h"
#include "tests/support/openapi.h"

/* Whatever a described operation answers must be among its described statuses. */
static void assert_described(const char *method, const char *raw, unsigned status)
{
	static struct openapi api;
	struct srv_target target;
	const char *variables[2];
	if (!api.count)
		openapi_read(&api, "server/openapi.yaml");
	if (srv_target_parse(&target, raw, strlen(raw), NULL))
		return;
	const struct srv_route *route = srv_route_find(&target, variables);
	const struct openapi_operation *operation = route ? openapi_find(&api, route->pattern, method) : NULL;
	if (operation && !openapi_documents(operation, status))
		fail_msg("%s %s: %u is not described", method, route->pattern, status);
}

UNIT_TEST(bad_requests_are_problems)
{
	static const struct { const char *method, *target, *headers, *body; unsigned status; const char *type;
		} rows[] = {
		{ "GET", "/", "", NULL, 404, "no-such-resource" },
			{ "GET", "/v1", "", NULL, 404, "no-such-resource" },
		{ "GET", BASE "/nothing", "", NULL, 404, "no-such-resource" },
		{ "GET", "/v1/scenes/none", "", NULL, 404, "no-such-scene" },
		{ "GET", "/v1/scenes/none/plan?" VIEW_BY("1"), "", NULL, 404, "no-such-scene" },
		{ "GET", BASE "/chunks/00000000000000000000000000000000", "", NULL, 404, "no-such-chunk" },
		{ "GET", BASE "/chunks/ffffffffffffffffffffffffffffffff", "", NULL, 404, "no-such-chunk" },
		{ "GET", BASE "/chunks/xyz", "", NULL, 404, "no-such-chunk" },
		{ "GET", "/../../etc/passwd", "", NULL, 400, "malformed-target" },
		{ "GET", "/healthz%00", "", NULL, 400, "malformed-target" },
		{ "GET", "/%zz", "", NULL, 400, "malformed-target" },
		{ "GET", "//healthz", "", NULL, 400, "malformed-target" },
		{ "GET", "/v1/scenes?x=%00", "", NULL, 400, "malformed-target" },
		{ "GET", "/v1/scenes?x=1&x=2", "", NULL, 400, "malformed-target" },
		{ "GET", "/healthz?x=1", "", NULL, 400, "bad-parameter" },
		{ "GET", BASE "?x=1", "", NULL, 400, "bad-parameter" },
		{ "GET", BASE "/plan", "", NULL, 400, "bad-parameter" },
		{ "GET", BASE "/plan?" VIEW, "", NULL, 400, "bad-parameter" },
		{ "GET", BASE "/stream?" VIEW_BY("1") "&verts=1", "", NULL, 400, "bad-parameter" },
		{ "GET", BASE "/stream?" VIEW_BY("nan"), "", NULL, 400, "bad-parameter" },
		{ "GET", BASE "/stream?" VIEW_BY("1") "&up=0,0,inf", "", NULL, 400, "bad-parameter" },
		{ "GET", BASE "/stream?" VIEW_BY("1") "&fov_y_deg=0", "", NULL, 400, "bad-parameter" },
		{ "GET", BASE "/stream?" VIEW_BY("1") "&pack=00000000000000000000000000000000", "", NULL, 409,
			"pack-changed" },
		{ "DELETE", "/healthz", "", NULL, 405, "method-not-allowed" },
		{ "POST", BASE "/plan", "", "", 405, "method-not-allowed" },
		{ "POST", "/healthz", "", "x", 405, "method-not-allowed" },
		{ "PUT", BASE "/stream", "", "x", 405, "method-not-allowed" },
		{ "OPTIONS", "/v1/scenes", "", NULL, 405, "method-not-allowed" },
		{ "POST", "/nothing", "", "x", 404, "no-such-resource" },
		{ "GET", "/healthz", "", "x", 400, "ambiguous-framing" },
		{ "HEAD", "/healthz", "", "x", 400, NULL },
		{ "POST", BASE "/stream?" VIEW_BY("1"), OCTETS, NULL, 411, "length-required" },
		{ "POST", BASE "/stream?" VIEW_BY("1"), "", "\1\1\1\1", 415, "unsupported-media-type" },
		{ "POST", BASE "/stream?" VIEW_BY("1"), "Content-Type: text/plain\r\n", "\1\1\1\1", 415,
			"unsupported-media-type" },
		{ "POST", BASE "/stream?" VIEW_BY("1"), OCTETS, "", 400, "bad-holdings" },
		{ "POST", BASE "/stream?" VIEW_BY("1"), OCTETS, "\1\1\1\1\1\1", 400, "bad-holdings" },
		{ "POST", BASE "/stream?" VIEW_BY("1"), OCTETS "Content-Length: 4194305\r\n", NULL, 413,
			"body-too-large" },
		{ "GET", "/healthz", "Range: bytes=0-1\r\nRange: bytes=0-1\r\n", NULL, 400,
			"ambiguous-framing" },
	};
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
		struct http_answer answer = http_ask(port, rows[i].method, rows[i].target, rows[i].headers,
			rows[i].body, rows[i].body ? strlen(rows[i].body) : 0);
		char urn[80], allow[64];
		if (answer.status != rows[i].status)
			fail_msg("%s %s: %u\n%s", rows[i].method, rows[i].target, answer.status, answer.head);
		assert_described(rows[i].method, rows[i].target, answer.status);
		assert_header(&answer, "Content-Type", "application/problem+json");
		if (rows[i].type) {
			json_t *json = json_of(&answer);
			snprintf(urn, sizeof urn, "urn:ecostream:problem:%s", rows[i].type);
			assert_string_equal(json_string_value(json_object_get(json, "type")), urn);
			assert_int_equal(json_integer_value(json_object_get(json, "status")), rows[i].status);
			assert_true(json_is_string(json_object_get(json, "title")));
			assert_true(json_string_length(json_object_get(json, "detail")) > 10);
			json_decref(json);
		}
		assert_int_equal(http_header(&answer, "Allow", allow, sizeof allow), rows[i].status == 405);
		http_free(&answer);
	}
}

UNIT_TEST(holdings_of_another_scene_are_refused)
{
	struct eco_holding items[] = { { 0, 100000 } };
	struct eco_holdings holdings = { items, 1 };
	struct eco_writer w = { 0 };
	eco_wire_write_holdings(&w, &holdings);
	struct http_answer answer = http_ask(port, "POST", BASE "/stream?" VIEW_BY("1"), OCTETS, w.bytes,
		w.size);
	assert_int_equal(answer.status, 400);
	assert_non_null(strstr(answer.body, "bad-holdings"));
	http_free(&answer);
	eco_writer_free(&w);
}

/* A request that must not be read as two: a refusal (`status` 0: any), nothing after it, and the connection
 * is closed. (Where libmicrohttpd 0.9.75 itself refuses, it sends its head twice; so heads are not counted.)
 */
UNIT_TEST(smuggling_is_refused_and_closed)
{
#define SECOND "GET /healthz HTTP/1.1\r\n" HOST "\r\n"
	static const struct { const char *request; unsigned status; } rows[] = {
		{ STREAM "Content-Length: 4\r\nTransfer-Encoding: chunked\r\n\r\n0\r\n\r\n" SECOND, 400 },
		{ STREAM "Transfer-Encoding: chunked\r\nContent-Length: 4\r\n\r\n0\r\n\r\n" SECOND, 400 },
		{ STREAM "Transfer-Encoding: chunked\r\n\r\n4\r\nabcd\r\n0\r\n\r\n" SECOND, 400 },
		{ STREAM "Transfer-Encoding: identity\r\nContent-Length: 4\r\n\r\nabcd" SECOND, 400 },
		{ STREAM "Transfer-Encoding:\r\n chunked\r\n\r\n0\r\n\r\n" SECOND, 400 },
		{ "GET /healthz HTTP/1.1\r\n" HOST "Transfer-Encoding:\r\n chunked\r\n\r\n0\r\n\r\n" SECOND,
			400 },
		{ STREAM "Content-Length: 4\r\n 0\r\n\r\nabcd" SECOND, 400 },
		{ STREAM "Content-Length: 4\r\nContent-Length: 4\r\n\r\nabcd" SECOND, 400 },
		{ STREAM "Content-Length: 4\r\nContent-Length: 50\r\n\r\nabcd" SECOND, 400 },
		{ STREAM "Content-Length: 4, 4\r\n\r\nabcd" SECOND, 400 },
		{ STREAM "Content-Length: +4\r\n\r\nabcd" SECOND, 400 },
		{ STREAM "Content-Length: -4\r\n\r\nabcd" SECOND, 400 },
		{ STREAM "Content-Length: 0x4\r\n\r\nabcd" SECOND, 400 },
		{ STREAM "Content-Length : 4\r\n\r\nabcd" SECOND, 0 },
		{ STREAM "Content-Length: 99999999999999999999\r\n\r\nabcd" SECOND, 0 },
		{ "GET /healthz HTTP/1.1\r\n" HOST "Content-Length: 4\r\n\r\n" SECOND, 400 },
		{ "GET /healthz HTTP/1.1\r\n" HOST "Transfer-Encoding: chunked\r\n\r\n0\r\n\r\n" SECOND,
			400 },
		{ "GET /healthz HTTP/1.1\r\n" HOST "Transfer-Encoding : chunked\r\n\r\n0\r\n\r\n" SECOND, 0 },
		{ "GET /healthz HTTP/1.1\r\n" HOST "Transfer-Encoding\t: chunked\r\n\r\n0\r\n\r\n" SECOND,
			0 },
		{ "GET /healthz HTTP/1.1\r\nHost: a\r\nHost: b\r\n\r\n" SECOND, 400 },
		{ "GET /healthz HTTP/1.1\r\n\r\n" SECOND, 400 },
		{ "GET /healthz%00 HTTP/1.1\r\n" HOST "\r\n" SECOND, 400 },
		{ "GET /v1/../healthz HTTP/1.1\r\n" HOST "\r\n" SECOND, 400 },
		{ "GET /health z HTTP/1.1\r\n" HOST "\r\n" SECOND, 0 },
	};
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
		struct http_answer answer = http_raw(port, rows[i].request, strlen(rows[i].request));
		if (rows[i].status ? answer.status != rows[i].status : answer.status != 0
				&& (answer.status < 400 || answer.status >= 506))
			fail_msg("%s\n-> %u\n%s", rows[i].request, answer.status, answer.head);
		if (strstr(answer.body, " 200 OK") || strstr(answer.body, "\"ok\""))
			fail_msg("two answers to\n%s\n%s%s", rows[i].request, answer.head, answer.body);
		http_free(&answer);
	}
}

UNIT_TEST(long_targets_and_heads_are_refused)
{
	char *target = malloc(40000), *headers = malloc(60000);
	memset(target, 'a', 3000);
	target[0] = '/';
	target[3000] = 0;
	struct http_answer answer = http_get(port, target);
	assert_int_equal(answer.status, 414);
	http_free(&answer);
	strcpy(headers, "GET /healthz HTTP/1.1\r\nHost: t\r\n");
	for (size_t at = strlen(headers), i = 0; i < 700; i++)
		at += (size_t)sprintf(headers + at, "X-%zu: aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa\r\n", i);
	strcat(headers, "\r\n");
	answer = http_raw(port, headers, strlen(headers));
	assert_true(answer.status == 0 || answer.status == 431 || answer.status == 413
		|| answer.status == 400);
	http_free(&answer);
	free(target);
	free(headers);
}

int main(void)
{
	return unit_tests_run(serve_start, serve_stop);
}
