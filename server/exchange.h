/* The daemon's state, and one request with its answer, from the request line to the end of sending.
 *
 *   new (request line) -> head (checked; refused and closed if its framing is bad) -> body, if there is one
 *   -> answered directly, or handed to a work thread while the connection is suspended -> answered when
 *   resumed -> free
 *
 * exchange.c receives and sends, exchange_answer.c decides on answers, answer.c makes responses. The polling
 * thread owns an exchange, except between srv_work_submit and MHD_resume_connection, when the work thread does. */
#pragma once

#include <pthread.h>

#include "server/access.h"
#include "server/daemon.h"
#include "server/describe.h"
#include "server/log.h"
#include "server/reaper.h"
#include "server/request/condition.h"
#include "server/request/json.h"
#include "server/request/query.h"
#include "server/stream.h"
#include "server/work.h"

struct MHD_Connection;
struct MHD_Daemon;
struct MHD_Response;
struct srv_kept_body;
struct srv_plan_cache;

struct srv_daemon {
	struct srv_config config;            /* defaults filled in */
	struct srv_catalog catalog;
	struct srv_work *work;
	struct srv_work *chores;             /* the operator's, one at a time */
	struct srv_plan_cache *plans;
	struct srv_reaper *reaper;
	struct srv_metrics metrics;
	struct MHD_Daemon *http;
	struct srv_endpoint endpoint;
	pthread_t listener;
	bool listens;                        /* the listener runs */
	int stop_fd;                         /* ends it */
	_Atomic(uint64_t) accept_failures;   /* for want of descriptors or memory */
	uint64_t id_seed;                    /* of requests' ids, with the number of those that came */
	_Atomic(uint64_t) id_count;
	pthread_mutex_t reloading;
	atomic_bool draining, reload_cancelled;
	_Atomic(uint32_t) busy;
	_Atomic(uint32_t) bad_packs;         /* at the start or the last reload that changed something */
};

/* Opens the scenes again that config.sources name. One at a time; later calls wait. *report says
 * what became of them, also where it fails, which leaves all as they were. */
enum eco_code srv_daemon_reload_now(struct srv_daemon *daemon, struct srv_reload *report, struct eco_error *error);
struct srv_gauges srv_daemon_gauges(struct srv_daemon *daemon);

#define SRV_REQUEST_ID_BYTES 65
#define SRV_ETAG_BYTES 35                /* 32 hex digits, two quotes, 0 */
#define SRV_IMMUTABLE "max-age=31536000, immutable"

enum srv_phase { SRV_PHASE_HEAD, SRV_PHASE_BODY, SRV_PHASE_WORKING, SRV_PHASE_DONE };

struct srv_answer {
	struct MHD_Response *response;       /* NULL: no memory even for a problem; the connection is dropped */
	unsigned status;
	uint64_t size_bytes;                 /* of the body that a GET gets */
	uint64_t memory_bytes;               /* that it takes until it is sent; 0: next to none of its own */
};

struct srv_exchange {
	struct srv_daemon *daemon;
	struct MHD_Connection *connection;
	struct srv_lease *lease;
	struct srv_address client;           /* behind a trusted proxy, if there is one */
	enum srv_phase phase;
	bool counted;                        /* in daemon->busy */
	bool closes;                         /* the connection cannot be used again */
	char id[SRV_REQUEST_ID_BYTES];       /* a trusted proxy's, or our own */
	const char *authorization, *origin;  /* headers, or NULL */

	char *raw;                           /* the request target as it came */
	struct srv_target target;
	enum eco_code target_code;
	struct eco_error error;
	enum srv_method method;
	const struct srv_route *route;       /* or NULL */
	const char *variables[2];
	struct srv_conditions conditions;
	bool has_length;
	uint64_t length;                     /* of the body: 0 without one */
	uint8_t *body;
	size_t body_size, body_room;         /* room: held by the lease */
	bool body_lost;                      /* there was no room for all of it */

	struct srv_edition *edition;         /* held from the head on */
	struct srv_scene *scene;             /* of it, or NULL */
	struct srv_query query;
	struct eco_holdings holdings;

	/* Validators of the answer's state. `etag` with quotes; "": none, and the answer is not to be stored.
	 * `modified_s`: since 1970, 0: not known. */
	char etag[SRV_ETAG_BYTES];
	int64_t modified_s;
	bool is_private;                     /* no cache that others share may keep it */

	struct srv_answer answer;
	atomic_bool cancelled;               /* nobody waits for the plan */
	uint64_t plan_us, plan_work;         /* plan_us 0: nothing was planned */
	bool cut_short;
	struct eco_writer trace;             /* of the plan, where slow ones are logged */
	uint64_t begun_us;
};

/* NULL if there is no memory. */
struct srv_exchange *srv_exchange_new(struct srv_daemon *daemon, struct MHD_Connection *connection,
	struct srv_lease *lease, const char *raw);
