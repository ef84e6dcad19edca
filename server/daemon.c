/* Wiring between the HTTP library's callbacks and exchanges, and the daemon's life.
 *
 * Order of stopping: quiesce (new requests get 503, also on new connections) -> listener stopped -> work
 * stopped (suspended connections are resumed with an answer, since the library aborts on suspended ones) ->
 * library stopped -> reaper, shared responses. MHD_quiesce_daemon is not used: with epoll and a pool, 0.9.75
 * may take the listening socket out of a set twice, and aborts. */
#include "server/daemon.h"

#include <errno.h>
#include <microhttpd.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include "server/exchange.h"

#define CHORES_MAX 4             /* that wait */
#define REST_MS 100
/* The reaper counts connections; the library only has to be able to. */
#define CONNECTIONS_LIMIT (1u << 20)

/* ---- Callbacks ---- */

static void end_exchange(struct srv_lease *lease)
{
	if (lease && lease->exchange)
		srv_exchange_end(lease->exchange);
	if (lease)
		lease->exchange = NULL;
}

static void *on_request_line(void *ctx, const char *target, struct MHD_Connection *connection)
{
	struct srv_daemon *daemon = ctx;
	const union MHD_ConnectionInfo *info = MHD_get_connection_info(connection,
		MHD_CONNECTION_INFO_SOCKET_CONTEXT);
	struct srv_lease *lease = info ? info->socket_context : NULL;
	if (!lease)
		return NULL;
	end_exchange(lease);
	return lease->exchange = srv_exchange_new(daemon, connection, lease, target);
}

static enum MHD_Result on_request(void *ctx, struct MHD_Connection *connection, const char *url,
	const char *method, const char *version, const char *bytes, size_t *size, void **exchange)
{
	(void)ctx, (void)connection, (void)url, (void)version;
	return *exchange && srv_exchange_handle(*exchange, method, bytes, size) ? MHD_YES : MHD_NO;
}

static void on_completed(void *ctx, struct MHD_Connection *connection, void **exchange,
	enum MHD_RequestTerminationCode how)
{
	(void)ctx, (void)connection, (void)how;
	if (*exchange)
		end_exchange(((struct srv_exchange *)*exchange)->lease);
	*exchange = NULL;
}

static void on_connection(void *ctx, struct MHD_Connection *connection, void **lease,
	enum MHD_ConnectionNotificationCode what)
{
	struct srv_daemon *daemon = ctx;
	if (what == MHD_CONNECTION_NOTIFY_STARTED) {
		const union MHD_ConnectionInfo *info = MHD_get_connection_info(connection,
			MHD_CONNECTION_INFO_CONNECTION_FD);
		*lease = info ? srv_reaper_find(daemon->reaper, info->connect_fd) : NULL;
	} else {
		end_exchange(*lease);
		srv_reaper_close(daemon->reaper, *lease);
		*lease = NULL;
	}
}

/* Targets are decoded by target.c; the library's copy stays as it came. */
static size_t no_unescape(void *ctx, struct MHD_Connection *connection, char *text)
{
	(void)ctx, (void)connection;
	return strlen(text);
}

static void no_log(void *ctx, const char *format, va_list arguments)
{
	(void)ctx, (void)format, (void)arguments;
}

/* ---- Taking connections in ---- */

static void refuse(int fd, const char *why)
{
	srv_trace(SRV_TRACE_CONNECTION, "socket %d is refused: %s", fd, why);
	srv_gate_answer(fd, SRV_PROBLEM_BUSY, why, false);
	shutdown(fd, SHUT_WR);
	close(fd);
}

/* False if there is none, or none can be had. */
static bool accept_one(struct srv_daemon *daemon)
{
	struct sockaddr_storage peer = { 0 };
	socklen_t size = sizeof peer;
	const char *why;
	int fd = accept4(daemon->endpoint.fd, (struct sockaddr *)&peer, &size, SOCK_CLOEXEC | SOCK_NONBLOCK);
	if (fd < 0)
		return errno == ECONNABORTED || errno == EINTR;
	struct srv_address address = srv_address_of((struct sockaddr *)&peer);
	struct srv_lease *lease = srv_reaper_open(daemon->reaper, fd, &address, &why);
	if (!lease)
		refuse(fd, why);
	/* the library closes what it does not take */
	else if (MHD_add_connection(daemon->http, fd, (struct sockaddr *)&peer, size) != MHD_YES)
		srv_reaper_close(daemon->reaper, lease);
	return true;
}

/* Without descriptors it makes room and rests, instead of asking again and again. */
static void *accept_all(void *argument)
{
	struct srv_daemon *daemon = argument;
	struct pollfd waits[] = { { .fd = daemon->stop_fd, .events = POLLIN },
		{ .fd = daemon->endpoint.fd, .events = POLLIN } };
	for (;;) {
		poll(waits, 2, -1);
		if (waits[0].revents)
			return NULL;
		errno = 0;
		if (accept_one(daemon) || errno == EAGAIN || errno == EWOULDBLOCK)
			continue;
		atomic_fetch_add(&daemon->accept_failures, 1);
		srv_trace(SRV_TRACE_CONNECTION, "cannot accept: %s", strerror(errno));
		srv_reaper_make_room(daemon->reaper);
		poll(waits, 1, REST_MS);
	}
}

