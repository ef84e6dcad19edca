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

#include "client-min/view_exchange.h"
#include "ecofiles/base/array_grow.h"

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

static enum eco_code open_loop(struct loop *loop, const struct view_session_host *host, uint32_t room,
	struct eco_error *error)
{
	CURLM *multi = curl_multi_init();
	loop->host = *host;
	loop->host.multi = multi;
	loop->host.report = &loop->report;
	loop->timer_ms = INFINITY;
	loop->sessions = calloc(room, sizeof *loop->sessions);
	loop->epoll = epoll_create1(EPOLL_CLOEXEC);
	if (!multi || !loop->sessions || loop->epoll < 0)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for %u clients", room);
	curl_multi_setopt(multi, CURLMOPT_SOCKETFUNCTION, on_socket);
	curl_multi_setopt(multi, CURLMOPT_SOCKETDATA, loop);
	curl_multi_setopt(multi, CURLMOPT_TIMERFUNCTION, on_timer);
	curl_multi_setopt(multi, CURLMOPT_TIMERDATA, loop);
	curl_multi_setopt(multi, CURLMOPT_MAXCONNECTS, (long)room * 8);
	return ECO_OK;
}

static void close_loop(struct loop *loop)
{
	for (uint32_t i = 0; i < loop->count; i++)
		view_session_free(loop->sessions[i]);
	curl_multi_cleanup(loop->host.multi);
	if (loop->epoll >= 0)
		close(loop->epoll);
	free(loop->sessions);
}

static bool add_answers(struct view_answers *into, const struct view_answers *from)
{
	for (uint32_t i = 0; i < from->count; i++)
		if (!view_answers_add(into, &from->items[i]))
			return false;
	return true;
}

static int by_due(const void *a, const void *b)
{
	double x = ((const struct view_answer *)a)->due_ms, y = ((const struct view_answer *)b)->due_ms;
	return (x > y) - (x < y);
}

static bool collect(struct view_load_report *into, struct view_load_report *from)
{
	bool good = add_answers(&into->answers, &from->answers);
	for (int i = 0; i < VIEW_OUTCOMES; i++)
		into->outcomes[i] += from->outcomes[i];
	for (int i = 0; i < VIEW_LOAD_COUNTS; i++)
		into->counts[i] += from->counts[i];
	if (from->first_failure[0] && !into->first_failure[0])
		memcpy(into->first_failure, from->first_failure, sizeof into->first_failure);
	view_answers_free(&from->answers);
	return good;
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
	enum eco_code code = ECO_OK;
	for (uint32_t i = 0; i < o->clients && !code; i++) {
		bool decodes = view_load_is_one_of(i, o->decoding, o->clients);
		struct loop *loop = decodes ? &loops[1 + decoding++ % (loop_count - 1)] : loops;
		code = view_session_new(&loop->sessions[loop->count++], &loop->host, i, decodes, error);
	}
	return code;
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
	enum eco_code code = ECO_OK;
	for (uint32_t i = 0; i < count; i++) {
		loops[i].epoll = -1;
		code = code ? code : open_loop(&loops[i], &host, o->clients, error);
	}
	if (!code)
		code = open_sessions(loops, count, o, error);
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
		if (!collect(report, &loops[i].report) && !code)
			code = eco_no_memory(error, "a report");
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
	*report = (struct view_load_report){ 0 };
	struct loop *loops = calloc(1 + decoding, sizeof *loops);
	if (!loops)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for %llu clients",
			(unsigned long long)options->clients);
	enum eco_code code = run_loops(report, options, loops, 1 + decoding, error);
	free(loops);
	if (code)
		view_load_free(report);
	return code;
}

void view_load_free(struct view_load_report *report)
{
	view_answers_free(&report->answers);
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

bool view_answers_add(struct view_answers *answers, const struct view_answer *answer)
{
	if (!eco_array_grow(&answers->items, &answers->room, answers->count, sizeof *answers->items))
		return false;
	answers->items[answers->count++] = *answer;
	return true;
}

void view_answers_free(struct view_answers *answers)
{
	free(answers->items);
	*answers = (struct view_answers){ 0 };
}
