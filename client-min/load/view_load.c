/* A thread waits for sockets (epoll, which libcurl tells what it waits for) and for the time when the next of
 * its sessions wants to be woken. */
#include "client-min/load/view_load.h"

#include <math.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

#include "client-min/view_ask.h"
#include "client-min/view_exchange.h"
#include "ecofiles/base/memory.h"
#include "ecofiles/base/order.h"
#include "ecofiles/base/random.h"

#define EVENTS 256
#define NAP_MS 100.0             /* the longest time between looks at whether all is over */
#define GRACE_MS 10000.0         /* answers that are due at the end are waited for so long */

struct loop {
	struct view_session_host host;
	struct view_load_report report;
	struct view_session **sessions;
	uint32_t count;
	int epoll;
	double timer_ms;                 /* when libcurl wants to be called; INFINITY: never */
	atomic_uint_fast64_t answers, failures;
	pthread_t thread;
	bool started;
};

bool view_load_is_one_of(uint32_t client, uint32_t some, uint32_t all)
{
	return (uint64_t)(client + 1) * some / all > (uint64_t)client * some / all;
}

/* ---- One thread ---- */

static int on_socket(CURL *curl, curl_socket_t fd, int what, void *ctx, void *known)
{
	struct loop *loop = ctx;
	struct epoll_event event = { .data.fd = fd };
	(void)curl;
	if (what != CURL_POLL_OUT)
		event.events |= EPOLLIN;
	if (what != CURL_POLL_IN)
		event.events |= EPOLLOUT;
	if (what == CURL_POLL_REMOVE)
		epoll_ctl(loop->epoll, EPOLL_CTL_DEL, fd, NULL);
	else
		epoll_ctl(loop->epoll, known ? EPOLL_CTL_MOD : EPOLL_CTL_ADD, fd, &event);
	curl_multi_assign(loop->host.multi, fd, what == CURL_POLL_REMOVE ? NULL : loop);
	return 0;
}

static int on_timer(CURLM *multi, long ms, void *ctx)
{
	(void)multi;
	((struct loop *)ctx)->timer_ms = ms < 0 ? INFINITY : view_clock_ms() + (double)ms;
	return 0;
}

static void wait_for_sockets(struct loop *loop, double until_ms)
{
	struct epoll_event events[EVENTS];
	double wait_ms = fmin(until_ms, loop->timer_ms) - view_clock_ms();
	int running, timeout = wait_ms > NAP_MS ? (int)NAP_MS : wait_ms > 0 ? (int)ceil(wait_ms) : 0;
	int count = epoll_wait(loop->epoll, events, EVENTS, timeout);
	for (int i = 0; i < count; i++) {
		int what = (events[i].events & EPOLLIN ? CURL_CSELECT_IN : 0)
			| (events[i].events & EPOLLOUT ? CURL_CSELECT_OUT : 0)
			| (events[i].events & (EPOLLERR | EPOLLHUP) ? CURL_CSELECT_ERR : 0);
		curl_multi_socket_action(loop->host.multi, events[i].data.fd, what, &running);
	}
	if (view_clock_ms() >= loop->timer_ms) {
		loop->timer_ms = INFINITY;
		curl_multi_socket_action(loop->host.multi, CURL_SOCKET_TIMEOUT, 0, &running);
	}
}

static void end_transfers(struct loop *loop)
{
	int left;
	for (CURLMsg *message; (message = curl_multi_info_read(loop->host.multi, &left));) {
		CURL *curl = message->easy_handle;
		view_exchange_transferred(curl, message->data.result);
	}
}

/* When the next of them wants to be woken. */
static double wake(struct loop *loop)
{
	double now = view_clock_ms(), next = INFINITY;
	for (uint32_t i = 0; i < loop->count; i++) {
		if (view_session_wakes_ms(loop->sessions[i]) <= now)
			view_session_wake(loop->sessions[i]);
		next = fmin(next, view_session_wakes_ms(loop->sessions[i]));
	}
	return next;
}

static bool is_stopped(const struct loop *loop)
{
	const volatile sig_atomic_t *stop = loop->host.options->stop;
	return stop && *stop;
}

static void *run_loop(void *ctx)
{
	struct loop *loop = ctx;
	double give_up_ms = loop->host.end_ms + GRACE_MS;
	while (!is_stopped(loop)) {
		double next = wake(loop);
		if (isinf(next) || view_clock_ms() > give_up_ms)
			break;
		wait_for_sockets(loop, next);
		end_transfers(loop);
		uint64_t answers = loop->report.answers.count;
		atomic_store(&loop->answers, answers);
		atomic_store(&loop->failures, answers - loop->report.outcomes[VIEW_ANSWERED]);
	}
	for (uint32_t i = 0; i < loop->count && !is_stopped(loop); i++)
		view_session_give_up(loop->sessions[i]);
	return NULL;
}

