/* Lines on stderr about requests and the daemon, for people or as JSON, one object a line, without headers
 * and without parameters that are named like a token. Characters that would end a line, or that a terminal
 * obeys, are written as '?' or escaped.
 *
 * Nobody waits for the reader of stderr: lines that find no room there are dropped and counted. */
#ifndef SRV_LOG_H
#define SRV_LOG_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "ecofiles/base/bytes.h"
#include "ecofiles/base/status.h"

enum srv_log_form { SRV_LOG_TEXT, SRV_LOG_JSON };

struct srv_log_request {
	const char *id, *client, *method, *target, *scene;       /* scene NULL: of none */
	unsigned status;
	uint64_t bytes;                  /* of the body that was sent */
	double ms, plan_ms;              /* plan_ms 0: nothing was planned */
	uint64_t work;
	bool cut_short;
	const char *trace;               /* of a slow plan: lines; NULL: none */
};
#define SRV_LOG_BYTES (256u << 10)
/* Before a sandbox: lets so many bytes wait in a pipe that is stderr. */
void srv_log_start(void);
uint64_t srv_log_dropped(void);          /* lines so far */
/* A line without its end. */
void srv_log_line(const char *text, size_t size);
void srv_log_request(enum srv_log_form form, const struct srv_log_request *request);
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

#endif
