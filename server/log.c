#include "server/log.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <poll.h>
#include <pthread.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "ecofiles/base/text.h"
#include "server/request/json.h"

#define END_MS 100

static _Atomic(uint64_t) dropped;

void srv_log_start(void)
{
	fcntl(STDERR_FILENO, F_SETPIPE_SZ, (int)SRV_LOG_BYTES);
}

uint64_t srv_log_dropped(void)
{
	return atomic_load(&dropped);
}

/* A pipe that has room takes PIPE_BUF bytes. A line that has begun waits for room for a while, so that it ends. */
static void put_line(const char *bytes, size_t size)
{
	static pthread_mutex_t mutex = PTHREAD_MUTEX_INITIALIZER;        /* lines of several threads do not mix */
	struct pollfd room = { .fd = STDERR_FILENO, .events = POLLOUT };
	size_t written = 0;
	pthread_mutex_lock(&mutex);
	while (written < size && poll(&room, 1, written ? END_MS : 0) == 1) {
		ssize_t part = write(STDERR_FILENO, bytes + written, size - written < PIPE_BUF ? size - written : PIPE_BUF);
		if (part < 0 && errno != EINTR && errno != EAGAIN)
			break;
		written += part > 0 ? (size_t)part : 0;
	}
	pthread_mutex_unlock(&mutex);
	atomic_fetch_add(&dropped, written < size);
}

/* ---- Lines ---- */

void srv_log_end(struct eco_writer *out)
{
	eco_write_u8(out, '\n');
	if (!out->failed)
		put_line((const char *)out->bytes, out->size);
	eco_writer_free(out);
}

/* A line without its end. */
static void log_line(const char *text, size_t size)
{
	struct eco_writer out = { 0 };
	for (const char *at = text, *end = text + size; at < end;) {
		size_t length = eco_utf8_bytes(at, (size_t)(end - at));
		bool shown = eco_utf8_printable(eco_utf8_code(at, length));
		eco_write_bytes(&out, shown ? at : "?", shown ? length : 1);
		at += length ? length : 1;
	}
	srv_log_end(&out);
}

void srv_log_clean_target(char to[SRV_LOG_TARGET_BYTES], const char *target)
{
	size_t size = 0;
	bool is_secret = false;
	for (const char *at = target; *at && size < SRV_LOG_TARGET_BYTES - 2; at++) {
		to[size++] = *at > 0x20 && *at < 0x7f ? *at : '?';
		if (*at == '?' || *at == '&') {
			const char *token = strstr(at, "token");
			is_secret = token && token < at + 1 + strcspn(at + 1, "=&");
		} else if (*at == '=' && is_secret) {
			to[size++] = '-';
			at += strcspn(at, "&") - 1;
		}
	}
	to[size] = 0;
}

void srv_log_begin(struct srv_json *json, const char *event)
{
	struct timespec now;
	struct tm utc;
	char text[32], time[40];
	clock_gettime(CLOCK_REALTIME, &now);
	gmtime_r(&now.tv_sec, &utc);
	strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%S", &utc);
	snprintf(time, sizeof time, "%s.%03dZ", text, (int)(now.tv_nsec / 1000000));
	srv_json_add(json, "{time:%s event:%s", time, event);
}

void srv_log_event(enum srv_log_form form, bool problem, const char *format, ...)
{
	char text[4096];
	struct srv_json json = { 0 };
	va_list arguments;
	va_start(arguments, format);
	vsnprintf(text, sizeof text, format, arguments);
	va_end(arguments);
	if (form == SRV_LOG_TEXT) {
		char line[sizeof text + 16];
		log_line(line, (size_t)snprintf(line, sizeof line, "ecoserve: %s", text));
		return;
	}
	srv_log_begin(&json, problem ? "problem" : "daemon");
	srv_json_add(&json, "text:%s}", text);
	srv_log_end(&json.out);
}

/* ---- Trace ---- */

static const struct { const char *name, *text; } trace_rows[] = {
#define X(bit, name, text) { name, text },
	SRV_TRACE_BITS(X)
#undef X
};

static uint32_t trace_bits;      /* written before threads start */
static _Thread_local struct eco_writer *captured;

static enum eco_code unknown(const char *name, size_t size, struct eco_error *error)
{
	char list[400] = "";
	for (size_t i = 0, at = 0; i < SRV_TRACE_COUNT && at < sizeof list; i++)
		at += (size_t)snprintf(list + at, sizeof list - at, "%s %s (%s)", i ? "," : "",
			trace_rows[i].name, trace_rows[i].text);
	return eco_fail(error, ECO_BAD_USAGE, "ECO_TRACE: there is no '%.*s'; known are%s",
		(int)(size < 40 ? size : 40), name, list);
}

enum eco_code srv_trace_set(const char *names, struct eco_error *error)
{
	trace_bits = 0;
	for (const char *at = names; at && *at;) {
		size_t size = strcspn(at, ","), i = 0;
		while (i < SRV_TRACE_COUNT
			&& (strlen(trace_rows[i].name) != size || memcmp(trace_rows[i].name, at, size) != 0))
			i++;
		if (i == SRV_TRACE_COUNT)
			return unknown(at, size, error);
		trace_bits |= 1u << i;
		at += size + (at[size] == ',');
	}
	return ECO_OK;
}

void srv_trace_capture(struct eco_writer *to) { captured = to; }