/* ---- All of them ---- */

static void open_loop(struct loop *loop, const struct view_session_host *host, uint32_t room)
{
	CURLM *multi = curl_multi_init();
	loop->host = *host;
	loop->host.multi = multi;
	loop->host.report = &loop->report;
	loop->timer_ms = INFINITY;
	loop->sessions = eco_alloc(room, sizeof *loop->sessions);
	loop->epoll = epoll_create1(EPOLL_CLOEXEC);
	if (!multi || loop->epoll < 0)
		eco_end("no memory");
	curl_multi_setopt(multi, CURLMOPT_SOCKETFUNCTION, on_socket);
	curl_multi_setopt(multi, CURLMOPT_SOCKETDATA, loop);
	curl_multi_setopt(multi, CURLMOPT_TIMERFUNCTION, on_timer);
	curl_multi_setopt(multi, CURLMOPT_TIMERDATA, loop);
	curl_multi_setopt(multi, CURLMOPT_MAXCONNECTS, (long)room * 8);
}

static void close_loop(struct loop *loop)
{
	for (uint32_t i = 0; i < loop->count; i++)
		view_session_free(loop->sessions[i]);
	curl_multi_cleanup(loop->host.multi);
	close(loop->epoll);
	free(loop->sessions);
}

ECO_ORDER(by_due, struct view_answer, ->due_ms)

static void collect(struct view_load_report *into, struct view_load_report *from)
{
	for (uint32_t i = 0; i < from->answers.count; i++)
		view_answers_add(&into->answers, &from->answers.items[i]);
	for (int i = 0; i < VIEW_OUTCOMES; i++)
		into->outcomes[i] += from->outcomes[i];
	for (int i = 0; i < VIEW_LOAD_COUNTS; i++)
		into->counts[i] += from->counts[i];
	if (from->first_failure[0] && !into->first_failure[0])
		memcpy(into->first_failure, from->first_failure, sizeof into->first_failure);
	free(from->answers.items);
}

