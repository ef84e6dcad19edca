/* Life: start -> submit* -> stop -> (submit refuses) -> free. The mutex guards everything. */
#include "server/work.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/array_grow.h"

#define NONE UINT32_MAX
#define IN_TURN 4u               /* of so many jobs one is the next in turn */

struct owner { struct srv_address address; uint32_t waiting, held; uint64_t turn; };     /* turn: of its next */
struct waiting { struct srv_job job; struct owner *owner; uint64_t turn; };

struct srv_work {
	pthread_mutex_t mutex;
	pthread_cond_t wake;
	struct waiting *queue;           /* by arrival */
	uint32_t count, capacity, share_max;
	struct owner *owners;            /* one that holds nothing is free */
	uint32_t owner_count;
	uint64_t turn;                   /* of the latest turn that was begun */
	uint64_t begun;                  /* jobs */
	bool stopping, spare;            /* spare: the thread that comes first is */
	uint32_t thread_count, running_count, idle_count;        /* idle: without the spare one */
	atomic_bool **running;           /* the flags of the jobs that run; one a thread, or NULL */
	pthread_t threads[];
};

static bool goes_first(const struct srv_work *work, const struct waiting *a, const struct waiting *b)
{
	if (work->begun % IN_TURN && a->owner->held != b->owner->held)
		return a->owner->held < b->owner->held;
	return a->turn < b->turn;
}

static struct waiting take_out(struct srv_work *work, uint32_t index)
{
	struct waiting waiting = work->queue[index];
	work->count--;
	memmove(&work->queue[index], &work->queue[index + 1], (work->count - index) * sizeof *work->queue);
	waiting.owner->waiting--;
	return waiting;
}

/* False if there is none for this thread. The spare one takes none that another thread is free for. */
static bool take_next(struct srv_work *work, bool spare, struct waiting *taken)
{
	uint32_t first = NONE;
	for (uint32_t i = 0; i < work->count && !(spare && work->idle_count && !work->stopping); i++)
		if ((!spare || work->stopping || work->queue[i].owner->held == 1)
				&& (first == NONE || goes_first(work, &work->queue[i], &work->queue[first])))
			first = i;
	if (first == NONE)
		return false;
	struct waiting next = take_out(work, first);
	work->begun++;
	work->turn = next.turn > work->turn ? next.turn : work->turn;
	*taken = next;
	return true;
}

static void *run(void *argument)
{
	struct srv_work *work = argument;
	pthread_mutex_lock(&work->mutex);
	bool spare = work->spare && !work->running_count;
	atomic_bool **mine = &work->running[work->running_count++];
	for (;;) {
		struct waiting next;
		bool taken;
		while (!(taken = take_next(work, spare, &next)) && !work->stopping) {
			work->idle_count += !spare;
			pthread_cond_wait(&work->wake, &work->mutex);
			work->idle_count -= !spare;
		}
		if (taken && work->count)
			pthread_cond_broadcast(&work->wake);
		if (!taken)
			break;
		*mine = next.job.cancelled;
		pthread_mutex_unlock(&work->mutex);
		next.job.run(next.job.argument);
		pthread_mutex_lock(&work->mutex);
		*mine = NULL;
		if (--next.owner->held == 1)     /* the spare thread may take the other */
			pthread_cond_broadcast(&work->wake);
		pthread_mutex_unlock(&work->mutex);
		if (next.job.finish)
			next.job.finish(next.job.argument);
		pthread_mutex_lock(&work->mutex);
	}
	pthread_mutex_unlock(&work->mutex);
	return NULL;
}

enum eco_code srv_work_start(struct srv_work **out, uint32_t threads, bool spare, uint32_t queue_max,
	uint32_t share_max, struct eco_error *error)
{
	threads += spare;
	struct srv_work *work = calloc(1, sizeof *work + threads * sizeof *work->threads);
	struct waiting *queue = calloc(queue_max, sizeof *queue);
	struct owner *owners = calloc((size_t)queue_max + threads + 1, sizeof *owners);
	atomic_bool **running = calloc(threads, sizeof *running);
	*out = NULL;
	if (!work || !queue || !owners || !running) {
		eco_free(work, queue, owners, running);
		return eco_fail(error, ECO_NO_MEMORY, "no memory for a queue of %u plans", queue_max);
	}
	pthread_mutex_init(&work->mutex, NULL);
	pthread_cond_init(&work->wake, NULL);
	work->queue = queue;
	work->owners = owners;
	work->owner_count = queue_max + threads + 1;
	work->running = running;
	work->capacity = queue_max;
	work->share_max = share_max;
	work->spare = spare;
	for (; work->thread_count < threads; work->thread_count++) {
		int failed = pthread_create(&work->threads[work->thread_count], NULL, run, work);
		if (failed) {
			srv_work_free(work);
			return eco_fail(error, ECO_IO, "cannot start a thread: %s", strerror(failed));
		}
	}
	*out = work;
	return ECO_OK;
}

