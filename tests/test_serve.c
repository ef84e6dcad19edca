/* The daemon over a loopback socket: every route, every refusal, and what must not get through. Long, as it is one
 * daemon with one client, and a table row or a few lines for each rule of HTTP. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <errno.h>
#include <jansson.h>
#include <pthread.h>
#include <sys/stat.h>

#include "server/daemon.h"
#include "server/problem.h"
#include "server/query.h"
#include "server/route.h"
#include "tests/http_client.h"
#include "tests/openapi.h"
#include "tests/sample_pack.h"
#include "tests/stream_reader.h"

#define PACK_PATH "build/tmp/test_serve.eco"
#define BASE "/v1/scenes/sample"
#define VIEW "eye=50,-30,12&target=50,30,2&width=400&height=300"
#define VIEW_BY(vertices) VIEW "&vertices=" vertices
#define OCTETS "Content-Type: application/octet-stream\r\n"
#define NOTHING_HELD "\0\0\0\0", 4

static struct srv_store store;
static struct srv_daemon *daemon_;
static uint16_t port;

static const struct eco_scene *scene(void)
{
	return &store.scenes[0].pack->scene;
}

static int start(void **state)
{
	struct eco_error error = { 0 };
	const struct srv_config config = { .listen = "127.0.0.1:0" };
	(void)state;
	mkdir("build", 0777);
	mkdir("build/tmp", 0777);
	srv_store_init(&store);
	if (sample_pack_write(PACK_PATH, &error) || srv_store_add(&store, NULL, PACK_PATH, &error)
		|| srv_daemon_start(&daemon_, &config, &store, &error)) {
		fprintf(stderr, "%s\n", error.text);
		return 1;
	}
	port = srv_daemon_port(daemon_);
	return 0;
}

static int stop(void **state)
{
	(void)state;
	srv_daemon_quiesce(daemon_);
	srv_daemon_stop(daemon_);
	srv_store_free(&store);
	return 0;
}

static void assert_header(const struct http_answer *answer, const char *name, const char *expected)
{
	char value[256];
	if (!http_header(answer, name, value, sizeof value))
		fail_msg("no %s in:\n%s", name, answer->head);
	assert_string_equal(value, expected);
}

static json_t *json_of(const struct http_answer *answer)
{
	json_error_t error;
	json_t *json = json_loadb(answer->body, answer->size, 0, &error);
	if (!json)
		fail_msg("not JSON: %s\n%s", error.text, answer->body);
	return json;
}

/* ---- Descriptions ---- */

static void health_and_scenes_are_described(void **state)
{
	struct http_answer answer = http_get(port, "/healthz");
	(void)state;
	assert_int_equal(answer.status, 200);
	assert_header(&answer, "Content-Type", "application/json");
	json_t *json = json_of(&answer);
	assert_string_equal(json_string_value(json_object_get(json, "status")), "ok");
	json_decref(json);
	http_free(&answer);

	answer = http_get(port, "/v1/scenes");
	json = json_of(&answer);
	json_t *first = json_array_get(json_object_get(json, "scenes"), 0);
	assert_string_equal(json_string_value(json_object_get(first, "name")), "sample");
	assert_string_equal(json_string_value(json_object_get(first, "href")), BASE);
	json_decref(json);
	http_free(&answer);

	answer = http_get(port, BASE);
	json = json_of(&answer);
	assert_int_equal(json_integer_value(json_object_get(json, "instances")), 4 * SAMPLE_PLANTS);
	assert_int_equal(json_integer_value(json_object_get(json, "chunks")), scene()->chunk_count);
	assert_int_equal(json_integer_value(json_object_get(json, "plants")), 2);
	assert_true(json_real_value(json_object_get(json, "near_m")) == scene()->near_m);
	assert_int_equal(json_array_size(json_object_get(json, "needs")), 6);
	char etag[80], headers[120];
	assert_true(http_header(&answer, "ETag", etag, sizeof etag));
	json_decref(json);
	http_free(&answer);
	snprintf(headers, sizeof headers, "If-None-Match: %s\r\n", etag);
	answer = http_ask(port, "GET", BASE, headers, NULL, 0);
	assert_int_equal(answer.status, 304);
	assert_int_equal(answer.size, 0);
	http_free(&answer);
}

