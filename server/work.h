/* Threads that make plans, so that a long plan never holds up a connection that only wants a chunk. The queue
 * is bounded: a job that finds no place is refused at once (503).
 *
 * An address holds the jobs that wait or run for it. A job displaces the youngest waiting job of the address
 * that holds most, if the queue is full and that address still holds no less than the newcomer afterwards.
 * Three of four jobs that are begun are of the address that holds least. The fourth is the next in turn: each
 * further job of an address is a turn later than the one before it (start-time fair queueing, Goyal and
 * others 1996, jobs of equal cost), so no address starves. */
#pragma once

#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

#include "ecofiles/base/status.h"
#include "server/request/address.h"

struct srv_work;
struct srv_job {
	void (*run)(void *argument);
	void (*finish)(void *argument);  /* after it; may free what the job has, its flag too; or NULL */
	void (*displaced)(void *argument);       /* in place of both: an accepted job gave its place away; or NULL */
	void *argument;
	atomic_bool *cancelled;          /* set by srv_work_stop, or by any other thread */
	struct srv_address owner;
};

/* `threads` of them, and room for queue_max jobs that wait, share_max of them of one address. `spare`: one
 * thread more, which begins jobs of addresses that hold no other when all others are busy, so that these wait
 * for nobody's long job. On an error *work is NULL. */
enum eco_code srv_work_start(struct srv_work **work, uint32_t threads, bool spare, uint32_t queue_max,
	uint32_t share_max, struct eco_error *error);
/* Runs the job on some thread; false if the owner's share is full, no place is found or it is stopped. May
 * call another job's `displaced` first. Any other accepted job is run, also while stopping. Any thread. */
bool srv_work_submit(struct srv_work *work, const struct srv_job *job);
uint32_t srv_work_waiting(struct srv_work *work);
/* A job of an address that holds none would be accepted. */
bool srv_work_has_room(struct srv_work *work);
/* Cancels all jobs, runs what is queued, and joins; nothing is accepted from then on. */
void srv_work_stop(struct srv_work *work);
/* stops it where that has not been done; NULL is fine */
void srv_work_free(struct srv_work *work);
