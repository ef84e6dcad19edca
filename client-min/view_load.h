/* Load on a server: clients in threads, each in a closed loop along a camera script from its own place in it,
 * keeping what it was sent, decoding everything and recounting every plan.
 *
 *   view_load_run(&report, &options, &error);    returns after `seconds`, or when *stop is set
 *   view_load_free(&report);
 * */
#ifndef VIEW_LOAD_H
#define VIEW_LOAD_H

#include <signal.h>

#include "client-min/view_fetch.h"

struct view_load_options {
	const char *url;
	const struct eco_camera *camera;
	uint32_t clients;
	double seconds;
	uint32_t width, height;
	uint64_t vertices, bytes;
	const volatile sig_atomic_t *stop;
	void (*tick)(void *ctx, double seconds_gone);    /* a few times a second; may be NULL */
	void *ctx;
};

enum view_load_failure { VIEW_LOAD_CONNECTION, VIEW_LOAD_REFUSED, VIEW_LOAD_DAMAGED, VIEW_LOAD_OTHER,
	VIEW_LOAD_FAILURES };
extern const char *const view_load_failure_names[VIEW_LOAD_FAILURES];

struct view_times { float *ms; uint32_t count, room; };          /* sorted once the run is over */

struct view_load_report {
	double seconds;
	uint64_t requests, nothing, bytes, vertices, chunks, chunks_twice;
	uint64_t failures[VIEW_LOAD_FAILURES];
	uint64_t renewed;                                /* clients that began anew: the pack was replaced */
	uint64_t vertex_violations, byte_violations;
	struct view_times latency, first_byte;
	char first_failure[512];                         /* text of one failure or violation; empty if none */
};

/* Fails only if it could not start at all; what servers do wrong is counted. */
enum eco_code view_load_run(struct view_load_report *report, const struct view_load_options *options,
	struct eco_error *error);
void view_load_free(struct view_load_report *report);
/* no failure, no violation, nothing twice, at least one answer */
bool view_load_clean(const struct view_load_report *report);

/* The value that a share of the sorted times does not exceed; NaN without times. */
double view_times_quantile(const struct view_times *times, double share);

#endif
