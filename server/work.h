/* A few threads that make plans, so that a long plan never holds up a connection that only wants a chunk.
 * Bounded: what does not fit into the queue is refused at once (503) instead of waiting for nobody knows how
 * long.
 *
 * Addresses are served in turn (start-time fair queueing, Goyal and others 1996, jobs of equal cost): each
 * job of an address that others wait behind is a turn later than the one before it, and no address may have
 * more than its share of the queue. */
#ifndef SRV_WORK_H
#define SRV_WORK_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

#include "ecofiles/base/status.h"
#include "server/request/address.h"

struct srv_work;
struct srv_job {
	void (*run)(void *argument);
	void (*finish)(void *argument);  /* after it; may free what the job has, its flag too */
	void *argument;
	atomic_bool *cancelled;          /* set by srv_work_stop, and by whoever else has reason to */
	struct srv_address owner;
};

/* `threads` of them, and room for queue_max jobs that wait, share_max of them of one address. On an error
 * *work is NULL. */
enum eco_code srv_work_start(struct srv_work **work, uint32_t threads, uint32_t queue_max, uint32_t share_max,
	struct eco_error *error);
/* Runs the job on some thread; false if the queue or the owner's share is full, or it is stopped. Every
 * accepted job is run, also while stopping. Any thread. */
bool srv_work_submit(struct srv_work *work, const struct srv_job *job);
uint32_t srv_work_waiting(struct srv_work *work);
/* Cancels all jobs, runs what is queued, and joins; nothing is accepted from then on. */
void srv_work_stop(struct srv_work *work);
/* stops it where that has not been done; NULL is fine */
void srv_work_free(struct srv_work *work);

#endif
