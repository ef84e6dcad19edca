/* One request and its answer, from the request line to the end of sending.
 *
 *   new (request line) -> head (checked; refused and closed if its framing is bad) -> body, if there is one
 *   -> answered directly, or handed to a work thread while the connection is suspended -> answered when
 *   resumed -> free
 *
 * exchange.c receives and sends, exchange_answer.c makes answers. The polling thread owns an exchange, except
 * between srv_work_submit and MHD_resume_connection, when the work thread does. */
#ifndef SRV_EXCHANGE_H
#define SRV_EXCHANGE_H

#include <pthread.h>

#include "server/answer.h"
#include "server/daemon.h"
#include "server/log.h"
#include "server/request/query.h"
#include "server/reaper.h"
#include "server/reload.h"
#include "server/request/target.h"
#include "server/work.h"

struct MHD_Connection;

struct srv_host {                        /* what exchanges need of the daemon */
	struct srv_config config;            /* defaults filled in */
	struct srv_catalog catalog;
	struct srv_work *work;
	struct srv_work *chores;             /* the operator's, one at a time */
	struct srv_plan_cache *plans;
	struct srv_reaper *reaper;
	struct srv_listener *listener;
	struct srv_metrics metrics;
	uint64_t id_seed;                    /* of requests' ids, with the number of those that came */
	_Atomic(uint64_t) id_count;
	pthread_mutex_t reloading;
	atomic_bool draining;
	_Atomic(uint32_t) busy;
	_Atomic(uint32_t) bad_packs;         /* at the start or the last reload that changed something */
};

/* Opens the scenes again that config.sources name. One at a time; later calls wait. *report says
 * what became of them, also where it fails, which leaves all as they were. */
enum eco_code srv_host_reload(struct srv_host *host, struct srv_reload *report, struct eco_error *error);
struct srv_gauges srv_host_gauges(struct srv_host *host);

#define SRV_REQUEST_ID_BYTES 65

enum srv_phase { SRV_PHASE_HEAD, SRV_PHASE_BODY, SRV_PHASE_WORKING, SRV_PHASE_DONE };

struct srv_exchange {
	struct srv_host *host;
	struct MHD_Connection *connection;
	struct srv_lease *lease;
	struct srv_address client;           /* behind a trusted proxy, if there is one */
	enum srv_phase phase;
	bool counted;                        /* in host->busy */
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
	struct srv_validators validators;    /* of a plan or stream that is got, else empty */

	struct srv_answer answer;
	atomic_bool cancelled;               /* nobody waits for the plan */
	uint64_t plan_us, plan_work;         /* plan_us 0: nothing was planned */
	bool cut_short;
	struct eco_writer trace;             /* of the plan, where slow ones are logged */
	uint64_t begun_us;
};

/* NULL if there is no memory. */
struct srv_exchange *srv_exchange_new(struct srv_host *host, struct MHD_Connection *connection,
	struct srv_lease *lease, const char *raw);
/* Takes part in the library's calls: true if all is well, false to drop the connection. */
bool srv_exchange_handle(struct srv_exchange *exchange, const char *method, const char *bytes, size_t *size);
/* Sent, or given up. Logs and frees. */
void srv_exchange_end(struct srv_exchange *exchange);

/* ---- Between its files ---- */

/* A header of the request, or NULL. */
const char *srv_exchange_header(const struct srv_exchange *exchange, const char *name);
/* The path names the resource that a problem is about; NULL where it could not be parsed. */
const char *srv_exchange_path(const struct srv_exchange *exchange, char path[SRV_TARGET_BYTES_MAX]);
/* Makes exchange->answer a problem, with this detail. */
void srv_exchange_problem(struct srv_exchange *exchange, enum srv_problem problem, const char *format, ...)
	__attribute__((format(printf, 3, 4)));
/* Lets preconditions count for exchange->answer, if there are any. */
void srv_exchange_judge(struct srv_exchange *exchange, const struct srv_validators *validators);

/* Suspends the connection until `run` has made exchange->answer on a thread of `work`; a problem where there
 * is no room for it. */
void srv_exchange_work(struct srv_exchange *exchange, struct srv_work *work, void (*run)(void *exchange));
/* Reads the parameters and the body; true if there is something to plan, else an answer has been made. */
bool srv_exchange_prepare_plan(struct srv_exchange *exchange);
void srv_exchange_make_plan(void *exchange);             /* on a work thread */
void srv_exchange_reload(void *exchange);                /* the same */
/* Makes the answer of any other route. */
void srv_exchange_answer_direct(struct srv_exchange *exchange);

#endif
