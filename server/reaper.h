/* Deadlines of connections, and what each address holds. The HTTP library only times out silence, so that 700
 * clients that drip a byte a second hold 700 places for ever. Here every phase that waits for a client has a
 * deadline: the head of a request (from connecting, or from the end of the request before), and its body. A
 * response must be taken at a least rate, window after window, by the client's acknowledgements. A thread
 * shuts overdue sockets down; the library then closes them.
 *
 * Addresses share connections, and bytes of request bodies and answers. A few more places than the limit are
 * for addresses that hold no connection. If one's share or all is full
 *   - the connection that has waited longest for a request, for a second at least, gives way;
 *   - else the address that holds most gives way, if it then holds more than the newcomer: with the connection
 *     that waits for a request, sends a body, takes an answer, or whose plan is made, in this order, the oldest
 *     first;
 *   - else the newcomer is refused. A loopback address that is no proxy's is taken if an equal gives way.
 * Bytes are shared in the same way. A trusted proxy has no limit of its own and gives way to nobody, but with
 * connections that wait for a request.
 *
 * A request that is refused before all of it is here leaves bytes unread. A socket closed so makes the system
 * send a reset, by which the client may lose the answer. Therefore the rest is dropped, for a while and up to
 * some bytes, until the client closes too; such a connection counts as one that waits.
 *
 * An entry is opened when the connection starts, and closed before its socket is (so that a number that the
 * system gave to another socket is never shut down). All functions may be called from any thread. */
#pragma once

#include <stdatomic.h>
#include <stdint.h>

#include "ecofiles/base/status.h"
#include "server/request/address.h"
#include "server/request/framing.h"

struct srv_reaper;
struct srv_exchange;
struct srv_holder;

enum srv_held { SRV_HELD_CONNECTIONS, SRV_HELD_BODIES, SRV_HELD_ANSWERS, SRV_HELD_COUNT };
/* Phases of a connection, in the order in which they give way. */
enum srv_wait { SRV_WAIT_REQUEST, SRV_WAIT_BODY, SRV_WAIT_SENDING, SRV_WAIT_WORK };

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
	enum srv_wait wait;
	uint64_t since_us;                               /* since when it is at that */
	/* the peer; who is asking, behind a proxy; and what it holds, bytes by `payer` */
	struct srv_holder *holder, *payer;
	uint64_t held[SRV_HELD_COUNT];
	atomic_bool *gone;                               /* to be set; NULL: nobody cares */
	uint64_t probe_us;                               /* when to find out again whether anyone reads */
	uint64_t taken_bytes;                            /* acknowledged since it began, before the window */
	bool lingers;                                    /* fd is the reaper's own; what comes is dropped, ... */
	uint64_t dropped_bytes;                          /* ... so much until now */
};

struct srv_config;
/* The configuration outlives it. */
enum eco_code srv_reaper_start(struct srv_reaper **reaper, const struct srv_config *config, struct eco_error *error);
/* After the library has stopped. Frees it, and leases of connections that the library never began; NULL is
 * fine. */
void srv_reaper_stop(struct srv_reaper *reaper);

/* Opens the gate, too; a request is waited for. NULL if the connection may not come in: *why says so. */
struct srv_lease *srv_reaper_open(struct srv_reaper *reaper, int fd, const struct srv_address *address,
	const char **why);
/* The lease of an open descriptor, or NULL. */
struct srv_lease *srv_reaper_find(struct srv_reaper *reaper, int fd);
/* Shuts the connection that has waited the longest for a request, else one of the address that holds most, if
 * that holds two. */
void srv_reaper_make_room(struct srv_reaper *reaper);
uint64_t srv_reaper_held(struct srv_reaper *reaper, enum srv_held what);  /* of connections that are not shut */
/* The lease's request is the client's, not the peer's; without memory it stays the peer's. It holds no bytes yet. */
void srv_reaper_speak_for(struct srv_reaper *reaper, struct srv_lease *lease, const struct srv_address *client);
/* The lease's request holds so many bytes from now on, until the next one is waited for. False where there is
 * no room for them, which is never so where they are fewer than before. */
bool srv_reaper_hold(struct srv_reaper *reaper, struct srv_lease *lease, enum srv_held what, uint64_t bytes);
/* The connection is in this phase from now on. SRV_WAIT_REQUEST: bytes that the request before held are given
 * back. SRV_WAIT_SENDING: the first window only finds out how much had been taken before. SRV_WAIT_WORK: no
 * deadline. */
void srv_reaper_await(struct srv_reaper *reaper, struct srv_lease *lease, enum srv_wait wait);
/* While a plan is made: *gone is set when the client hangs up, which is more than to send no more. NULL: no
 * more. */
void srv_reaper_watch(struct srv_reaper *reaper, struct srv_lease *lease, atomic_bool *gone);
/* NULL lease: nothing. If a request is refused with more to come the connection is kept for a while. */
void srv_reaper_close(struct srv_reaper *reaper, struct srv_lease *lease);

uint64_t srv_clock_us(void);                             /* monotonic */
