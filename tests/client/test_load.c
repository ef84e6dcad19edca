/* Load tests: their figures against a simple twin; what they make of servers that stall, break off, refuse
 * and lie, by a server that answers as it is told; and every option against ecoserve. */
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "client-min/load/view_load.h"
#include "ecofiles/base/array_grow.h"
#include "tests/support/files.h"
#include "tests/support/ground_tiles.h"
#include "tests/support/serve/serve_daemon.h"

/* ---- A server that answers as it is told ---- */

#define NONE_FITS "HTTP/1.1 204 No Content\r\n\r\n"
#define BROKEN "HTTP/1.1 200 OK\r\nContent-Length: 1000\r\n\r\nabc"

static struct told {
	int listener;
	uint16_t port;
	const char *answers[4];          /* the first requests get these, all others NONE_FITS; "": none */
	bool closes;                     /* the connection, behind one of these */
	uint32_t stalls_at;              /* which request makes all wait; 0: none */
	uint32_t stall_ms;
	uint32_t asked, connections, gets;
	double stall_from_ms, stall_to_ms;
	pthread_mutex_t lock;
	pthread_t thread;
} told;

/* False: the connection is to be closed. */
static bool told_answer(int fd, const char *request)
{
	pthread_mutex_lock(&told.lock);
	uint32_t number = told.asked++;
	const char *text = number < 4 && told.answers[number] ? told.answers[number] : NONE_FITS;
	told.gets += !strncmp(request, "GET", 3);
	if (told.stalls_at && number == told.stalls_at) {
		told.stall_from_ms = view_clock_ms();
		usleep(told.stall_ms * 1000);
		told.stall_to_ms = view_clock_ms();
	}
	pthread_mutex_unlock(&told.lock);
	send(fd, text, strlen(text), MSG_NOSIGNAL);
	return text[0] && !(told.closes && text != (const char *)NONE_FITS);
}

static void *told_connection(void *ctx)
{
	int fd = (int)(intptr_t)ctx;
	char request[8192];
	size_t size;
	while (http_hear(fd, request, sizeof request, &size) && (told_answer(fd, request) || !told.closes))
		continue;
	close(fd);
	return NULL;
}

static void *told_run(void *ctx)
{
	for (int fd; (fd = accept(told.listener, NULL, NULL)) >= 0; told.connections++) {
		pthread_t thread;
		assert_int_equal(pthread_create(&thread, NULL, told_connection, (void *)(intptr_t)fd), 0);
		pthread_detach(thread);
	}
	return NULL;
}

static void told_start(struct told given)
{
	told = given;
	pthread_mutex_init(&told.lock, NULL);
	told.listener = http_listen(&told.port);
	assert_int_equal(pthread_create(&told.thread, NULL, told_run, NULL), 0);
}

static void told_stop(void)
{
	shutdown(told.listener, SHUT_RDWR);
	pthread_join(told.thread, NULL);
	close(told.listener);
}

/* ---- Runs ---- */

static struct eco_view views[2] = { { { 50, -30, 12 }, { 50, 30, 2 }, { 0, 0, 1 }, 45, 400, 300 },
	{ { 50, -20, 12 }, { 50, 30, 2 }, { 0, 0, 1 }, 45, 400, 300 } };
static struct view_load_report report;
static char url[96];

static struct view_load_options options_at(uint16_t at)
{
	snprintf(url, sizeof url, "http://127.0.0.1:%u" BASE, at);
	return (struct view_load_options){ .url = url, .views = views, .view_count = 2, .clients = 1,
		.seconds = 0.3, .vertices = 5000, .bytes = ECO_BYTES_UNBOUNDED };
}

static void run(const struct view_load_options *options)
{
	view_load_free(&report);
	assert_good(view_load_run(&report, options, &cause));
}

static void run_clean(const struct view_load_options *options)
{
	run(options);
	if (!view_load_clean(&report))
		fail_msg("%s", report.first_failure);
}

/* ---- Servers that are not well ---- */

/* 4 clients, 100 requests a second, and a server that answers nobody for .6 s: what was due meanwhile waited
 * until it ended, though no client had more than one request on its way. A closed loop would not see it. */
UNIT_TEST(an_open_loop_counts_from_when_requests_were_due)
{
	told_start((struct told){ .stalls_at = 20, .stall_ms = 600 });
	struct view_load_options options = options_at(told.port);
	options.clients = 4;
	options.rate = 100;
	options.seconds = 1.2;
	run_clean(&options);
	told_stop();
	uint32_t due_meanwhile = 0, asked_later = 0;
	for (uint32_t i = 0; i < report.answers.count; i++) {
		const struct view_answer *a = &report.answers.items[i];
		double due_ms = report.start_ms + a->due_ms, done_ms = due_ms + (double)a->done_ms;
		assert_true(fabs(a->due_ms - 10 * i) < 1e-6);
		assert_true(fabsf(a->asked_ms + a->service_ms - a->done_ms) < 1);
		if (due_ms <= told.stall_from_ms || due_ms >= told.stall_to_ms)
			continue;
		due_meanwhile++;
		assert_true(done_ms >= told.stall_to_ms - 1);
		asked_later += due_ms + (double)a->asked_ms >= told.stall_to_ms - 1;
	}
	assert_int_equal(report.answers.count, 120);
	assert_true(due_meanwhile >= 55);
	assert_true(asked_later >= due_meanwhile - 4);
}

