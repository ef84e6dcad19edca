/* An operator's work on a daemon that serves: other packs, tokens, pages of others, numbers. */
#include "tests/support/serve/serve_daemon.h"

#include <pthread.h>
#include <stdatomic.h>

#include "server/access.h"
#include "server/log.h"
#include "server/stream.h"
#include "tests/support/files.h"
#include "tests/support/ground_tiles.h"
#include "tests/support/pack_resign.h"

static char served[64], other[64], other_name[64], token_file[64];

static double flat(double x, double y) { return 1 + 0.02 * x + 0 * y; }

/* Another pack of the same name: on other ground, and bushes without a texture. */
static enum eco_code write_other(const char *path, struct eco_error *error)
{
	struct eco_ground ground = ground_make(16, 16, -8, -8, 8, flat);
	enum eco_code code = sample_pack_write_on(path, &ground, true, error);
	eco_ground_free(&ground);
	return code;
}

static int prepare(void **state)
{
	int pid = (int)getpid();
	struct eco_error error = { 0 };
	folder_make("build/tmp");
	snprintf(served, sizeof served, "build/tmp/operate-%d.eco", pid);
	snprintf(other, sizeof other, "build/tmp/operate-%d-other.eco", pid);
	snprintf(other_name, sizeof other_name, "build/tmp/operate-%d-renamed.eco", pid);
	snprintf(token_file, sizeof token_file, "build/tmp/operate-%d.token", pid);
	file_write_text(token_file, "0123456789abcdef-park\nnot this\n");
	return sample_pack_write(served, &error) || write_other(other, &error);
}

static int clean(void **state)
{
	unlink(served);
	unlink(other);
	unlink(token_file);
	return 0;
}

/* A copy beside it, then renamed: as ecopack puts a pack in place. */
static void put_in_place(const char *from)
{
	char command[400];
	snprintf(command, sizeof command, "cp %s %s.new && mv %s.new %s", from, served, served, served);
	assert_int_equal(system(command), 0);
}

static struct srv_store scenes;          /* of the daemon that runs */

static void start(struct srv_config config)
{
	static char *const paths[] = { served };
	static const struct srv_sources sources = { paths, 1, "build/tmp", NULL };
	struct srv_reload report;
	config.listen = "127.0.0.1:0";
	config.sources = &sources;
	assert_good(srv_sources_load(&sources, NULL, &scenes, &report, &cause));
	assert_good(srv_daemon_start(&daemon_, &config, &scenes, &cause));
	port = srv_daemon_port(daemon_);
}

static void stop(void)
{
	srv_daemon_stop(daemon_);
	srv_store_free(&scenes);
}

static void restore(void)
{
	assert_good(sample_pack_write(served, &cause));
}

static void expect(const char *method, const char *target, const char *headers, unsigned status)
{
	http_expect(port, method, target, headers, status, NULL);
}

#define RELOAD "/v1/admin/reload"

static void give_token(struct srv_access *access, const char *scene)
{
	char argument[100];
	snprintf(argument, sizeof argument, "%s=%s", scene, token_file);
	assert_good(srv_access_add_token(argument, access, &cause));
}

/* ---- Reload ---- */

static atomic_bool over;

static void *ask_on(void *argument)
{
	uintptr_t failed = 0;
	for (uint32_t i = 0; !atomic_load(&over); i++) {
		char target[200];
		snprintf(target, sizeof target, i % 3 ? BASE "/stream?" VIEW "&vertices=%u" : BASE,
			1000 + i % 7777);
		struct http_answer answer = http_get(port, target);
		failed += answer.status != 200;
		http_free(&answer);
	}
	return (void *)failed;
}

UNIT_TEST(reloads_fail_no_request)
{
	pthread_t threads[4];
	uintptr_t sum = 0, failed;
	char first[80], command[200];
	start((struct srv_config){ .connections_per_address = 500 });
	atomic_store(&over, false);
	for (int i = 0; i < 4; i++)
		assert_int_equal(pthread_create(&threads[i], NULL, ask_on, NULL), 0);
	snprintf(first, sizeof first, "%s.first", served);
	snprintf(command, sizeof command, "cp %s %s", served, first);
	assert_int_equal(system(command), 0);
	for (int i = 0; i < 20; i++) {
		put_in_place(i % 2 ? first : other);
		http_expect(port, "POST", RELOAD, "", 200, "{\"opened\":");
	}
	atomic_store(&over, true);
	for (int i = 0; i < 4; i++) {
		pthread_join(threads[i], (void **)&failed);
		sum += failed;
	}
	assert_int_equal(sum, 0);
	assert_int_equal(unlink(first), 0);
	stop();
	restore();
}

