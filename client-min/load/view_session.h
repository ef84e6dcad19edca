/* One client of a load test, as a thing that libcurl's multi interface moves on.
 *
 *   waits until an answer is due -> (its line's latency) -> asks -> reads -> (fetches chunks that are named)
 *   -> records the answer -> waits for the next
 *
 * An answer that breaks off is asked for again with what came of it; a pack that has been replaced is begun
 * anew. */
#ifndef VIEW_SESSION_H
#define VIEW_SESSION_H

#include <curl/curl.h>

#include "client-min/load/view_load.h"

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
/* A transfer of one of the sessions has ended. */
void view_session_transferred(CURL *curl, CURLcode rc);
/* Whatever is due and has not come never will. */
void view_session_give_up(struct view_session *session);

#endif
