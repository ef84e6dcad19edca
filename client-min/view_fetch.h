/* Asking a server for a view and feeding its answer to a store while it arrives.
 *
 *   view_fetch_new(&fetch, &options, &error);       one per thread: keeps its connection
 *   view_fetch_stream(fetch, store, &request, &result, &error);
 *   view_fetch_free(fetch);
 *
 * POST url/stream?eye=..&target=..&up=..&fov_y_deg=..&width=..&height=..&vertices=..[&bytes=..][&rule=..]
 * with the store's holdings as body, and [&pack=..], which they are of: where the scene has another by now
 * that is a problem of status 409, and a new store begins anew. With a host of chunks also name_from=..: the
 * stream is then read twice, for names while it comes, which are fetched at once, and into the store when it
 * is whole. Problem documents (RFC 9457) become errors with their title and detail. Everything is bounded:
 * the body, its rate, the time. Bodies that are held whole have smaller bounds: descriptions of a scene or of
 * plants 8 MiB, explanations 64 MiB, streams with names 256 MiB. */
#pragma once

#include <signal.h>

#include "client-min/view_store.h"

struct view_fetch;

/* ---- Where in an answer that arrives a picture is drawn: after so many bytes, or milliseconds ---- */

#define VIEW_MARKS_MAX 64u

struct view_marks {
	uint64_t bytes[VIEW_MARKS_MAX], ms[VIEW_MARKS_MAX];     /* each ascending, without repeats */
	uint32_t bytes_count, ms_count;
};

/* Such as "20000,50000" or "200ms,1000ms,20000": numbers from 1 on, in any order. ECO_BAD_USAGE says what is
 * wrong with which of them. */
enum eco_code view_marks_read(struct view_marks *marks, const char *text, struct eco_error *error);

/* ---- Asking ---- */

struct view_fetch_options {
	const char *url;         /* of a scene, http://host:port/v1/scenes/NAME; a final slash is ignored */
	const char *rule;        /* how the server spends the budget: optimal or deussen; NULL: as it likes */
	uint64_t body_max;       /* 0: 16 GiB */
	/* the server names chunks of at least name_from bytes (0: ECO_NAME_FROM), which are fetched from
	 * chunks/ID, several at once; NULL: all come with the stream. They do once the host sends less than
	 * 1 KiB/s for 10 s */
	const char *chunks;
	uint64_t name_from;
	long connect_ms;         /* 0: 10 s */
	long stall_ms;           /* the time in which at least 1 KiB/s must come; 0: 120 s */
	/* a server that is busy (503 or 429 with Retry-After) is asked again for so long; 0: an error */
	long patience_ms;
	/* limit of repetitions after an answer that broke off, stalled or did not come from a server that has
	 * answered before: after a pause that doubles from .1 s, or as long as Retry-After says */
	uint32_t resumes;
	const volatile sig_atomic_t *stop;       /* not 0: end with ECO_INTERRUPTED; may be NULL */
};

struct view_fetch_result {
	long status;                     /* HTTP; 0: there was none */
	bool nothing;                    /* 204: no valid stream fits the budget; the store holds no plan */
	uint64_t requests;               /* more than 1: see view_store_again, and: */
	uint64_t broken;                 /* answers that broke off or did not come */
	uint64_t bytes;                  /* of the bodies, and of chunks that they name: */
	uint64_t named, named_bytes;     /* number of these, and their bytes */
	uint64_t most_bytes;             /* of the largest answer */
	bool host_left;                  /* the host of chunks hung: from now on none are named */
	double retry_ms;                 /* when a busy server wants to be asked again; 0: it did not say */
	uint64_t cancelled;              /* bytes that were not waited for: view_fetch_turn */
	double plan_ms;                  /* from Server-Timing; NaN: the server did not say */
	double first_byte_ms, stream_ms; /* from asking to the first byte and to the last, decoding included */
};

/* Once per process, before any thread fetches. */
enum eco_code view_fetch_setup(struct eco_error *error);
void view_fetch_teardown(void);

enum eco_code view_fetch_new(struct view_fetch **fetch, const struct view_fetch_options *options,
	struct eco_error *error);
void view_fetch_free(struct view_fetch *fetch);                  /* NULL is fine */

/* Begins a frame of the store and fetches it, in more than one answer if memory is short. *result is filled
 * also on failure, as far as things went. */
enum eco_code view_fetch_stream(struct view_fetch *fetch, struct view_store *store,
	const struct eco_request *request, struct view_fetch_result *result, struct eco_error *error);

struct view_fetch_watch {                /* zero: of nothing */
	/* `reached` is called where an answer has come to a mark, once for each, with what there is of the
	 * result: the store can be drawn, as far as it has come. At a mark of milliseconds that is what had
	 * been fed by then; so_far->stream_ms is the mark. Marks beyond an answer's end are not reached. An
	 * error ends the answer. NULL: no marks */
	const struct view_marks *marks;
	enum eco_code (*reached)(void *ctx, const struct view_fetch_result *so_far, struct eco_error *error);
	/* asked while there comes what only the next view needs: true ends the answer there, and what has
	 * come is a whole one. Not where chunks have a host, as streams are then short. NULL: it never is */
	bool (*turned)(void *ctx);
	void *ctx;
};
/* Watches the streams from now on. The marks must outlive them. */
void view_fetch_watch(struct view_fetch *fetch, const struct view_fetch_watch *watch);

/* GET url/plan?..&explain=1: the plan as JSON, with why each cut is what it is, for a client that holds
 * nothing. *text ends with 0; the caller frees it. */
enum eco_code view_fetch_explanation(struct view_fetch *fetch, const struct eco_request *request, char **text,
	struct eco_error *error);
/* The server's description of the scene (openapi.yaml's Scene), as text of the caller. */
enum eco_code view_fetch_scene(struct view_fetch *fetch, char **text, struct eco_error *error);

/* The server's description of plants of a list of a pack (openapi.yaml's Plants): at most `count`, from
 * `first` on. */
enum eco_code view_fetch_plants(struct view_fetch *fetch, const struct eco_chunk_id *pack, uint32_t list,
	uint32_t first, uint32_t count, char **text, struct eco_error *error);
