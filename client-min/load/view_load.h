/* Load on a server: many clients, each asking for the views of a script, from a few threads.
 *
 *   view_load_run(&report, &options, &error);        returns after `seconds`, or when *stop is set
 *   ... view_score_sample, view_load_print, view_load_json, view_load_csv ...
 *   view_load_free(&report);
 *
 * Clients that only count what they get share one thread; those that decode it share one a processor, so that
 * decoding delays no one else's answers. A client (view_session.c) asks one thing at a time. Lack of memory
 * ends the program (memory.h), except while a stream is read. */
#pragma once

#include <curl/curl.h>
#include <jansson.h>
#include <stdio.h>

#include "client-min/view_fetch.h"

#define VIEW_CLIENTS_MAX 10000u

struct view_load_options {
	const char *url;                         /* of a scene */
	const char *camera;              /* "walk", "flyover", "random", or the name of a file */
	uint32_t width, height;
	double snap_m;                           /* as eco_view_snap */
	struct eco_view *views;                  /* of view_views_make; each client begins at its own place */
	uint32_t view_count;
	uint64_t clients;                        /* at most VIEW_CLIENTS_MAX */
	uint64_t decoding;                       /* so many of them decode what they get and check it */
	uint64_t cold;                           /* so many hold nothing, and connect anew for each view */
	double seconds;
	/* Open loop: so many requests a second of all clients together; 0: closed loop. Evenly spaced, or as
	 * a Poisson process. */
	double rate;
	bool random_arrivals;
	uint64_t seed;                           /* of random views and arrivals */
	uint64_t vertices, bytes;
	/* Each client's line: bytes a second (0: no limit), and how long each request takes on its way. */
	uint64_t bandwidth_bytes_s;
	double latency_ms;
	double deadline_ms;                      /* of an answer, since it was due; 0: two minutes */
	/* As in struct view_fetch_options. */
	const char *chunks;
	uint64_t name_from;
	uint64_t resumes;                        /* an answer that breaks off is asked for again so often */
	const volatile sig_atomic_t *stop;
	/* a few times a second; may be NULL */
	void (*tick)(void *ctx, double seconds_gone, uint64_t answers, uint64_t failures);
	void *ctx;
};

/* ---- Answers: a record each ---- */

enum view_outcome {
	VIEW_ANSWERED,                   /* with a picture, or with 204: none fits in the bytes */
	VIEW_CONNECTION,                 /* no connection */
	VIEW_BROKEN,                     /* the answer ended too soon */
	VIEW_LATE,                       /* not whole at its deadline */
	VIEW_BUSY,                       /* 503 */
	VIEW_REFUSED,                    /* another status of 400 and above */
	VIEW_DAMAGED,                    /* a stream that is not well */
	VIEW_UNFINISHED,                 /* due before the end, and not answered some time after it */
	VIEW_OTHER,                      /* such as want of memory */
	VIEW_OUTCOMES
};
extern const char *const view_outcome_names[VIEW_OUTCOMES];

/* Times are milliseconds since the answer was due; NaN: that did not happen. In a closed loop a request is
 * due when the last answer has come; in an open loop when its schedule says, so that a server that stalls
 * also has the time that requests waited behind others on its account (coordinated omission). */
struct view_answer {
	double due_ms;                   /* since the run began */
	float asked_ms, first_byte_ms, picture_ms, q80_ms, q90_ms, done_ms;
	float service_ms;                /* from asking to the end, as a closed loop sees it */
	float plan_ms;                   /* as the server says */
	float predicted_q;               /* of the last plan */
	uint64_t bytes, vertices;
	uint32_t client, frame;
	uint16_t status;                 /* of HTTP; 0: there was none */
	uint8_t outcome;                 /* enum view_outcome */
	bool cold, nothing;              /* the client held nothing; the answer was 204 */
	uint8_t resumed;                 /* so many times it broke off and was asked for again */
};

struct view_answers { struct view_answer *items; uint32_t count, room; };    /* owns its items */

void view_answers_add(struct view_answers *answers, const struct view_answer *answer);

/* ---- Runs ---- */

struct view_scored {
	uint32_t frame;
	double predicted_q, q, precision, recall;
	uint64_t coarse;                         /* of full detail: view_selection's */
};

#define VIEW_LOAD_COUNTS 11
struct view_load_report {
	const struct view_load_options *options;
	double start_ms;                         /* when it began (view_clock_ms) */
	double seconds, cpu_seconds;             /* cpu: of this process */
	uint32_t processors;
	struct view_answers answers;
	struct view_scored *scored; uint32_t scored_count;       /* of view_score_sample; owned */
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

/* Fails only if it could not start at all; what servers do wrong is counted. The options outlive the report. */
enum eco_code view_load_run(struct view_load_report *report, const struct view_load_options *options,
	struct eco_error *error);
void view_load_free(struct view_load_report *report);
uint64_t view_load_failures(const struct view_load_report *report);
/* no failure, no violation, nothing twice, at least one answer */
bool view_load_clean(const struct view_load_report *report);

/* Whether a client is one of `some` that are spread evenly over all of them. */
bool view_load_is_one_of(uint32_t client, uint32_t some, uint32_t all);

/* ---- Reports: view_load_report.c: for people, as JSON, and as CSV with a line an answer ---- */

void view_load_print(const struct view_load_report *report, FILE *out);
json_t *view_load_json(const struct view_load_report *report);           /* of the caller */
/* The file appears whole or not at all. */
enum eco_code view_load_csv(const struct view_load_report *report, const char *path, struct eco_error *error);

/* Scores a sample of a run's views: after it, each is asked for once more by a client that holds nothing,
 * drawn in software, and scored against every triangle of the scene. So the load is not disturbed, and what
 * the server predicts of its answers is seen to hold.
 *
 * `count` of the views that were answered, evenly spread over the run, into report->scored. */
enum eco_code view_score_sample(struct view_load_report *report, struct view_fetch *fetch, uint32_t count,
	struct eco_error *error);

/* ---- Views that clients ask for ---- */

/* Those of a camera script, or made for the scene. walk: round the middle of the scene, 1.7 m above the
 * ground, looking ahead. flyover: to and fro above it, looking down ahead. random: from anywhere in it and
 * somewhat above, in any direction down to its ground.
 *
 * Fills options->views, which the caller frees. Asks the scene for its size and, where views count from the
 * ground, for its ground below each. */
enum eco_code view_views_make(struct view_load_options *options, struct view_fetch *fetch,
	struct eco_error *error);

/* ---- Sessions: view_session.c ---- */

/* One client of a load test: it waits until an answer is due, and for its line's latency, asks by an exchange
 * (view_exchange.h), records the answer, and waits for the next.
 *
 * An answer that breaks off is asked for again with what came of it; a pack that has been replaced is begun
 * anew. */
struct view_session;

/* Shared by the sessions of a thread. */
struct view_session_host {
	CURLM *multi;
	const struct view_load_options *options;
	double start_ms, end_ms;                 /* answers are due from start on, before end */
	struct view_load_report *report;         /* the thread's own */
};

enum eco_code view_session_new(struct view_session **session, struct view_session_host *host, uint32_t number,
	bool decodes, struct eco_error *error);
void view_session_free(struct view_session *session);            /* NULL is fine */

/* When it wants to be woken (view_clock_ms); INFINITY: its run is over. */
double view_session_wakes_ms(const struct view_session *session);
void view_session_wake(struct view_session *session);
/* Whatever is due and has not come never will. */
void view_session_give_up(struct view_session *session);
