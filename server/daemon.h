/* The daemon: scenes over HTTP.
 *
 *   srv_store_init(&store); srv_store_add(&store, ...);
 *   srv_daemon_start(&daemon, &config, &store, &error);
 *   for each request: target -> route -> framing -> query -> plan (work threads) -> answer (exchange.h)
 *   srv_daemon_reload(daemon);                later requests get other packs
 *   srv_daemon_quiesce(daemon);               new requests, /healthz too, are answered 503
 *   while (srv_daemon_busy(daemon)) wait;     running requests end, while the caller waits
 *   srv_daemon_stop(daemon);
 *   srv_store_free(&store);
 *
 * Threads: one accepts; a pool polls, reads requests and sends answers; work threads plan; one
 * watches deadlines. The library's parser only splits heads that are known to be well: see framing.h
 * and target.h. */
#pragma once

#include <netdb.h>
#include <stdbool.h>
#include <stdint.h>

#include "server/request/address.h"
#include "server/store.h"

/* The socket that takes connections: opened here, or handed over by systemd, which keeps it while the server
 * is started again; before the server gives up its privileges, as ports below 1024 need some. */
#define SRV_LISTEN_DEFAULT "127.0.0.1:8080"

struct srv_endpoint {
	int fd;                          /* listens, nonblocking */
	uint16_t port;
	char url[NI_MAXHOST + 24];       /* "http://127.0.0.1:8080": with the port that was bound */
};

/* Is it HOST:PORT? NULL is fine. */
enum eco_code srv_endpoint_check(const char *listen, struct eco_error *error);
/* NULL: SRV_LISTEN_DEFAULT. Errors say what was wrong with the address, or who may hold the port. The caller
 * closes the descriptor; it is -1 on failure. */
enum eco_code srv_endpoint_open(struct srv_endpoint *endpoint, const char *listen, struct eco_error *error);
/* The same, but where systemd hands a socket over (LISTEN_FDS, as sd_listen_fds(3) describes it) that one,
 * and then `listen` must be NULL. Called once, by a program's main thread: the environment forgets it. */
enum eco_code srv_endpoint_take(struct srv_endpoint *endpoint, const char *listen, struct eco_error *error);

struct srv_access;
struct srv_reload;
struct srv_site;
struct srv_sources;
/* Limits: name, default and meaning. */
#define SRV_LIMITS(X) \
	X(polling_threads, 2, "that read requests and send answers") \
	X(work_threads, processors(), "that plan, beside the spare one (work.h)") \
	X(queue_max, 64, "plans that wait") \
	X(queue_share_max, 32, "of them of one address") \
	X(connections_max, 1000, "connections; idle ones give way (reaper.h)") \
	X(connections_per_address, 128, "of them of one address; an IPv6 /64 is one address") \
	X(head_ms, 20000, "to send a request's head, and to begin the next one") \
	X(body_ms, 30000, "to send its body") \
	X(send_ms, 30000, "window in which an answer must be taken at the rate, ...") \
	X(rate_bytes_s, 16u << 10, "... which is this") \
	X(body_max, 4u << 20, "bytes of a request's body") \
	X(bodies_max, 256u << 20, "bytes of bodies that have arrived, of all requests") \
	X(response_max, 1ull << 31, "bytes of an answer") \
	X(answers_max, 256u << 20, "memory of all answers that are being sent") \
	X(plan_cache_bytes, 64u << 20, "of answers that are kept for repeated requests") \
	X(plan_times, 7, "work of a plan, over an ordinary one of its scene (stream.h)") \
	X(keep_s, 600, "that chunks of a replaced pack are still served")

struct srv_config {                      /* what it points to outlives the daemon */
#define X(name, value, meaning) uint64_t name;
	SRV_LIMITS(X)                    /* 0: the default */
#undef X
	/* "HOST:PORT", host numeric, [IPv6] in brackets, port 0: any; NULL: 127.0.0.1:8080 */
	const char *listen;
	const struct srv_endpoint *endpoint;     /* in its place one that listens, which the daemon takes over */
	const struct srv_site *site;             /* at /; NULL: how to make it */
	struct srv_networks trusted;             /* proxies without a share, whose X-Forwarded-For counts */
	const struct srv_access *access;         /* tokens, origins and caps of scenes; NULL: none */
	const struct srv_sources *sources;       /* for a reload; NULL: there is none */
	uint32_t bad_packs;                      /* of the sources at the start */
	bool log;                                /* one line a request on stderr, ... */
	int log_form;                            /* ... an enum srv_log_form */
	uint64_t slow_ms;                        /* plans that took longer are logged with their trace; 0: none */
};

struct srv_daemon;

/* Shares the store's scenes. Errors say what was wrong with the address, or who may hold the port. */
enum eco_code srv_daemon_start(struct srv_daemon **daemon, const struct srv_config *config,
	const struct srv_store *store, struct eco_error *error);
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