static void a_plan_tells_what_the_stream_sends(void **state)
{
	struct http_answer plan = http_get(port, BASE "/plan?" VIEW_BY("50000")), stream = http_get(port, BASE "/stream?" VIEW_BY("50000"));
	(void)state;
	assert_int_equal(plan.status, 200);
	assert_int_equal(stream.status, 200);
	json_t *json = json_of(&plan);
	assert_int_equal(json_integer_value(json_object_get(json, "bytes")), stream.size);
	assert_true(json_integer_value(json_object_get(json, "vertices")) <= 50000);
	assert_true(json_integer_value(json_object_get(json, "vertices")) >= 2000);      /* the summary, if nothing else */
	assert_true(json_array_size(json_object_get(json, "cuts")) > 0);
	assert_true(json_is_true(json_object_get(json, "fits")));
	json_t *ground = json_object_get(json, "ground");
	assert_true(json_integer_value(json_object_get(ground, "tiles")) == 1 && json_number_value(json_object_get(ground, "ground_px")) == 1);
	assert_true(json_is_null(json_object_get(json, "budget_bytes")));
	json_t *q = json_object_get(json_object_get(json, "prediction"), "q");
	assert_true(json_is_number(q) && json_number_value(q) <= 1);
	json_decref(json);
	char timing[128];
	assert_true(http_header(&plan, "Server-Timing", timing, sizeof timing) && strncmp(timing, "plan;dur=", 9) == 0);
	http_free(&plan);
	http_free(&stream);
	plan = http_get(port, BASE "/plan?" VIEW_BY("50000") "&bytes=10");
	json = json_of(&plan);
	assert_true(json_is_false(json_object_get(json, "fits")));
	assert_true(json_integer_value(json_object_get(json, "bytes")) > 10);
	json_decref(json);
	http_free(&plan);
}

/* ---- Streams ---- */

static void read_stream(struct stream_reader *reader, const struct http_answer *answer, uint64_t vertices)
{
	struct eco_error error = { 0 };
	assert_int_equal(answer->status, 200);
	assert_header(answer, "Content-Type", "application/octet-stream");
	if (stream_reader_read(reader, answer->body, answer->size, vertices, &error))
		fail_msg("%s", error.text);
}

static void streams_are_complete_and_send_only_what_is_missing(void **state)
{
	struct stream_reader reader;
	(void)state;
	stream_reader_init(&reader, scene());
	struct http_answer answer = http_get(port, BASE "/stream?" VIEW_BY("3000000"));
	read_stream(&reader, &answer, 3000000);
	assert_true(reader.chunks > 10 && reader.lists > 5 && reader.plants == 2 && reader.plans > 1);
	size_t first_size = answer.size;
	http_free(&answer);

	struct eco_writer held = stream_reader_holdings(&reader);
	answer = http_ask(port, "POST", BASE "/stream?" VIEW_BY("3000000"), OCTETS, held.bytes, held.size);
	read_stream(&reader, &answer, 3000000);
	assert_int_equal(reader.chunks, 0);
	assert_int_equal(reader.lists, 0);
	assert_int_equal(reader.plants, 0);
	assert_true(answer.size < first_size / 20);
	http_free(&answer);
	eco_writer_free(&held);

	held = stream_reader_holdings(&reader);
	answer = http_ask(port, "POST", BASE "/stream?eye=20,20,2&target=30,20,2&width=400&height=300&vertices=9000000", OCTETS, held.bytes,
		held.size);
	read_stream(&reader, &answer, 9000000);
	http_free(&answer);
	eco_writer_free(&held);
	stream_reader_free(&reader);

	stream_reader_init(&reader, scene());
	answer = http_ask(port, "POST", BASE "/stream?" VIEW_BY("1000"), OCTETS, NOTHING_HELD);
	read_stream(&reader, &answer, 1000);
	http_free(&answer);
	stream_reader_free(&reader);
}

static void same_request_same_bytes(void **state)
{
	static const char *const targets[] = { BASE "/stream?" VIEW_BY("100000"), BASE "/stream?" VIEW_BY("100000") "&bytes=60000",
		BASE "/plan?" VIEW_BY("100000"), BASE "/stream?" VIEW_BY("0") };
	(void)state;
	for (size_t i = 0; i < sizeof targets / sizeof *targets; i++) {
		struct http_answer one = http_get(port, targets[i]), two = http_get(port, targets[i]);
		char etag[80], headers[120];
		assert_true(one.status == 200 && one.size == two.size);
		assert_memory_equal(one.body, two.body, one.size);
		assert_true(http_header(&one, "ETag", etag, sizeof etag));
		assert_header(&two, "ETag", etag);
		snprintf(headers, sizeof headers, "If-None-Match: %s\r\n", etag);
		struct http_answer known = http_ask(port, "GET", targets[i], headers, NULL, 0);
		assert_true(known.status == 304 && known.size == 0);
		struct http_answer head = http_ask(port, "HEAD", targets[i], "", NULL, 0);
		char length[32], size[32];
		snprintf(size, sizeof size, "%zu", one.size);
		assert_header(&known, "Content-Length", size);
		assert_true(head.status == 200 && head.size == 0 && http_header(&head, "Content-Length", length, sizeof length));
		assert_string_equal(length, size);
		http_free(&one);
		http_free(&two);
		http_free(&known);
		http_free(&head);
	}
}

