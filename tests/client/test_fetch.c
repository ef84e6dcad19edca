/* Fetching from a server that answers well, with problems, or badly: a thread with a socket and a list of
 * canned answers. */
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "client-min/view_ask.h"
#include "tests/support/cases.h"
#include "tests/support/serve/http_client.h"
#include "tests/support/unit_test.h"
#include "tests/support/view_scene.h"

#define ENDLESS_MOST ((size_t)400 << 20)

static struct eco_plan plan;             /* of scene_view, ... */
static struct eco_writer good;           /* ... and its stream */

/* The server of the test under way: begin makes it anew. */
static struct server {
	int listener;
	uint16_t port;
	const char *head;                /* status line and headers, without Content-Length */
	uint32_t busy;                   /* so many requests are answered with 503 before */
	uint32_t again;                  /* so many are answered after, alike or: */
	const struct eco_writer *then;   /* with this; may be NULL */
	const struct eco_plan *plan;     /* answers are made of it, for what is held; NULL: they are `body` */
	const size_t *cuts;              /* after so many bytes of them they break off */
	uint32_t resumes;                /* of the client */
	size_t sent;                     /* of all these answers */
	bool drips;                      /* a byte every 5 ms */
	bool holds;                      /* the connection, until the client lets it go */
	bool endless;                    /* the body is sent again and again */
	bool patient;                    /* the client, also where the server is not busy first */
	const char *busy_head;           /* status line and headers of the first */
	const uint8_t *body; size_t size, declared;
	char heard[8192]; size_t heard_size;
	pthread_t thread;
} server;
static struct view_store *store;
static struct view_fetch_result result;
static struct eco_error error;

/* The rest of the scene, for who holds what the request says. */
static void make_answer(struct server *s, uint32_t number, struct eco_writer *w)
{
	const char *body = strstr(s->heard, "\r\n\r\n") + 4;
	struct eco_holdings holdings;
	uint32_t held[L_COUNT] = { 0 };
	assert_ok(eco_wire_read_holdings((const uint8_t *)body, s->heard_size - (size_t)(body - s->heard),
		&holdings, &error), error);
	for (uint32_t i = 0; i < holdings.count; i++)
		held[holdings.items[i].list] = holdings.items[i].chunks;
	scene_stream(&grove, s->plan, holdings.count ? held : NULL, w);
	free(holdings.items);
	s->body = w->bytes;
	s->declared = w->size;
	s->size = s->cuts[number] < w->size ? s->cuts[number] : w->size;
	s->sent += s->size;
}

/* Reads one request whole, sends the answer, closes. */
static void serve_one(struct server *s, uint32_t number)
{
	struct eco_writer made = { 0 };
	char head[512];
	int c = accept(s->listener, NULL, NULL);
	if (c < 0)
		return;
	http_hear(c, s->heard, sizeof s->heard, &s->heard_size);
	if (s->plan)
		make_answer(s, number, &made);
	int size = snprintf(head, sizeof head, "%sConnection: close\r\n", s->head);
	if (!s->endless)
		size += snprintf(head + size, sizeof head - (size_t)size, "Content-Length: %zu\r\n",
			s->declared);
	size += snprintf(head + size, sizeof head - (size_t)size, "\r\n");
	send(c, head, (size_t)size, MSG_NOSIGNAL);
	for (ssize_t n = 1; s->endless && s->sent < ENDLESS_MOST && n > 0;) {
		n = send(c, s->body, s->size, MSG_NOSIGNAL);
		s->sent += n > 0 ? (size_t)n : 0;
	}
	for (size_t at = 0; at < s->size && !s->endless;) {
		size_t most = s->drips ? 1 : 1000, piece = s->size - at < most ? s->size - at : most;
		usleep(s->drips ? 5000 : 0);
		ssize_t n = send(c, s->body + at, piece, MSG_NOSIGNAL);
		if (n <= 0)
			break;
		at += (size_t)n;
	}
	while (s->holds && recv(c, head, sizeof head, 0) > 0)
		continue;
	close(c);
	eco_writer_free(&made);
}