/* A chunk that only the pack before had is there for as long as was said. */
UNIT_TEST(chunks_of_a_replaced_pack_stay_for_a_while)
{
	char gone[128] = "";
	struct eco_pack *after;
	start((struct srv_config){ .keep_s = 1 });
	const struct eco_scene *tables = &scenes.scenes[0]->pack->scene;
	assert_good(eco_pack_open(&after, other, &cause));
	for (uint32_t c = 0; c < tables->chunk_count && !gone[0]; c++) {
		bool both = false;
		for (uint32_t k = 0; k < after->scene.chunk_count; k++)
			both |= memcmp(&after->scene.chunks[k].id, &tables->chunks[c].id,
				sizeof tables->chunks[c].id) == 0;
		if (!both)
			chunk_target(gone, tables, c);
	}
	eco_pack_close(after);
	put_in_place(other);
	http_expect(port, "POST", RELOAD, "", 200, "{\"opened\":1,\"same\":0,\"gone\":0}");
	expect("GET", gone, "", 200);
	usleep(1100000);
	srv_daemon_tick(daemon_);
	expect("GET", gone, "", 404);
	stop();
	restore();
}

/* Packs come and go with the files of a folder. */
UNIT_TEST(a_folder_is_all_packs_in_it)
{
	char folder[80], path[100], command[400];
	struct srv_store first, second;
	struct srv_reload report;
	snprintf(folder, sizeof folder, "build/tmp/operate-%d-folder", (int)getpid());
	snprintf(path, sizeof path, "%s/a.eco", folder);
	const struct srv_sources sources = { (char *[]){ folder }, 1, NULL, NULL };
	snprintf(command, sizeof command, "rm -rf %s && mkdir %s && touch %s/.hidden.eco %s/readme", folder,
		folder, folder, folder);
	assert_int_equal(system(command), 0);
	assert_code(srv_sources_load(&sources, NULL, &first, &report, &cause), ECO_NOT_FOUND, "");
	srv_store_free(&first);
	assert_good(sample_pack_write(path, &cause));
	assert_good(srv_sources_load(&sources, NULL, &first, &report, &cause));
	assert_true(first.count == 1 && report.opened == 1);
	assert_good(srv_sources_load(&sources, &first, &second, &report, &cause));
	assert_true(second.count == 1 && report.same == 1 && second.scenes[0] == first.scenes[0]);
	srv_store_free(&first);
	srv_store_free(&second);
	folder_empty(folder);
	assert_int_equal(rmdir(folder), 0);
}

UNIT_TEST(reading_scenes_ends_when_it_is_cancelled)
{
	char *paths[] = { served };
	atomic_bool cancelled = true;
	const struct srv_sources sources = { paths, 1, "build/tmp", &cancelled },
		whole = { paths, 1, "build/tmp", NULL };
	struct srv_reload report;
	assert_good(srv_sources_load(&whole, NULL, &scenes, &report, &cause));
	assert_int_equal(srv_typical_find(scenes.scenes[0], &cancelled), 0);
	struct srv_store again;
	assert_code(srv_sources_load(&sources, NULL, &again, &report, &cause), ECO_INTERRUPTED, "");
	srv_store_free(&again);
	assert_good(srv_store_add(&scenes, "other", other, &cause));
	assert_good(srv_sources_load(&sources, &scenes, &again, &report, &cause));
	assert_int_equal(report.same, 1);        /* nothing had to be read */
	srv_store_free(&again);
	cancelled = false;
	assert_true(srv_typical_find(scenes.scenes[0], &cancelled) > 0);
	srv_store_free(&scenes);
}

/* ---- Caps ---- */

static void etag_of(char value[100], const char *target)
{
	struct http_answer answer = http_get(port, target);
	assert_true(answer.status == 200 && http_header(&answer, "ETag", value, 100));
	http_free(&answer);
}

/* Budgets, vertices drawn and bytes of the plan for this much; what is asked for is told by its tag, too. */
static void assert_plan(const char *asked, uint64_t budget, uint64_t bytes_most)
{
	char target[200];
	snprintf(target, sizeof target, BASE "/plan?" VIEW "&vertices=%s", asked);
	json_t *plan = json_get(target);
	assert_int_equal(count_in(plan, "budget_vertices"), budget);
	assert_true((uint64_t)count_in(plan, "vertices") <= budget && (uint64_t)count_in(plan, "bytes") <= bytes_most);
	json_decref(plan);
	snprintf(target, sizeof target, BASE "/stream?" VIEW "&vertices=%s", asked);
	struct http_answer answer = http_get(port, target);
	assert_true(answer.status == 200 && answer.size <= bytes_most);
	http_free(&answer);
}

