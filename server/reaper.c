#include "server/reaper.h"

#include <errno.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <linux/tcp.h>
#include <pthread.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#include "server/trace.h"

/* between two looks at all leases: a few microseconds of work for a thousand of them */
#define ROUND_MS 100u
#define PROBE_MS 1000u                   /* between two interim responses */
/* TCP_ESTABLISHED and TCP_CLOSE_WAIT of netinet/tcp.h, which has no tcpi_bytes_acked */
#define ESTABLISHED 1
#define CLOSE_WAIT 8
#define NOT_TAKEN UINT64_MAX             /* not known yet */
#define LINGER_MS 30000u                 /* what a refused client still sends is dropped so long, ... */
#define LINGER_QUIET_MS 5000u            /* ... until it has sent nothing so long, ... */
#define LINGER_BYTES_MAX (16u << 20)     /* ... up to so much, ... */
#define LINGER_ROUND_BYTES (1u << 20)    /* ... and so much a round, ... */
#define LINGER_ROUND_MS 10u              /* ... which are more often then: the window stays small */

struct srv_reaper {
	pthread_mutex_t mutex;       /* guards everything below */
	pthread_cond_t wake;
	struct srv_lease leases;     /* ring */
	struct srv_reaper_limits limits;
	bool stopping;
	pthread_t thread;
};

uint64_t srv_clock_us(void)
{
	struct timespec now;
	clock_gettime(CLOCK_MONOTONIC, &now);
	return (uint64_t)now.tv_sec * 1000000 + (uint64_t)now.tv_nsec / 1000;
}

static void shut(struct srv_lease *lease, const char *why)
{
	lease->due_us = 0;
	lease->is_shut = true;
	shutdown(lease->fd, SHUT_RDWR);
	srv_trace(SRV_TRACE_CONNECTION, "socket %d %s", lease->fd, why);
}

static struct tcp_info about(const struct srv_lease *lease)
{
	struct tcp_info info = { 0 };
	socklen_t size = sizeof info;
	getsockopt(lease->fd, IPPROTO_TCP, TCP_INFO, &info, &size);
	return info;
}

/* A new window for a client that took enough in the last one. */
static bool renew(struct srv_reaper *reaper, struct srv_lease *lease, uint64_t now)
{
	const struct srv_reaper_limits *limits = &reaper->limits;
	uint64_t bytes = about(lease).tcpi_bytes_acked, least = limits->rate_bytes_s * limits->send_ms / 1000;
	bool first = lease->taken_bytes == NOT_TAKEN;
	if (!lease->is_sending || (!first && bytes - lease->taken_bytes < (least ? least : 1)))
		return false;
	lease->taken_bytes = bytes;
	lease->due_us = now + limits->send_ms * 1000;
	return true;
}

/* To a client that has ended its sending, and may still read. An interim response (RFC 9110, 15.2) makes the
 * system of one that has closed its socket reset the connection, which this look or a later one finds.
 * HTTP/1.0 knows none: there the client is believed to read. False where the connection is of no more use. */
static bool probe(struct srv_lease *lease, uint64_t now)
{
	static const char interim[] = "HTTP/1.1 102 Processing\r\n\r\n";
	if (lease->gate.framing.is_http_1_0 || now < lease->probe_us)
		return true;
	lease->probe_us = now + PROBE_MS * 1000;
	ssize_t sent = send(lease->fd, interim, sizeof interim - 1, MSG_NOSIGNAL | MSG_DONTWAIT);
	return sent < 0 ? errno == EAGAIN
		: sent == sizeof interim - 1 && about(lease).tcpi_state == CLOSE_WAIT;
}

static void tell_gone(struct srv_lease *lease, uint64_t now)
{
	if (!lease->gone)
		return;
	uint8_t state = about(lease).tcpi_state;
	if (state == ESTABLISHED || (state == CLOSE_WAIT && probe(lease, now)))
		return;
	atomic_store(lease->gone, true);
	lease->gone = NULL;
	srv_trace(SRV_TRACE_CONNECTION, "socket %d hung up while its plan is made", lease->fd);
	if (state == CLOSE_WAIT)         /* a part of the interim response may be out */
		shut(lease, "is of no more use");
}

/* Drops what has come to a refused connection. False where it has ended. */
static bool drop_rest(struct srv_lease *lease, uint64_t now)
{
	ssize_t size = recv(lease->fd, NULL, LINGER_ROUND_BYTES, MSG_DONTWAIT | MSG_TRUNC);
	if (size > 0) {
		lease->dropped_bytes += (uint64_t)size;
		lease->quiet_us = now + LINGER_QUIET_MS * 1000;
	}
	return (size > 0 || (size < 0 && errno == EAGAIN)) && lease->dropped_bytes < LINGER_BYTES_MAX
		&& now < lease->due_us && now < lease->quiet_us;
}