static void *serve(void *ctx)
{
	struct server *s = &server;
	char head[512];
	for (uint32_t i = 0; i < s->busy; i++) {
		int refused = accept(s->listener, NULL, NULL);
		if (refused < 0)
			return NULL;
		assert_true(recv(refused, head, sizeof head, 0) > 0);
		int size = snprintf(head, sizeof head, "%sContent-Length: 0\r\nConnection: close\r\n\r\n",
			s->busy_head);
		send(refused, head, (size_t)size, MSG_NOSIGNAL);
		shutdown(refused, SHUT_WR);
		while (recv(refused, head, sizeof head, 0) > 0)
			continue;
		close(refused);
	}
	for (uint32_t i = 0; i <= s->again; i++) {
		serve_one(s, i);
		if (s->then) {
			s->body = s->then->bytes;
			s->size = s->declared = s->then->size;
		}
	}
	return NULL;
}

static const char ok[] = "HTTP/1.1 200 OK\r\nContent-Type: application/octet-stream\r\nServer-Timing: "
	"plan;dur=7.25\r\n";

static void begin(uint64_t memory_max)
{
	struct view_store_options options = { .memory_max = memory_max };
	view_store_free(store);
	assert_int_equal(view_store_new(&store, &options, NULL), ECO_OK);
	result = (struct view_fetch_result){ 0 };
	error = (struct eco_error){ 0 };
}

static void start_server(struct server given, uint64_t memory_max)
{
	begin(memory_max);
	struct server *s = &server;
	*s = given;
	if (given.head == ok && !given.body && !given.plan) {
		s->body = good.bytes;
		s->size = good.size;
		s->declared = given.declared ? given.declared : good.size;
	}
	s->listener = http_listen(&s->port);
	assert_int_equal(pthread_create(&s->thread, NULL, serve, NULL), 0);
}

static void start(const char *head, const void *body, size_t size, size_t declared)
{
	start_server((struct server){ .head = head, .body = body, .size = size, .declared = declared }, 0);
}

/* A client that gave up too early leaves the server waiting: that ends, too. */
static void stop_server(void)
{
	shutdown(server.listener, SHUT_RDWR);
	pthread_join(server.thread, NULL);
	close(server.listener);
}

static struct view_marks marks;          /* none but in a test of them */
static uint64_t reached[VIEW_MARKS_MAX];
static double reached_ms[VIEW_MARKS_MAX];
static uint32_t reached_count, refuse_at, slow_ms;

static enum eco_code at_mark(void *ctx, const struct view_fetch_result *so_far, struct eco_error *e)
{
	assert_ptr_equal(ctx, &marks);
	reached_ms[reached_count] = so_far->stream_ms;
	reached[reached_count++] = so_far->bytes;
	usleep(1000 * slow_ms);
	return reached_count == refuse_at ? eco_fail(e, ECO_INTERRUPTED, "enough") : ECO_OK;
}

static uint32_t turn_asked, turns_at;    /* 0: never */

static bool has_turned(void *ctx)
{
	assert_ptr_equal(ctx, &marks);
	return ++turn_asked == turns_at;
}

/* The server's port, or one where none listens. */
static struct view_fetch *fetch_at(uint16_t port, struct view_fetch_options options)
{
	static char url[64];
	struct view_fetch *fetch;
	snprintf(url, sizeof url, "http://127.0.0.1:%u/v1/scenes/test/", port);
	options.url = url;
	assert_ok(view_fetch_new(&fetch, &options, &error), error);
	return fetch;
}

static enum eco_code ask(uint64_t body_max)
{
	struct eco_request request = { .view = scene_view(), .vertices = 1000, .bytes = 5000000 };
	struct view_fetch *fetch = fetch_at(server.port, (struct view_fetch_options){ .body_max = body_max,
		.rule = "deussen", .patience_ms = server.busy || server.patient ? 20000 : 0,
		.stall_ms = server.drips ? 300 : 0, .resumes = server.resumes });
	view_fetch_watch(fetch, &(struct view_fetch_watch){ marks.bytes_count ? &marks : NULL, at_mark,
		turns_at ? has_turned : NULL, &marks });
	reached_count = 0;
	enum eco_code code = view_fetch_stream(fetch, store, &request, &result, &error);
	view_fetch_free(fetch);
	stop_server();
	return code;
}