/* Takes part in the library's calls: true if all is well, false to drop the connection. */
bool srv_exchange_handle(struct srv_exchange *exchange, const char *method, const char *bytes, size_t *size);
/* Sent, or given up. Logs and frees. */
void srv_exchange_end(struct srv_exchange *exchange);

/* ---- Between its files ---- */

/* A header of the request, or NULL. */
const char *srv_exchange_header(const struct srv_exchange *exchange, const char *name);
/* Reads the parameters and the body; true if there is something to plan, else an answer has been made. */
bool srv_exchange_prepare_plan(struct srv_exchange *exchange);
void srv_exchange_make_plan(void *exchange);             /* on a work thread */
void srv_exchange_reload(void *exchange);                /* the same */
/* Makes the answer of any other route. */
void srv_exchange_answer_direct(struct srv_exchange *exchange);

/* ---- Responses: each function makes exchange->answer ---- */

/* A problem document with this detail, in place of an answer that was made. */
void srv_exchange_problem(struct srv_exchange *exchange, enum srv_problem problem, const char *format, ...)
	__attribute__((format(printf, 3, 4)));
/* From bytes that outlive it. `type` NULL: it has none. */
void srv_answer_bytes(struct srv_exchange *exchange, unsigned status, const void *bytes, size_t size, const char *type);
/* Takes *text. */
void srv_answer_text(struct srv_exchange *exchange, unsigned status, struct eco_writer *text, const char *type);
/* Takes *body. */
void srv_answer_body(struct srv_exchange *exchange, struct srv_body *body, const char *type);
/* From a body that is held; holds it, too. */
void srv_answer_kept(struct srv_exchange *exchange, struct srv_kept_body *body, const char *type);
/* 304, or a 200 to HEAD, without the body. `size_bytes` of the body that GET gets; SRV_SIZE_UNKNOWN closes
 * the connection. `type`: the body's. */
#define SRV_SIZE_UNKNOWN UINT64_MAX
void srv_answer_head(struct srv_exchange *exchange, unsigned status, uint64_t size_bytes, const char *type);
/* The chunk, a part of it (to GET alone), 304, 416, or the problem that its payload is damaged. The scene
 * outlives the answer. */
void srv_answer_chunk(struct srv_exchange *exchange, const struct srv_scene *scene, uint32_t chunk);

/* Adds a header; value NULL: none. */
void srv_answer_add(struct srv_exchange *exchange, const char *name, const char *value);
/* Adds the exchange's validators, and what caches may do with what has a tag. */
void srv_answer_add_validators(struct srv_exchange *exchange, const char *cache_control);
/* Lets the request's preconditions count for an answer that has been made: it stays, or is 304 or 412
 * instead. */
void srv_answer_judge(struct srv_exchange *exchange);
/* Lets go of an answer that was queued (the library holds its own reference) or is not wanted. */
void srv_answer_free(struct srv_exchange *exchange);
/* Sets the validators of an answer from this scene, without a tag. */
void srv_answer_validate(struct srv_exchange *exchange, const struct srv_scene *scene);
void srv_etag_of(char etag[SRV_ETAG_BYTES], const struct eco_chunk_id *id);

/* ---- Kept answers ---- */

/* Answers to plan and stream requests, by their ETag: the same request to the same pack gives the same bytes,
 * so that a HEAD, a 304 and a repeated GET cost no plan. Status and size are kept of each, the body if it is
 * small. The least recently used goes first. Any thread; a body lives as long as someone holds it. */
#define SRV_KEPT_BODY_MAX (256u << 10)

struct srv_kept_body { _Atomic(uint32_t) holders; size_t size; uint8_t bytes[]; };
struct srv_kept_answer { unsigned status; uint64_t size_bytes; struct srv_kept_body *body; /* or NULL */ };

/* A body of `size` bytes, which the caller fills and holds; NULL: no memory, or larger than SRV_KEPT_BODY_MAX. */
struct srv_kept_body *srv_kept_body_make(uint64_t size);
void srv_kept_body_hold(struct srv_kept_body *body);
void srv_kept_body_release(struct srv_kept_body *body);          /* NULL is fine */

/* NULL if there is no memory. */
struct srv_plan_cache *srv_plan_cache_new(uint64_t bytes_max);
void srv_plan_cache_free(struct srv_plan_cache *cache);          /* NULL is fine */
/* Holds the body, too. `etag`: short; "": nothing is kept, as without memory. */
void srv_plan_cache_put(struct srv_plan_cache *cache, const char *etag, const struct srv_kept_answer *kept);
/* The caller holds the body then, if there is one. */
bool srv_plan_cache_get(struct srv_plan_cache *cache, const char *etag, struct srv_kept_answer *kept);
/* Memory of all that is kept. */
uint64_t srv_plan_cache_bytes(struct srv_plan_cache *cache);