UNIT_TEST(what_goes_wrong_is_counted_by_kind)
{
	static const struct {
		const char *answers[4];
		bool closes;
		uint32_t resumes;
		enum view_outcome outcome;
		uint64_t failures, resumed;
	} cases[] = {
		{ { BROKEN }, true, 0, VIEW_BROKEN, 1, 0 },
		{ { BROKEN }, true, 1, VIEW_BROKEN, 0, 1 },
		{ { BROKEN, BROKEN }, true, 1, VIEW_BROKEN, 1, 0 },
		{ { "HTTP/1.1 502 Bad\r\nContent-Length: 0\r\n\r\n" }, false, 1, VIEW_REFUSED, 0, 1 },
		{ { "HTTP/1.1 502 Bad\r\nContent-Length: 0\r\n\r\n" }, false, 0, VIEW_REFUSED, 1, 0 },
		{ { "HTTP/1.1 503 Busy\r\nRetry-After: 0\r\nContent-Length: 0\r\n\r\n" }, false, 1, VIEW_BUSY,
			1, 0 },
		{ { "HTTP/1.1 404 None\r\nContent-Length: 4\r\n\r\nnone" }, false, 1, VIEW_REFUSED, 1, 0 },
		{ { "HTTP/1.1 409 Other\r\nContent-Length: 0\r\n\r\n" }, false, 1, VIEW_REFUSED, 1, 0 },
		{ { "HTTP/1.1 200 OK\r\nContent-Length: 24\r\n\r\nThis is not a stream at." }, false, 1,
			VIEW_DAMAGED, 1, 0 },
		{ { "" }, false, 1, VIEW_LATE, 1, 0 },
	};
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		struct told given = { .closes = cases[i].closes };
		memcpy(given.answers, cases[i].answers, sizeof given.answers);
		told_start(given);
		struct view_load_options options = options_at(told.port);
		options.resumes = cases[i].resumes;
		options.deadline_ms = cases[i].outcome == VIEW_LATE ? 100 : 0;
		options.seconds = 0.5;
		run(&options);
		told_stop();
		if (report.outcomes[cases[i].outcome] != cases[i].failures)
			fail_msg("case %zu: %s", i, report.first_failure);
		assert_int_equal(view_load_failures(&report), cases[i].failures);
		assert_int_equal(report.resumed, cases[i].resumed);
		assert_int_equal(view_load_clean(&report), !cases[i].failures);
		assert_true(report.outcomes[VIEW_ANSWERED] > 0);
	}
	struct view_load_options nobody = options_at(told.port);     /* where none listens any more */
	run(&nobody);
	assert_int_equal(report.outcomes[VIEW_CONNECTION], report.answers.count);
	assert_false(view_load_clean(&report));
}

UNIT_TEST(random_arrivals_have_their_rate_and_their_seed)
{
	double first[2];
	told_start((struct told){ .stalls_at = 0 });
	struct view_load_options options = options_at(told.port);
	options.clients = 10;
	options.rate = 500;
	options.random_arrivals = true;
	options.seconds = 1;
	for (int i = 0; i < 3; i++) {
		options.seed = i == 2 ? 8 : 7;
		run_clean(&options);
		assert_in_range(report.answers.count, 400, 600);
		if (i < 2)
			first[i] = report.answers.items[0].due_ms;
	}
	told_stop();
	assert_true(fabs(first[0] - first[1]) < 1e-3);
	assert_true(fabs(first[0] - report.answers.items[0].due_ms) > 1e-3);
}

UNIT_TEST(a_stop_ends_it_with_what_there_is)
{
	static volatile sig_atomic_t stop = 1;
	told_start((struct told){ .answers = { "" } });
	struct view_load_options options = options_at(told.port);
	options.stop = &stop;
	options.seconds = 1000;
	run(&options);
	told_stop();
	assert_int_equal(view_load_failures(&report), 0);
	assert_false(view_load_clean(&report));
}

/* ---- ecoserve ---- */