UNIT_TEST(stream_arrives_in_pieces)
{
	start_server((struct server){ .head = ok }, 0);
	assert_int_equal(ask(0), ECO_OK);
	assert_true(result.status == 200 && result.bytes == good.size && result.plan_ms == 7.25
		&& !result.nothing);
	assert_true(result.first_byte_ms <= result.stream_ms);
	assert_true(view_store_plan(store)->vertices == plan.vertices);
	assert_non_null(strstr(server.heard, "POST "
		"/v1/scenes/test/stream?eye=-22,-19,6.5&target=0,0,2.5&up=0,0,"
		"1&fov_y_deg=45&width=480&height=320"
		"&vertices=1000&bytes=5000000&rule=deussen HTTP/1.1\r\n"));
	assert_non_null(strstr(server.heard, "\r\nContent-Length: 4\r\n"));
}

UNIT_TEST(a_picture_may_be_drawn_after_so_many_bytes)
{
	assert_int_equal(view_marks_read(&marks, "3,70,100000000,1500", &error), ECO_OK);
	for (refuse_at = 0; refuse_at < 3; refuse_at += 2) {
		start_server((struct server){ .head = ok }, 0);
		assert_int_equal(ask(0), refuse_at ? ECO_INTERRUPTED : ECO_OK);
		assert_int_equal(reached_count, refuse_at ? 2 : 3);
		assert_true(reached[0] == 3 && reached[1] == 70 && (refuse_at || reached[2] == 1500));
		assert_true(refuse_at || result.bytes == good.size);
	}
	assert_string_equal(strstr(error.text, "enough"), "enough");
	marks = (struct view_marks){ .bytes_count = 0 };
	refuse_at = 0;
}

/* A picture that takes longer than from one mark to the next: each mark has its own, of what was there. */
UNIT_TEST(each_mark_is_reached_once_and_without_what_came_later)
{
	uint32_t seen = 0;
	assert_int_equal(view_marks_read(&marks, "7ms,1,3ms,1400,5ms,1,3ms", &error), ECO_OK);
	slow_ms = 20;
	start_server((struct server){ .head = ok }, 0);
	assert_int_equal(ask(0), ECO_OK);
	assert_int_equal(reached_count, 5);
	for (uint32_t i = 0; i < 4; i++) {
		assert_true(reached[i] <= 1 && (!i || reached[i] >= reached[i - 1]));
		seen += reached_ms[i] == 3 + 2 * seen;
	}
	assert_int_equal(seen, 3);
	assert_int_equal(reached[4], 1400);
	slow_ms = 0;
	marks = (struct view_marks){ .bytes_count = 0 };
}

/* A byte now and then keeps a connection alive, but no client waiting. */
UNIT_TEST(an_answer_that_drips_is_given_up)
{
	start_server((struct server){ .head = ok, .drips = true }, 0);
	assert_true(good.size > 2000);
	assert_int_equal(ask(0), ECO_IO);
	assert_non_null(strstr(error.text, "Less than 1024 bytes/sec"));
	assert_in_range(result.bytes, 1, good.size - 1);
}

UNIT_TEST(marks_are_numbers_of_bytes_or_milliseconds)
{
	static const char *const wrong[] = { "", "0", "a", "5,", ",5", "5;6", "5m", "5 ms", "5kms", "-1",
		"1e9", "99999999999999999999", "5,x,6" };
	struct view_marks m;
	assert_int_equal(view_marks_read(&m, "500ms,2k,10ms,2048,7,10ms", NULL), ECO_OK);
	assert_true(m.bytes_count == 2 && m.bytes[0] == 7 && m.bytes[1] == 2048);
	assert_true(m.ms_count == 2 && m.ms[0] == 10 && m.ms[1] == 500);
	for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++)
		assert_int_equal(view_marks_read(&m, wrong[i], NULL), ECO_BAD_USAGE);
}

UNIT_TEST(nothing_fits_is_no_failure)
{
	start("HTTP/1.1 204 No Content\r\n", NULL, 0, 0);
	assert_int_equal(ask(0), ECO_OK);
	assert_true(result.nothing && result.bytes == 0 && isnan(result.plan_ms));
	assert_null(view_store_plan(store));
}

UNIT_TEST(problems_become_readable_errors)
{
	struct row { const char *head, *body; enum eco_code code; const char *text; };
	uint32_t count;
	const struct row *rows = cases_rows("tests/client/cases/problems.tsv", "sscs", sizeof *rows, &count);
	for (size_t i = 0; i < count; i++) {
		start(rows[i].head, rows[i].body, strlen(rows[i].body), strlen(rows[i].body));
		assert_int_equal(ask(0), rows[i].code);
		const char *says = strstr(error.text, "/v1/scenes/");        /* behind whose fault it is */
		assert_non_null(says);
		assert_string_equal(strstr(says, ": ") + 2, rows[i].text);
	}
}

