/* A few threads that make plans, so that a long plan never holds up a connection that only wants a chunk.
 * Bounded: what does not fit into the queue is refused at once (503) instead of waiting for nobody knows how
 * long. */
#ifndef SRV_WORK_H
#define SRV_WORK_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

#include "ecofiles/base/status.h"

struct srv_work;
typedef void (*srv_work_fn)(void *job);

/* `threads` of them, and room for queue_max jobs that wait. On an error *work is NULL. */
enum eco_code srv_work_start(struct srv_work **work, uint32_t threads, uint32_t queue_max,
	struct eco_error *error);
/* Runs fn(job) on some thread; false if the queue is full or stopped. Every accepted job is run, also while
 * stopping. Any thread. */
bool srv_work_submit(struct srv_work *work, srv_work_fn fn, void *job);
/* True from srv_work_stop on: jobs look at it and end early. */
const atomic_bool *srv_work_cancelled(const struct srv_work *work);
/* Cancels, runs what is queued, and joins; nothing is accepted from then on. */
void srv_work_stop(struct srv_work *work);
/* stops it where that has not been done; NULL is fine */
void srv_work_free(struct srv_work *work);

#endif
