/* Lines on stderr about requests and the daemon, for people or as JSON, one object a line, without headers
 * and without parameters that are named like a token. Characters that would end a line, or that a terminal
 * obeys, are written as '?' or escaped.
 *
 * Nobody waits for the reader of stderr: lines that find no room there are dropped and counted. */
#pragma once

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "ecofiles/base/bytes.h"
#include "ecofiles/base/status.h"
#include "server/request/target.h"

enum srv_log_form { SRV_LOG_TEXT, SRV_LOG_JSON };

#define SRV_LOG_BYTES (256u << 10)
/* Before a sandbox: lets so many bytes wait in a pipe that is stderr. */
void srv_log_start(void);
uint64_t srv_log_dropped(void);          /* lines so far */
/* An object of JSON with its time and event, which the caller goes on with. */
struct srv_json;
void srv_log_begin(struct srv_json *json, const char *event);
void srv_log_end(struct eco_writer *line);       /* prints and frees it */
/* A target's printable characters, without values of parameters whose names contain "token". */
#define SRV_LOG_TARGET_BYTES 400u
void srv_log_clean_target(char to[SRV_LOG_TARGET_BYTES], const char *target);
/* Something about the daemon; `problem`: that the operator should look at. */
void srv_log_event(enum srv_log_form form, bool problem, const char *format, ...)
	__attribute__((format(printf, 3, 4)));

/* ---- Trace ---- ECO_TRACE=plan,cache prints on stderr why things are as they are. One table of bits;
 * reading it costs one load when off. */

#define SRV_TRACE_BITS(X) \
	X(PLAN, "plan", "vertex budgets tried for a byte budget, steps taken or left out, and why") \
	X(CUTS, "cuts", "of each plan, why each cut is what it is") \
	X(CACHE, "cache", "answers without a plan, chunks refused") \
	X(CONNECTION, "connection", "connections that were shut down, and why")

enum srv_trace_bit {
#define X(bit, name, text) SRV_TRACE_##bit,
	SRV_TRACE_BITS(X)
#undef X
	SRV_TRACE_COUNT
};

/* Sets the bits from a comma-separated list of names (NULL: none), once, before threads start. ECO_BAD_USAGE
 * lists the names. */
enum eco_code srv_trace_set(const char *names, struct eco_error *error);
/* From now on what this thread says of its plans goes to `to`, too, a line each; NULL: no more. */
void srv_trace_capture(struct eco_writer *to);
bool srv_trace_on(enum srv_trace_bit bit);
void srv_trace(enum srv_trace_bit bit, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* ---- Metrics ---- Counters for Prometheus: a table of counters with a sentence each, requests by route and
 * status, and how long plans took. Adding is one atomic addition; any thread. */

#define SRV_COUNTERS(X) \
	X(PLANS, "plans_total", "Plans that were made.") \
	X(PLANS_CUT, "plans_cut_short_total", \
		"Of these, those that ended at the bound of their work (--plan-work).") \
	X(PLAN_WORK, "plan_work_total", \
		"Work of all plans, counted in units of about 7 ns of processor time.") \
	X(PLANS_CANCELLED, "plans_cancelled_total", "Plans given up because their client had left.") \
	X(PLANS_REFUSED, "plans_refused_total", "Requests answered 503 because too many plans waited.") \
	X(KEPT, "kept_answers_total", "Requests for a plan or stream that were answered without planning.") \
	X(BODY_BYTES, "response_bytes_total", "Bytes of the bodies that were answered.") \
	X(RELOADS, "reloads_total", "Reloads of the scenes that were asked for.") \
	X(RELOADS_FAILED, "reloads_failed_total", \
		"Of these, those that left at least one scene as it was before.") \
	X(SLOW, "slow_requests_total", "Requests whose plan took longer than --slow.")

enum srv_counter {
#define X(name, metric, help) SRV_COUNT_##name,
	SRV_COUNTERS(X)
#undef X
	SRV_COUNTER_COUNT
};

#define SRV_STATUSES_MAX 32u
#define SRV_PLAN_BUCKETS 9u

struct srv_metrics {
	_Atomic(uint64_t) counters[SRV_COUNTER_COUNT];
	_Atomic(uint64_t) requests[SRV_RESOURCE_COUNT + 1][SRV_STATUSES_MAX];    /* the last route: none */
	_Atomic(uint64_t) plan_buckets[SRV_PLAN_BUCKETS + 1], plan_us;
};

static inline void srv_count(struct srv_metrics *metrics, enum srv_counter counter, uint64_t more)
{
	atomic_fetch_add_explicit(&metrics->counters[counter], more, memory_order_relaxed);
}
/* `route` NULL: there is none. */
void srv_count_request(struct srv_metrics *metrics, const struct srv_route *route, unsigned status);
void srv_count_plan(struct srv_metrics *metrics, uint64_t took_us, uint64_t work, bool cut_short);

/* Present values, and counters that others keep. */
#define SRV_GAUGES(X) \
	X(refused_heads, "refused_heads_total", "counter", "Requests that were refused before they were whole: heads " \
		"that are malformed or too large, connections beyond a limit.") \
	X(accept_failures, "accept_failures_total", "counter", "Times that no connection could be accepted, for want " \
		"of descriptors or memory.") \
	X(dropped_lines, "log_lines_dropped_total", "counter", "Lines of the log that were dropped because nobody read " \
		"stderr fast enough.") \
	X(connections, "connections", "gauge", "Connections that are open.") \
	X(busy, "requests_in_flight", "gauge", "Requests that have begun and are not answered yet.") \
	X(waiting_plans, "plans_waiting", "gauge", "Plans that wait for a thread.") \
	X(bodies_bytes, "bodies_bytes", "gauge", "Memory of the request bodies that are held.") \
	X(answers_bytes, "answers_bytes", "gauge", "Memory of the answers that are being sent.") \
	X(kept_bytes, "kept_bytes", "gauge", "Memory of the answers that are kept.") \
	X(scenes, "scenes", "gauge", "Scenes that are served.") \
	X(retired, "retired_scenes", "gauge", "Scenes that were replaced, and whose chunks are still served.") \
	X(bad_packs, "bad_packs", "gauge", "Packs that were not well when they were last read; see the log.") \
	X(ready, "ready", "gauge", "1 where /readyz says so.")
struct srv_gauges {
#define X(name, metric, type, help) uint64_t name;
	SRV_GAUGES(X)
#undef X
};
/* The text format 0.0.4 of Prometheus. */
void srv_metrics_write(struct eco_writer *out, struct srv_metrics *metrics, const struct srv_gauges *gauges);