/* As a server says it that is busy, or a proxy that counts requests; not for longer than there is patience.
 * */
UNIT_TEST(a_server_that_has_too_much_to_do_is_asked_again)
{
	static const struct { const char *head; bool waits; } cases[] = {
		{ "HTTP/1.1 503 Busy\r\nRetry-After: 0\r\n", true },
		{ "HTTP/1.1 429 Too Many Requests\r\nRetry-After: 1\r\n", true },
		{ "HTTP/1.1 429 Too Many Requests\r\nRetry-After: 29\r\n", false },
		{ "HTTP/1.1 429 Too Many Requests\r\nRetry-After: 3600\r\n", false },
		{ "HTTP/1.1 429 Too Many Requests\r\n", false } };
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		double begun_ms = view_clock_ms();
		if (cases[i].waits)
			start_server((struct server){ .head = ok, .busy = 2, .busy_head = cases[i].head }, 0);
		else
			start_server((struct server){ .head = cases[i].head, .patient = true }, 0);
		assert_int_equal(ask(0), cases[i].waits ? ECO_OK : ECO_BAD_INPUT);
		assert_int_equal(result.status, cases[i].waits ? 200 : 429);
		assert_int_equal(result.bytes == good.size, cases[i].waits);
		double ms = view_clock_ms() - begun_ms;
		assert_true(cases[i].waits ? ms >= (i ? 2000 : 200) : ms < 10000);
	}
}

typedef enum eco_code fetch_text(struct view_fetch *fetch, char **text);

static enum eco_code fetch_scene(struct view_fetch *fetch, char **text)
{
	return view_fetch_scene(fetch, text, &error);
}

static enum eco_code fetch_explanation(struct view_fetch *fetch, char **text)
{
	struct eco_request request = { .view = scene_view(), .vertices = 1000, .bytes = ECO_BYTES_UNBOUNDED };
	return view_fetch_explanation(fetch, &request, text, &error);
}

UNIT_TEST(bodies_that_are_held_whole_are_bounded)
{
	static const char json[] = "HTTP/1.1 200 OK\r\nContent-Type: application/json\r\n";
	static char blanks[1 << 16];
	static const struct { const char *what; fetch_text *fetch; size_t most; } cases[] = {
		{ "scene", fetch_scene, 8u << 20 }, { "explanation", fetch_explanation, 64u << 20 } };
	memset(blanks, ' ', sizeof blanks);
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		char *text = NULL;
		start_server((struct server){ .head = json, .endless = true, .body = (const uint8_t *)blanks,
			.size = sizeof blanks }, 0);
		struct view_fetch *fetch = fetch_at(server.port, (struct view_fetch_options){ .resumes = 3 });
		assert_int_equal(cases[i].fetch(fetch, &text), ECO_TOO_LARGE);
		assert_null(text);
		assert_non_null(strstr(error.text, "the answer is longer than"));
		view_fetch_free(fetch);
		stop_server();
		/* and what lies in the system's buffers */
		if (server.sent < cases[i].most || server.sent > cases[i].most + (16u << 20))
			fail_msg("%s: %zu bytes were taken", cases[i].what, server.sent);
	}
}

UNIT_TEST(huge_problem_does_not_fill_memory)
{
	size_t size = 1 << 20;
	char *body = malloc(size);
	memset(body, ' ', size);
	start("HTTP/1.1 500 Oops\r\n", body, size, size);
	assert_int_equal(ask(0), ECO_IO);
	assert_non_null(strstr(error.text, "the server answered 500"));
	assert_true(result.bytes < size);
	free(body);
}

UNIT_TEST(cut_or_damaged_streams_are_refused)
{
	for (int i = 0; i < 4; i++) {
		size_t half = good.size / 2;
		good.bytes[half] ^= i == 3 ? 4 : 0;
		/* cut in the connection; cut in the answer; cut by the client's limit; damaged */
		start(ok, good.bytes, i < 2 ? half : good.size, i == 1 ? half : good.size);
		enum eco_code code = ask(i == 2 ? half : 0);
		assert_int_equal(code, i == 0 ? ECO_IO : i == 2 ? ECO_TOO_LARGE : ECO_DAMAGED);
		assert_false(view_store_complete(store));
		good.bytes[half] ^= i == 3 ? 4 : 0;
	}
}

