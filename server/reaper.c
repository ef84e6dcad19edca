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

#include "server/daemon.h"
#include "server/log.h"

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

#define RESERVED 16u                     /* connections beyond the limit, for addresses that hold none */
#define IDLE_US 1000000u                 /* so long a connection waits for a request before it is given up for any */

struct srv_holder {                      /* an address, and what it holds */
	struct srv_holder *next;
	struct srv_address address;
	bool is_proxy;
	uint32_t users;                  /* leases that name it, as the peer or the client */
	uint64_t held[SRV_HELD_COUNT];
};

struct srv_reaper {
	pthread_mutex_t mutex;       /* guards everything below */
	pthread_cond_t wake;
	struct srv_lease leases;     /* ring */
	struct srv_holder *holders;
	uint64_t held[SRV_HELD_COUNT];
	uint64_t most[SRV_HELD_COUNT];
	const struct srv_config *config;
	bool stopping;
	pthread_t thread;
};

uint64_t srv_clock_us(void)
{
	struct timespec now;
	clock_gettime(CLOCK_MONOTONIC, &now);
	return (uint64_t)now.tv_sec * 1000000 + (uint64_t)now.tv_nsec / 1000;
}

/* ---- Holders; under the mutex ---- */

static struct srv_holder *holder_of(struct srv_reaper *reaper, const struct srv_address *address)
{
	struct srv_holder *holder = reaper->holders;
	while (holder && !srv_address_same(&holder->address, address))
		holder = holder->next;
	return holder;
}

/* NULL: no memory */
static struct srv_holder *use_holder(struct srv_reaper *reaper, const struct srv_address *address)
{
	struct srv_holder *holder = holder_of(reaper, address);
	if (!holder) {
		holder = calloc(1, sizeof *holder);
		if (!holder)
			return NULL;
		holder->address = *address;
		holder->is_proxy = srv_networks_contain(&reaper->config->trusted, address);
		holder->next = reaper->holders;
		reaper->holders = holder;
	}
	holder->users++;
	return holder;
}

static void leave_holder(struct srv_reaper *reaper, struct srv_holder *holder)
{
	struct srv_holder **at = &reaper->holders;
	if (--holder->users)
		return;
	while (*at != holder)
		at = &(*at)->next;
	*at = holder->next;
	free(holder);
}

static struct srv_holder *payer_of(const struct srv_lease *lease, enum srv_held what)
{
	return what == SRV_HELD_CONNECTIONS ? lease->holder : lease->payer;
}

static void set_held(struct srv_reaper *reaper, struct srv_lease *lease, enum srv_held what, uint64_t amount)
{
	struct srv_holder *holder = payer_of(lease, what);
	holder->held[what] += amount - lease->held[what];
	reaper->held[what] += amount - lease->held[what];
	lease->held[what] = amount;
}

static void give_back(struct srv_reaper *reaper, struct srv_lease *lease)
{
	for (enum srv_held what = 0; what < SRV_HELD_COUNT; what++)
		set_held(reaper, lease, what, 0);
}

static void shut(struct srv_reaper *reaper, struct srv_lease *lease, const char *why)
{
	lease->due_us = 0;
	lease->is_shut = true;
	give_back(reaper, lease);
	if (lease->gone)
		atomic_store(lease->gone, true);
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
	const struct srv_config *limits = reaper->config;
	uint64_t bytes = about(lease).tcpi_bytes_acked, least = limits->rate_bytes_s * limits->send_ms / 1000;
	bool first = lease->taken_bytes == NOT_TAKEN;
	if (lease->wait != SRV_WAIT_SENDING || (!first && bytes - lease->taken_bytes < (least ? least : 1)))
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

static void tell_gone(struct srv_reaper *reaper, struct srv_lease *lease, uint64_t now)
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
		shut(reaper, lease, "is of no more use");
}