/* The address's owner, or a free one: there is one more than all jobs that can be held. */
static struct owner *owner_of(struct srv_work *work, const struct srv_address *address)
{
	struct owner *free_one = NULL;
	for (uint32_t i = 0; i < work->owner_count; i++) {
		struct owner *owner = &work->owners[i];
		if (owner->held && srv_address_same(&owner->address, address))
			return owner;
		if (!owner->held && !free_one)
			free_one = owner;
	}
	*free_one = (struct owner){ .address = *address };
	return free_one;
}

/* The youngest waiting job of the address that holds most. */
static const struct waiting *to_displace(const struct srv_work *work)
{
	const struct waiting *most = &work->queue[work->count - 1];
	for (uint32_t i = work->count - 1; i-- > 0;)
		if (work->queue[i].owner->held > most->owner->held)
			most = &work->queue[i];
	return most;
}

/* An address that holds `held` jobs may displace one, and is left with no more than the other then. */
static bool may_displace(const struct srv_work *work, uint32_t held)
{
	return to_displace(work)->owner->held > held + 1;
}

static void enqueue(struct srv_work *work, const struct srv_job *job, struct owner *owner)
{
	uint64_t turn = owner->held && owner->turn > work->turn ? owner->turn : work->turn;
	owner->turn = turn + 1;
	owner->waiting++;
	owner->held++;
	work->queue[work->count++] = (struct waiting){ *job, owner, turn };
	pthread_cond_broadcast(&work->wake);
}

bool srv_work_submit(struct srv_work *work, const struct srv_job *job)
{
	struct srv_job displaced = { 0 };
	pthread_mutex_lock(&work->mutex);
	struct owner *owner = owner_of(work, &job->owner);
	bool room = !work->stopping && owner->waiting < work->share_max;
	if (room && work->count == work->capacity) {
		room = may_displace(work, owner->held);
		if (room) {
			struct waiting out = take_out(work, (uint32_t)(to_displace(work) - work->queue));
			out.owner->held--;
			out.owner->turn--;
			displaced = out.job;
		}
	}
	if (room)
		enqueue(work, job, owner);
	pthread_mutex_unlock(&work->mutex);
	if (displaced.displaced)
		displaced.displaced(displaced.argument);
	return room;
}

bool srv_work_has_room(struct srv_work *work)
{
	pthread_mutex_lock(&work->mutex);
	bool room = !work->stopping && (work->count < work->capacity || may_displace(work, 0));
	pthread_mutex_unlock(&work->mutex);
	return room;
}

uint32_t srv_work_waiting(struct srv_work *work)
{
	pthread_mutex_lock(&work->mutex);
	uint32_t count = work->count;
	pthread_mutex_unlock(&work->mutex);
	return count;
}

static void cancel_all(struct srv_work *work)
{
	for (uint32_t i = 0; i < work->count; i++)
		atomic_store(work->queue[i].job.cancelled, true);
	for (uint32_t i = 0; i < work->running_count; i++)
		if (work->running[i])
			atomic_store(work->running[i], true);
}

void srv_work_stop(struct srv_work *work)
{
	pthread_mutex_lock(&work->mutex);
	work->stopping = true;
	cancel_all(work);
	pthread_cond_broadcast(&work->wake);
	pthread_mutex_unlock(&work->mutex);
	for (uint32_t i = 0; i < work->thread_count; i++)
		pthread_join(work->threads[i], NULL);
	work->thread_count = 0;
}

void srv_work_free(struct srv_work *work)
{
	if (!work)
		return;
	srv_work_stop(work);
	pthread_cond_destroy(&work->wake);
	pthread_mutex_destroy(&work->mutex);
	eco_free(work->running, work->owners, work->queue, work);
}
