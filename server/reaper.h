/* Deadlines for connections. The HTTP library only times out silence, so that 700 clients that drip a byte a
 * second hold 700 places for ever. Here every phase in which a client is waited for has a deadline, however
 * busy it looks: the head of a request (from connecting, or from the end of the request before), and its
 * body. A response must be taken at a stated least rate, window after window, as the system counts what the
 * client has acknowledged. While the server itself works there is no deadline. A thread shuts overdue
 * sockets down; the library then closes them.
 *
 * It also decides who may come in: so many connections in all, and so many of one address (address.h). Where
 * it is full, the connection that has waited the longest for its client to send a request gives way, of the
 * same address where that is what is full; if none waits, the new one is refused. A trusted proxy has no
 * limit of its own.
 *
 * A request that is refused before all of it is here leaves bytes unread, and more may come: a socket that is
 * closed so makes the system send a reset, by which the client may lose the answer. So what still comes is
 * dropped, for a while and up to some bytes, until the client closes too; a connection that is kept for that
 * counts as one that waits, and gives way like it.
 *
 * Life of an entry: opened when the connection starts, closed before its socket is (so that a number that
 * the system gave to another socket is never shut down). All functions may be called from any thread. */
#ifndef SRV_REAPER_H
#define SRV_REAPER_H

#include <stdatomic.h>
#include <stdint.h>

#include "ecofiles/base/status.h"
#include "server/request/address.h"
#include "server/request/gate.h"

struct srv_reaper;
struct srv_exchange;

struct srv_lease {
	/* the request that is under way, or NULL; the polling thread's. The library forgets to complete some
	 * that it drops: they end with the connection, or at its next request line. */
	struct srv_exchange *exchange;
	bool is_refused;                                 /* with more to come; the polling thread's, too */
	struct srv_gate gate;
	struct srv_lease *before, *next;                 /* the rest is the reaper's, under its mutex */
	struct srv_address address;
	bool is_proxy, is_shut;
	int fd;
	uint64_t due_us;                                 /* 0: no deadline */
	uint64_t idle_us;                                /* since when a request is waited for; 0: none is */
	atomic_bool *gone;                               /* to be set; NULL: nobody cares */
	uint64_t probe_us;                               /* when to find out again whether anyone reads */
	bool is_sending;
	uint64_t taken_bytes;                            /* acknowledged since it began, before the window */
	bool lingers;                                    /* fd is the reaper's own; what comes is dropped, ... */
	uint64_t dropped_bytes, quiet_us;                /* ... so much until now, and no longer than that */
};

struct srv_reaper_limits {
	uint64_t connections, per_address, head_ms, send_ms, rate_bytes_s;
	const struct srv_networks *trusted;              /* proxies */
};
enum eco_code srv_reaper_start(struct srv_reaper **reaper, const struct srv_reaper_limits *limits,
	struct eco_error *error);
/* After the library has stopped. Frees it, and leases of connections that the library never began; NULL is
 * fine. */
void srv_reaper_stop(struct srv_reaper *reaper);

/* Opens the gate, too; a request is waited for. NULL if the connection may not come in: *why says so. */
struct srv_lease *srv_reaper_open(struct srv_reaper *reaper, int fd, const struct srv_address *address,
	const char **why);
/* That of an open descriptor, or NULL. */
struct srv_lease *srv_reaper_find(struct srv_reaper *reaper, int fd);
/* Shuts the connection that has waited the longest for a request, if there is one. */
void srv_reaper_make_room(struct srv_reaper *reaper);
uint64_t srv_reaper_connections(struct srv_reaper *reaper);      /* that are not shut */
/* The next request is waited for, for head_ms. */
void srv_reaper_await(struct srv_reaper *reaper, struct srv_lease *lease);
/* NULL lease: nothing */
void srv_reaper_arm(struct srv_reaper *reaper, struct srv_lease *lease, uint64_t after_ms);
/* A response is sent. The first window only finds out how much had been taken before. */
void srv_reaper_send(struct srv_reaper *reaper, struct srv_lease *lease);
/* No deadline until it is armed again: the server works. */
void srv_reaper_clear(struct srv_reaper *reaper, struct srv_lease *lease);
/* While a plan is made: *gone is set when the client hangs up, which is more than to send no more. NULL: no
 * more. */
void srv_reaper_watch(struct srv_reaper *reaper, struct srv_lease *lease, atomic_bool *gone);
/* NULL lease: nothing. Where a request is refused with more to come the connection is kept for a while. */
void srv_reaper_close(struct srv_reaper *reaper, struct srv_lease *lease);

uint64_t srv_clock_us(void);                             /* monotonic */

#endif
