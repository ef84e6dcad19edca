/* Requests that the daemon refuses, and that it says why; requests that must not get through. A table row for
 * each rule of HTTP. */
#include "tests/support/serve/serve_daemon.h"

#include "ecofiles/format/wire.h"
#include "server/request/problem.h"
#include "server/request/route.h"
#include "tests/support/serve/openapi.h"

/* Whatever a described operation answers must be among its described statuses. */
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
	static const struct { const char *method, *target, *headers, *body; unsigned status; const char *type;
	} rows[] = {
		{ "GET", "/viewer/none.js", "", NULL, 404, "no-such-resource" },
		{ "GET", BASE "/nothing", "", NULL, 404, "no-such-resource" },
		{ "GET", "/v1/scenes/none", "", NULL, 404, "no-such-scene" },
		{ "GET", "/v1/scenes/none/plan?" VIEW_BY("1"), "", NULL, 404, "no-such-scene" },
		{ "GET", BASE "/chunks/00000000000000000000000000000000", "", NULL, 404, "no-such-chunk" },
		{ "GET", BASE "/chunks/xyz", "", NULL, 404, "no-such-chunk" },
		{ "GET", BASE "/plants/xyz", "", NULL, 404, "no-such-resource" },
		{ "GET", BASE "/plants/0?x=1", "", NULL, 400, "bad-parameter" },
		{ "GET", "/../../etc/passwd", "", NULL, 400, "malformed-target" },
		{ "GET", "/healthz%00", "", NULL, 400, "malformed-target" },
		{ "GET", "/v1/scenes?x=%00", "", NULL, 400, "malformed-target" },
		{ "GET", "/healthz?x=1", "", NULL, 400, "bad-parameter" },
		{ "GET", BASE "/plan", "", NULL, 400, "bad-parameter" },
		{ "GET", BASE "/stream?" VIEW_BY("1") "&verts=1", "", NULL, 400, "bad-parameter" },
		{ "GET", BASE "/stream?" VIEW_BY("nan"), "", NULL, 400, "bad-parameter" },
		{ "GET", BASE "/stream?" VIEW_BY("1") "&fov_y_deg=0", "", NULL, 400, "bad-parameter" },
		{ "GET", BASE "/stream?" VIEW_BY("1") "&pack=00000000000000000000000000000000", "", NULL, 409,
			"pack-changed" },
		{ "DELETE", "/healthz", "", NULL, 405, "method-not-allowed" },
		{ "POST", BASE "/plan", "", "", 405, "method-not-allowed" },
		{ "POST", "/healthz", "", "x", 405, "method-not-allowed" },
		{ "PUT", BASE "/stream", "", "x", 405, "method-not-allowed" },
		{ "GET", "/v1/admin/reload", "", NULL, 405, "method-not-allowed" },
		{ "POST", "/v1/admin/reload", "", "x", 400, "ambiguous-framing" },
		{ "POST", "/v1/admin/reload", "Origin: http://evil.example\r\n", NULL, 403,
			"not-the-operator" },
		{ "POST", "/v1/admin/reload", "X-Forwarded-For: 127.0.0.1\r\n", NULL, 403,
			"not-the-operator" },
		{ "GET", "/metrics", "Via: 1.1 proxy\r\n", NULL, 403, "not-the-operator" },
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
	const struct srv_config config = { .listen = "127.0.0.1:0", .connections_per_address = 4 };
	struct srv_daemon *small = serve_another(&config);
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

int main(void)
{
	return unit_tests_run(serve_start, serve_stop);
}
