/* One request and its answer, from the request line to the end of sending.
 *
 *   new (request line) -> head (checked; refused at once and closed if its framing is bad) -> body, where
 *   there is one
 *   -> answered directly, or handed to a work thread while the connection is suspended -> answered when
 *   resumed -> free
 *
 * The polling thread owns an exchange, except between srv_work_submit and MHD_resume_connection, when the
 * work thread does. */
#ifndef SRV_EXCHANGE_H
#define SRV_EXCHANGE_H

#include "server/answer.h"
#include "server/catalog.h"
#include "server/daemon.h"
#include "server/query.h"
#include "server/reaper.h"
#include "server/route.h"
#include "server/work.h"

struct MHD_Connection;

struct srv_host {                        /* what exchanges need of the daemon */
	struct srv_config config;            /* defaults filled in */
	struct srv_catalog *catalog;
	struct srv_work *work;
	struct srv_plan_cache *plans;
	struct srv_reaper *reaper;
	atomic_bool draining;
	_Atomic(uint32_t) busy;
	_Atomic(uint64_t) bodies_bytes;      /* memory of the bodies that are held */
};

enum srv_phase { SRV_PHASE_HEAD, SRV_PHASE_BODY, SRV_PHASE_WORKING, SRV_PHASE_DONE };

struct srv_exchange {
	struct srv_host *host;
	struct MHD_Connection *connection;
	struct srv_lease *lease;
	struct srv_address client;           /* behind a trusted proxy, if there is one */
	enum srv_phase phase;
	bool counted;                        /* in host->busy */

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
	size_t body_size, body_room;         /* room: counted in host->bodies_bytes */
	bool body_lost;                      /* there was no room for all of it */

	struct srv_edition *edition;         /* held from the head on */
	struct srv_scene *scene;             /* of it, or NULL */
	struct srv_query query;
	struct eco_holdings holdings;
	struct srv_validators validators;    /* of a plan or stream that is got, else empty */

	struct srv_answer answer;
	atomic_bool cancelled;               /* nobody waits for the plan */
	uint64_t begun_us;
};

/* NULL if there is no memory. */
struct srv_exchange *srv_exchange_new(struct srv_host *host, struct MHD_Connection *connection,
	struct srv_lease *lease, const char *raw);
/* Takes part in the library's calls: true if all is well, false to drop the connection. */
bool srv_exchange_handle(struct srv_exchange *exchange, const char *method, const char *bytes, size_t *size);
/* Sent, or given up. Logs and frees. */
void srv_exchange_end(struct srv_exchange *exchange);

#endif
