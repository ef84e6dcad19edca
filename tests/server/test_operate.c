/* An operator's work on a daemon that serves: other packs, tokens, pages of others, numbers.
 * Longer than 600 lines: all tests share the daemon's start and its packs. */
#include "tests/support/serve/serve_daemon.h"

#include <pthread.h>
#include <stdatomic.h>

#include "server/access.h"
#include "server/metrics.h"
#include "server/reload.h"
#include "server/typical.h"
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
	FILE *file = fopen(token_file, "w");
	if (!file || fputs("0123456789abcdef-park\nnot this\n", file) < 0 || fclose(file))
		return 1;
	snprintf(pack_path, sizeof pack_path, "%s", served);
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

static struct srv_daemon *start(struct srv_config config, struct srv_store *scenes)
{
	static char *const paths[] = { served };
	static const struct srv_sources sources = { paths, 1, "build/tmp", NULL };
	struct srv_daemon *daemon;
	struct srv_reload report;
	struct eco_error error = { 0 };
	config.listen = "127.0.0.1:0";
	config.sources = &sources;
	assert_ok(srv_sources_load(&sources, NULL, scenes, &report, &error), error);
	assert_ok(srv_daemon_start(&daemon, &config, scenes, &error), error);
	port = srv_daemon_port(daemon);
	return daemon;
}

static unsigned status_of(const char *method, const char *target, const char *headers)
{
	struct http_answer answer = http_ask(port, method, target, headers, NULL, 0);
	unsigned status = answer.status;
	http_free(&answer);
	return status;
}

static json_t *answered(const char *method, const char *target, unsigned status)
{
	struct http_answer answer = http_ask(port, method, target, "", NULL, 0);
	assert_int_equal(answer.status, status);
	json_t *json = json_of(&answer);
	http_free(&answer);
	return json;
}

static int64_t count_in(json_t *json, const char *key)
{
	return json_integer_value(json_object_get(json, key));
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
	struct srv_store scenes;
	struct srv_daemon *daemon = start((struct srv_config){ .connections_per_address = 500 }, &scenes);
	pthread_t threads[4];
	uintptr_t sum = 0, failed;
	atomic_store(&over, false);
	for (int i = 0; i < 4; i++)
		assert_int_equal(pthread_create(&threads[i], NULL, ask_on, NULL), 0);
	struct eco_error error = { 0 };
	char first[80], command[200];
	snprintf(first, sizeof first, "%s.first", served);
	snprintf(command, sizeof command, "cp %s %s", served, first);
	assert_int_equal(system(command), 0);
	for (int i = 0; i < 20; i++) {
		put_in_place(i % 2 ? first : other);
		json_t *json = answered("POST", "/v1/admin/reload", 200);
		assert_int_equal(count_in(json, "opened") + count_in(json, "same"), 1);
		json_decref(json);
	}
	atomic_store(&over, true);
	for (int i = 0; i < 4; i++) {
		pthread_join(threads[i], (void **)&failed);
		sum += failed;
	}
	assert_int_equal(sum, 0);
	assert_int_equal(unlink(first), 0);
	srv_daemon_stop(daemon);
	srv_store_free(&scenes);
	assert_int_equal(sample_pack_write(served, &error), ECO_OK);
}

/* A chunk that only the pack before had is there for as long as was said. */
UNIT_TEST(chunks_of_a_replaced_pack_stay_for_a_while)
{
	struct srv_store scenes;
	struct srv_daemon *daemon = start((struct srv_config){ .keep_s = 1 }, &scenes);
	struct eco_scene *tables = &scenes.scenes[0]->pack->scene;
	char gone[128] = "", id[SRV_ID_TEXT_BYTES];
	struct eco_error error = { 0 };
	struct eco_pack *after;
	assert_ok(eco_pack_open(&after, other, &error), error);
	for (uint32_t c = 0; c < tables->chunk_count && !gone[0]; c++) {
		bool both = false;
		for (uint32_t k = 0; k < after->scene.chunk_count; k++)
			both |= memcmp(&after->scene.chunks[k].id, &tables->chunks[c].id,
					sizeof tables->chunks[c].id) == 0;
		srv_format_id(id, &tables->chunks[c].id);
		if (!both)
			snprintf(gone, sizeof gone, BASE "/chunks/%s", id);
	}
	eco_pack_close(after);
	assert_true(gone[0]);
	put_in_place(other);
	json_t *json = answered("POST", "/v1/admin/reload", 200);
	assert_int_equal(count_in(json, "opened"), 1);
	json_decref(json);
	assert_int_equal(status_of("GET", gone, ""), 200);
	usleep(1100000);
	srv_daemon_tick(daemon);
	assert_int_equal(status_of("GET", gone, ""), 404);
	srv_daemon_stop(daemon);
	srv_store_free(&scenes);
	assert_int_equal(sample_pack_write(served, &error), ECO_OK);
}