static void byte_budgets_are_never_exceeded(void **state)
{
	struct sample random = { .state = 99 };
	uint32_t fitting = 0, refused = 0;
	(void)state;
	for (int i = 0; i < 200; i++) {
		char target[256];
		uint32_t bytes = i % 4 ? sample_bits(&random) % 400000 : sample_bits(&random) % 4000;
		uint32_t vertices = sample_bits(&random) % 2000000;
		snprintf(target, sizeof target, BASE "/stream?" VIEW "&vertices=%u&bytes=%u", vertices, bytes);
		struct http_answer answer = http_get(port, target);
		if (answer.status == 200) {
			struct stream_reader reader;
			stream_reader_init(&reader, scene());
			assert_true(answer.size <= bytes);
			read_stream(&reader, &answer, vertices);
			stream_reader_free(&reader);
			fitting++;
		} else {
			assert_int_equal(answer.status, 204);
			assert_int_equal(answer.size, 0);
			refused++;
		}
		http_free(&answer);
	}
	assert_true(fitting > 100 && refused > 5);
}

static void below_the_smallest_stream_there_is_none(void **state)
{
	struct http_answer least = http_get(port, BASE "/stream?" VIEW_BY("0")), answer;
	char target[200];
	(void)state;
	assert_int_equal(least.status, 200);
	snprintf(target, sizeof target, BASE "/stream?" VIEW "&vertices=100000&bytes=%zu", least.size);
	answer = http_get(port, target);
	assert_true(answer.status == 200 && answer.size <= least.size);
	http_free(&answer);
	snprintf(target, sizeof target, BASE "/stream?" VIEW "&vertices=100000&bytes=%zu", least.size - 1);
	answer = http_get(port, target);
	assert_true(answer.status == 204 && answer.size == 0);
	http_free(&answer);
	http_free(&least);
}

/* ---- Chunks ---- */

static void chunk_target(char target[128], uint32_t chunk)
{
	char id[SRV_ID_TEXT_BYTES];
	srv_format_id(id, &scene()->chunks[chunk].id);
	snprintf(target, 128, BASE "/chunks/%s", id);
}