/* Drops what has come to a refused connection. False where it has ended. */
static bool drop_rest(struct srv_lease *lease, uint64_t now)
{
	ssize_t size = recv(lease->fd, NULL, LINGER_ROUND_BYTES, MSG_DONTWAIT | MSG_TRUNC);
	if (size > 0) {
		lease->dropped_bytes += (uint64_t)size;
		lease->due_us = now + LINGER_QUIET_MS * 1000;
	}
	return (size > 0 || (size < 0 && errno == EAGAIN)) && lease->dropped_bytes < LINGER_BYTES_MAX
		&& now < lease->due_us && now < lease->since_us + LINGER_MS * 1000;
}

static void unlink_lease(struct srv_reaper *reaper, struct srv_lease *lease)
{
	give_back(reaper, lease);
	leave_holder(reaper, lease->payer);
	leave_holder(reaper, lease->holder);
	lease->before->next = lease->next;
	lease->next->before = lease->before;
}

/* Returns when to look again, in milliseconds. */
static uint64_t shut_overdue(struct srv_reaper *reaper)
{
	uint64_t now = srv_clock_us(), again = ROUND_MS;
	for (struct srv_lease *lease = reaper->leases.next, *next; lease != &reaper->leases; lease = next) {
		next = lease->next;
		if (lease->lingers) {
			again = LINGER_ROUND_MS;
			if (!drop_rest(lease, now)) {
				close(lease->fd);
				unlink_lease(reaper, lease);
				free(lease);
			}
			continue;
		}
		tell_gone(reaper, lease, now);
		if (lease->due_us && lease->due_us <= now && !renew(reaper, lease, now))
			shut(reaper, lease, "is past its deadline");
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

enum eco_code srv_reaper_start(struct srv_reaper **out, const struct srv_config *config,
	struct eco_error *error)
{
	struct srv_reaper *reaper = calloc(1, sizeof *reaper);
	pthread_condattr_t attributes;
	*out = NULL;
	if (!reaper)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for connection deadlines");
	reaper->leases.before = reaper->leases.next = &reaper->leases;
	reaper->config = config;
	reaper->most[SRV_HELD_CONNECTIONS] = config->connections_max;
	reaper->most[SRV_HELD_BODIES] = config->bodies_max;
	reaper->most[SRV_HELD_ANSWERS] = config->answers_max;
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
		if (lease->lingers)
			close(lease->fd);
		else
			srv_gate_close(&lease->gate);
		unlink_lease(reaper, lease);
		free(lease);
	}
	pthread_cond_destroy(&reaper->wake);
	pthread_mutex_destroy(&reaper->mutex);
	free(reaper);
}

/* ---- Giving way; under the mutex ---- */

/* `other` may be NULL */
static bool goes_before(const struct srv_lease *lease, const struct srv_lease *other)
{
	return !other || (lease->wait != other->wait ? lease->wait < other->wait
		: lease->since_us < other->since_us);
}

/* The connection that goes first: one that holds some of this, of a holder (NULL: of any), at most in phase
 * `last` of those in which they give way, and there since before `since_us`. */
static struct srv_lease *first_to_go(struct srv_reaper *reaper, enum srv_held what, const struct srv_holder *holder,
	enum srv_wait last, uint64_t since_us)
{
	struct srv_lease *first = NULL;
	for (struct srv_lease *lease = reaper->leases.next; lease != &reaper->leases; lease = lease->next)
		if (lease->held[what] && lease->wait <= last && lease->since_us < since_us
				&& (!holder || payer_of(lease, what) == holder) && goes_before(lease, first))
			first = lease;
	return first;
}

static struct srv_lease *longest_idle(struct srv_reaper *reaper, const struct srv_holder *holder)
{
	return first_to_go(reaper, SRV_HELD_CONNECTIONS, holder, SRV_WAIT_REQUEST, UINT64_MAX);
}

/* The connection with which the largest holder gives way, if it holds so much; NULL: none does. */
static struct srv_lease *of_largest(struct srv_reaper *reaper, enum srv_held what, uint64_t least)
{
	const struct srv_holder *largest = NULL;
	for (struct srv_holder *holder = reaper->holders; holder; holder = holder->next)
		if (!holder->is_proxy && holder->held[what] > (largest ? largest->held[what] : 0))
			largest = holder;
	return largest && largest->held[what] >= least ? first_to_go(reaper, what, largest, SRV_WAIT_WORK, UINT64_MAX)
		: NULL;
}

/* The connection that gives way to one more of the newcomer; NULL: none does. */
static struct srv_lease *who_gives_way(struct srv_reaper *reaper, const struct srv_holder *newcomer)
{
	uint64_t same = newcomer->held[SRV_HELD_CONNECTIONS];
	bool is_near = !newcomer->is_proxy && srv_address_is_loopback(&newcomer->address);
	struct srv_lease *way = first_to_go(reaper, SRV_HELD_CONNECTIONS, NULL, SRV_WAIT_REQUEST,
		srv_clock_us() - IDLE_US);
	way = way ? way : of_largest(reaper, SRV_HELD_CONNECTIONS, same + (is_near ? 1 : 2));
	way = way ? way : longest_idle(reaper, newcomer);
	return way || same ? way : longest_idle(reaper, NULL);
}

/* NULL, or why not. */
static const char *make_way(struct srv_reaper *reaper, const struct srv_holder *newcomer)
{
	uint64_t same = newcomer->held[SRV_HELD_CONNECTIONS], all = reaper->held[SRV_HELD_CONNECTIONS];
	bool same_full = !newcomer->is_proxy && same >= reaper->config->connections_per_address;
	if (!same_full && all < reaper->most[SRV_HELD_CONNECTIONS] + (same ? 0 : RESERVED))
		return NULL;
	struct srv_lease *way = same_full ? longest_idle(reaper, newcomer)
		: who_gives_way(reaper, newcomer);
	if (way)
		shut(reaper, way, "gives way to a new one");
	return way ? NULL : same_full ? "there are too many connections from this address; close some, or "
		"use them for more than one request" : "there are too many connections; ask again in a "
		"second";
}

/* Requests of holders that have more than this one would have give way. */
static bool free_bytes(struct srv_reaper *reaper, const struct srv_lease *lease, enum srv_held what,
	uint64_t more)
{
	uint64_t most = reaper->most[what];
	while (more > most || reaper->held[what] > most - more) {
		struct srv_lease *way = of_largest(reaper, what, lease->payer->held[what] + more + 1);
		if (!way)
			return false;
		shut(reaper, way, what == SRV_HELD_BODIES ? "gives way with its body" : "gives way with its answer");
	}
	return true;
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
	unlink_lease(reaper, stale);
	free(stale);
}

static const char *enter(struct srv_reaper *reaper, struct srv_lease *lease)
{
	const char *why = make_way(reaper, lease->holder);
	if (why)
		return why;
	if (!srv_gate_open(&lease->gate, lease->fd))
		return "there are too many descriptors; ask again in a second";
	lease->payer = lease->holder;
	lease->payer->users++;
	set_held(reaper, lease, SRV_HELD_CONNECTIONS, 1);
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
	*lease = (struct srv_lease){ .fd = fd, .address = *address, .since_us = now,
		.due_us = now + reaper->config->head_ms * 1000 };
	pthread_mutex_lock(&reaper->mutex);
	forget_stale(reaper, fd);
	lease->holder = use_holder(reaper, address);
	if (lease->holder) {
		lease->is_proxy = lease->holder->is_proxy;
		*why = enter(reaper, lease);
		if (*why)
			leave_holder(reaper, lease->holder);
	}
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
	struct srv_lease *way = longest_idle(reaper, NULL);
	way = way ? way : of_largest(reaper, SRV_HELD_CONNECTIONS, 2);
	if (way)
		shut(reaper, way, "gives its descriptor back");
	pthread_mutex_unlock(&reaper->mutex);
}

uint64_t srv_reaper_held(struct srv_reaper *reaper, enum srv_held what)
{
	pthread_mutex_lock(&reaper->mutex);
	uint64_t held = reaper->held[what];
	pthread_mutex_unlock(&reaper->mutex);
	return held;
}

void srv_reaper_speak_for(struct srv_reaper *reaper, struct srv_lease *lease, const struct srv_address *client)
{
	pthread_mutex_lock(&reaper->mutex);
	struct srv_holder *payer = use_holder(reaper, client);
	if (payer) {
		leave_holder(reaper, lease->payer);
		lease->payer = payer;
	}
	pthread_mutex_unlock(&reaper->mutex);
}

bool srv_reaper_hold(struct srv_reaper *reaper, struct srv_lease *lease, enum srv_held what, uint64_t bytes)
{
	pthread_mutex_lock(&reaper->mutex);
	bool held = bytes <= lease->held[what] || (!lease->is_shut
		&& free_bytes(reaper, lease, what, bytes - lease->held[what]));
	if (held && !lease->is_shut)
		set_held(reaper, lease, what, bytes);
	pthread_mutex_unlock(&reaper->mutex);
	return held;
}

/* ---- Deadlines ---- */

/* Under the mutex. */
static void set_wait(struct srv_reaper *reaper, struct srv_lease *lease, enum srv_wait wait)
{
	const uint64_t limits_ms[] = { [SRV_WAIT_REQUEST] = reaper->config->head_ms,
		[SRV_WAIT_BODY] = reaper->config->body_ms, [SRV_WAIT_SENDING] = reaper->config->send_ms,
		[SRV_WAIT_WORK] = 0 };
	uint64_t now = srv_clock_us();
	lease->due_us = lease->is_shut || !limits_ms[wait] ? 0 : now + limits_ms[wait] * 1000;
	lease->wait = wait;
	lease->since_us = now;
	lease->taken_bytes = NOT_TAKEN;
}

void srv_reaper_await(struct srv_reaper *reaper, struct srv_lease *lease, enum srv_wait wait)
{
	pthread_mutex_lock(&reaper->mutex);
	set_wait(reaper, lease, wait);
	if (wait == SRV_WAIT_REQUEST) {
		set_held(reaper, lease, SRV_HELD_BODIES, 0);
		set_held(reaper, lease, SRV_HELD_ANSWERS, 0);
	}
	pthread_mutex_unlock(&reaper->mutex);
}

void srv_reaper_watch(struct srv_reaper *reaper, struct srv_lease *lease, atomic_bool *gone)
{
	pthread_mutex_lock(&reaper->mutex);
	lease->gone = gone;
	lease->probe_us = 0;
	pthread_mutex_unlock(&reaper->mutex);
}

/* Goes on with a descriptor of its own, as the library closes the connection's. */
static bool linger(struct srv_reaper *reaper, struct srv_lease *lease)
{
	bool refused = lease->is_refused || lease->gate.framing.problem;
	int fd = refused && !lease->is_shut ? fcntl(lease->fd, F_DUPFD_CLOEXEC, 0) : -1;
	if (fd < 0)
		return false;
	shutdown(fd, SHUT_WR);
	lease->lingers = true;
	lease->fd = fd;
	set_wait(reaper, lease, SRV_WAIT_REQUEST);
	lease->due_us = lease->since_us + LINGER_QUIET_MS * 1000;
	return true;
}

void srv_reaper_close(struct srv_reaper *reaper, struct srv_lease *lease)
{
	if (!lease)
		return;
	srv_gate_close(&lease->gate);
	pthread_mutex_lock(&reaper->mutex);
	bool lingers = linger(reaper, lease);
	if (!lingers)
		unlink_lease(reaper, lease);
	pthread_mutex_unlock(&reaper->mutex);
	if (!lingers)
		free(lease);
}
