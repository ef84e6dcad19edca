/* Load on a server: many clients, each asking for the views of a script, from a few threads.
 *
 *   view_load_run(&report, &options, &error);        returns after `seconds`, or when *stop is set
 *   ... view_load_print, view_load_json, view_load_csv ...
 *   view_load_free(&report);
 *
 * Clients that only count what they get share one thread; those that decode it share one a processor, so that
 * decoding delays no one else's answers. A client (view_session.h) asks one thing at a time. */
#ifndef VIEW_LOAD_H
#define VIEW_LOAD_H

#include <signal.h>

#include "client-min/load/view_answers.h"
#include "ecofiles/format/view.h"

#define VIEW_CLIENTS_MAX 10000u

struct view_load_options {
	const char *url;                         /* of a scene */
	const struct eco_view *views;            /* each client begins at its own place in them */
	uint32_t view_count;
	uint32_t clients;
	uint32_t decoding;                       /* so many of them decode what they get and check it */
	uint32_t cold;                           /* so many hold nothing, and connect anew for each view */
	double seconds;
	/* Open loop: so many requests a second of all clients together; 0: closed loop. Evenly spaced, or as
	 * a Poisson process. */
	double rate;
	bool random_arrivals;
	uint64_t seed;
	uint64_t vertices, bytes;
	/* Each client's line: bytes a second (0: no limit), and how long each request takes on its way. */
	uint64_t bandwidth_bytes_s;
	double latency_ms;
	double deadline_ms;                      /* of an answer, since it was due; 0: two minutes */
	/* As in struct view_fetch_options. */
	const char *chunks;
	uint64_t name_from;
	uint32_t resumes;                        /* an answer that breaks off is asked for again so often */
	const volatile sig_atomic_t *stop;
	/* a few times a second; may be NULL */
	void (*tick)(void *ctx, double seconds_gone, uint64_t answers, uint64_t failures);
	void *ctx;
};

#define VIEW_LOAD_COUNTS 11
struct view_load_report {
	double start_ms;                         /* when it began (view_clock_ms) */
	double seconds, cpu_seconds;             /* cpu: of this process */
	uint32_t processors;
	struct view_answers answers;
	uint64_t outcomes[VIEW_OUTCOMES];
	union {
		struct {
			uint64_t nothing, bytes, vertices, chunks, chunks_decoded, chunks_named, chunks_twice;
			uint64_t resumed;        /* answers that broke off, and came when asked for again */
			uint64_t renewed;        /* clients that began anew: the pack was replaced */
			uint64_t vertex_violations, byte_violations;
		};
		uint64_t counts[VIEW_LOAD_COUNTS];       /* the same, in this order */
	};
	char first_failure[512];                 /* text of one failure or violation; empty if none */
};

/* Fails only if it could not start at all; what servers do wrong is counted. */
enum eco_code view_load_run(struct view_load_report *report, const struct view_load_options *options,
	struct eco_error *error);
void view_load_free(struct view_load_report *report);
uint64_t view_load_failures(const struct view_load_report *report);
/* no failure, no violation, nothing twice, at least one answer */
bool view_load_clean(const struct view_load_report *report);

/* Whether a client is one of `some` that are spread evenly over all of them. */
bool view_load_is_one_of(uint32_t client, uint32_t some, uint32_t all);

#endif