UNIT_TEST(a_pack_that_is_not_well_leaves_the_scene)
{
	struct srv_store scenes;
	struct srv_daemon *daemon = start((struct srv_config){ 0 }, &scenes);
	json_t *before = answered("GET", BASE, 200);
	struct eco_error error = { 0 };
	FILE *file = fopen(served, "w");
	assert_true(file && fputs("no pack", file) >= 0 && fclose(file) == 0);
	json_t *problem = answered("POST", "/v1/admin/reload", 500);
	assert_non_null(strstr(json_string_value(json_object_get(problem, "detail")), served));
	json_decref(problem);
	json_t *after = answered("GET", BASE, 200);
	assert_true(json_equal(before, after));
	assert_int_equal(unlink(served), 0);
	assert_int_equal(status_of("POST", "/v1/admin/reload", ""), 500);
	assert_int_equal(status_of("GET", BASE "/stream?" VIEW_BY("1000"), ""), 200);
	assert_int_equal(sample_pack_write(served, &error), ECO_OK);
	assert_int_equal(status_of("POST", "/v1/admin/reload", ""), 200);
	json_decref(before);
	json_decref(after);
	srv_daemon_stop(daemon);
	srv_store_free(&scenes);
}

/* Packs come and go with the files of a folder. */
UNIT_TEST(a_folder_is_all_packs_in_it)
{
	char folder[80], command[400];
	struct srv_store first, second;
	struct srv_reload report;
	struct eco_error error = { 0 };
	snprintf(folder, sizeof folder, "build/tmp/operate-%d-folder", (int)getpid());
	char *paths[] = { folder };
	const struct srv_sources sources = { paths, 1, NULL, NULL };
	snprintf(command, sizeof command, "rm -rf %s && mkdir %s && touch %s/.hidden.eco %s/readme", folder,
		folder, folder, folder);
	assert_int_equal(system(command), 0);
	assert_int_equal(srv_sources_load(&sources, NULL, &first, &report, &error), ECO_NOT_FOUND);
	srv_store_free(&first);
	snprintf(command, sizeof command, "cp %s %s/a.eco", served, folder);
	assert_int_equal(system(command), 0);
	assert_ok(srv_sources_load(&sources, NULL, &first, &report, &error), error);
	assert_true(first.count == 1 && report.opened == 1);
	assert_ok(srv_sources_load(&sources, &first, &second, &report, &error), error);
	assert_true(second.count == 1 && report.same == 1 && second.scenes[0] == first.scenes[0]);
	srv_store_free(&first);
	snprintf(command, sizeof command, "rm -r %s", folder);
	assert_int_equal(srv_scene_chunk(second.scenes[0], &second.scenes[0]->pack->scene.chunks[0].id) !=
			ECO_NONE,
		true);
	srv_store_free(&second);
	assert_int_equal(system(command), 0);
}

UNIT_TEST(reading_scenes_ends_when_it_is_cancelled)
{
	char *paths[] = { served };
	atomic_bool cancelled = true;
	const struct srv_sources sources = { paths, 1, "build/tmp", &cancelled },
		whole = { paths, 1, "build/tmp", NULL };
	struct srv_store scenes;
	struct srv_reload report;
	struct eco_error error = { 0 };
	assert_ok(srv_sources_load(&whole, NULL, &scenes, &report, &error), error);
	assert_int_equal(srv_typical_find(scenes.scenes[0], &cancelled), 0);
	struct srv_store again;
	assert_int_equal(srv_sources_load(&sources, NULL, &again, &report, &error), ECO_INTERRUPTED);
	srv_store_free(&again);
	assert_ok(srv_store_add(&scenes, "other", other, &error), error);
	assert_int_equal(srv_sources_load(&sources, &scenes, &again, &report, &error), ECO_OK);
	assert_int_equal(report.same, 1);        /* nothing had to be read */
	srv_store_free(&again);
	cancelled = false;
	assert_true(srv_typical_find(scenes.scenes[0], &cancelled) > 0);
	srv_store_free(&scenes);
}