static enum eco_code start_listening(struct srv_daemon *daemon, struct eco_error *error)
{
	daemon->stop_fd = eventfd(0, EFD_CLOEXEC);
	int failed = daemon->stop_fd < 0 ? errno : pthread_create(&daemon->listener, NULL, accept_all, daemon);
	daemon->listens = !failed;
	return failed ? eco_fail(error, ECO_IO, "cannot start a thread that listens: %s", strerror(failed)) : ECO_OK;
}

/* ---- Life ---- */

static uint64_t processors(void)
{
	long count = sysconf(_SC_NPROCESSORS_ONLN);
	return count < 1 ? 1 : count > 8 ? 8 : (uint64_t)count;
}

static void fill_defaults(struct srv_config *config)
{
#define X(name, value, meaning) config->name = config->name ? config->name : (value);
	SRV_LIMITS(X)
#undef X
}

static enum eco_code start_http(struct srv_daemon *daemon, struct eco_error *error)
{
	unsigned flags = MHD_USE_EPOLL_INTERNAL_THREAD | MHD_USE_INTERNAL_POLLING_THREAD
		| MHD_ALLOW_SUSPEND_RESUME | MHD_USE_ITC | MHD_USE_ERROR_LOG | MHD_USE_NO_LISTEN_SOCKET;
	daemon->http = MHD_start_daemon(flags, 0, NULL, NULL, on_request, daemon,
		MHD_OPTION_EXTERNAL_LOGGER, no_log, NULL,
		MHD_OPTION_THREAD_POOL_SIZE, (unsigned)daemon->config.polling_threads,
		MHD_OPTION_CONNECTION_LIMIT, (unsigned)CONNECTIONS_LIMIT,
		MHD_OPTION_CONNECTION_MEMORY_LIMIT, (size_t)SRV_CONNECTION_MEMORY,
		MHD_OPTION_STRICT_FOR_CLIENT, 1,
		MHD_OPTION_UNESCAPE_CALLBACK, no_unescape, NULL,
		MHD_OPTION_URI_LOG_CALLBACK, on_request_line, daemon,
		MHD_OPTION_NOTIFY_COMPLETED, on_completed, daemon,
		MHD_OPTION_NOTIFY_CONNECTION, on_connection, daemon,
		MHD_OPTION_END);
	if (!daemon->http)
		return eco_fail(error, ECO_IO, "cannot start the HTTP threads: %s", errno ? strerror(errno)
			: "not enough resources");
	return ECO_OK;
}

enum eco_code srv_daemon_start(struct srv_daemon **out, const struct srv_config *given,
	const struct srv_store *store, struct eco_error *error)
{
	static struct srv_access open_to_all;
	struct srv_daemon *daemon = *out = calloc(1, sizeof *daemon);
	if (!daemon)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for the daemon");
	struct srv_config *config = &daemon->config;
	*config = *given;
	fill_defaults(config);
	config->access = config->access ? config->access : &open_to_all;
	daemon->endpoint = config->endpoint ? *config->endpoint : (struct srv_endpoint){ .fd = -1 };
	daemon->stop_fd = -1;
	daemon->id_seed = (uint64_t)getpid() ^ srv_clock_us() << 20;
	pthread_mutex_init(&daemon->catalog.mutex, NULL);
	pthread_mutex_init(&daemon->reloading, NULL);
	atomic_store(&daemon->bad_packs, config->bad_packs);
	srv_typical_find_all(store, NULL);       /* so that no request waits for it */
	enum eco_code code = config->endpoint ? ECO_OK : srv_endpoint_open(&daemon->endpoint, config->listen, error);
	code = code ? code : srv_catalog_replace(&daemon->catalog, store, 0, 0, error);
	code = code ? code : srv_reaper_start(&daemon->reaper, config, error);
	if (!code && !(daemon->plans = srv_plan_cache_new(config->plan_cache_bytes)))
		code = eco_fail(error, ECO_NO_MEMORY, "no memory for answers that are kept");
	code = code ? code : srv_work_start(&daemon->work, (uint32_t)config->work_threads, true,
		(uint32_t)config->queue_max, (uint32_t)config->queue_share_max, error);
	code = code ? code : srv_work_start(&daemon->chores, 1, false, CHORES_MAX, CHORES_MAX, error);
	code = code ? code : start_http(daemon, error);
	code = code ? code : start_listening(daemon, error);
	if (!code)
		return ECO_OK;
	srv_daemon_stop(daemon);
	*out = NULL;
	return code;
}

/* ---- Reloading ---- */