/* Behind the last plan, so many bytes are to come for the next view. */
static void say_ahead(struct eco_writer *w)
{
	uint32_t number = 0;
	w->size -= ECO_END_FRAME_BYTES;
	for (size_t at = 0; at < w->size; number++) {
		struct eco_reader r = { .bytes = w->bytes, .size = w->size, .at = at + 4 };
		at += ECO_FRAME_HEADER_BYTES + eco_read_u32(&r);
	}
	eco_frame_end(w, eco_frame_begin(w, ECO_FRAME_AHEAD, number));
}

/* The server has all of it to send yet, and sends nothing: whoever turns need not wait. */
UNIT_TEST(who_turns_does_not_wait_for_the_next_view)
{
	struct eco_writer w = { 0 };
	eco_write_bytes(&w, good.bytes, good.size);
	say_ahead(&w);
	for (turns_at = 1; turns_at <= 2; turns_at++) {
		turn_asked = 0;
		start_server((struct server){ .head = ok, .holds = true, .body = w.bytes, .size = w.size,
			.declared = w.size + 5000, .resumes = 3 }, 0);
		assert_ok(ask(0), error);
		assert_true(turn_asked == turns_at && result.cancelled == 5000 && result.bytes == w.size);
		assert_true(!result.broken && !result.nothing && view_store_complete(store));
		assert_int_equal(view_store_plan(store)->vertices, plan.vertices);
	}
	turns_at = 1000000;
	start_server((struct server){ .head = ok, .body = w.bytes, .size = w.size,
		.declared = w.size + 5000 }, 0);
	assert_int_equal(ask(0), ECO_IO);
	assert_true(result.cancelled == 0 && !view_store_complete(store));
	turns_at = 0;
	eco_writer_free(&w);
}

static const char *heard_head(void)
{
	*strstr(server.heard, "\r\n\r\n") = 0;
	return server.heard;
}

/* Wherever an answer breaks off: no chunk comes twice, and what is there then is what had come at once. */
UNIT_TEST(an_answer_that_breaks_off_goes_on_with_what_came)
{
	uint64_t chunk_bytes = 0;
	for (size_t at = good.size + 150; at > 150; at = at > good.size ? good.size - 1 : at - at / 6) {
		const size_t cuts[] = { at, SIZE_MAX };
		bool breaks = at < good.size;
		start_server((struct server){ .head = ok, .again = breaks, .plan = &plan, .cuts = cuts,
			.resumes = 1 }, 0);
		assert_ok(ask(0), error);
		assert_true(result.broken == breaks && result.requests == 1u + breaks && !result.nothing);
		assert_true(result.bytes == server.sent && result.most_bytes <= good.size);
		assert_true(view_store_complete(store) && view_store_plan(store)->vertices == plan.vertices);
		struct view_store_stats stats = view_store_stats(store);
		assert_int_equal(stats.chunks_twice, 0);
		if (!breaks)
			chunk_bytes = stats.chunk_bytes;
		assert_int_equal(stats.chunk_bytes, chunk_bytes);
		/* what is sent twice: the scene, and the frame in whose middle it broke */
		assert_true(result.bytes < good.size + good.size / 3);
		/* a picture has come before the last frame: what is left of the budget is asked for */
		assert_int_equal(strstr(heard_head(), "&bytes=5000000&") != NULL, at != good.size - 1);
	}
}

/* It says that it is back in a second, in another's name; and a server that never was there is not waited
 * for. */
UNIT_TEST(a_lost_server_is_asked_again_when_it_says)
{
	start_server((struct server){ .head = "HTTP/1.1 502 Bad Gateway\r\nRetry-After: 1\r\n", .again = 2,
		.resumes = 2 }, 0);
	double begun_ms = view_clock_ms();
	assert_int_equal(ask(0), ECO_IO);
	assert_true(result.broken == 2 && view_clock_ms() - begun_ms > 1000);
	assert_non_null(strstr(error.text, "asked 3 times"));
	begin(0);
	struct view_fetch *fetch = fetch_at(9, (struct view_fetch_options){ .resumes = 20 });
	struct eco_request request = { .view = scene_view(), .vertices = 1000, .bytes = ECO_BYTES_UNBOUNDED };
	assert_int_equal(view_fetch_stream(fetch, store, &request, &result, &error), ECO_IO);
	assert_true(result.broken == 0 && strstr(error.text, "start ecoserve there"));
	view_fetch_free(fetch);
}

