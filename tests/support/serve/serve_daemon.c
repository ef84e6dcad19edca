#include "tests/support/serve/serve_daemon.h"
#include "tests/support/files.h"

struct srv_store store;
struct srv_daemon *daemon_;
uint16_t port;
char pack_path[64];         /* tests run at the same time, each with a pack of its own */

const struct srv_site sample_site = { .count = 2, .version = "0123abcd", .files = {
	{ SRV_SITE_INDEX, "text/html; charset=utf-8", { { (uint8_t *)"<!doctype html>", 15 },
		{ (uint8_t *)"by gzip", 7 }, { (uint8_t *)"brotli", 6 } } },
	{ SRV_SITE_ICON, "image/svg+xml", { { (uint8_t *)"<svg/>", 6 }, { (uint8_t *)"by gzip", 7 },
		{ (uint8_t *)"brotli", 6 } } } } };

static char *const sample_paths[] = { pack_path };
static const struct srv_sources sample_sources = { sample_paths, 1, NULL, NULL };

const struct eco_scene *scene(void)
{
	return &store.scenes[0]->pack->scene;
}

int serve_start(void **state)
{
	struct eco_error error = { 0 };
	const struct srv_config config = { .listen = "127.0.0.1:0", .site = &sample_site,
		.plan_times = SAMPLE_PLAN_TIMES, .sources = &sample_sources };
	folder_make("build/tmp");
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

int serve_stop(void **state)
{
	srv_daemon_quiesce(daemon_);
	srv_daemon_stop(daemon_);
	srv_store_free(&store);
	unlink(pack_path);
	return 0;
}

void assert_header(const struct http_answer *answer, const char *name, const char *expected)
{
	char value[256];
	if (!http_header(answer, name, value, sizeof value))
		fail_msg("no %s in:\n%s", name, answer->head);
	assert_string_equal(value, expected);
}

json_t *json_of(const struct http_answer *answer)
{
	json_error_t error;
	json_t *json = json_loadb(answer->body, answer->size, 0, &error);
	if (!json)
		fail_msg("not JSON: %s\n%s", error.text, answer->body);
	return json;
}

void chunk_target(char target[128], const struct eco_scene *tables, uint32_t chunk)
{
	snprintf(target, 128, BASE "/chunks/%s", eco_id_text(tables->chunks[chunk].id.bytes).hex);
}

struct srv_daemon *serve_another(const struct srv_config *config)
{
	struct srv_daemon *another;
	assert_good(srv_daemon_start(&another, config, &store, &cause));
	return another;
}

json_t *json_get(const char *target)
{
	struct http_answer answer = http_get(port, target);
	assert_int_equal(answer.status, 200);
	json_t *json = json_of(&answer);
	http_free(&answer);
	return json;
}

int64_t count_in(const json_t *json, const char *key)
{
	return json_integer_value(json_object_get(json, key));
}
