/* Streams that name chunks: fetched from the server, or from a static host that has them as files,
 * they are what a stream carries, within the same bytes. */
#include <pthread.h>
#include <stdio.h>
#include <string.h>

#include "client-min/view_select.h"
#include "client-min/view_fetch.h"
#include "lod/eye.h"
#include "tests/support/files.h"
#include "tests/support/serve/serve_daemon.h"

#define NAME_FROM 300u

/* ---- A static host: files of a folder by name, one request a connection ---- */

static struct host {
	int listener;
	uint16_t port;
	char folder[64];
	pthread_t thread;
	uint32_t asked;
	/* so many requests are answered that they are too many, after each so many that are not */
	uint32_t refuses, allows, allowed, refused;
	const char *refusal;             /* a status and headers; NULL: the connection is closed */
	uint32_t hangs_ms;               /* before the next answer */
	const char *moved;               /* files are there; NULL: where they are asked for */
} host;

static void reply(int c, const char *status, const char *more, const void *body, size_t size)
{
	char head[240];
	int at = snprintf(head, sizeof head,
		"HTTP/1.1 %s\r\n%sContent-Length: %zu\r\nConnection: close\r\n\r\n", status, more, size);
	send(c, head, (size_t)at, MSG_NOSIGNAL);
	send(c, body, size, MSG_NOSIGNAL);
}

static void answer_one(int c)
{
	static char bytes[1 << 20];
	char request[2048], name[64] = "", path[160];
	ssize_t size = recv(c, request, sizeof request - 1, 0);
	request[size > 0 ? size : 0] = 0;
	nanosleep(&(struct timespec){ host.hangs_ms / 1000, host.hangs_ms % 1000 * 1000000l }, NULL);
	host.hangs_ms = 0;
	if (host.refuses && host.allowed == host.allows) {
		if (host.refusal)
			reply(c, host.refusal, "", "", 0);
		host.allowed = ++host.refused % host.refuses ? host.allowed : 0;
		return;
	}
	host.allowed += host.refuses > 0;
	if (sscanf(request, "GET /moved/%40[0-9a-f] HTTP", name) != 1
			&& sscanf(request, "GET /%40[0-9a-f] HTTP", name) == 1 && host.moved) {
		snprintf(path, sizeof path, "Location: %s%s\r\n", host.moved, name);
		reply(c, "302 Found", path, "moved", 5);
		return;
	}
	snprintf(path, sizeof path, "%s/%s", host.folder, name);
	FILE *file = fopen(path, "rb");
	size_t there = file ? fread(bytes, 1, sizeof bytes, file) : 0;
	host.asked++;
	reply(c, file ? "200 OK" : "404 Not Found", "", bytes, there);
	if (file)
		fclose(file);
}

static void *serve_folder(void *ctx)
{
	for (int c; (c = accept(host.listener, NULL, NULL)) >= 0; close(c))
		answer_one(c);
	return NULL;
}

/* Chunks of so many bytes and more, each as a file that is named by its id. */
static int write_chunks(uint32_t from)
{
	struct eco_pack *pack;
	char path[160];
	if (eco_pack_open(&pack, pack_path, &cause))
		return 1;
	folder_make(host.folder);
	for (uint32_t i = 0; i < pack->scene.chunk_count; i++) {
		const struct eco_chunk *chunk = &pack->scene.chunks[i];
		snprintf(path, sizeof path, "%s/%s", host.folder, eco_id_text(chunk->id.bytes).hex);
		if (chunk->size_bytes >= from)
			file_write(path, pack->map + chunk->offset, chunk->size_bytes);
	}
	eco_pack_close(pack);
	return 0;
}

static int start(void **state)
{
	if (serve_start(state))
		return 1;
	snprintf(host.folder, sizeof host.folder, "build/tmp/named-%d", (int)getpid());
	host.listener = http_listen(&host.port);
	return write_chunks(300) || pthread_create(&host.thread, NULL, serve_folder, NULL);
}

static int stop(void **state)
{
	shutdown(host.listener, SHUT_RDWR);
	pthread_join(host.thread, NULL);
	close(host.listener);
	folder_empty(host.folder);
	rmdir(host.folder);
	return serve_stop(state);
}

/* ---- Clients ---- */

struct client {
	struct view_fetch *fetch;
	struct view_store *store;
	struct view_fetch_result result;
	char digest[VIEW_DIGEST_BYTES];
};

enum from { CARRIED, FROM_SERVER, FROM_HOST };

static long stall_ms = 10000;            /* without a byte, after which a host is given up */