UNIT_TEST(answers_of_a_scene_may_be_capped)
{
	static struct srv_access caps;
	char tag[100], free_tag[100];
	caps = (struct srv_access){ .token_count = 0 };
	start((struct srv_config){ .access = &caps });
	http_expect(port, "GET", BASE, "", 200, "\"cap_vertices\":null,\"cap_bytes\":null");
	assert_plan("5000", 5000, UINT64_MAX);
	etag_of(free_tag, BASE "/stream?" VIEW_BY("5000"));
	stop();
	assert_good(srv_cap_add_vertices("sample=700", &caps.vertices, &cause));
	assert_good(srv_cap_add_vertices("300", &caps.vertices, &cause));
	assert_good(srv_cap_add_bytes("4k", &caps.bytes, &cause));
	start((struct srv_config){ .access = &caps });
	http_expect(port, "GET", BASE, "", 200, "\"cap_vertices\":700,\"cap_bytes\":4096");
	assert_plan("5000", 700, 4096);
	assert_plan("600", 600, 4096);
	assert_plan("9223372036854775807", 700, 4096);
	etag_of(tag, BASE "/stream?" VIEW_BY("5000"));
	assert_string_not_equal(tag, free_tag);
	stop();
}

/* ---- Who may ---- */

#define BEARER(token) "Authorization: Bearer " token "\r\n"
#define TOKEN "0123456789abcdef-park"

/* A head without what is another one's by chance, and the body. */
static char *told(const char *method, const char *scene, const char *below)
{
	static const char *const own[] = { "Date: ", "X-Request-Id: " };
	char target[200];
	snprintf(target, sizeof target, "/v1/scenes/%s%s", scene, below);
	struct http_answer answer = http_ask(port, method, target, BEARER("0123456789abcdef-none"), NULL, 0);
	char *text = NULL, *at;
	assert_true(asprintf(&text, "%s\n%s", answer.head, answer.body ? answer.body : "") > 0);
	for (size_t i = 0; i < sizeof own / sizeof *own; i++)
		if ((at = strstr(text, own[i])))
			memset(at, '-', strcspn(at, "\r"));
	while ((at = strstr(text, scene)))
		memset(at, '-', strlen(scene));
	http_free(&answer);
	return text;
}

/* A scene that needs a token, and one that is not there. */
static void assert_alike(const char *method, const char *below)
{
	char *there = told(method, "sample", below), *none = told(method, "simple", below);
	if (strcmp(there, none) != 0)
		fail_msg("%s %s:\n%s\nbut\n%s", method, below, there, none);
	free(there);
	free(none);
}

