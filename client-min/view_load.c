#include "client-min/view_load.h"

#include <math.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "client-min/view_select.h"
#include "client-min/view_stand.h"
#include "ecofiles/base/room.h"

const char *const view_load_failure_names[VIEW_LOAD_FAILURES] = { "connection", "refused", "damaged",
	"other" };

#define PACK_CHANGED 409

struct client {                                  /* one thread; the report is its own until it has ended */
	const struct view_load_options *options;
	const atomic_bool *over;
	uint32_t number;
	pthread_t thread;
	bool started;
	struct view_load_report report;
	struct view_fetch *fetch;
	struct view_store *store;
};

/* ---- Times ---- */

static void add_time(struct view_times *times, double ms)
{
	if (!eco_room(&times->ms, &times->room, times->count, sizeof *times->ms))
		return;
	times->ms[times->count++] = (float)ms;
}

static int by_value(const void *a, const void *b)
{
	float x = *(const float *)a, y = *(const float *)b;
	return x < y ? -1 : x > y;
}

double view_times_quantile(const struct view_times *times, double share)
{
	if (!times->count)
		return NAN;
	double at = ceil(share * times->count);
	uint32_t index = at < 1 ? 0 : at > times->count ? times->count - 1 : (uint32_t)at - 1;
	return (double)times->ms[index];
}

/* ---- One client ---- */

static void note(struct view_load_report *report, const char *text)
{
	if (!report->first_failure[0])
		snprintf(report->first_failure, sizeof report->first_failure, "%s", text);
}

static enum view_load_failure kind_of(enum eco_code code, long status)
{
	if (status >= 400)
		return VIEW_LOAD_REFUSED;
	if (code == ECO_DAMAGED)
		return VIEW_LOAD_DAMAGED;
	return code == ECO_IO ? VIEW_LOAD_CONNECTION : VIEW_LOAD_OTHER;
}

static void check_answer(struct client *c, const struct eco_request *request,
	const struct view_fetch_result *result)
{
	struct view_load_report *report = &c->report;
	struct view_selection selection;
	struct eco_error error = { 0 };
	struct lod_eye eye;
	lod_eye_make(&eye, &request->view);
	if (view_select_make(&selection, c->store, &eye, &error)) {
		report->failures[VIEW_LOAD_DAMAGED]++;
		note(report, error.text);
		return;
	}
	report->vertices += selection.vertices;
	if (selection.vertices > request->vertices) {
		report->vertex_violations++;
		note(report, "a plan drew more vertices than allowed");
	}
	if (result->most_bytes > request->bytes) {
		report->byte_violations++;
		note(report, "a response took more bytes than allowed");
	}
	view_select_free(&selection);
}

/* After a failure the store may hold less than the server believes it sent: what is held is stated with each
 * request, so going on is safe; but a store that refused a stream is begun anew, so that one fault is counted
 * once. */
static enum eco_code restart(struct client *c, struct eco_error *error)
{
	struct view_store_options options = { 0 };
	if (c->store) {
		c->report.chunks += view_store_stats(c->store).chunks;
		c->report.chunks_twice += view_store_stats(c->store).chunks_twice;
	}
	view_store_free(c->store);
	return view_store_new(&c->store, &options, error);
}

static void pause_ms(long ms)
{
	nanosleep(&(struct timespec){ ms / 1000, ms % 1000 * 1000000 }, NULL);
}

static void one_request(struct client *c, uint32_t frame)
{
	const struct view_load_options *o = c->options;
	struct eco_request request = { .vertices = o->vertices, .bytes = o->bytes };
	struct view_fetch_result result;
	struct eco_error error = { 0 };
	eco_camera_frame(o->camera, frame, &request.view);
	request.view.width = o->width;
	request.view.height = o->height;
	enum eco_code code = ECO_OK;
	if (eco_camera_above_ground(o->camera)) {
		code = view_stand(c->fetch, c->store, &request, &result, &error);
		c->report.bytes += result.bytes;
	}
	if (!code) {
		code = view_fetch_stream(c->fetch, c->store, &request, &result, &error);
		c->report.bytes += result.bytes;
	}
	if (code == ECO_INTERRUPTED)
		return;
	c->report.requests++;
	if (code && result.status == PACK_CHANGED) {
		c->report.renewed++;
		restart(c, NULL);
		return;
	}
	if (code) {
		c->report.failures[kind_of(code, result.status)]++;
		note(&c->report, error.text);
		if (restart(c, NULL))
			return;
		pause_ms(result.retry_ms > 50 ? (long)result.retry_ms : 50);
		return;
	}
	add_time(&c->report.latency, result.stream_ms);
	add_time(&c->report.first_byte, result.first_byte_ms);
	c->report.nothing += result.nothing;
	check_answer(c, &request, &result);
}

