/* Life: start -> submit* -> stop -> (submit refuses) -> free. The mutex guards everything. */
#include "server/work.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

struct waiting { struct srv_job job; uint64_t turn; };

struct srv_work {
	pthread_mutex_t mutex;
	pthread_cond_t wake;
	struct waiting *queue;           /* by arrival */
	uint32_t count, capacity, share_max;
	uint64_t turn;                   /* of the job that was begun last */
	bool stopping;
	uint32_t thread_count, running_count;
	atomic_bool **running;           /* the flags of the jobs that run; one a thread, or NULL */
	pthread_t threads[];
};

static struct srv_job take_next(struct srv_work *work)
{
	uint32_t first = 0;
	for (uint32_t i = 1; i < work->count; i++)
		if (work->queue[i].turn < work->queue[first].turn)
			first = i;
	struct waiting next = work->queue[first];
	work->count--;
	memmove(&work->queue[first], &work->queue[first + 1], (work->count - first) * sizeof *work->queue);
	work->turn = next.turn;
	return next.job;
}

static void *run(void *argument)
{
	struct srv_work *work = argument;
	pthread_mutex_lock(&work->mutex);
	atomic_bool **mine = &work->running[work->running_count++];
	for (;;) {
		while (!work->count && !work->stopping)
			pthread_cond_wait(&work->wake, &work->mutex);
		if (!work->count)
			break;
		struct srv_job job = take_next(work);
		*mine = job.cancelled;
		pthread_mutex_unlock(&work->mutex);
		job.run(job.argument);
		pthread_mutex_lock(&work->mutex);
		*mine = NULL;
		pthread_mutex_unlock(&work->mutex);
		job.finish(job.argument);
		pthread_mutex_lock(&work->mutex);
	}
	pthread_mutex_unlock(&work->mutex);
	return NULL;
}

enum eco_code srv_work_start(struct srv_work **out, uint32_t threads, uint32_t queue_max, uint32_t share_max,
	struct eco_error *error)
{
	struct srv_work *work = calloc(1, sizeof *work + threads * sizeof *work->threads);
	struct waiting *queue = calloc(queue_max, sizeof *queue);
	atomic_bool **running = calloc(threads, sizeof *running);
	*out = NULL;
	if (!work || !queue || !running) {
		free(work);
		free(queue);
		free(running);
		return eco_fail(error, ECO_NO_MEMORY, "no memory for a queue of %u plans", queue_max);
	}
	pthread_mutex_init(&work->mutex, NULL);
	pthread_cond_init(&work->wake, NULL);
	work->queue = queue;
	work->running = running;
	work->capacity = queue_max;
	work->share_max = share_max;
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

bool srv_work_submit(struct srv_work *work, const struct srv_job *job)
{
	pthread_mutex_lock(&work->mutex);
	uint64_t turn = work->turn;
	uint32_t share = 0;
	for (uint32_t i = 0; i < work->count; i++)
		if (srv_address_same(&work->queue[i].job.owner, &job->owner)) {
			share++;
			turn = work->queue[i].turn + 1;
		}
	bool room = work->count < work->capacity && share < work->share_max && !work->stopping;
	if (room) {
		work->queue[work->count++] = (struct waiting){ *job, turn };
		pthread_cond_signal(&work->wake);
	}
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
	free(work->running);
	free(work->queue);
	free(work);
}
