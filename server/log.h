/* Lines on stderr about requests and the daemon, for people or as JSON, one object a line. No header is in
 * them, so no token is; a parameter of a target that is named like one is left out. Characters that would end
 * a line, or that a terminal obeys, are written as '?' or escaped.
 *
 * Once srv_log_start has been called a thread writes them, so that nobody waits for whoever reads stderr:
 * what does not fit into SRV_LOG_BYTES until it is read is dropped and counted. */
#ifndef SRV_LOG_H
#define SRV_LOG_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

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
/* Again, or where no thread can be had, it does nothing: without one lines are written where they are said, and
 * dropped where nobody reads stderr within a second. */
void srv_log_start(void);
/* Waits until all is written, for a second at most. */
void srv_log_flush(void);
uint64_t srv_log_dropped(void);          /* lines so far */
/* A line without its end. */
void srv_log_line(const char *text, size_t size);
void srv_log_request(enum srv_log_form form, const struct srv_log_request *request);
/* Something about the daemon; `problem`: that the operator should look at. */
void srv_log_event(enum srv_log_form form, bool problem, const char *format, ...)
	__attribute__((format(printf, 3, 4)));

#endif