/* ---- Caps ---- */

static char *etag_of(const char *target)
{
	struct http_answer answer = http_ask(port, "GET", target, "", NULL, 0);
	char value[100];
	assert_true(answer.status == 200 && http_header(&answer, "ETag", value, sizeof value));
	http_free(&answer);
	return strdup(value);
}

/* Budgets, vertices drawn and bytes of the plan for this much; what is asked for is told by its tag, too. */
static void assert_plan(const char *asked, uint64_t budget, uint64_t bytes_most)
{
	char target[200];
	snprintf(target, sizeof target, BASE "/plan?" VIEW "&vertices=%s", asked);
	json_t *plan = answered("GET", target, 200);
	uint64_t vertices = (uint64_t)json_integer_value(json_object_get(plan, "vertices"));
	assert_int_equal(json_integer_value(json_object_get(plan, "budget_vertices")), budget);
	assert_true(vertices <= budget
		&& (uint64_t)json_integer_value(json_object_get(plan, "bytes")) <= bytes_most);
	json_decref(plan);
	snprintf(target, sizeof target, BASE "/stream?" VIEW "&vertices=%s", asked);
	struct http_answer answer = http_ask(port, "GET", target, "", NULL, 0);
	assert_true(answer.status == 200 && answer.size <= bytes_most);
	http_free(&answer);
}

