/* Life: start -> submit* -> cancel? -> stop -> (submit refuses) -> free. The mutex guards the ring;
 * `cancelled` is atomic because jobs look at it often. */
#include "server/work.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

struct job { srv_work_fn fn; void *argument; };

struct srv_work {
	pthread_mutex_t mutex;
	pthread_cond_t wake;
	struct job *ring;
	uint32_t first, count, capacity;
	bool stopping;
	atomic_bool cancelled;
	uint32_t thread_count;
	pthread_t threads[];
};

static void *run(void *argument)
{
	struct srv_work *work = argument;
	pthread_mutex_lock(&work->mutex);
	for (;;) {
		while (!work->count && !work->stopping)
			pthread_cond_wait(&work->wake, &work->mutex);
		if (!work->count)
			break;
		struct job job = work->ring[work->first];
		work->first = (work->first + 1) % work->capacity;
		work->count--;
		pthread_mutex_unlock(&work->mutex);
		job.fn(job.argument);
		pthread_mutex_lock(&work->mutex);
	}
	pthread_mutex_unlock(&work->mutex);
	return NULL;
}

enum eco_code srv_work_start(struct srv_work **out, uint32_t threads, uint32_t queue_max,
	struct eco_error *error)
{
	struct srv_work *work = calloc(1, sizeof *work + threads * sizeof *work->threads);
	struct job *ring = calloc(queue_max, sizeof *ring);
	*out = NULL;
	if (!work || !ring) {
		free(work);
		free(ring);
		return eco_fail(error, ECO_NO_MEMORY, "no memory for a queue of %u plans", queue_max);
	}
	pthread_mutex_init(&work->mutex, NULL);
	pthread_cond_init(&work->wake, NULL);
	work->ring = ring;
	work->capacity = queue_max;
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

bool srv_work_submit(struct srv_work *work, srv_work_fn fn, void *job)
{
	pthread_mutex_lock(&work->mutex);
	bool room = work->count < work->capacity && !work->stopping;
	if (room) {
		work->ring[(work->first + work->count++) % work->capacity] = (struct job){ fn, job };
		pthread_cond_signal(&work->wake);
	}
	pthread_mutex_unlock(&work->mutex);
	return room;
}

const atomic_bool *srv_work_cancelled(const struct srv_work *work)
{
	return &work->cancelled;
}

void srv_work_stop(struct srv_work *work)
{
	atomic_store(&work->cancelled, true);
	pthread_mutex_lock(&work->mutex);
	work->stopping = true;
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
	free(work->ring);
	free(work);
}