static void unlink_lease(struct srv_lease *lease)
{
	lease->before->next = lease->next;
	lease->next->before = lease->before;
}

static void end_lingering(struct srv_lease *lease)
{
	close(lease->fd);
	unlink_lease(lease);
	free(lease);
}

/* Returns when to look again, in milliseconds. */
static uint64_t shut_overdue(struct srv_reaper *reaper)
{
	uint64_t now = srv_clock_us(), again = ROUND_MS;
	for (struct srv_lease *lease = reaper->leases.next, *next; lease != &reaper->leases; lease = next) {
		next = lease->next;
		if (lease->lingers) {
			again = LINGER_ROUND_MS;
			if (!drop_rest(lease, now))
				end_lingering(lease);
			continue;
		}
		tell_gone(lease, now);
		if (lease->due_us && lease->due_us <= now && !renew(reaper, lease, now))
			shut(lease, "is past its deadline");
	}
	return again;
}

static void *run(void *argument)
{
	struct srv_reaper *reaper = argument;
	uint64_t again = ROUND_MS;
	pthread_mutex_lock(&reaper->mutex);
	while (!reaper->stopping) {
		uint64_t until = srv_clock_us() + again * 1000;
		struct timespec at = { .tv_sec = (time_t)(until / 1000000),
			.tv_nsec = (long)(until % 1000000 * 1000) };
		pthread_cond_timedwait(&reaper->wake, &reaper->mutex, &at);
		again = shut_overdue(reaper);
	}
	pthread_mutex_unlock(&reaper->mutex);
	return NULL;
}

enum eco_code srv_reaper_start(struct srv_reaper **out, const struct srv_reaper_limits *limits,
	struct eco_error *error)
{
	struct srv_reaper *reaper = calloc(1, sizeof *reaper);
	pthread_condattr_t attributes;
	*out = NULL;
	if (!reaper)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for connection deadlines");
	reaper->leases.before = reaper->leases.next = &reaper->leases;
	reaper->limits = *limits;
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
	for (struct srv_lease *lease; (lease = reaper->leases.next) != &reaper->leases;) {
		if (!lease->lingers)
			srv_gate_close(&lease->gate);
		if (lease->lingers)
			close(lease->fd);
		unlink_lease(lease);
		free(lease);
	}
	pthread_cond_destroy(&reaper->wake);
	pthread_mutex_destroy(&reaper->mutex);
	free(reaper);
}

/* ---- Who may come in; under the mutex ---- */

struct census {                      /* of connections that are not shut */
	uint64_t all, same;          /* same: of the address */
	struct srv_lease *idle, *same_idle;      /* that have waited the longest, or NULL */
};

static struct srv_lease *longer_idle(struct srv_lease *a, struct srv_lease *b)
{
	return b->idle_us && (!a || b->idle_us < a->idle_us) ? b : a;
}

static struct census count(struct srv_reaper *reaper, const struct srv_address *address)
{
	struct census census = { 0 };
	for (struct srv_lease *lease = reaper->leases.next; lease != &reaper->leases; lease = lease->next) {
		if (lease->is_shut)
			continue;
		census.all++;
		census.idle = longer_idle(census.idle, lease);
		if (!address || !srv_address_same(&lease->address, address))
			continue;
		census.same++;
		census.same_idle = longer_idle(census.same_idle, lease);
	}
	return census;
}

/* NULL, or why not. */
static const char *make_way(struct srv_reaper *reaper, const struct srv_address *address, bool is_proxy)
{
	struct census census = count(reaper, address);
	bool same_full = !is_proxy && census.same >= reaper->limits.per_address;
	if (!same_full && census.all < reaper->limits.connections)
		return NULL;
	struct srv_lease *way = same_full ? census.same_idle : census.idle;
	if (way)
		shut(way, "gives way to a new one");
	return way ? NULL : same_full ? "there are too many connections from this address; close some, or "
		"use them for more than one request" : "there are too many connections; ask again in a "
		"second";
}

static struct srv_lease *find(struct srv_reaper *reaper, int fd)
{
	for (struct srv_lease *lease = reaper->leases.next; lease != &reaper->leases; lease = lease->next)
		if (lease->fd == fd)
			return lease;
	return NULL;
}

/* The library may close a connection without a word, when memory runs out: the number then comes again. */
static void forget_stale(struct srv_reaper *reaper, int fd)
{
	struct srv_lease *stale = find(reaper, fd);
	if (!stale)
		return;
	unlink_lease(stale);
	free(stale);
}