UNIT_TEST(stop_flag_and_bad_urls_end_at_once)
{
	static volatile sig_atomic_t flag = 1;
	static const char *const bad[] = { "", "ftp://x/", "localhost:8080", "http://x/?a=b", "http://x/ y",
		"file:///etc/passwd" };
	struct view_fetch *fetch;
	for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
		struct view_fetch_options options = { .url = bad[i] };
		assert_int_equal(view_fetch_new(&fetch, &options, NULL), ECO_BAD_USAGE);
		assert_null(fetch);
	}
	begin(0);
	struct eco_request request = { .view = scene_view(), .vertices = 1000, .bytes = ECO_BYTES_UNBOUNDED };
	fetch = fetch_at(9, (struct view_fetch_options){ .stop = &flag });
	enum eco_code code = view_fetch_stream(fetch, store, &request, &result, &error);
	assert_true(code == ECO_INTERRUPTED || code == ECO_IO);
	view_fetch_free(fetch);
}

static int set_up(void **state)
{
	struct eco_view view = scene_view();
	scene_open(state);
	scene_plan(&grove, &view, 1, &plan);
	scene_stream(&grove, &plan, NULL, &good);
	return view_fetch_setup(NULL);
}

static int tear_down(void **state)
{
	view_store_free(store);
	eco_writer_free(&good);
	eco_plan_free(&plan);
	view_fetch_teardown();
	return scene_close(state);
}

/* Chunks that had to go while the answer came are asked for again: with a budget of bytes, for as many
 * vertices as that plan has. This server does not listen to holdings, and so the second answer is refused. */
UNIT_TEST(short_memory_asks_again_for_the_same_plan)
{
	char vertices[64];
	start_server((struct server){ .head = ok, .again = 1 }, 20000);
	assert_int_equal(ask(0), ECO_DAMAGED);
	assert_non_null(strstr(error.text, "sent again"));
	snprintf(vertices, sizeof vertices, "&vertices=%llu&", (unsigned long long)plan.vertices);
	assert_non_null(strstr(server.heard, vertices));
	assert_true(result.requests == 2 && result.bytes > good.size && result.most_bytes == good.size);
	assert_true(plan.vertices != 1000 && view_store_stats(store).memory_peak_bytes <= 20000);
}

/* The hilly ground of view_scene.c. */
static double ground_at(double x, double y) { return 0.02 * x + 0.00045 * (x * x - y * y); }

UNIT_TEST(views_stand_on_the_ground_below_eye_and_target)
{
	struct eco_writer then;
	uint32_t held[L_COUNT];
	struct eco_request request = { .view = scene_view(), .next = { true, { 1, 2, 3 }, { 4, 5, 6 } } };
	const struct eco_view view = request.view;
	for (uint32_t i = 0; i < L_COUNT; i++)
		held[i] = scene_needs(&grove, &plan, i);
	scene_stream(&grove, &plan, held, &then);
	start_server((struct server){ .head = ok, .again = 1, .then = &then }, 0);
	struct view_fetch *fetch = fetch_at(server.port, (struct view_fetch_options){ .resumes = 0 });
	assert_ok(view_stand(fetch, store, &request, &result, &error), error);
	view_fetch_free(fetch);
	stop_server();
	double eye_m = ground_at(view.eye[0], view.eye[1]),
	       target_m = ground_at(view.target[0], view.target[1]);
	assert_true(fabs(eye_m) > 0.3 && fabs(request.view.eye[2] - view.eye[2] - eye_m) < 0.03);
	assert_true(fabs(request.view.target[2] - view.target[2] - target_m) < 0.03);
	assert_true(fabs(request.next.eye[2] - 3 - eye_m) < 0.03 &&
		fabs(request.next.target[2] - 6 - target_m) < 0.03);
	assert_true(request.view.eye[0] == view.eye[0] && request.view.target[1] == view.target[1]);
	assert_true(result.requests == 2 && result.bytes == good.size + then.size);
	/* the last was asked at the target, straight down */
	assert_non_null(strstr(server.heard, "stream?eye=0,0,100000&target=0,0,0&up=0,1,0&"));
	assert_non_null(strstr(server.heard, "&width=1&height=1&vertices=0"));
	eco_writer_free(&then);
}

UNIT_MAIN(set_up, tear_down)
