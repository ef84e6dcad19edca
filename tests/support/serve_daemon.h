/* A daemon on a loopback socket that serves the sample scene, for the tests of server/. */
#ifndef TESTS_SERVE_DAEMON_H
#define TESTS_SERVE_DAEMON_H

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <jansson.h>
#include <sys/stat.h>
#include <unistd.h>

#include "server/daemon.h"
#include "server/query.h"
#include "tests/support/http_client.h"
#include "tests/support/scene_packs.h"

#define BASE "/v1/scenes/sample"
#define VIEW "eye=50,-30,12&target=50,30,2&width=400&height=300"
#define VIEW_BY(vertices) VIEW "&vertices=" vertices
#define OCTETS "Content-Type: application/octet-stream\r\n"
#define HOST "Host: t\r\n"
#define STREAM "POST " BASE "/stream?" VIEW_BY("1") " HTTP/1.1\r\n" HOST OCTETS
#define NOTHING_HELD "\0\0\0\0", 4

static struct srv_store store;
static struct srv_daemon *daemon_;
static uint16_t port;
static char pack_path[64];         /* tests run at the same time, each with a pack of its own */

static inline const struct eco_scene *scene(void)
{
	return &store.scenes[0].pack->scene;
}

static inline int start(void **state)
{
	struct eco_error error = { 0 };
	const struct srv_config config = { .listen = "127.0.0.1:0" };
	(void)state;
	mkdir("build", 0777);
	mkdir("build/tmp", 0777);
	srv_store_init(&store);
	snprintf(pack_path, sizeof pack_path, "build/tmp/serve-%d.eco", (int)getpid());
	if (sample_pack_write(pack_path, &error) || srv_store_add(&store, NULL, pack_path, &error)
		|| srv_daemon_start(&daemon_, &config, &store, &error)) {
		fprintf(stderr, "%s\n", error.text);
		return 1;
	}
	port = srv_daemon_port(daemon_);
	return 0;
}

static inline int stop(void **state)
{
	(void)state;
	srv_daemon_quiesce(daemon_);
	srv_daemon_stop(daemon_);
	srv_store_free(&store);
	unlink(pack_path);
	return 0;
}

static inline void assert_header(const struct http_answer *answer, const char *name, const char *expected)
{
	char value[256];
	if (!http_header(answer, name, value, sizeof value))
		fail_msg("no %s in:\n%s", name, answer->head);
	assert_string_equal(value, expected);
}

static inline json_t *json_of(const struct http_answer *answer)
{
	json_error_t error;
	json_t *json = json_loadb(answer->body, answer->size, 0, &error);
	if (!json)
		fail_msg("not JSON: %s\n%s", error.text, answer->body);
	return json;
}

static inline void chunk_target(char target[128], uint32_t chunk)
{
	char id[SRV_ID_TEXT_BYTES];
	srv_format_id(id, &scene()->chunks[chunk].id);
	snprintf(target, 128, BASE "/chunks/%s", id);
}

#endif