static double cpu_seconds(void)
{
	struct rusage usage;
	getrusage(RUSAGE_SELF, &usage);
	return (double)(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec)
		+ 1e-6 * (double)(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
}

/* Clients of loop 0 count; those of the others decode. */
static enum eco_code open_sessions(struct loop *loops, uint32_t loop_count,
	const struct view_load_options *o, struct eco_error *error)
{
	uint32_t decoding = 0;
	for (uint32_t i = 0; i < o->clients; i++) {
		bool decodes = view_load_is_one_of(i, o->decoding, o->clients);
		struct loop *loop = decodes ? &loops[1 + decoding++ % (loop_count - 1)] : loops;
		ECO_PASS(view_session_new(&loop->sessions[loop->count++], &loop->host, i, decodes, error));
	}
	return ECO_OK;
}

static void show(const struct view_load_options *o, struct loop *loops, uint32_t count, double start_ms)
{
	uint64_t answers = 0, failures = 0;
	for (uint32_t i = 0; i < count; i++) {
		answers += atomic_load(&loops[i].answers);
		failures += atomic_load(&loops[i].failures);
	}
	if (o->tick)
		o->tick(o->ctx, (view_clock_ms() - start_ms) / 1e3, answers, failures);
}

/* The threads end by themselves; meanwhile progress is shown. */
static void wait_for_loops(const struct view_load_options *o, struct loop *loops, uint32_t count,
	double start_ms)
{
	for (uint32_t i = 0; i < count; i++) {
		struct timespec until;
		if (!loops[i].started)
			continue;
		do {
			show(o, loops, count, start_ms);
			clock_gettime(CLOCK_REALTIME, &until);
			until.tv_nsec += 200000000;
			until.tv_sec += until.tv_nsec / 1000000000;
			until.tv_nsec %= 1000000000;
		} while (pthread_timedjoin_np(loops[i].thread, NULL, &until));
	}
}

static enum eco_code run_loops(struct view_load_report *report, const struct view_load_options *o,
	struct loop *loops, uint32_t count, struct eco_error *error)
{
	double start_ms = view_clock_ms(), cpu_s = cpu_seconds();
	struct view_session_host host = { .options = o, .start_ms = start_ms,
		.end_ms = start_ms + o->seconds * 1e3 };
	for (uint32_t i = 0; i < count; i++)
		open_loop(&loops[i], &host, (uint32_t)o->clients);
	enum eco_code code = open_sessions(loops, count, o, error);
	for (uint32_t i = 0; i < count && !code; i++) {
		loops[i].started = !pthread_create(&loops[i].thread, NULL, run_loop, &loops[i]);
		if (!loops[i].started)
			code = eco_fail(error, ECO_IO, "the system allows no further thread");
	}
	wait_for_loops(o, loops, count, start_ms);
	report->start_ms = start_ms;
	report->seconds = (view_clock_ms() - start_ms) / 1e3;
	report->cpu_seconds = cpu_seconds() - cpu_s;
	report->processors = (uint32_t)sysconf(_SC_NPROCESSORS_ONLN);
	for (uint32_t i = 0; i < count; i++) {
		close_loop(&loops[i]);
		collect(report, &loops[i].report);
	}
	if (report->answers.count)
		qsort(report->answers.items, report->answers.count, sizeof *report->answers.items, by_due);
	return code;
}

enum eco_code view_load_run(struct view_load_report *report, const struct view_load_options *options,
	struct eco_error *error)
{
	uint32_t processors = (uint32_t)sysconf(_SC_NPROCESSORS_ONLN);
	uint32_t decoding = options->decoding < processors ? options->decoding : processors;
	*report = (struct view_load_report){ .options = options };
	struct loop *loops = eco_alloc(1 + decoding, sizeof *loops);
	enum eco_code code = run_loops(report, options, loops, 1 + decoding, error);
	free(loops);
	if (code)
		view_load_free(report);
	return code;
}

void view_load_free(struct view_load_report *report)
{
	free(report->answers.items);
	free(report->scored);
	*report = (struct view_load_report){ 0 };
}

uint64_t view_load_failures(const struct view_load_report *report)
{
	uint64_t failures = 0;
	for (int i = VIEW_ANSWERED + 1; i < VIEW_OUTCOMES; i++)
		failures += report->outcomes[i];
	return failures;
}

bool view_load_clean(const struct view_load_report *report)
{
	return report->outcomes[VIEW_ANSWERED] && !view_load_failures(report) && !report->vertex_violations
		&& !report->byte_violations && !report->chunks_twice;
}

/* ---- Answers ---- */

const char *const view_outcome_names[VIEW_OUTCOMES] = { "answered", "connection", "broken", "late", "busy",
	"refused", "damaged", "unfinished", "other" };

void view_answers_add(struct view_answers *answers, const struct view_answer *answer)
{
	eco_grow(&answers->items, &answers->room, answers->count, sizeof *answers->items);
	answers->items[answers->count++] = *answer;
}

/* ==== Views ==== */

#define FRAMES 240u
#define EYE_M 1.7
#define WALK_RADIUS_M 60.0
#define FOV_DEG 50.0
#define TURN 6.283185307179586

struct extent {                          /* of a scene */
	double low[3], high[3];
	bool has_ground;
};

/* ---- Views made for a scene; z of an eye that walks and of all targets counts from the ground ---- */

static double share_of(const struct extent *e, int axis, double share)
{
	return e->low[axis] + share * (e->high[axis] - e->low[axis]);
}

static double width_of(const struct extent *e)
{
	return fmax(fmax(e->high[0] - e->low[0], e->high[1] - e->low[1]), 10);
}

static void set(double at[3], double x, double y, double z)
{
	at[0] = x;
	at[1] = y;
	at[2] = z;
}

static void walk_view(const struct extent *e, uint32_t frame, struct eco_view *view)
{
	double radius = fmin(0.25 * width_of(e), WALK_RADIUS_M), angle = TURN * frame / FRAMES;
	double x = share_of(e, 0, 0.5), y = share_of(e, 1, 0.5);
	set(view->eye, x + radius * cos(angle), y + radius * sin(angle), EYE_M);
	set(view->target, x + radius * cos(angle + 0.5), y + radius * sin(angle + 0.5), EYE_M);
}

/* A stripe of a fifth of the width after the other; every other one goes back. */
static void flyover_view(const struct extent *e, uint32_t frame, struct eco_view *view)
{
	uint32_t stripes = 5, length = FRAMES / stripes, stripe = frame / length;
	double along = (frame % length + 0.5) / length, back = stripe % 2 ? -1 : 1;
	double x = share_of(e, 0, back > 0 ? along : 1 - along), y = share_of(e, 1, (stripe + 0.5) / stripes);
	double above = fmax(0.15 * width_of(e), 2 * EYE_M);
	set(view->eye, x, y, above + (e->has_ground ? 0 : e->high[2]));
	set(view->target, x + back * 2 * above, y, 0);
}

static void random_view(const struct extent *e, uint64_t *random, struct eco_view *view)
{
	double of[5];
	for (int i = 0; i < 5; i++)
		of[i] = eco_random_unit(eco_random_next(random));
	double most = fmax(0.5 * width_of(e), 2 * EYE_M);
	set(view->eye, share_of(e, 0, of[0]), share_of(e, 1, of[1]), EYE_M * pow(most / EYE_M, of[2]));
	set(view->target, share_of(e, 0, of[3]), share_of(e, 1, of[4]), 0);
}

static enum eco_code read_extent(struct view_fetch *fetch, struct extent *e, struct eco_error *error)
{
	char *text;
	enum eco_code code = view_fetch_scene(fetch, &text, error);
	if (code)
		return code;
	json_t *about = json_loads(text, 0, NULL), *need;
	size_t i;
	free(text);
	if (json_unpack(about, "{s:{s:[F,F,F],s:[F,F,F]}}", "bounds", "low", &e->low[0], &e->low[1],
			&e->low[2], "high", &e->high[0], &e->high[1], &e->high[2]))
		code = eco_fail(error, ECO_BAD_INPUT, "the scene's description has no bounds, which an "
			"ecoserve sends");
	json_array_foreach(json_object_get(about, "needs"), i, need)
		e->has_ground |= json_is_string(need) && !strcmp(json_string_value(need), "ground");
	json_decref(about);
	return code;
}

static enum eco_code make_views(struct view_load_options *o, struct view_fetch *fetch, bool *above_ground,
	struct eco_error *error)
{
	struct extent e = { .has_ground = false };
	uint64_t random = o->seed;
	ECO_PASS(read_extent(fetch, &e, error));
	o->views = eco_alloc(FRAMES, sizeof *o->views);
	o->view_count = FRAMES;
	*above_ground = e.has_ground;
	for (uint32_t i = 0; i < FRAMES; i++) {
		struct eco_view *view = &o->views[i];
		*view = (struct eco_view){ .up = { 0, 0, 1 }, .fov_y_deg = FOV_DEG };
		if (!strcmp(o->camera, "walk"))
			walk_view(&e, i, view);
		else if (!strcmp(o->camera, "flyover"))
			flyover_view(&e, i, view);
		else
			random_view(&e, &random, view);
	}
	return ECO_OK;
}

static enum eco_code read_views(struct view_load_options *o, bool *above_ground, struct eco_error *error)
{
	struct eco_camera *camera = NULL;
	ECO_PASS(eco_camera_load(&camera, o->camera, error));
	o->view_count = eco_camera_frame_count(camera);
	o->views = eco_alloc(o->view_count, sizeof *o->views);
	*above_ground = eco_camera_above_ground(camera);
	for (uint32_t i = 0; i < o->view_count; i++)
		eco_camera_frame(camera, i, &o->views[i]);
	eco_camera_free(camera);
	return ECO_OK;
}

static enum eco_code stand_all(struct view_load_options *o, struct view_fetch *fetch, struct eco_error *error)
{
	struct view_store *store = NULL;
	enum eco_code code = view_store_new(&store, &(struct view_store_options){ 0 }, error);
	for (uint32_t i = 0; i < o->view_count && !code; i++) {
		struct eco_request request = { .view = o->views[i] };
		struct view_fetch_result result;
		code = o->stop && *o->stop ? eco_fail(error, ECO_INTERRUPTED, "interrupted")
			: view_stand(fetch, store, &request, &result, error);
		o->views[i] = request.view;
	}
	view_store_free(store);
	return code;
}

enum eco_code view_views_make(struct view_load_options *o, struct view_fetch *fetch, struct eco_error *error)
{
	bool above_ground = false, made = !strcmp(o->camera, "walk") || !strcmp(o->camera, "flyover")
		|| !strcmp(o->camera, "random");
	enum eco_code code = made ? make_views(o, fetch, &above_ground, error)
		: read_views(o, &above_ground, error);
	if (!code && above_ground)
		code = stand_all(o, fetch, error);
	for (uint32_t i = 0; i < o->view_count && !code; i++) {
		o->views[i].width = o->width;
		o->views[i].height = o->height;
		eco_view_snap(&o->views[i], o->snap_m);
		code = eco_view_check(&o->views[i], error);
	}
	return code;
}