enum eco_code srv_daemon_reload_now(struct srv_daemon *daemon, struct srv_reload *report, struct eco_error *error)
{
	struct srv_sources sources = { .count = 0 };
	enum srv_log_form form = (enum srv_log_form)daemon->config.log_form;
	struct srv_store store;
	*report = (struct srv_reload){ 0 };
	if (!daemon->config.sources)
		return eco_fail(error, ECO_UNSUPPORTED, "this server has no packs to load again");
	sources = *daemon->config.sources;
	sources.cancelled = &daemon->draining;
	pthread_mutex_lock(&daemon->reloading);
	struct srv_edition *before = srv_catalog_hold(&daemon->catalog);
	uint64_t now_us = srv_clock_us(), until_us = now_us + daemon->config.keep_s * 1000000;
	enum eco_code code = srv_sources_load(&sources, &before->store, &store, report, error);
	if (!code)
		code = srv_access_check(daemon->config.access, &store, &sources, &before->store, error);
	if (!code && !srv_typical_find_all(&store, sources.cancelled))
		code = eco_fail(error, ECO_INTERRUPTED, "the server is stopping");
	if (!code)
		code = srv_catalog_replace(&daemon->catalog, &store, until_us, now_us, error);
	if (!code)
		atomic_store(&daemon->bad_packs, report->bad);
	srv_store_free(&store);
	srv_edition_release(before);
	pthread_mutex_unlock(&daemon->reloading);
	srv_count(&daemon->metrics, SRV_COUNT_RELOADS, 1);
	srv_count(&daemon->metrics, SRV_COUNT_RELOADS_FAILED, code || report->bad);
	if (code)
		srv_log_event(form, true, "reload: nothing is changed: %s", error->text);
	else
		srv_log_event(form, report->bad, "reload: %u scenes opened, %u as they were, %u gone%s%s",
			report->opened, report->same, report->gone, report->bad
			? "; not well, and served as before where they were: " : "", report->why);
	return code;
}

static void reload(void *argument)
{
	struct srv_daemon *daemon = argument;
	struct srv_reload report;
	struct eco_error error = { 0 };
	srv_daemon_reload_now(daemon, &report, &error);
}

/* If the queue has no place for it, one of the reloads in it begins later than now. */
void srv_daemon_reload(struct srv_daemon *daemon)
{
	srv_work_submit(daemon->chores, &(struct srv_job){ .run = reload, .argument = daemon,
		.cancelled = &daemon->reload_cancelled });
}

/* Without memory, or while scenes are read, it is tried again. */
void srv_daemon_tick(struct srv_daemon *daemon)
{
	struct eco_error error = { 0 };
	if (pthread_mutex_trylock(&daemon->reloading))
		return;
	srv_catalog_retire(&daemon->catalog, srv_clock_us(), &error);
	pthread_mutex_unlock(&daemon->reloading);
}

struct srv_gauges srv_daemon_gauges(struct srv_daemon *daemon)
{
	struct srv_edition *edition = srv_catalog_hold(&daemon->catalog);
	struct srv_gauges gauges = { .connections = srv_reaper_held(daemon->reaper, SRV_HELD_CONNECTIONS),
		.busy = atomic_load(&daemon->busy),
		.waiting_plans = srv_work_waiting(daemon->work),
		.scenes = edition->store.count,
		.retired = edition->retired_count,
		.bad_packs = atomic_load(&daemon->bad_packs),
		.bodies_bytes = srv_reaper_held(daemon->reaper, SRV_HELD_BODIES),
		.answers_bytes = srv_reaper_held(daemon->reaper, SRV_HELD_ANSWERS),
		.kept_bytes = srv_plan_cache_bytes(daemon->plans),
		.accept_failures = atomic_load(&daemon->accept_failures),
		.refused_heads = srv_gate_refused(),
		.dropped_lines = srv_log_dropped() };
	gauges.ready = !atomic_load(&daemon->draining) && srv_work_has_room(daemon->work);
	srv_edition_release(edition);
	return gauges;
}

void srv_daemon_quiesce(struct srv_daemon *daemon)
{
	atomic_store(&daemon->draining, true);
}

uint32_t srv_daemon_busy(const struct srv_daemon *daemon)
{
	return atomic_load(&daemon->busy);
}

void srv_daemon_stop(struct srv_daemon *daemon)
{
	if (!daemon)
		return;
	srv_daemon_quiesce(daemon);
	if (daemon->listens) {
		eventfd_write(daemon->stop_fd, 1);
		pthread_join(daemon->listener, NULL);
	}
	if (daemon->chores)
		srv_work_stop(daemon->chores);
	if (daemon->work)
		srv_work_stop(daemon->work);
	if (daemon->http)
		MHD_stop_daemon(daemon->http);
	srv_work_free(daemon->work);
	srv_work_free(daemon->chores);
	srv_reaper_stop(daemon->reaper);
	srv_edition_release(daemon->catalog.current);
	srv_plan_cache_free(daemon->plans);
	if (daemon->stop_fd >= 0)
		close(daemon->stop_fd);
	if (daemon->endpoint.fd >= 0)
		close(daemon->endpoint.fd);
	pthread_mutex_destroy(&daemon->catalog.mutex);
	pthread_mutex_destroy(&daemon->reloading);
	free(daemon);
}
