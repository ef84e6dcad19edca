#include "server/reaper.h"

#include <pthread.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>

#include "server/trace.h"

/* between two looks at all leases: a few microseconds of work for a thousand of them */
#define ROUND_MS 100u

struct srv_reaper {
	pthread_mutex_t mutex;       /* guards everything below */
	pthread_cond_t wake;
	struct srv_lease leases;     /* ring */
	bool stopping;
	pthread_t thread;
};

uint64_t srv_clock_us(void)
{
	struct timespec now;
	clock_gettime(CLOCK_MONOTONIC, &now);
	return (uint64_t)now.tv_sec * 1000000 + (uint64_t)now.tv_nsec / 1000;
}

static void shut_overdue(struct srv_reaper *reaper)
{
	uint64_t now = srv_clock_us();
	for (struct srv_lease *lease = reaper->leases.next; lease != &reaper->leases; lease = lease->next) {
		if (!lease->due_us || lease->due_us > now)
			continue;
		lease->due_us = 0;
		shutdown(lease->fd, SHUT_RDWR);
		srv_trace(SRV_TRACE_CONNECTION, "socket %d is past its deadline", lease->fd);
	}
}

static void *run(void *argument)
{
	struct srv_reaper *reaper = argument;
	pthread_mutex_lock(&reaper->mutex);
	while (!reaper->stopping) {
		uint64_t until = srv_clock_us() + ROUND_MS * 1000;
		struct timespec at = { .tv_sec = (time_t)(until / 1000000),
			.tv_nsec = (long)(until % 1000000 * 1000) };
		pthread_cond_timedwait(&reaper->wake, &reaper->mutex, &at);
		shut_overdue(reaper);
	}
	pthread_mutex_unlock(&reaper->mutex);
	return NULL;
}

enum eco_code srv_reaper_start(struct srv_reaper **out, struct eco_error *error)
{
	struct srv_reaper *reaper = calloc(1, sizeof *reaper);
	pthread_condattr_t attributes;
	*out = NULL;
	if (!reaper)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for connection deadlines");
	reaper->leases.before = reaper->leases.next = &reaper->leases;
	pthread_mutex_init(&reaper->mutex, NULL);
	pthread_condattr_init(&attributes);
	pthread_condattr_setclock(&attributes, CLOCK_MONOTONIC);
	pthread_cond_init(&reaper->wake, &attributes);
	pthread_condattr_destroy(&attributes);
	int failed = pthread_create(&reaper->thread, NULL, run, reaper);
	if (failed) {
		free(reaper);
		return eco_fail(error, ECO_IO, "cannot start a thread: %s", strerror(failed));
	}
	*out = reaper;
	return ECO_OK;
}

void srv_reaper_stop(struct srv_reaper *reaper)
{
	if (!reaper)
		return;
	pthread_mutex_lock(&reaper->mutex);
	reaper->stopping = true;
	pthread_cond_signal(&reaper->wake);
	pthread_mutex_unlock(&reaper->mutex);
	pthread_join(reaper->thread, NULL);
	pthread_cond_destroy(&reaper->wake);
	pthread_mutex_destroy(&reaper->mutex);
	free(reaper);
}

struct srv_lease *srv_reaper_open(struct srv_reaper *reaper, int fd, uint64_t after_ms)
{
	struct srv_lease *lease = malloc(sizeof *lease);
	if (!lease)
		return NULL;
	*lease = (struct srv_lease){ .fd = fd, .due_us = srv_clock_us() + after_ms * 1000 };
	if (!srv_gate_open(&lease->gate, fd)) {
		free(lease);
		return NULL;
	}
	pthread_mutex_lock(&reaper->mutex);
	lease->next = &reaper->leases;
	lease->before = reaper->leases.before;
	lease->before->next = lease->next->before = lease;
	pthread_mutex_unlock(&reaper->mutex);
	return lease;
}

static void set_due(struct srv_reaper *reaper, struct srv_lease *lease, uint64_t due_us)
{
	if (!lease)
		return;
	pthread_mutex_lock(&reaper->mutex);
	lease->due_us = due_us;
	pthread_mutex_unlock(&reaper->mutex);
}

void srv_reaper_arm(struct srv_reaper *reaper, struct srv_lease *lease, uint64_t after_ms)
{
	set_due(reaper, lease, srv_clock_us() + after_ms * 1000);
}

void srv_reaper_clear(struct srv_reaper *reaper, struct srv_lease *lease)
{
	set_due(reaper, lease, 0);
}

void srv_reaper_close(struct srv_reaper *reaper, struct srv_lease *lease)
{
	if (!lease)
		return;
	srv_gate_close(&lease->gate);
	pthread_mutex_lock(&reaper->mutex);
	lease->before->next = lease->next;
	lease->next->before = lease->before;
	pthread_mutex_unlock(&reaper->mutex);
	free(lease);
}