UNIT_TEST(answers_of_a_scene_may_be_capped)
{
	static struct srv_caps caps;
	struct srv_store scenes;
	struct eco_error error = { 0 };
	caps = (struct srv_caps){ .vertices.count = 0 };
	struct srv_daemon *daemon = start((struct srv_config){ .caps = &caps }, &scenes);
	json_t *described = answered("GET", BASE, 200);
	assert_true(json_is_null(json_object_get(described, "cap_vertices"))
		&& json_is_null(json_object_get(described, "cap_bytes")));
	json_decref(described);
	assert_plan("5000", 5000, UINT64_MAX);
	char *free_tag = etag_of(BASE "/stream?" VIEW_BY("5000"));
	srv_daemon_stop(daemon);
	srv_store_free(&scenes);
	assert_ok(srv_cap_add_vertices("sample=700", &caps.vertices, &error), error);
	assert_ok(srv_cap_add_vertices("300", &caps.vertices, &error), error);
	assert_ok(srv_cap_add_bytes("4k", &caps.bytes, &error), error);
	daemon = start((struct srv_config){ .caps = &caps }, &scenes);
	assert_ok(srv_access_check(NULL, &caps, &scenes, &(struct srv_sources){ .count = 0 }, NULL, &error), error);
	described = answered("GET", BASE, 200);
	assert_int_equal(json_integer_value(json_object_get(described, "cap_vertices")), 700);
	assert_int_equal(json_integer_value(json_object_get(described, "cap_bytes")), 4096);
	json_decref(described);
	assert_plan("5000", 700, 4096);
	assert_plan("600", 600, 4096);
	assert_plan("9223372036854775807", 700, 4096);
	char *tag = etag_of(BASE "/stream?" VIEW_BY("5000"));
	assert_string_not_equal(tag, free_tag);
	free(tag);
	free(free_tag);
	srv_daemon_stop(daemon);
	srv_store_free(&scenes);
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
	static struct srv_access access;
	struct srv_store scenes;
	struct eco_error error = { 0 };
	char argument[100];
	access = (struct srv_access){ 0 };
	snprintf(argument, sizeof argument, "sample=%s", token_file);
	assert_ok(srv_access_add_token(argument, &access, &error), error);
	assert_int_equal(srv_access_add_token("sample", &access, &error), ECO_BAD_USAGE);
	assert_true(srv_access_add_token("sample=/dev/null", &access, &error) != ECO_OK);
	struct srv_daemon *daemon = start((struct srv_config){ .access = &access }, &scenes);
	static const struct { const char *headers; unsigned status; } rows[] = { { "", 401 },
		{ BEARER(TOKEN), 200 }, { "authorization: bearer  " TOKEN "\r\n", 200 }, { BEARER("x"), 401 },
		{ BEARER(TOKEN "x"), 401 }, { BEARER("0123456789abcdef-par"), 401 }, { BEARER(""), 401 },
		{ "Authorization: Basic " TOKEN "\r\n", 401 }, { "Authorization: " TOKEN "\r\n", 401 } };
	char chunk[128];
	struct eco_scene *tables = &scenes.scenes[0]->pack->scene;
	char id[SRV_ID_TEXT_BYTES];
	srv_format_id(id, &tables->chunks[0].id);
	snprintf(chunk, sizeof chunk, BASE "/chunks/%s", id);
	char plants[128];
	uint32_t standing = 0;
	while (tables->lists[standing].kind != ECO_LIST_INSTANCES)
		standing++;
	snprintf(plants, sizeof plants, BASE "/plants/%u", standing);
	const char *const targets[] = { BASE, BASE "/plan?" VIEW_BY("1000"), BASE "/stream?" VIEW_BY("1000"),
		chunk, plants, BASE "/species" };
	for (size_t t = 0; t < sizeof targets / sizeof *targets; t++)
		for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
			struct http_answer answer =
				http_ask(port, "GET", targets[t], rows[i].headers, NULL, 0);
			char value[100];
			if (answer.status != rows[i].status)
				fail_msg("%s, %s: %u", targets[t], rows[i].headers, answer.status);
			if (answer.status == 401)
				assert_header(&answer, "WWW-Authenticate", "Bearer");
			else
				assert_true(http_header(&answer, "Cache-Control", value, sizeof value)
					&& strncmp(value, "private", 7) == 0);
			http_free(&answer);
		}
	static const char *const methods[] = { "GET", "HEAD", "POST", "OPTIONS" },
				 *const under[] = { "", "/plan?" VIEW_BY("1000"), "/plan?x=1",
		"/stream?" VIEW_BY("1000"), "/chunks/0123", "/plants/0", "/species", "/species?x=1", "/none" };
	for (size_t i = 0; i < sizeof under / sizeof *under; i++)
		for (size_t m = 0; m < sizeof methods / sizeof *methods; m++)
			assert_alike(methods[m], under[i]);
	assert_int_equal(status_of("GET", "/v1/scenes/simple", BEARER(TOKEN)), 401);
	json_t *list = answered("GET", "/v1/scenes", 200);
	assert_int_equal(json_array_size(json_object_get(list, "scenes")), 0);
	json_decref(list);
	srv_daemon_stop(daemon);
	char *named[] = { "smaple=none.eco" };
	const struct srv_sources none = { .count = 0 }, renamed = { named, 1, NULL, NULL };
	assert_int_equal(srv_access_check(&access, NULL, &scenes, &none, NULL, &error), ECO_OK);
	strcpy(access.tokens[0].scene, "smaple");
	assert_int_equal(srv_access_check(&access, NULL, &scenes, &none, NULL, &error), ECO_BAD_USAGE);
	assert_int_equal(srv_access_check(&access, NULL, &scenes, &renamed, NULL, &error), ECO_OK);
	assert_int_equal(srv_access_check(&access, NULL, &scenes, &renamed, &scenes, &error), ECO_OK);
	srv_store_free(&scenes);
}

/* The served pack, whose scene is called "sample", as one that has this name. */
static void put_renamed(const char *name)
{
	static uint8_t bytes[8 << 20];
	FILE *file = fopen(served, "rb"), *to = fopen(other_name, "wb");
	assert_true(file && to);
	size_t size = fread(bytes, 1, sizeof bytes, file);
	for (uint32_t i = 0; i < bytes[12]; i++) {
		const uint8_t *section = bytes + ECO_PACK_HEADER_BYTES + i * ECO_PACK_SECTION_BYTES;
		if (section[0] == ECO_SECTION_SCENE)
			strncpy((char *)bytes + resign_u64(section + 8), name, 64);
	}
	pack_resign(bytes, size);
	assert_int_equal(fwrite(bytes, 1, size, to), size);
	assert_true(fclose(file) == 0 && fclose(to) == 0);
	assert_int_equal(rename(other_name, served), 0);
}