UNIT_TEST(clients_that_count_see_what_those_that_decode_see)
{
	uint64_t bytes[2], chunks[2], vertices[2];
	for (uint32_t decodes = 0; decodes < 2; decodes++) {
		struct view_load_options options = options_at(port);
		options.decoding = decodes;
		options.rate = 10;
		options.seconds = 0.35;
		run_clean(&options);
		assert_int_equal(report.answers.count, 4);
		assert_int_equal(report.chunks_decoded, decodes ? report.chunks : 0);
		assert_true(report.chunks > 0 && report.vertices > 0);
		bytes[decodes] = report.bytes;
		chunks[decodes] = report.chunks;
		vertices[decodes] = report.vertices;
		const struct view_answer *a = report.answers.items;
		assert_true(a->first_byte_ms <= a->picture_ms && a->picture_ms <= a->done_ms);
		assert_true(isnan(a->q80_ms) == !(a->predicted_q >= 0.8f));
		assert_true(a->bytes > 4 * (a + 2)->bytes);      /* the same view again: it is held */
	}
	assert_int_equal(bytes[0], bytes[1]);
	assert_int_equal(chunks[0], chunks[1]);
	assert_int_equal(vertices[0], vertices[1]);
}

UNIT_TEST(cold_clients_hold_nothing_and_named_chunks_are_fetched)
{
	char chunks[128];
	struct view_load_options options = options_at(port);
	options.clients = options.decoding = 2;
	options.cold = 1;
	options.rate = 20;
	run_clean(&options);
	uint64_t bytes = report.bytes;
	assert_int_equal(report.answers.count, 6);
	for (uint32_t i = 0; i < 6; i++)
		if (report.answers.items[i].cold)
			assert_true(report.answers.items[i].bytes > 1000);
	snprintf(chunks, sizeof chunks, "%s/chunks/", url);
	options.chunks = chunks;
	options.name_from = 300;
	run_clean(&options);
	assert_true(report.chunks_named > 10);
	assert_in_range(report.bytes, bytes, bytes + 40 * report.chunks_named);
	options.name_from = 1u << 30;
	run_clean(&options);
	assert_int_equal(report.chunks_named, 0);
	options.name_from = 300;
	options.chunks = url;                    /* no chunks lie there */
	run(&options);
	assert_int_equal(report.outcomes[VIEW_REFUSED], report.answers.count);
}

UNIT_TEST(a_line_has_its_bandwidth_and_its_latency)
{
	struct view_load_options options = options_at(port);
	options.cold = 1;
	options.bandwidth_bytes_s = 500000;
	options.latency_ms = 40;
	for (int named = 0; named < 2; named++) {
		char chunks[128];
		snprintf(chunks, sizeof chunks, "%s/chunks", url);
		options.chunks = named ? chunks : NULL;
		run_clean(&options);
		for (uint32_t i = 0; i < report.answers.count; i++) {
			const struct view_answer *a = &report.answers.items[i];
			double least_ms = 40 + 1e3 * (double)a->bytes / 500000;
			assert_true((double)a->done_ms >= least_ms - 1);
			assert_true((double)a->first_byte_ms >= 40);
		}
	}
}

UNIT_TEST(budgets_are_asked_for_and_held_against_answers)
{
	struct view_load_options options = options_at(port);
	options.bytes = 9000;
	options.cold = 1;
	run_clean(&options);
	for (uint32_t i = 0; i < report.answers.count; i++)
		assert_true(report.answers.items[i].bytes <= 9000);
	options.bytes = 10;                      /* nothing fits */
	run_clean(&options);
	assert_int_equal(report.nothing, report.answers.count);
	options = options_at(port);
	options.vertices = 100;
	run_clean(&options);
	assert_true(report.vertices <= 100 * report.answers.count);
}

/* ---- Views ---- */

static struct view_load_options views_of(const char *camera, uint64_t seed)
{
	struct view_fetch *fetch;
	struct view_load_options made = { .camera = camera, .width = 32, .height = 24, .seed = seed };
	snprintf(url, sizeof url, "http://127.0.0.1:%u" BASE, port);
	assert_good(view_fetch_new(&fetch, &(struct view_fetch_options){ .url = url }, &cause));
	assert_good(view_views_make(&made, fetch, &cause));
	view_fetch_free(fetch);
	return made;
}

UNIT_TEST(views_are_made_for_the_scene)
{
	struct view_load_options walk = views_of("walk", 1), over = views_of("flyover", 1),
		one = views_of("random", 1), same = views_of("random", 1), other = views_of("random", 2);
	const struct eco_tile *root = &scene()->tiles[scene()->root];
	for (uint32_t i = 0; i < one.view_count; i++) {
		assert_int_equal(one.views[i].width, 32);
		assert_memory_equal(&one.views[i], &same.views[i], sizeof one.views[i]);
		assert_memory_not_equal(&one.views[i], &other.views[i], sizeof one.views[i]);
		for (int axis = 0; axis < 2; axis++)
			assert_true(walk.views[i].eye[axis] >= root->low[axis]
				&& walk.views[i].eye[axis] <= root->high[axis]);
		assert_true(over.views[i].eye[2] > walk.views[i].eye[2] + 5);
	}
	eco_free(walk.views, over.views, one.views, same.views, other.views);
}