UNIT_TEST(a_scene_with_a_token_is_for_its_holders)
{
	static const struct { const char *headers; unsigned status; } rows[] = { { "", 401 },
		{ BEARER(TOKEN), 200 }, { "authorization: bearer  " TOKEN "\r\n", 200 }, { BEARER("x"), 401 },
		{ BEARER(TOKEN "x"), 401 }, { BEARER("0123456789abcdef-par"), 401 }, { BEARER(""), 401 },
		{ "Authorization: Basic " TOKEN "\r\n", 401 }, { "Authorization: " TOKEN "\r\n", 401 } };
	static const char *const methods[] = { "GET", "HEAD", "POST", "OPTIONS" },
		*const under[] = { "", "/plan?" VIEW_BY("1000"), "/plan?x=1", "/stream?" VIEW_BY("1000"), "/chunks/0123",
		"/plants/0", "/species", "/species?x=1", "/none" };
	struct srv_access access = { 0 };
	char chunk[128], plants[128], value[100];
	uint32_t standing = 0;
	give_token(&access, "sample");
	assert_code(srv_access_add_token("sample", &access, &cause), ECO_BAD_USAGE, "");
	assert_code(srv_access_add_token("sample=/dev/null", &access, &cause), ECO_CODE_COUNT, "");
	start((struct srv_config){ .access = &access });
	const struct eco_scene *tables = &scenes.scenes[0]->pack->scene;
	chunk_target(chunk, tables, 0);
	while (tables->lists[standing].kind != ECO_LIST_INSTANCES)
		standing++;
	snprintf(plants, sizeof plants, BASE "/plants/%u", standing);
	const char *const targets[] = { BASE, BASE "/plan?" VIEW_BY("1000"), BASE "/stream?" VIEW_BY("1000"),
		chunk, plants, BASE "/species" };
	for (size_t t = 0; t < sizeof targets / sizeof *targets; t++)
		for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
			struct http_answer answer = http_ask(port, "GET", targets[t], rows[i].headers, NULL, 0);
			if (answer.status != rows[i].status)
				fail_msg("%s, %s: %u", targets[t], rows[i].headers, answer.status);
			if (answer.status == 401)
				assert_header(&answer, "WWW-Authenticate", "Bearer");
			else
				assert_true(http_header(&answer, "Cache-Control", value, sizeof value)
					&& strncmp(value, "private", 7) == 0);
			http_free(&answer);
		}
	for (size_t i = 0; i < sizeof under / sizeof *under; i++)
		for (size_t m = 0; m < sizeof methods / sizeof *methods; m++)
			assert_alike(methods[m], under[i]);
	expect("GET", "/v1/scenes/simple", BEARER(TOKEN), 401);
	http_expect(port, "GET", "/v1/scenes", "", 200, "{\"scenes\":[]}");
	srv_daemon_stop(daemon_);
	char *named[] = { "smaple=none.eco" };
	const struct srv_sources none = { .count = 0 }, renamed = { named, 1, NULL, NULL };
	assert_good(srv_access_check(&access, &scenes, &none, NULL, &cause));
	strcpy(access.tokens[0].scene, "smaple");
	assert_code(srv_access_check(&access, &scenes, &none, NULL, &cause), ECO_BAD_USAGE, "");
	assert_good(srv_access_check(&access, &scenes, &renamed, &scenes, &cause));
	srv_store_free(&scenes);
}

/* The served pack, whose scene is called "sample", as one that has this name. */
static void put_renamed(const char *name)
{
	size_t size;
	uint8_t *bytes = file_read(served, &size);
	for (uint32_t i = 0; i < bytes[12]; i++) {
		const uint8_t *section = bytes + ECO_PACK_HEADER_BYTES + i * ECO_PACK_SECTION_BYTES;
		if (section[0] == ECO_SECTION_SCENE)
			strncpy((char *)bytes + resign_u64(section + 8), name, 64);
	}
	pack_resign(bytes, size);
	file_write(other_name, bytes, size);
	free(bytes);
	assert_int_equal(rename(other_name, served), 0);
}

/* Under a name that has no token, or no cap, everybody would have it. */
UNIT_TEST(a_reload_that_would_open_a_scene_changes_nothing)
{
	for (int capped = 0; capped < 2; capped++) {
		struct srv_access access = { 0 };
		if (!capped)
			give_token(&access, "sample");
		else
			assert_good(srv_cap_add_vertices("sample=700", &access.vertices, &cause));
		restore();
		start((struct srv_config){ .access = &access });
		put_renamed("simple");
		http_expect(port, "POST", RELOAD, "", 500, capped ? "--cap-vertices sample=700: there is no scene"
			: "--token sample=FILE: there is no scene");
		expect("GET", "/v1/scenes/simple", "", capped ? 404 : 401);
		expect("GET", BASE, BEARER(TOKEN), 200);
		put_renamed("sample");
		expect("POST", RELOAD, "", 200);
		stop();
	}
	restore();
}

/* The token's scene is there, but it is another file's now. */
UNIT_TEST(a_file_keeps_its_token)
{
	struct srv_access access = { 0 };
	struct srv_store before, after;
	const struct srv_sources none = { .count = 0 };
	give_token(&access, "one");
	srv_store_init(&before);
	srv_store_init(&after);
	assert_good(srv_store_add(&before, "one", served, &cause));
	assert_good(srv_store_add(&before, "two", other, &cause));
	assert_good(srv_store_add(&after, "two", served, &cause));
	assert_good(srv_store_add(&after, "one", other, &cause));
	assert_good(srv_access_check(&access, &before, &none, &before, &cause));
	assert_code(srv_access_check(&access, &after, &none, &before, &cause), ECO_BAD_USAGE, served);
	srv_store_free(&before);
	srv_store_free(&after);
}