static void chunks_are_immutable_and_partial(void **state)
{
	const struct eco_chunk *chunk = &scene()->chunks[3];
	const uint8_t *payload = store.scenes[0].pack->map + chunk->offset;
	char target[128], etag[SRV_ID_TEXT_BYTES + 2], last[64], whole_range[64], half[64];
	uint32_t size = chunk->size_bytes;
	(void)state;
	chunk_target(target, 3);
	snprintf(etag, sizeof etag, "\"%s\"", strrchr(target, '/') + 1);
	snprintf(last, sizeof last, "Range: bytes=%u-%u\r\n", size - 1, size + 100);
	snprintf(whole_range, sizeof whole_range, "If-None-Match: \"x\", %s\r\n", etag);
	snprintf(half, sizeof half, "Range: bytes=0-3\r\nIf-Range: %s\r\n", "\"other\"");
	const struct { const char *method, *headers; unsigned status; uint32_t first, end; } rows[] = {
		{ "GET", "", 200, 0, size }, { "GET", "", 200, 0, size }, { "GET", "Range: bytes=0-3\r\n", 206, 0, 4 },
		{ "GET", "Range: bytes=5-\r\n", 206, 5, size }, { "GET", "Range: bytes=-7\r\n", 206, size - 7, size },
		{ "GET", last, 206, size - 1, size }, { "GET", "Range: bytes=0-1,3-4\r\n", 200, 0, size },
		{ "GET", "Range: bytes=99999999-\r\n", 416, 0, 0 }, { "GET", "Range: nonsense\r\n", 200, 0, size },
		{ "GET", whole_range, 304, 0, 0 }, { "GET", "If-None-Match: *\r\nRange: bytes=0-3\r\n", 304, 0, 0 },
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

static void a_connection_serves_many_requests(void **state)
{
	int fd = http_connect(port);
	char request[300], target[128];
	(void)state;
	assert_true(fd >= 0);
	for (uint32_t i = 0; i < scene()->chunk_count; i++) {
		chunk_target(target, i);
		snprintf(request, sizeof request, "GET %s HTTP/1.1\r\nHost: t\r\n\r\n", i % 5 ? target : i % 2 ? "/nothing" : BASE "/plan?" VIEW_BY("100"));
		assert_true(http_send(fd, request, strlen(request)));
		struct http_answer answer = http_receive(fd, false, false);
		assert_int_equal(answer.status, i % 5 || !(i % 2) ? 200 : 404);
		if (i % 5)
			assert_int_equal(answer.size, scene()->chunks[i].size_bytes);
		http_free(&answer);
	}
	close(fd);
}

/* ---- The description ---- */

static void every_route_is_described_and_every_description_is_served(void **state)
{
	static const struct { enum srv_method bit; const char *name; } methods[] = { { SRV_METHOD_GET, "GET" }, { SRV_METHOD_POST, "POST" } };
	struct openapi api;
	unsigned routed = 0;
	(void)state;
	openapi_read(&api, "server/openapi.yaml");
	for (int i = 0; i < SRV_RESOURCE_COUNT; i++)
		for (int m = 0; m < 2; m++)
			if (srv_routes[i].methods & methods[m].bit) {
				if (!openapi_find(&api, srv_routes[i].pattern, methods[m].name))
					fail_msg("%s %s is not described", methods[m].name, srv_routes[i].pattern);
				routed++;
			}
	assert_int_equal(routed, api.count);
	for (unsigned i = 0; i < api.count; i++) {
		const struct openapi_operation *operation = &api.operations[i];
		bool post = strcmp(operation->method, "POST") == 0;
		char target[256], id[SRV_ID_TEXT_BYTES];
		srv_format_id(id, &scene()->chunks[0].id);
		snprintf(target, sizeof target, "%s%s%s", strncmp(operation->path, "/v1/scenes/", 11) ? operation->path : BASE,
			strncmp(operation->path, "/v1/scenes/", 11) ? "" : operation->path + strlen("/v1/scenes/{scene}"),
			strstr(operation->path, "/plan") || strstr(operation->path, "/stream") ? "?" VIEW_BY("100") : "");
		if (strstr(target, "{id}"))
			strcpy(strstr(target, "{id}"), id);
		struct http_answer answer = http_ask(port, operation->method, target, post ? OCTETS : "", post ? "\0\0\0\0" : NULL, post ? 4 : 0);
		if (answer.status != 200 || !openapi_documents(operation, 200))
			fail_msg("%s %s: %u\n%s", operation->method, target, answer.status, answer.body);
		http_free(&answer);
	}
}

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

/* ---- Refusals ---- */

static void bad_requests_are_problems(void **state)
{
	static const struct { const char *method, *target, *headers, *body; unsigned status; const char *type; } rows[] = {
		{ "GET", "/", "", NULL, 404, "no-such-resource" }, { "GET", "/v1", "", NULL, 404, "no-such-resource" },
		{ "GET", BASE "/nothing", "", NULL, 404, "no-such-resource" }, { "GET", "/v1/scenes/none", "", NULL, 404, "no-such-scene" },
		{ "GET", "/v1/scenes/none/plan?" VIEW_BY("1"), "", NULL, 404, "no-such-scene" },
		{ "GET", BASE "/chunks/00000000000000000000000000000000", "", NULL, 404, "no-such-chunk" },
		{ "GET", BASE "/chunks/ffffffffffffffffffffffffffffffff", "", NULL, 404, "no-such-chunk" },
		{ "GET", BASE "/chunks/xyz", "", NULL, 404, "no-such-chunk" },
		{ "GET", "/../../etc/passwd", "", NULL, 400, "malformed-target" }, { "GET", "/healthz%00", "", NULL, 400, "malformed-target" },
		{ "GET", "/%zz", "", NULL, 400, "malformed-target" }, { "GET", "//healthz", "", NULL, 400, "malformed-target" },
		{ "GET", "/v1/scenes?x=%00", "", NULL, 400, "malformed-target" }, { "GET", "/v1/scenes?x=1&x=2", "", NULL, 400, "malformed-target" },
		{ "GET", "/healthz?x=1", "", NULL, 400, "bad-parameter" }, { "GET", BASE "?x=1", "", NULL, 400, "bad-parameter" },
		{ "GET", BASE "/plan", "", NULL, 400, "bad-parameter" }, { "GET", BASE "/plan?" VIEW, "", NULL, 400, "bad-parameter" },
		{ "GET", BASE "/stream?" VIEW_BY("1") "&verts=1", "", NULL, 400, "bad-parameter" },
		{ "GET", BASE "/stream?" VIEW_BY("nan"), "", NULL, 400, "bad-parameter" },
		{ "GET", BASE "/stream?" VIEW_BY("1") "&up=0,0,inf", "", NULL, 400, "bad-parameter" },
		{ "GET", BASE "/stream?" VIEW_BY("1") "&fov_y_deg=0", "", NULL, 400, "bad-parameter" },
		{ "GET", BASE "/stream?" VIEW_BY("1") "&pack=00000000000000000000000000000000", "", NULL, 409, "pack-changed" },
		{ "DELETE", "/healthz", "", NULL, 405, "method-not-allowed" }, { "POST", BASE "/plan", "", "", 405, "method-not-allowed" },
		{ "POST", "/healthz", "", "x", 405, "method-not-allowed" }, { "PUT", BASE "/stream", "", "x", 405, "method-not-allowed" },
		{ "OPTIONS", "/v1/scenes", "", NULL, 405, "method-not-allowed" }, { "POST", "/nothing", "", "x", 404, "no-such-resource" },
		{ "GET", "/healthz", "", "x", 400, "ambiguous-framing" }, { "HEAD", "/healthz", "", "x", 400, NULL },
		{ "POST", BASE "/stream?" VIEW_BY("1"), OCTETS, NULL, 411, "length-required" },
		{ "POST", BASE "/stream?" VIEW_BY("1"), "", "\1\1\1\1", 415, "unsupported-media-type" },
		{ "POST", BASE "/stream?" VIEW_BY("1"), "Content-Type: text/plain\r\n", "\1\1\1\1", 415, "unsupported-media-type" },
		{ "POST", BASE "/stream?" VIEW_BY("1"), OCTETS, "", 400, "bad-holdings" },
		{ "POST", BASE "/stream?" VIEW_BY("1"), OCTETS, "\1\1\1\1\1\1", 400, "bad-holdings" },
		{ "POST", BASE "/stream?" VIEW_BY("1"), OCTETS "Content-Length: 4194305\r\n", NULL, 413, "body-too-large" },
		{ "GET", "/healthz", "Range: bytes=0-1\r\nRange: bytes=0-1\r\n", NULL, 400, "ambiguous-framing" },
	};
	(void)state;
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
		struct http_answer answer = http_ask(port, rows[i].method, rows[i].target, rows[i].headers, rows[i].body,
			rows[i].body ? strlen(rows[i].body) : 0);
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

static void holdings_of_another_scene_are_refused(void **state)
{
	struct eco_holding items[] = { { 0, 100000 } };
	struct eco_holdings holdings = { items, 1 };
	struct eco_writer w = { 0 };
	(void)state;
	eco_wire_write_holdings(&w, &holdings);
	struct http_answer answer = http_ask(port, "POST", BASE "/stream?" VIEW_BY("1"), OCTETS, w.bytes, w.size);
	assert_int_equal(answer.status, 400);
	assert_non_null(strstr(answer.body, "bad-holdings"));
	http_free(&answer);
	eco_writer_free(&w);
}

/* What must not be read as two requests: a refusal (`status` 0: any), nothing after it, and the connection is closed. (Where
 * libmicrohttpd 0.9.75 itself refuses, it sends its head twice; so heads are not counted.) */
static void smuggling_is_refused_and_closed(void **state)
{
#define HOST "Host: t\r\n"
#define SECOND "GET /healthz HTTP/1.1\r\n" HOST "\r\n"
#define STREAM "POST " BASE "/stream?" VIEW_BY("1") " HTTP/1.1\r\n" HOST OCTETS
	static const struct { const char *request; unsigned status; } rows[] = {
		{ STREAM "Content-Length: 4\r\nTransfer-Encoding: chunked\r\n\r\n0\r\n\r\n" SECOND, 400 },
		{ STREAM "Transfer-Encoding: chunked\r\nContent-Length: 4\r\n\r\n0\r\n\r\n" SECOND, 400 },
		{ STREAM "Transfer-Encoding: chunked\r\n\r\n4\r\nabcd\r\n0\r\n\r\n" SECOND, 400 },
		{ STREAM "Transfer-Encoding: identity\r\nContent-Length: 4\r\n\r\nabcd" SECOND, 400 },
		{ STREAM "Transfer-Encoding:\r\n chunked\r\n\r\n0\r\n\r\n" SECOND, 400 },
		{ "GET /healthz HTTP/1.1\r\n" HOST "Transfer-Encoding:\r\n chunked\r\n\r\n0\r\n\r\n" SECOND, 400 },
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
		{ "GET /healthz HTTP/1.1\r\n" HOST "Transfer-Encoding: chunked\r\n\r\n0\r\n\r\n" SECOND, 400 },
		{ "GET /healthz HTTP/1.1\r\n" HOST "Transfer-Encoding : chunked\r\n\r\n0\r\n\r\n" SECOND, 0 },
		{ "GET /healthz HTTP/1.1\r\n" HOST "Transfer-Encoding\t: chunked\r\n\r\n0\r\n\r\n" SECOND, 0 },
		{ "GET /healthz HTTP/1.1\r\nHost: a\r\nHost: b\r\n\r\n" SECOND, 400 },
		{ "GET /healthz HTTP/1.1\r\n\r\n" SECOND, 400 },
		{ "GET /healthz%00 HTTP/1.1\r\n" HOST "\r\n" SECOND, 400 },
		{ "GET /v1/../healthz HTTP/1.1\r\n" HOST "\r\n" SECOND, 400 },
		{ "GET /health z HTTP/1.1\r\n" HOST "\r\n" SECOND, 0 },
	};
	(void)state;
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
		struct http_answer answer = http_raw(port, rows[i].request, strlen(rows[i].request));
		if (rows[i].status ? answer.status != rows[i].status : answer.status != 0 && (answer.status < 400 || answer.status >= 506))
			fail_msg("%s\n-> %u\n%s", rows[i].request, answer.status, answer.head);
		if (strstr(answer.body, " 200 OK") || strstr(answer.body, "\"ok\""))
			fail_msg("two answers to\n%s\n%s%s", rows[i].request, answer.head, answer.body);
		http_free(&answer);
	}
}

static void long_targets_and_heads_are_refused(void **state)
{
	char *target = malloc(40000), *headers = malloc(60000);
	(void)state;
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
	assert_true(answer.status == 0 || answer.status == 431 || answer.status == 413 || answer.status == 400);
	http_free(&answer);
	free(target);
	free(headers);
}

/* ---- Many at once, slow ones, the end ---- */

static void *ask_many(void *argument)
{
	uintptr_t number = (uintptr_t)argument, wrong = 0;
	for (uint32_t i = 0; i < 12; i++) {
		char target[200];
		uint32_t chunk = (uint32_t)(number * 7 + i) % scene()->chunk_count;
		if (i % 3 == 0)
			snprintf(target, sizeof target, BASE "/stream?" VIEW "&vertices=%u", 1000 * (1 + i));
		else
			chunk_target(target, chunk);
		struct http_answer answer = http_get(port, target);
		wrong += answer.status != 200 || (i % 3 && answer.size != scene()->chunks[chunk].size_bytes);
		http_free(&answer);
	}
	return (void *)wrong;
}

static void many_clients_are_served_at_once(void **state)
{
	pthread_t threads[16];
	(void)state;
	for (uintptr_t i = 0; i < 16; i++)
		assert_int_equal(pthread_create(&threads[i], NULL, ask_many, (void *)i), 0);
	for (int i = 0; i < 16; i++) {
		void *wrong;
		pthread_join(threads[i], &wrong);
		assert_null(wrong);
	}
}

static void overdue_connections_are_shut(void **state)
{
	static const char *const starts[] = { "", "GET /hea", "GET /healthz HTTP/1.1\r\nHost: t\r\nX: ",
		STREAM "Content-Length: 100\r\n\r\nab" };
	const struct srv_config config = { .listen = "127.0.0.1:0", .head_ms = 200, .body_ms = 200 };
	struct srv_daemon *daemon;
	struct eco_error error = { 0 };
	(void)state;
	assert_int_equal(srv_daemon_start(&daemon, &config, &store, &error), ECO_OK);
	for (size_t i = 0; i < sizeof starts / sizeof *starts; i++) {
		int fd = http_connect(srv_daemon_port(daemon));
		assert_true(http_send(fd, starts[i], strlen(starts[i])));
		struct http_answer answer = http_receive(fd, false, true);
		assert_true(answer.closed || errno == ECONNRESET);
		assert_int_equal(answer.status, 0);
		http_free(&answer);
		close(fd);
	}
	srv_daemon_stop(daemon);
}

static void bodies_are_bounded_together(void **state)
{
	static const char start[] = STREAM "Content-Length: 1000\r\n\r\n";
	const struct srv_config config = { .listen = "127.0.0.1:0", .bodies_max = 1500 };
	struct srv_daemon *daemon;
	struct eco_error error = { 0 };
	(void)state;
	assert_int_equal(srv_daemon_start(&daemon, &config, &store, &error), ECO_OK);
	int first = http_connect(srv_daemon_port(daemon));
	assert_true(http_send(first, start, sizeof start - 1));
	while (!srv_daemon_busy(daemon))         /* its head is being read */
		usleep(1000);
	usleep(20000);
	struct http_answer answer = http_raw(srv_daemon_port(daemon), start, sizeof start - 1);
	assert_int_equal(answer.status, 503);
	http_free(&answer);
	close(first);
	while (srv_daemon_busy(daemon))
		usleep(1000);
	answer = http_ask(srv_daemon_port(daemon), "POST", BASE "/stream?" VIEW_BY("1"), OCTETS, NOTHING_HELD);
	assert_int_equal(answer.status, 200);
	http_free(&answer);
	srv_daemon_stop(daemon);
}

static void stopping_refuses_new_requests_and_ends(void **state)
{
	static const char request[] = "GET /healthz HTTP/1.1\r\nHost: t\r\n\r\n";
	const struct srv_config config = { .listen = "127.0.0.1:0" };
	struct srv_daemon *daemon;
	struct eco_error error = { 0 };
	(void)state;
	assert_int_equal(srv_daemon_start(&daemon, &config, &store, &error), ECO_OK);
	int fd = http_connect(srv_daemon_port(daemon)), unfinished = http_connect(srv_daemon_port(daemon));
	assert_true(http_send(fd, request, sizeof request - 1));
	struct http_answer answer = http_receive(fd, false, false);
	assert_int_equal(answer.status, 200);
	http_free(&answer);
	assert_true(http_send(unfinished, "GET /", 5));
	srv_daemon_quiesce(daemon);
	assert_true(http_send(fd, request, sizeof request - 1));
	answer = http_receive(fd, false, true);
	assert_int_equal(answer.status, 503);
	assert_header(&answer, "Retry-After", "1");
	assert_true(answer.closed);
	http_free(&answer);
	srv_daemon_stop(daemon);
	close(fd);
	close(unfinished);
}

/* Connections that wait for a plan are suspended; the library aborts if one still is when it is stopped. */
static void stopping_while_planning_is_clean(void **state)
{
	static const char request[] = "GET " BASE "/stream?" VIEW_BY("2000000") "&bytes=300000 HTTP/1.1\r\n" HOST "\r\n";
	const struct srv_config config = { .listen = "127.0.0.1:0", .work_threads = 2, .queue_max = 8 };
	(void)state;
	for (int round = 0; round < 12; round++) {
		struct srv_daemon *daemon;
		struct eco_error error = { 0 };
		int fds[24];
		assert_int_equal(srv_daemon_start(&daemon, &config, &store, &error), ECO_OK);
		for (int i = 0; i < 24; i++) {
			fds[i] = http_connect(srv_daemon_port(daemon));
			assert_true(http_send(fds[i], request, sizeof request - 1));
		}
		if (round % 3) {         /* an answer, or a refusal because the queue is full; never nothing */
			struct http_answer answer = http_receive(fds[round], false, false);
			assert_true(answer.status == 200 || answer.status == 503);
			http_free(&answer);
		}
		if (round % 2)
			srv_daemon_quiesce(daemon);
		srv_daemon_stop(daemon);
		for (int i = 0; i < 24; i++)
			close(fds[i]);
	}
}

static void a_taken_port_is_named(void **state)
{
	char listen_at[32];
	struct srv_config config = { .listen = listen_at };
	struct srv_daemon *daemon;
	struct eco_error error = { 0 };
	(void)state;
	snprintf(listen_at, sizeof listen_at, "127.0.0.1:%u", port);
	assert_int_equal(srv_daemon_start(&daemon, &config, &store, &error), ECO_IO);
	assert_null(daemon);
	assert_non_null(strstr(error.text, listen_at));
	assert_non_null(strstr(error.text, "--listen"));
	static const char *const bad[] = { "", "8080", ":8080", "127.0.0.1", "127.0.0.1:", "127.0.0.1:65536", "127.0.0.1:-1", "::1:80", "[::1]",
		"127.0.0.1:80x" };
	for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
		config.listen = bad[i];
		error = (struct eco_error){ 0 };
		assert_int_equal(srv_daemon_start(&daemon, &config, &store, &error), ECO_BAD_USAGE);
	}
}

static void files_give_names_that_can_be_asked_for(void **state)
{
	static const struct { const char *path, *name; bool valid; } rows[] = {
		{ "/data/park.eco", "park", true }, { "park", "park", true }, { "a--b_.eco", "a--b_", true }, { "x.y/Park.ECO", "park-eco", true },
		{ "Parque Eduardo VII.eco", "parque-eduardo-vii", true }, { "__ (2) .eco", "2", true }, { "\xc3\xa1rvores.eco", "rvores", true },
		{ "\xc3\x81.eco", "\xc3\x81", false }, { ".eco", "eco", true }, { "dir/", "", false },
		{ "0123456789012345678901234567890123456789012345678901234567890123456789.eco",
			"012345678901234567890123456789012345678901234567890123456789012", true },
	};
	(void)state;
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
		char name[SRV_NAME_BYTES];
		srv_name_of_file(name, rows[i].path);
		assert_string_equal(name, rows[i].name);
		assert_int_equal(srv_name_valid(name), rows[i].valid);
	}
}