/* Under a name that has no token, or no cap, everybody would have it. */
UNIT_TEST(a_reload_that_would_open_a_scene_changes_nothing)
{
	static struct srv_access access;
	static struct srv_caps caps;
	struct eco_error error = { 0 };
	char argument[100];
	for (int capped = 0; capped < 2; capped++) {
		struct srv_store scenes;
		access = (struct srv_access){ 0 };
		caps = (struct srv_caps){ .vertices.count = 0 };
		snprintf(argument, sizeof argument, "sample=%s", token_file);
		assert_ok(capped ? srv_cap_add_vertices("sample=700", &caps.vertices, &error)
			: srv_access_add_token(argument, &access, &error), error);
		assert_ok(sample_pack_write(served, &error), error);
		struct srv_daemon *daemon = start((struct srv_config){ .access = &access, .caps = &caps },
			&scenes);
		put_renamed("simple");
		json_t *problem = answered("POST", "/v1/admin/reload", 500);
		assert_non_null(strstr(json_string_value(json_object_get(problem, "detail")), capped
			? "--cap-vertices sample=700: there is no scene"
			: "--token sample=FILE: there is no scene"));
		json_decref(problem);
		assert_int_equal(status_of("GET", "/v1/scenes/simple", ""), capped ? 404 : 401);
		assert_int_equal(status_of("GET", BASE, BEARER(TOKEN)), 200);
		put_renamed("sample");
		assert_int_equal(status_of("POST", "/v1/admin/reload", ""), 200);
		srv_daemon_stop(daemon);
		srv_store_free(&scenes);
	}
	assert_ok(sample_pack_write(served, &error), error);
}

/* The token's scene is there, but it is another file's now. */
UNIT_TEST(a_file_keeps_its_token)
{
	static struct srv_access access;
	struct srv_store before, after;
	struct eco_error error = { 0 };
	char argument[100];
	access = (struct srv_access){ 0 };
	snprintf(argument, sizeof argument, "one=%s", token_file);
	assert_ok(srv_access_add_token(argument, &access, &error), error);
	srv_store_init(&before);
	srv_store_init(&after);
	assert_ok(srv_store_add(&before, "one", served, &error), error);
	assert_ok(srv_store_add(&before, "two", other, &error), error);
	assert_ok(srv_store_add(&after, "two", served, &error), error);
	assert_ok(srv_store_add(&after, "one", other, &error), error);
	const struct srv_sources none = { .count = 0 };
	assert_ok(srv_access_check(&access, NULL, &before, &none, &before, &error), error);
	assert_int_equal(srv_access_check(&access, NULL, &after, &none, &before, &error), ECO_BAD_USAGE);
	assert_non_null(strstr(error.text, served));
	srv_store_free(&before);
	srv_store_free(&after);
}