UNIT_TEST(the_operator_has_a_token_or_the_machine)
{
	static const struct { const char *host; unsigned status; } hosts[] = { { "evil.example", 403 },
		{ "evil.example:80", 403 }, { "localhost.evil.example", 403 }, { "127.0.0.1:80", 200 },
		{ "[::1]:9", 200 }, { "localhost", 200 } };
	struct srv_access access = { 0 };
	start((struct srv_config){ 0 });
	expect("GET", "/metrics", "", 200);
	expect("POST", RELOAD, "", 200);
	expect("POST", RELOAD, "Origin: null\r\n", 403);
	for (size_t i = 0; i < sizeof hosts / sizeof *hosts; i++) {
		char request[200];
		int size = snprintf(request, sizeof request, "GET /metrics HTTP/1.1\r\nHost: %s\r\n"
			"Connection: close\r\n\r\n", hosts[i].host);
		struct http_answer answer = http_raw(port, request, (size_t)size);
		if (answer.status != hosts[i].status)
			fail_msg("%s: %u", hosts[i].host, answer.status);
		http_free(&answer);
	}
	stop();
	assert_good(srv_access_add_operator(token_file, &access, &cause));
	start((struct srv_config){ .access = &access });
	expect("GET", "/metrics", "", 403);
	expect("GET", "/metrics", BEARER("another"), 403);
	expect("GET", "/metrics", BEARER(TOKEN), 200);
	expect("GET", BASE, "", 200);
	stop();
}

/* ---- Pages of other origins ---- */

static void assert_origin(const char *target, const char *origin, const char *allowed, bool varies)
{
	char headers[100], value[100];
	snprintf(headers, sizeof headers, origin ? "Origin: %s\r\n" : "", origin);
	struct http_answer answer = http_ask(port, "GET", target, headers, NULL, 0);
	assert_int_equal(answer.status, 200);
	bool has = http_header(&answer, "Access-Control-Allow-Origin", value, sizeof value);
	assert_int_equal(has, allowed != NULL);
	if (has) {
		assert_string_equal(value, allowed);
		assert_true(http_header(&answer, "Access-Control-Expose-Headers", value, sizeof value)
			&& strstr(value, "ETag") && strstr(value, "Server-Timing"));
	}
	assert_int_equal(http_header(&answer, "Vary", value, sizeof value), varies);
	http_free(&answer);
}

UNIT_TEST(pages_of_some_origins_may_read_answers)
{
#define A "https://a.example"
#define B "http://b.example:81"
	static const struct { const char *origins[2], *asks, *allowed; bool varies; } rows[] = {
		{ { NULL }, A, NULL, false }, { { "*" }, A, "*", false }, { { "*" }, NULL, "*", false },
		{ { A }, A, A, false }, { { A }, B, A, false }, { { A, B }, B, B, true },
		{ { A, B }, "http://b.example", NULL, true }, { { A, "*" }, B, "*", false } };
	static const char *const bad[] = { "a.example", "https://", "https://a.example/", "https://a b", "" };
	struct srv_access access = { 0 };
	char chunk[128];
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
		access = (struct srv_access){ 0 };
		for (int o = 0; o < 2 && rows[i].origins[o]; o++)
			assert_good(srv_access_add_origin(rows[i].origins[o], &access, &cause));
		start((struct srv_config){ .access = &access });
		chunk_target(chunk, &scenes.scenes[0]->pack->scene, 0);
		assert_origin(chunk, rows[i].asks, rows[i].allowed, rows[i].varies);
		assert_origin(BASE "/stream?" VIEW_BY("1000"), rows[i].asks, rows[i].allowed, rows[i].varies);
		stop();
	}
	for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
		assert_int_equal(srv_access_add_origin(bad[i], &access, NULL), ECO_BAD_USAGE);
}

UNIT_TEST(pages_of_some_origins_may_have_the_viewer_in_a_frame)
{
	static const struct { const char *origins[2], *policy; } rows[] = { { { NULL }, "frame-ancestors 'self'" },
		{ { A }, "frame-ancestors 'self' " A }, { { A, B }, "frame-ancestors 'self' " A " " B },
		{ { "*" }, "frame-ancestors 'self' *" } };
	static const char *const bad[] = { "a.example", "https://a.example/", "https://a;script-src *", "'none'", "" };
	struct srv_access access;
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
		char value[1000];
		access = (struct srv_access){ 0 };
		for (int o = 0; o < 2 && rows[i].origins[o]; o++)
			assert_good(srv_access_add_frame(rows[i].origins[o], &access, &cause));
		start((struct srv_config){ .access = &access, .site = &sample_site });
		struct http_answer answer = http_get(port, "/");
		assert_true(http_header(&answer, "Content-Security-Policy", value, sizeof value));
		const char *frames = strstr(value, "frame-ancestors");
		assert_string_equal(frames ? frames : "none", rows[i].policy);
		http_free(&answer);
		stop();
	}
	for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
		assert_int_equal(srv_access_add_frame(bad[i], &access, NULL), ECO_BAD_USAGE);
	enum eco_code code = ECO_OK;
	for (int i = 0; i < 100 && !code; i++)
		code = srv_access_add_frame(A, &access, NULL);
	assert_int_equal(code, ECO_TOO_LARGE);
}

