/* Takes connections in: a thread that accepts, lets the reaper decide who may come in (reaper.h), and hands
 * the socket on. Where descriptors run out it makes room and rests, instead of asking again and again. */
#ifndef SRV_LISTENER_H
#define SRV_LISTENER_H

#include <stdint.h>
#include <sys/socket.h>

#include "server/reaper.h"

struct srv_listener;
/* Takes over the descriptor of a connection that has a lease. */
typedef void srv_listener_fn(void *ctx, int fd, const struct sockaddr *peer, socklen_t size);

/* `fd`: listening, non-blocking, the caller's. */
enum eco_code srv_listener_start(struct srv_listener **listener, int fd, struct srv_reaper *reaper,
	srv_listener_fn *take, void *ctx, struct eco_error *error);
/* Nothing is taken in from then on. NULL is fine. */
void srv_listener_stop(struct srv_listener *listener);
/* How often accepting failed for want of descriptors or memory. */
uint64_t srv_listener_failures(const struct srv_listener *listener);

#endif
