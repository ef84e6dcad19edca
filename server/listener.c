#include "server/listener.h"

#include <errno.h>
#include <poll.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include "server/trace.h"

#define REST_MS 100

struct srv_listener {
	int fd, stop_fd;
	struct srv_reaper *reaper;
	srv_listener_fn *take;
	void *ctx;
	_Atomic(uint64_t) failures;
	pthread_t thread;
};

static void refuse(int fd, const char *why)
{
	srv_trace(SRV_TRACE_CONNECTION, "socket %d is refused: %s", fd, why);
	srv_gate_answer(fd, SRV_PROBLEM_BUSY, why, false);
	shutdown(fd, SHUT_WR);
	close(fd);
}

/* False if there is none, or none can be had. */
static bool accept_one(struct srv_listener *listener)
{
	struct sockaddr_storage peer = { 0 };
	socklen_t size = sizeof peer;
	const char *why;
	int fd = accept4(listener->fd, (struct sockaddr *)&peer, &size, SOCK_CLOEXEC | SOCK_NONBLOCK);
	if (fd < 0)
		return errno == ECONNABORTED || errno == EINTR;
	struct srv_address address = srv_address_of((struct sockaddr *)&peer);
	if (srv_reaper_open(listener->reaper, fd, &address, &why))
		listener->take(listener->ctx, fd, (struct sockaddr *)&peer, size);
	else
		refuse(fd, why);
	return true;
}

static void *run(void *argument)
{
	struct srv_listener *listener = argument;
	struct pollfd waits[] = { { .fd = listener->stop_fd, .events = POLLIN },
		{ .fd = listener->fd, .events = POLLIN } };
	for (;;) {
		poll(waits, 2, -1);
		if (waits[0].revents)
			return NULL;
		errno = 0;
		if (accept_one(listener) || errno == EAGAIN || errno == EWOULDBLOCK)
			continue;
		atomic_fetch_add(&listener->failures, 1);
		srv_trace(SRV_TRACE_CONNECTION, "cannot accept: %s", strerror(errno));
		srv_reaper_make_room(listener->reaper);
		poll(waits, 1, REST_MS);
	}
}

enum eco_code srv_listener_start(struct srv_listener **out, int fd, struct srv_reaper *reaper,
	srv_listener_fn *take, void *ctx, struct eco_error *error)
{
	struct srv_listener *listener = calloc(1, sizeof *listener);
	*out = NULL;
	if (!listener)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for a listener");
	*listener = (struct srv_listener){ .fd = fd, .stop_fd = eventfd(0, EFD_CLOEXEC), .reaper = reaper,
		.take = take, .ctx = ctx };
	int failed = listener->stop_fd < 0 ? errno : pthread_create(&listener->thread, NULL, run, listener);
	if (failed) {
		if (listener->stop_fd >= 0)
			close(listener->stop_fd);
		free(listener);
		return eco_fail(error, ECO_IO, "cannot start a thread that listens: %s", strerror(failed));
	}
	*out = listener;
	return ECO_OK;
}

void srv_listener_stop(struct srv_listener *listener)
{
	if (!listener)
		return;
	eventfd_write(listener->stop_fd, 1);
	pthread_join(listener->thread, NULL);
	close(listener->stop_fd);
	free(listener);
}

uint64_t srv_listener_failures(const struct srv_listener *listener)
{
	return atomic_load(&listener->failures);
}