UNIT_TEST(the_operator_has_a_token_or_the_machine)
{
	static struct srv_access access;
	struct srv_store scenes;
	struct eco_error error = { 0 };
	struct srv_daemon *daemon = start((struct srv_config){ 0 }, &scenes);
	assert_int_equal(status_of("GET", "/metrics", ""), 200);
	assert_int_equal(status_of("POST", "/v1/admin/reload", ""), 200);
	assert_int_equal(status_of("POST", "/v1/admin/reload", "Origin: null\r\n"), 403);
	static const struct { const char *host; unsigned status; } hosts[] = { { "evil.example", 403 },
		{ "evil.example:80", 403 }, { "localhost.evil.example", 403 }, { "127.0.0.1:80", 200 },
		{ "[::1]:9", 200 }, { "localhost", 200 } };
	for (size_t i = 0; i < sizeof hosts / sizeof *hosts; i++) {
		char request[200];
		int size = snprintf(request, sizeof request, "GET /metrics HTTP/1.1\r\nHost: %s\r\n"
			"Connection: close\r\n\r\n", hosts[i].host);
		struct http_answer answer = http_raw(port, request, (size_t)size);
		if (answer.status != hosts[i].status)
			fail_msg("%s: %u", hosts[i].host, answer.status);
		http_free(&answer);
	}
	srv_daemon_stop(daemon);
	srv_store_free(&scenes);
	access = (struct srv_access){ 0 };
	assert_ok(srv_access_add_operator(token_file, &access, &error), error);
	daemon = start((struct srv_config){ .access = &access }, &scenes);
	assert_int_equal(status_of("GET", "/metrics", ""), 403);
	assert_int_equal(status_of("GET", "/metrics", BEARER("another")), 403);
	assert_int_equal(status_of("GET", "/metrics", BEARER(TOKEN)), 200);
	assert_int_equal(status_of("GET", BASE, ""), 200);
	srv_daemon_stop(daemon);
	srv_store_free(&scenes);
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
	static const struct { const char *origins[2], *asks, *allowed; bool varies;
	} rows[] = { { { NULL }, "https://a.example", NULL, false },
		{ { "*" }, "https://a.example", "*", false }, { { "*" }, NULL, "*", false },
		{ { "https://a.example" }, "https://a.example", "https://a.example", false },
		{ { "https://a.example" }, "https://b.example", "https://a.example", false },
		{ { "https://a.example", "http://b.example:81" }, "http://b.example:81",
			"http://b.example:81", true },
		{ { "https://a.example", "http://b.example:81" }, "http://b.example", NULL, true },
		{ { "https://a.example", "*" }, "http://b.example", "*", false } };
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
		static struct srv_access access;
		struct srv_store scenes;
		struct eco_error error = { 0 };
		char chunk[128], id[SRV_ID_TEXT_BYTES];
		access = (struct srv_access){ 0 };
		for (int o = 0; o < 2 && rows[i].origins[o]; o++)
			assert_ok(srv_access_add_origin(rows[i].origins[o], &access, &error), error);
		struct srv_daemon *daemon = start((struct srv_config){ .access = &access }, &scenes);
		srv_format_id(id, &scenes.scenes[0]->pack->scene.chunks[0].id);
		snprintf(chunk, sizeof chunk, BASE "/chunks/%s", id);
		for (int twice = 0; twice < 2; twice++)
			assert_origin(chunk, rows[i].asks, rows[i].allowed, rows[i].varies);
		assert_origin(BASE "/stream?" VIEW_BY("1000"), rows[i].asks, rows[i].allowed, rows[i].varies);
		srv_daemon_stop(daemon);
		srv_store_free(&scenes);
	}
	struct srv_access access = { 0 };
	static const char *const bad[] = { "a.example", "https://", "https://a.example/", "https://a b", "" };
	for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
		assert_int_equal(srv_access_add_origin(bad[i], &access, NULL), ECO_BAD_USAGE);
}

UNIT_TEST(pages_of_some_origins_may_have_the_viewer_in_a_frame)
{
	static const struct { const char *origins[2], *policy;
	} rows[] = { { { NULL }, "frame-ancestors 'self'" },
		{ { "https://a.example" }, "frame-ancestors 'self' https://a.example" },
		{ { "https://a.example", "http://b.example:81" },
			"frame-ancestors 'self' https://a.example http://b.example:81" },
		{ { "*" }, "frame-ancestors 'self' *" } };
	static struct srv_access access;
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
		struct srv_store scenes;
		struct eco_error error = { 0 };
		char value[1000];
		access = (struct srv_access){ 0 };
		for (int o = 0; o < 2 && rows[i].origins[o]; o++)
			assert_ok(srv_access_add_frame(rows[i].origins[o], &access, &error), error);
		const struct srv_config config = { .access = &access, .site = &sample_site };
		struct srv_daemon *daemon = start(config, &scenes);
		struct http_answer answer = http_get(port, "/");
		assert_true(http_header(&answer, "Content-Security-Policy", value, sizeof value));
		const char *frames = strstr(value, "frame-ancestors");
		assert_non_null(frames);
		assert_string_equal(frames, rows[i].policy);
		http_free(&answer);
		srv_daemon_stop(daemon);
		srv_store_free(&scenes);
	}
	static const char *const bad[] = { "a.example", "https://a.example/", "https://a;script-src *", "'none'",
		"" };
	for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
		assert_int_equal(srv_access_add_frame(bad[i], &access, NULL), ECO_BAD_USAGE);
	enum eco_code code = ECO_OK;
	for (int i = 0; i < 100 && !code; i++)
		code = srv_access_add_frame("https://a.example", &access, NULL);
	assert_int_equal(code, ECO_TOO_LARGE);
}