static void scenes_are_named_and_checked(void **state)
{
	struct srv_store other;
	struct eco_error error = { 0 };
	(void)state;
	srv_store_init(&other);
	assert_int_equal(srv_store_add(&other, "a", PACK_PATH, &error), ECO_OK);
	assert_int_equal(srv_store_add(&other, "b-2", PACK_PATH, &error), ECO_OK);
	assert_int_equal(srv_store_add(&other, "a", PACK_PATH, &error), ECO_BAD_USAGE);
	assert_non_null(strstr(error.text, "two scenes are named 'a'"));
	error = (struct eco_error){ 0 };
	assert_int_equal(srv_store_add(&other, "Bad", PACK_PATH, &error), ECO_BAD_USAGE);
	error = (struct eco_error){ 0 };
	assert_true(srv_store_add(&other, NULL, "build/tmp/not-there.eco", &error) != ECO_OK);
	assert_non_null(strstr(error.text, "not-there.eco"));
	assert_int_equal(other.count, 2);
	assert_ptr_equal(srv_store_find(&other, "b-2"), &other.scenes[1]);
	for (uint32_t i = 0; i < other.scenes[0].pack->scene.chunk_count; i++) {
		const struct eco_chunk *chunks = other.scenes[0].pack->scene.chunks;
		uint32_t found = srv_scene_chunk(&other.scenes[0], &chunks[i].id);
		assert_memory_equal(chunks[found].id.bytes, chunks[i].id.bytes, sizeof chunks->id.bytes);
	}
	srv_store_free(&other);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(health_and_scenes_are_described),
		cmocka_unit_test(a_plan_tells_what_the_stream_sends),
		cmocka_unit_test(streams_are_complete_and_send_only_what_is_missing),
		cmocka_unit_test(same_request_same_bytes),
		cmocka_unit_test(byte_budgets_are_never_exceeded),
		cmocka_unit_test(below_the_smallest_stream_there_is_none),
		cmocka_unit_test(chunks_are_immutable_and_partial),
		cmocka_unit_test(a_connection_serves_many_requests),
		cmocka_unit_test(every_route_is_described_and_every_description_is_served),
		cmocka_unit_test(bad_requests_are_problems),
		cmocka_unit_test(holdings_of_another_scene_are_refused),
		cmocka_unit_test(smuggling_is_refused_and_closed),
		cmocka_unit_test(long_targets_and_heads_are_refused),
		cmocka_unit_test(many_clients_are_served_at_once),
		cmocka_unit_test(overdue_connections_are_shut),
		cmocka_unit_test(bodies_are_bounded_together),
		cmocka_unit_test(stopping_refuses_new_requests_and_ends),
		cmocka_unit_test(stopping_while_planning_is_clean),
		cmocka_unit_test(a_taken_port_is_named),
		cmocka_unit_test(files_give_names_that_can_be_asked_for),
		cmocka_unit_test(scenes_are_named_and_checked),
	};
	return cmocka_run_group_tests(tests, start, stop);
}