UNIT_TEST(options_say_what_a_resource_takes)
{
	start((struct srv_config){ 0 });
	struct http_answer answer = http_ask(port, "OPTIONS", BASE "/stream", "Origin: https://a.example\r\n"
		"Access-Control-Request-Method: POST\r\n", NULL, 0);
	assert_int_equal(answer.status, 204);
	assert_header(&answer, "Allow", "GET, HEAD, POST, OPTIONS");
	assert_header(&answer, "Access-Control-Allow-Methods", "GET, HEAD, POST, OPTIONS");
	http_free(&answer);
	expect("OPTIONS", "/nothing", "", 404);
	stop();
}

/* ---- Numbers ---- */

UNIT_TEST(metrics_count_what_happens_with_a_sentence_each)
{
	static const char *const lines[] = { "plans_total 1", "kept_answers_total 2", "reloads_total 1",
		"reloads_failed_total 0", "scenes 1", "ready 1",
		"requests_total{route=\"/v1/scenes/{scene}/stream\",code=\"200\"} 3",
		"requests_total{route=\"\",code=\"404\"} 1", "plan_seconds_count 1", "plan_seconds_bucket{le=\"+Inf\"} 1" };
	char line[200];
	unsigned helps = 0, types = 0;
	start((struct srv_config){ 0 });
	for (int i = 0; i < 3; i++)
		expect("GET", BASE "/stream?" VIEW_BY("1000"), "", 200);
	expect("GET", "/nothing", "", 404);
	expect("POST", RELOAD, "", 200);
	struct http_answer answer = http_get(port, "/metrics");
	assert_header(&answer, "Content-Type", "text/plain; version=0.0.4; charset=utf-8");
	for (size_t i = 0; i < sizeof lines / sizeof *lines; i++) {
		snprintf(line, sizeof line, "\necoserve_%s\n", lines[i]);
		if (!strstr(answer.body, line))
			fail_msg("no %s in:\n%s", lines[i], answer.body);
	}
	for (const char *at = answer.body; (at = strstr(at, "# HELP ")); at++, helps++)
		assert_true(strcspn(strchr(at + 7, ' '), "\n") > 15);
	for (const char *at = answer.body; (at = strstr(at, "# TYPE ")); at++)
		types++;
	assert_true(helps == types && helps >= SRV_COUNTER_COUNT + 8);
	http_free(&answer);
	stop();
}

UNIT_TEST(it_is_ready_until_it_stops)
{
	start((struct srv_config){ 0 });
	assert_true(atomic_load(&scenes.scenes[0]->typical_work) > 0);   /* no request waits for it */
	expect("GET", "/readyz", "", 200);
	srv_daemon_quiesce(daemon_);
	expect("GET", "/readyz", "", 503);
	stop();
}

/* A trusted proxy's where it is harmless; else another for each request. */
UNIT_TEST(requests_have_ids)
{
	struct srv_config config = { 0 };
	char ids[3][100];
	assert_good(srv_networks_parse("127.0.0.1", &config.trusted, &cause));
	for (int trusted = 0; trusted < 2; trusted++) {
		start(trusted ? config : (struct srv_config){ 0 });
		static const char *const sent[] = { "", "X-Request-Id: abc-1.2_X\r\n",
			"X-Request-Id: a b\r\n" };
		for (int i = 0; i < 3; i++) {
			struct http_answer answer = http_ask(port, "GET", "/nothing", sent[i], NULL, 0);
			assert_true(http_header(&answer, "X-Request-Id", ids[i], sizeof ids[i]));
			http_free(&answer);
		}
		assert_int_equal(strcmp(ids[1], "abc-1.2_X") == 0, trusted);
		assert_string_not_equal(ids[0], ids[2]);
		assert_int_equal(strlen(ids[2]), 16);
		stop();
	}
}

UNIT_MAIN(prepare, clean)