UNIT_TEST(options_say_what_a_resource_takes)
{
	struct srv_store scenes;
	struct srv_daemon *daemon = start((struct srv_config){ 0 }, &scenes);
	struct http_answer answer = http_ask(port, "OPTIONS", BASE "/stream", "Origin: https://a.example\r\n"
		"Access-Control-Request-Method: POST\r\n", NULL, 0);
	assert_int_equal(answer.status, 204);
	assert_header(&answer, "Allow", "GET, HEAD, POST, OPTIONS");
	assert_header(&answer, "Access-Control-Allow-Methods", "GET, HEAD, POST, OPTIONS");
	http_free(&answer);
	assert_int_equal(status_of("OPTIONS", "/nothing", ""), 404);
	srv_daemon_stop(daemon);
	srv_store_free(&scenes);
}

/* ---- Numbers ---- */

static uint64_t metric(const char *text, const char *name)
{
	char line[200];
	snprintf(line, sizeof line, "\n%s ", name);
	const char *at = strstr(text, line);
	if (!at)
		fail_msg("no %s in:\n%s", name, text);
	return strtoull(at + strlen(line), NULL, 10);
}

UNIT_TEST(metrics_count_what_happens_with_a_sentence_each)
{
	struct srv_store scenes;
	struct srv_daemon *daemon = start((struct srv_config){ 0 }, &scenes);
	for (int i = 0; i < 3; i++)
		assert_int_equal(status_of("GET", BASE "/stream?" VIEW_BY("1000"), ""), 200);
	assert_int_equal(status_of("GET", "/nothing", ""), 404);
	assert_int_equal(status_of("POST", "/v1/admin/reload", ""), 200);
	struct http_answer answer = http_get(port, "/metrics");
	assert_int_equal(answer.status, 200);
	assert_header(&answer, "Content-Type", "text/plain; version=0.0.4; charset=utf-8");
	static const struct { const char *name; uint64_t value; } rows[] = { { "ecoserve_plans_total", 1 },
		{ "ecoserve_kept_answers_total", 2 }, { "ecoserve_reloads_total", 1 },
		{ "ecoserve_reloads_failed_total", 0 }, { "ecoserve_scenes", 1 }, { "ecoserve_ready", 1 },
		{ "ecoserve_requests_total{route=\"/v1/scenes/{scene}/stream\",code=\"200\"}", 3 },
		{ "ecoserve_requests_total{route=\"\",code=\"404\"}", 1 },
		{ "ecoserve_plan_seconds_count", 1 }, { "ecoserve_plan_seconds_bucket{le=\"+Inf\"}", 1 } };
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
		assert_int_equal(metric(answer.body, rows[i].name), rows[i].value);
	unsigned helps = 0, types = 0;
	for (const char *at = answer.body; (at = strstr(at, "# HELP ")); at++, helps++)
		assert_true(strcspn(strchr(at + 7, ' '), "\n") > 15);
	for (const char *at = answer.body; (at = strstr(at, "# TYPE ")); at++)
		types++;
	assert_int_equal(helps, types);
	assert_true(helps >= SRV_COUNTER_COUNT + 8);
	http_free(&answer);
	srv_daemon_stop(daemon);
	srv_store_free(&scenes);
}

UNIT_TEST(it_is_ready_until_it_stops)
{
	struct srv_store scenes;
	struct srv_daemon *daemon = start((struct srv_config){ 0 }, &scenes);
	assert_true(atomic_load(&scenes.scenes[0]->typical_work) > 0);   /* no request waits for it */
	assert_int_equal(status_of("GET", "/readyz", ""), 200);
	srv_daemon_quiesce(daemon);
	assert_int_equal(status_of("GET", "/readyz", ""), 503);
	srv_daemon_stop(daemon);
	srv_store_free(&scenes);
}

/* A trusted proxy's where it is harmless; else another for each request. */
UNIT_TEST(requests_have_ids)
{
	struct srv_store scenes;
	struct srv_config config = { 0 };
	struct eco_error error = { 0 };
	char ids[3][100];
	assert_ok(srv_networks_parse(&config.trusted, "127.0.0.1", &error), error);
	for (int trusted = 0; trusted < 2; trusted++) {
		struct srv_daemon *daemon = start(trusted ? config : (struct srv_config){ 0 }, &scenes);
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
		srv_daemon_stop(daemon);
		srv_store_free(&scenes);
	}
}

int main(void)
{
	return unit_tests_run(prepare, clean);
}