static struct client client_new(enum from from)
{
	char url[64], chunks[80];
	struct client c = { 0 };
	const struct view_store_options options = { .images = false };
	const struct view_fetch_options fetch = { .url = url, .chunks = from ? chunks : NULL,
		.name_from = NAME_FROM, .resumes = 1, .stall_ms = stall_ms };
	snprintf(url, sizeof url, "http://127.0.0.1:%u" BASE, port);
	if (from == FROM_SERVER)
		snprintf(chunks, sizeof chunks, "%s/chunks/", url);
	else
		snprintf(chunks, sizeof chunks, "http://127.0.0.1:%u", host.port);
	assert_good(view_fetch_new(&c.fetch, &fetch, &cause));
	assert_good(view_store_new(&c.store, &options, &cause));
	return c;
}

static void client_free(struct client *c)
{
	view_fetch_free(c->fetch);
	view_store_free(c->store);
}

static struct eco_request request_of(double distance, uint64_t bytes)
{
	return (struct eco_request){ .view = { .eye = { 50 - distance, 20, distance / 4 },
		.target = { 50, 30, 2 }, .up = { 0, 0, 1 }, .fov_y_deg = 50, .width = 400, .height = 300 },
		.vertices = 200000, .bytes = bytes };
}

static enum eco_code look(struct client *c, const struct eco_request *request, struct eco_error *error)
{
	struct view_selection selection;
	struct lod_eye eye;
	ECO_PASS(view_fetch_stream(c->fetch, c->store, request, &c->result, error));
	lod_eye_make(&eye, &request->view);
	assert_ok(view_select_make(&selection, c->store, &eye, error), *error);
	assert_ok(view_digest_write(c->digest, c->store, &selection, error), *error);
	view_select_free(&selection);
	return ECO_OK;
}

/* Two views, one after the other: the second needs only what the first has not brought. */
UNIT_TEST(what_is_fetched_by_name_is_what_a_stream_carries)
{
	for (enum from from = FROM_SERVER; from <= FROM_HOST; from++) {
		struct client named = client_new(from);
		struct client again = client_new(CARRIED);
		uint32_t asked = host.asked;
		for (int view = 0; view < 2; view++) {
			const struct eco_request request = request_of(view ? 30 : 150, ECO_BYTES_UNBOUNDED);
			assert_good(look(&again, &request, &cause));
			assert_good(look(&named, &request, &cause));
			assert_string_equal(named.digest, again.digest);
			struct view_store_stats a = view_store_stats(again.store),
				b = view_store_stats(named.store);
			assert_true(a.chunks == b.chunks && a.chunk_bytes == b.chunk_bytes);
			assert_true(named.result.named > 10 && named.result.named_bytes >= NAME_FROM
				* named.result.named && named.result.named_bytes < named.result.bytes);
			/* an id and a size in place of a size; fewer frames */
			assert_true(named.result.bytes <= again.result.bytes
				+ named.result.named * (1 + sizeof(struct eco_chunk_id)));
			assert_int_equal(again.result.named, 0);
		}
		assert_true(from == FROM_HOST ? host.asked > asked : host.asked == asked);
		client_free(&again);
		client_free(&named);
		named = client_new(from);
		const struct eco_request small = request_of(60, 15000);
		assert_int_equal(look(&named, &small, &(struct eco_error){ 0 }), ECO_OK);
		assert_true(named.result.bytes <= small.bytes && named.result.named > 0);        /* they count */
		client_free(&named);
	}
}

/* Asks for a view by names, with this outcome (NULL: good, and what a stream carries), and so many requests (0: any). */
static void ask_named(const char *says, uint32_t requests)
{
	const struct eco_request request = request_of(150, ECO_BYTES_UNBOUNDED);
	struct client named = client_new(FROM_HOST), carried = client_new(CARRIED);
	struct eco_error error = { 0 };
	uint32_t asked = host.asked;
	enum eco_code code = look(&named, &request, &error);
	if (says ? !code || !strstr(error.text, says) : code != ECO_OK)
		fail_msg("'%s', not '%s'", error.text, says ? says : "");
	assert_good(look(&carried, &request, &cause));
	if (!code)
		assert_string_equal(named.digest, carried.digest);
	assert_true(!requests || named.result.requests == requests);
	assert_true(!requests || code || host.asked - asked < 2 * named.result.named);
	client_free(&named);
	client_free(&carried);
}

/* As buckets and CDNs do; not for ever, and not to files of this machine. */
UNIT_TEST(hosts_may_keep_chunks_elsewhere)
{
	static const char *const cases[][2] = { { "/moved/", NULL }, { "/", "redirects" }, { "file:///etc/", "rotocol" } };
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		host.moved = cases[i][0];
		ask_named(cases[i][1], 0);
	}
	host.moved = NULL;
}

/* ---- Hosts that lack something ---- */

static void path_of(char path[160], const struct eco_chunk *chunk)
{
	snprintf(path, 160, "%s/%s", host.folder, eco_id_text(chunk->id.bytes).hex);
}