static void *work(void *ctx)
{
	struct client *c = ctx;
	uint32_t frames = eco_camera_frame_count(c->options->camera);
	uint32_t frame = (uint32_t)((uint64_t)frames * c->number / c->options->clients);
	while (c->store && !atomic_load(c->over) && !(c->options->stop && *c->options->stop)) {
		one_request(c, frame);
		frame = (frame + 1) % frames;
	}
	return NULL;
}

/* ---- All of them ---- */

static enum eco_code open_client(struct client *c, struct eco_error *error)
{
	struct view_fetch_options options = { .url = c->options->url, .stop = c->options->stop };
	enum eco_code code = view_fetch_new(&c->fetch, &options, error);
	return code ? code : restart(c, error);
}

static void add_times(struct view_times *into, const struct view_times *from)
{
	for (uint32_t i = 0; i < from->count; i++)
		add_time(into, (double)from->ms[i]);
}

static void collect(struct view_load_report *into, struct client *c)
{
	const struct view_load_report *from = &c->report;
	if (c->store) {
		into->chunks += view_store_stats(c->store).chunks;
		into->chunks_twice += view_store_stats(c->store).chunks_twice;
	}
	into->requests += from->requests;
	into->renewed += from->renewed;
	into->nothing += from->nothing;
	into->bytes += from->bytes;
	into->vertices += from->vertices;
	into->chunks += from->chunks;
	into->chunks_twice += from->chunks_twice;
	into->vertex_violations += from->vertex_violations;
	into->byte_violations += from->byte_violations;
	for (int i = 0; i < VIEW_LOAD_FAILURES; i++)
		into->failures[i] += from->failures[i];
	if (from->first_failure[0])
		note(into, from->first_failure);
	add_times(&into->latency, &from->latency);
	add_times(&into->first_byte, &from->first_byte);
}

static void wait_for(const struct view_load_options *o, double start)
{
	double end = start + o->seconds * 1e3;
	while (view_clock_ms() < end && !(o->stop && *o->stop)) {
		double left = end - view_clock_ms();
		pause_ms(left > 200 ? 200 : left > 1 ? (long)left : 1);
		if (o->tick)
			o->tick(o->ctx, (view_clock_ms() - start) / 1e3);
	}
}

enum eco_code view_load_run(struct view_load_report *report, const struct view_load_options *options,
	struct eco_error *error)
{
	atomic_bool over = false;
	*report = (struct view_load_report){ 0 };
	struct client *clients = calloc(options->clients, sizeof *clients);
	if (!clients)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for %u clients", options->clients);
	enum eco_code code = ECO_OK;
	for (uint32_t i = 0; i < options->clients && !code; i++) {
		clients[i].options = options;
		clients[i].over = &over;
		clients[i].number = i;
		code = open_client(&clients[i], error);
	}
	double start = view_clock_ms();
	for (uint32_t i = 0; i < options->clients && !code; i++) {
		clients[i].started = pthread_create(&clients[i].thread, NULL, work, &clients[i]) == 0;
		if (!clients[i].started)
			code = eco_fail(error, ECO_IO, "the system allows no more than %u clients", i);
	}
	if (!code)
		wait_for(options, start);
	atomic_store(&over, true);
	for (uint32_t i = 0; i < options->clients; i++) {
		if (clients[i].started)
			pthread_join(clients[i].thread, NULL);
		collect(report, &clients[i]);
		free(clients[i].report.latency.ms);
		free(clients[i].report.first_byte.ms);
		view_fetch_free(clients[i].fetch);
		view_store_free(clients[i].store);
	}
	report->seconds = (view_clock_ms() - start) / 1e3;
	qsort(report->latency.ms, report->latency.count, sizeof *report->latency.ms, by_value);
	qsort(report->first_byte.ms, report->first_byte.count, sizeof *report->first_byte.ms, by_value);
	free(clients);
	if (code)
		view_load_free(report);
	return code;
}

void view_load_free(struct view_load_report *report)
{
	free(report->latency.ms);
	free(report->first_byte.ms);
	*report = (struct view_load_report){ 0 };
}

bool view_load_clean(const struct view_load_report *report)
{
	uint64_t failures = 0;
	for (int i = 0; i < VIEW_LOAD_FAILURES; i++)
		failures += report->failures[i];
	return report->requests && !failures && !report->vertex_violations && !report->byte_violations
		&& !report->chunks_twice;
}
