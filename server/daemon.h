/* The daemon: scenes over HTTP.
 *
 *   srv_store_init(&store); srv_store_add(&store, ...);
 *   srv_daemon_start(&daemon, &config, &store, &error);
 *   for each request: target -> route -> framing -> query -> plan (work threads) -> answer (answer.h)
 *   srv_daemon_reload(daemon);                other packs for who comes from now on
 *   srv_daemon_quiesce(daemon);               new requests, /healthz too, are answered 503
 *   while (srv_daemon_busy(daemon)) wait;     what runs is finished, for as long as the caller cares to wait
 *   srv_daemon_stop(daemon);
 *   srv_store_free(&store);
 *
 * Threads: one takes connections in (endpoint.h); a pool of polling threads reads requests and sends answers
 * and does nothing that takes long; work threads plan; one thread watches deadlines. The library's parser is
 * not trusted with anything but splitting a head that is known to be well into lines: see gate.h, framing.h
 * and target.h. */
#ifndef SRV_DAEMON_H
#define SRV_DAEMON_H

#include <stdbool.h>
#include <stdint.h>

#include "server/request/address.h"
#include "server/endpoint.h"
#include "server/store.h"

struct srv_access;
struct srv_caps;
struct srv_reload;
struct srv_site;
struct srv_sources;
struct srv_config {              /* 0 is the default */
	/* "HOST:PORT", host numeric, [IPv6] in brackets, port 0: any; NULL: 127.0.0.1:8080 */
	const char *listen;
	const struct srv_endpoint *endpoint; /* in its place one that listens, which the daemon takes over */
	const struct srv_site *site;         /* what / shows; NULL: how to make it. Outlives the daemon */
	uint32_t polling_threads;    /* 2 */
	uint32_t work_threads;       /* one a processor, at most 8; beside the spare one (work.h) */
	uint64_t queue_max;          /* plans waiting: 64 */
	uint64_t queue_share_max;    /* of them of one address: 32 */
	uint64_t connections_max;    /* 1000; where it is full idle ones give way (reaper.h) */
	uint64_t connections_per_address;        /* 128; an IPv6 /64 is one address */
	struct srv_networks trusted; /* proxies without that limit, whose X-Forwarded-For counts: none */
	uint64_t head_ms;            /* to send a request's head, and to begin the next one: 20,000 */
	uint64_t body_ms;            /* to send its body: 30,000 */
	uint64_t send_ms;            /* window in which an answer must be taken at the rate: 30,000 */
	uint64_t rate_bytes_s;       /* 16 KiB */
	uint64_t body_max;           /* of requests: 4 MiB */
	uint64_t bodies_max;         /* arrived, of all requests that are received or planned: 256 MiB */
	uint64_t response_max;       /* 2 GiB */
	uint64_t answers_max;        /* memory of all answers that are being sent: 256 MiB */
	uint64_t plan_cache_bytes;   /* of answers that are kept for who asks again: 64 MiB */
	uint64_t plan_times;         /* work of a plan, over an ordinary one of its scene (typical.h): 5 */
	const struct srv_access *access;     /* tokens and origins; NULL: none. Outlives the daemon */
	const struct srv_caps *caps; /* of scenes (access.h); NULL: none. Outlives the daemon */
	const struct srv_sources *sources; /* what a reload opens; NULL: there is none. Outlives the daemon */
	uint32_t bad_packs;          /* of the sources: not well when they were read at the start */
	uint64_t keep_s;             /* that chunks of a replaced pack are still served: 600 */
	bool log;                    /* one line a request on stderr, ... */
	int log_form;                /* ... an enum srv_log_form */
	uint64_t slow_ms;            /* plans that took longer are logged with their trace; 0: none */
};

struct srv_daemon;

/* Shares the store's scenes. Errors say what was wrong with the address, or who may hold the port. */
enum eco_code srv_daemon_start(struct srv_daemon **daemon, const struct srv_config *config,
	const struct srv_store *store, struct eco_error *error);
uint16_t srv_daemon_port(const struct srv_daemon *daemon);
/* "http://127.0.0.1:8080": with the port that was bound. Valid as long as the daemon. */
const char *srv_daemon_url(const struct srv_daemon *daemon);
struct srv_counts { uint64_t connections, accept_failures; };    /* open now; for want of descriptors */
struct srv_counts srv_daemon_counts(const struct srv_daemon *daemon);
/* Opens the scenes again that config.sources name, on a thread, without failing a request; logs what became
 * of them. Quiescing ends it. */
void srv_daemon_reload(struct srv_daemon *daemon);
/* Now and then: forgets replaced packs whose time is over. */
void srv_daemon_tick(struct srv_daemon *daemon);
/* A reload that runs ends soon, and changes nothing. */
void srv_daemon_quiesce(struct srv_daemon *daemon);
/* requests that have begun and are not answered yet */
uint32_t srv_daemon_busy(const struct srv_daemon *daemon);
void srv_daemon_stop(struct srv_daemon *daemon);                 /* ends what still runs; NULL is fine */

#endif