/* Each file has other bytes, and so many more. */
static void spoil(int more)
{
	static const char bytes[1 << 20];
	char path[160];
	for (uint32_t i = 0; i < scene()->chunk_count; i++) {
		const struct eco_chunk *chunk = &scene()->chunks[i];
		path_of(path, chunk);
		if (chunk->size_bytes >= NAME_FROM)
			file_write(path, bytes, chunk->size_bytes + (size_t)more);
	}
}

UNIT_TEST(hosts_that_lack_chunks_or_have_others_are_told)
{
	static const struct { int more; const char *says; } cases[] = {
		{ 0, ": its bytes do not have the hash that names it; remove it there" },
		{ -1, "it has not the" }, { 1, "it has not the" } };
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		spoil(cases[i].more);
		ask_named(cases[i].says, 0);
	}
	folder_empty(host.folder);
	ask_named("its host answered 404; it needs the chunks of the pack", 1);
}

/* The rest of the stream is asked for again, when the host says; what came of it is held. */
UNIT_TEST(hosts_that_fail_or_are_asked_too_much_get_time)
{
	static const struct { const char *refusal, *says; } cases[] = {
		{ NULL, NULL }, { "429 Too Many Requests\r\nRetry-After: 1", NULL },
		{ "503 Slow Down\r\nRetry-After: 1", NULL }, { "429 Too Many Requests", "its host answered 429" },
		{ "408 Request Timeout", "its host answered 408" } };
	assert_int_equal(write_chunks(300), 0);
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		bool good = !cases[i].says;
		double begun_ms = view_clock_ms();
		host.refusal = cases[i].refusal;
		host.refuses = good ? 1 : UINT32_MAX;
		host.allows = 1000;
		host.allowed = host.allows - (good ? 10 : 0);
		host.refused = 0;
		ask_named(cases[i].says, 2);
		assert_true(!good || !cases[i].refusal || view_clock_ms() - begun_ms > 1000);
	}
	host.refuses = 0;
}

/* It may be that a host lacks a chunk for a while only; where it never had one the address is wrong. */
UNIT_TEST(hosts_that_had_chunks_are_asked_again)
{
	struct client named = client_new(FROM_HOST);
	struct eco_request request = request_of(150, ECO_BYTES_UNBOUNDED);
	struct eco_error error = { 0 };
	assert_int_equal(write_chunks(300), 0);
	assert_ok(look(&named, &request, &error), error);
	folder_empty(host.folder);
	request = request_of(30, ECO_BYTES_UNBOUNDED);
	assert_int_not_equal(look(&named, &request, &error), ECO_OK);
	assert_int_equal(named.result.requests, 2);
	assert_non_null(strstr(error.text, "(asked 2 times)"));
	client_free(&named);
}

/* Last, as it answers late. */
UNIT_TEST(hosts_that_hang_are_left_for_the_scenes_server)
{
	assert_int_equal(write_chunks(300), 0);
	stall_ms = 1000;
	for (int known = 0; known < 2; known++) {
		struct client named = client_new(FROM_HOST), carried = client_new(CARRIED);
		for (int view = 0; view < 3; view++) {
			const struct eco_request request = request_of(view == 0 ? 150 : view == 1 ? 60 : 30,
				view == 2 ? 100000 : ECO_BYTES_UNBOUNDED);
			uint32_t asked = host.asked;
			bool hangs = view == known;
			host.hangs_ms = hangs ? 3000 : 0;
			assert_good(look(&named, &request, &cause));
			assert_good(look(&carried, &request, &cause));
			assert_string_equal(named.digest, carried.digest);
			assert_true(named.result.host_left == hangs && named.result.broken == 0);
			assert_int_equal(named.result.requests, 1 + hangs);
			if (view > known)
				assert_true(named.result.named == 0 && host.asked == asked);
			/* it answers what it was asked before, and nobody hears it */
			if (hangs)
				sleep(3);
		}
		client_free(&named);
		client_free(&carried);
	}
}

UNIT_TEST(urls_that_are_none_are_refused)
{
	static const char *const urls[] = { "", "chunks", "ftp://host/chunks", "http://host/a b",
		"http://h/?x" };
	for (size_t i = 0; i < sizeof urls / sizeof *urls; i++) {
		struct view_fetch *fetch;
		const struct view_fetch_options options = { .url = "http://127.0.0.1" BASE,
			.chunks = urls[i] };
		assert_code(view_fetch_new(&fetch, &options, &cause), ECO_BAD_USAGE, "");
		assert_null(fetch);
		assert_non_null(strstr(cause.text, "it should look like http://host/chunks"));
	}
}

int main(void)
{
	if (view_fetch_setup(NULL))
		return 1;
	int failed = unit_tests_run(start, stop);
	view_fetch_teardown();
	return failed;
}