static const char *enter(struct srv_reaper *reaper, struct srv_lease *lease)
{
	forget_stale(reaper, lease->fd);
	const char *why = make_way(reaper, &lease->address, lease->is_proxy);
	if (why)
		return why;
	if (!srv_gate_open(&lease->gate, lease->fd))
		return "there are too many descriptors; ask again in a second";
	lease->next = &reaper->leases;
	lease->before = reaper->leases.before;
	lease->before->next = lease->next->before = lease;
	return NULL;
}

struct srv_lease *srv_reaper_open(struct srv_reaper *reaper, int fd, const struct srv_address *address,
	const char **why)
{
	struct srv_lease *lease = malloc(sizeof *lease);
	uint64_t now = srv_clock_us();
	*why = "there is no memory; ask again in a second";
	if (!lease)
		return NULL;
	*lease = (struct srv_lease){ .fd = fd, .address = *address, .idle_us = now,
		.due_us = now + reaper->limits.head_ms * 1000,
		.is_proxy = srv_networks_contain(reaper->limits.trusted, address) };
	pthread_mutex_lock(&reaper->mutex);
	*why = enter(reaper, lease);
	pthread_mutex_unlock(&reaper->mutex);
	if (!*why)
		return lease;
	free(lease);
	return NULL;
}

struct srv_lease *srv_reaper_find(struct srv_reaper *reaper, int fd)
{
	pthread_mutex_lock(&reaper->mutex);
	struct srv_lease *lease = find(reaper, fd);
	pthread_mutex_unlock(&reaper->mutex);
	return lease;
}

void srv_reaper_make_room(struct srv_reaper *reaper)
{
	pthread_mutex_lock(&reaper->mutex);
	struct census census = count(reaper, NULL);
	if (census.idle)
		shut(census.idle, "gives its descriptor back");
	pthread_mutex_unlock(&reaper->mutex);
}

uint64_t srv_reaper_connections(struct srv_reaper *reaper)
{
	pthread_mutex_lock(&reaper->mutex);
	uint64_t all = count(reaper, NULL).all;
	pthread_mutex_unlock(&reaper->mutex);
	return all;
}

/* ---- Deadlines ---- */

static void set_due(struct srv_reaper *reaper, struct srv_lease *lease, uint64_t due_us, uint64_t idle_us)
{
	if (!lease)
		return;
	pthread_mutex_lock(&reaper->mutex);
	lease->due_us = lease->is_shut ? 0 : due_us;
	lease->idle_us = idle_us;
	lease->is_sending = false;
	pthread_mutex_unlock(&reaper->mutex);
}

void srv_reaper_arm(struct srv_reaper *reaper, struct srv_lease *lease, uint64_t after_ms)
{
	set_due(reaper, lease, srv_clock_us() + after_ms * 1000, 0);
}

void srv_reaper_send(struct srv_reaper *reaper, struct srv_lease *lease)
{
	pthread_mutex_lock(&reaper->mutex);
	lease->due_us = lease->is_shut ? 0 : srv_clock_us() + reaper->limits.send_ms * 1000;
	lease->idle_us = 0;
	lease->is_sending = true;
	lease->taken_bytes = NOT_TAKEN;
	pthread_mutex_unlock(&reaper->mutex);
}

void srv_reaper_clear(struct srv_reaper *reaper, struct srv_lease *lease)
{
	set_due(reaper, lease, 0, 0);
}

void srv_reaper_await(struct srv_reaper *reaper, struct srv_lease *lease)
{
	uint64_t now = srv_clock_us();
	set_due(reaper, lease, now + reaper->limits.head_ms * 1000, now);
}

void srv_reaper_watch(struct srv_reaper *reaper, struct srv_lease *lease, atomic_bool *gone)
{
	pthread_mutex_lock(&reaper->mutex);
	lease->gone = gone;
	lease->probe_us = 0;
	pthread_mutex_unlock(&reaper->mutex);
}

/* Goes on with a descriptor of its own, as the library closes the connection's. */
static bool linger(struct srv_lease *lease)
{
	bool refused = lease->is_refused || lease->gate.framing.problem;
	int fd = refused && !lease->is_shut ? fcntl(lease->fd, F_DUPFD_CLOEXEC, 0) : -1;
	if (fd < 0)
		return false;
	shutdown(fd, SHUT_WR);
	lease->lingers = true;
	lease->fd = fd;
	lease->idle_us = srv_clock_us();
	lease->due_us = lease->idle_us + LINGER_MS * 1000;
	lease->quiet_us = lease->idle_us + LINGER_QUIET_MS * 1000;
	return true;
}

void srv_reaper_close(struct srv_reaper *reaper, struct srv_lease *lease)
{
	if (!lease)
		return;
	srv_gate_close(&lease->gate);
	pthread_mutex_lock(&reaper->mutex);
	bool lingers = linger(lease);
	if (!lingers)
		unlink_lease(lease);
	pthread_mutex_unlock(&reaper->mutex);
	if (!lingers)
		free(lease);
}