/* ---- Reports ---- */

static uint32_t count_of(const char *text, const char *what)
{
	uint32_t count = 0;
	for (const char *at = text; (at = strstr(at, what)); at++)
		count++;
	return count;
}

static double slope(double x, double y)
{
	return x / 8 + y / 16;
}

/* The sample scene has a texture that is no picture. */
UNIT_TEST(a_sample_is_drawn_and_scored)
{
	struct view_fetch *fetch;
	struct srv_store plain;
	struct srv_daemon *other;
	char path[64];
	snprintf(path, sizeof path, "build/tmp/load-%d.eco", (int)getpid());
	srv_store_init(&plain);
	struct eco_ground ground = ground_make(16, 16, -8, -8, 8, slope);
	assert_good(sample_pack_write_on(path, &ground, true, &cause));
	eco_ground_free(&ground);
	assert_good(srv_store_add(&plain, "sample", path, &cause));
	assert_good(srv_daemon_start(&other, &(struct srv_config){ .listen = "127.0.0.1:0" }, &plain, &cause));
	struct view_load_options options = options_at(srv_daemon_port(other));
	options.rate = 10;
	run_clean(&options);
	assert_int_equal(report.answers.count, 3);
	assert_good(view_fetch_new(&fetch, &(struct view_fetch_options){ .url = url }, &cause));
	assert_good(view_score_sample(&report, fetch, 3, &cause));
	assert_int_equal(report.scored_count, 3);
	const struct view_scored *scored = report.scored;
	for (uint32_t i = 0; i < 3; i++) {
		assert_int_equal(scored[i].frame, i % 2);
		assert_true(scored[i].q < 0.99 && scored[i].precision >= scored[i].q);
		assert_true(fabs(scored[i].q - scored[i % 2].q) < 1e-9);
	}
	options.vertices = ECO_VERTICES_MAX;     /* all there is */
	assert_good(view_score_sample(&report, fetch, 1, &cause));
	assert_true(report.scored->q > 0.99 && report.scored->recall > 0.99);
	assert_int_equal(report.scored->coarse, 0);
	view_fetch_free(fetch);
	srv_daemon_stop(other);
	srv_store_free(&plain);
	unlink(path);
}

UNIT_TEST(reports_say_what_there_was)
{
	const struct view_scored scored[2] = { { 0, 0.9, 0.8, 0.85, 0.9, 0 }, { 1, NAN, 0.8, 0.85, 0.9, 7 } };
	struct eco_error error = { 0 };
	struct view_load_options options = options_at(port);
	options.clients = 2;
	options.cold = 1;
	options.rate = 30;
	options.camera = "walk";
	run_clean(&options);
	report.scored = memcpy(malloc(sizeof scored), scored, sizeof scored);
	report.scored_count = 2;
	json_t *json = view_load_json(&report);
	assert_int_equal(json_integer_value(json_object_get(json, "requests")), report.answers.count);
	json_t *cold = json_object_get(json_object_get(json, "cold"), "latency_ms");
	assert_true(json_real_value(json_object_get(cold, "p50")) > 0);
	assert_true(json_real_value(json_object_get(cold, "p90")) >= json_real_value(json_object_get(cold,
		"p50"))
		&& json_real_value(json_object_get(cold, "max")) >= json_real_value(json_object_get(cold,
			"p99")));
	assert_true(json_real_value(json_object_get(cold, "reached")) == 1);
	json_t *second = json_array_get(json_object_get(json, "scored"), 1);
	assert_true(json_is_null(json_object_get(second, "predicted_q")));
	assert_true(json_real_value(json_object_get(second, "q")) > 0.79);
	assert_int_equal(json_integer_value(json_object_get(second, "reference_coarse")), 7);
	json_decref(json);
	char csv[64];
	snprintf(csv, sizeof csv, "build/tmp/load-%d.csv", (int)getpid());
	assert_ok(view_load_csv(&report, csv, &error), error);
	char *lines = (char *)file_read(csv, &(size_t){ 0 });
	assert_int_equal(count_of(lines, "\n"), report.answers.count + 1);
	assert_int_equal(count_of(lines, ",cold,"), report.answers.count / 2);
	assert_int_equal(view_load_csv(&report, "build/none/x.csv", &error), ECO_IO);
	free(lines);
	unlink(csv);
}

int main(void)
{
	if (view_fetch_setup(NULL))
		return 1;
	int failed = unit_tests_run(serve_start, serve_stop);
	view_load_free(&report);
	view_fetch_teardown();
	return failed;
}