bool srv_trace_on(enum srv_trace_bit bit) { return trace_bits >> bit & 1; }

void srv_trace(enum srv_trace_bit bit, const char *format, ...)
{
	char line[512];
	bool captures = bit == SRV_TRACE_PLAN && captured;
	if (!srv_trace_on(bit) && !captures)
		return;
	va_list arguments;
	va_start(arguments, format);
	vsnprintf(line, sizeof line, format, arguments);
	va_end(arguments);
	if (captures) {
		eco_write_bytes(captured, line, strlen(line));
		eco_write_u8(captured, '\n');
	}
	if (srv_trace_on(bit))
		srv_log_event(SRV_LOG_TEXT, false, "%s: %s", trace_rows[bit].name, line);
}

/* ---- Metrics ---- */

#define PREFIX "ecoserve_"

static const struct { const char *metric, *help; } counter_rows[] = {
#define X(name, metric, help) { metric, help },
	SRV_COUNTERS(X)
#undef X
};

/* Those that there are; any other counts as the last. */
static const unsigned statuses[] = { 200, 204, 206, 304, 400, 401, 403, 404, 405, 409, 411, 412, 413, 414,
	415, 416, 422, 500, 503, 0 };
#define STATUS_COUNT (sizeof statuses / sizeof *statuses)
_Static_assert(STATUS_COUNT <= SRV_STATUSES_MAX, "room for all statuses");

static const double buckets_s[SRV_PLAN_BUCKETS] = { 0.001, 0.003, 0.01, 0.03, 0.1, 0.3, 1, 3, 10 };

void srv_count_request(struct srv_metrics *metrics, const struct srv_route *route, unsigned status)
{
	size_t i = 0;
	while (statuses[i] && statuses[i] != status)
		i++;
	atomic_fetch_add_explicit(&metrics->requests[route ? route - srv_routes : SRV_RESOURCE_COUNT][i], 1,
		memory_order_relaxed);
}

void srv_count_plan(struct srv_metrics *metrics, uint64_t took_us, uint64_t work, bool cut_short)
{
	uint32_t i = 0;
	while (i < SRV_PLAN_BUCKETS && (double)took_us * 1e-6 > buckets_s[i])
		i++;
	atomic_fetch_add_explicit(&metrics->plan_buckets[i], 1, memory_order_relaxed);
	atomic_fetch_add_explicit(&metrics->plan_us, took_us, memory_order_relaxed);
	srv_count(metrics, SRV_COUNT_PLANS, 1);
	srv_count(metrics, SRV_COUNT_PLANS_CUT, cut_short);
	srv_count(metrics, SRV_COUNT_PLAN_WORK, work);
}

static void add_head(struct eco_writer *out, const char *metric, const char *type, const char *help)
{
	eco_write_format(out, "# HELP " PREFIX "%s %s\n# TYPE " PREFIX "%s %s\n", metric, help, metric, type);
}

static void add_value(struct eco_writer *out, const char *metric, const char *type, const char *help,
	uint64_t value)
{
	add_head(out, metric, type, help);
	eco_write_format(out, PREFIX "%s %llu\n", metric, (unsigned long long)value);
}

static void add_requests(struct eco_writer *out, struct srv_metrics *metrics)
{
	add_head(out, "requests_total", "counter", "Requests that were answered, by route and status.");
	for (uint32_t r = 0; r <= SRV_RESOURCE_COUNT; r++)
		for (size_t s = 0; s < STATUS_COUNT; s++) {
			uint64_t count = atomic_load(&metrics->requests[r][s]);
			if (count)
				eco_write_format(out,
					PREFIX "requests_total{route=\"%s\",code=\"%u\"} %llu\n",
					r < SRV_RESOURCE_COUNT ? srv_routes[r].pattern : "", statuses[s],
					(unsigned long long)count);
		}
}

static void add_plans(struct eco_writer *out, struct srv_metrics *metrics)
{
	uint64_t sum = 0;
	add_head(out, "plan_seconds", "histogram",
		"How long plans took, from their start on a thread to their "
		"answer.");
	for (uint32_t i = 0; i <= SRV_PLAN_BUCKETS; i++) {
		sum += atomic_load(&metrics->plan_buckets[i]);
		if (i < SRV_PLAN_BUCKETS)
			eco_write_format(out, PREFIX "plan_seconds_bucket{le=\"%g\"} %llu\n", buckets_s[i],
				(unsigned long long)sum);
	}
	eco_write_format(out, PREFIX "plan_seconds_bucket{le=\"+Inf\"} %llu\n", (unsigned long long)sum);
	eco_write_format(out, PREFIX "plan_seconds_sum %.6f\n" PREFIX "plan_seconds_count %llu\n",
		(double)atomic_load(&metrics->plan_us) * 1e-6, (unsigned long long)sum);
}

void srv_metrics_write(struct eco_writer *out, struct srv_metrics *metrics, const struct srv_gauges *gauges)
{
	for (uint32_t i = 0; i < SRV_COUNTER_COUNT; i++)
		add_value(out, counter_rows[i].metric, "counter", counter_rows[i].help,
			atomic_load(&metrics->counters[i]));
	add_requests(out, metrics);
	add_plans(out, metrics);
#define X(name, metric, type, help) add_value(out, metric, type, help, gauges->name);
	SRV_GAUGES(X)
#undef X
}
