/* ecoserve: serves packs over HTTP until SIGTERM or SIGINT, then finishes what runs; a second signal ends at
 * once. */
#include <malloc.h>
#include <netdb.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

#include "ecofiles/base/options_file.h"
#include "server/access.h"
#include "server/daemon.h"
#include "server/log.h"
#include "server/sandbox.h"
#include "server/site.h"
#include "server/stream.h"

#define ENVIRONMENT "ECOSERVE_"
#define NAMES_SHOWN 8u
/* Freed memory that a thread keeps: a plan needs a few MB, and to get them anew from the kernel, page by
 * page, took 6 % of its time. */
#define KEPT_BYTES (4 << 20)
#define DRAIN_MS 10000u
#define DRAIN_ROUND_MS 20u
#define DESCRIPTORS_BESIDE (SRV_SCENES_MAX + 100u)

static struct {
	struct srv_config config;
	struct srv_access access;
	struct eco_inputs scenes;
	const char *copies, *viewer, *settings, *user;
	bool in_place, only_check, without_sandbox, require_sandbox;
} given;

/* A descriptor a connection, and some for packs and threads: as many as this process may have. */
static void raise_descriptors(uint64_t connections)
{
	struct rlimit limit;
	rlim_t wanted = (rlim_t)(connections ? connections : 1000) + DESCRIPTORS_BESIDE;
	if (getrlimit(RLIMIT_NOFILE, &limit) || limit.rlim_cur >= wanted)
		return;
	limit.rlim_cur = wanted < limit.rlim_max ? wanted : limit.rlim_max;
	setrlimit(RLIMIT_NOFILE, &limit);
}

static const char *const log_forms[] = { [SRV_LOG_TEXT] = "text", [SRV_LOG_JSON] = "json", NULL };

static const struct eco_option options[] = {
	{ "a pack", 0, ECO_OPTION_INPUTS, "[NAME=]OUT.eco", .value = &given.scenes, .is_required = true },
	{ "listen", 'l', ECO_OPTION_TEXT, "HOST:PORT", .value = &given.config.listen },
	{ "copies", 0, ECO_OPTION_TEXT, "DIR", .value = &given.copies },
	{ "in-place", 0, ECO_OPTION_FLAG, NULL, .value = &given.in_place },
	{ "connections", 0, ECO_OPTION_COUNT, "N", .value = &given.config.connections_max, 1, 100000 },
	{ "connections-per-address", 0, ECO_OPTION_COUNT, "N", .value = &given.config.connections_per_address,
		1, 100000 },
	{ "plans", 0, ECO_OPTION_COUNT, "N", .value = &given.config.queue_max, 1, 100000 },
	{ "plans-per-address", 0, ECO_OPTION_COUNT, "N", .value = &given.config.queue_share_max, 1, 100000 },
	{ "plan-work", 0, ECO_OPTION_COUNT, "N", .value = &given.config.plan_times, 1, 1000 },
	{ "head-ms", 0, ECO_OPTION_COUNT, "MS", .value = &given.config.head_ms, 10, 3600000 },
	{ "body-ms", 0, ECO_OPTION_COUNT, "MS", .value = &given.config.body_ms, 10, 3600000 },
	{ "send-ms", 0, ECO_OPTION_COUNT, "MS", .value = &given.config.send_ms, 10, 3600000 },
	{ "send-rate", 0, ECO_OPTION_BYTES, "BYTES", .value = &given.config.rate_bytes_s, 1, 1 << 30 },
	{ "body-bytes", 0, ECO_OPTION_BYTES, "BYTES", .value = &given.config.body_max, 4, 1 << 30 },
	{ "bodies-bytes", 0, ECO_OPTION_BYTES, "BYTES", .value = &given.config.bodies_max, 4, 1ull << 40 },
	{ "answer-bytes", 0, ECO_OPTION_BYTES, "BYTES", .value = &given.config.response_max, 1, 1ull << 40 },
	{ "answers-bytes", 0, ECO_OPTION_BYTES, "BYTES", .value = &given.config.answers_max, 4, 1ull << 40 },
	{ "cap-vertices", 0, ECO_OPTION_READ, "[SCENE=]N", .value = &given.access.vertices,
		.read = srv_cap_add_vertices, .times = ECO_ONCE_A_NAME },
	{ "cap-bytes", 0, ECO_OPTION_READ, "[SCENE=]BYTES", .value = &given.access.bytes,
		.read = srv_cap_add_bytes, .times = ECO_ONCE_A_NAME },
	{ "kept-bytes", 0, ECO_OPTION_BYTES, "BYTES", .value = &given.config.plan_cache_bytes, 1,
		1ull << 40 },
	{ "trust-proxy", 0, ECO_OPTION_READ, "ADDRESS[/BITS],...", .value = &given.config.trusted,
		.read = srv_networks_parse },
	{ "viewer", 0, ECO_OPTION_TEXT, "DIR", .value = &given.viewer },
	{ "token", 0, ECO_OPTION_READ, "SCENE=FILE", .value = &given.access, .read = srv_access_add_token,
		.times = ECO_OFTEN },
	{ "admin-token", 0, ECO_OPTION_READ, "FILE", .value = &given.access, .read = srv_access_add_operator,
		.times = ECO_OFTEN },
	{ "cors", 0, ECO_OPTION_READ, "ORIGIN", .value = &given.access, .read = srv_access_add_origin,
		.times = ECO_OFTEN },
	{ "embed", 0, ECO_OPTION_READ, "ORIGIN", .value = &given.access, .read = srv_access_add_frame,
		.times = ECO_OFTEN },
	{ "keep", 0, ECO_OPTION_COUNT, "SECONDS", .value = &given.config.keep_s, 1, 86400 },
	{ "log", 0, ECO_OPTION_CHOICE, "FORM", .value = &given.config.log_form, .choices = log_forms,
		.given = &given.config.log },
	{ "slow", 0, ECO_OPTION_COUNT, "MS", .value = &given.config.slow_ms, 1, 3600000 },
	{ "user", 0, ECO_OPTION_TEXT, "NAME", .value = &given.user },
	{ "require-sandbox", 0, ECO_OPTION_FLAG, NULL, .value = &given.require_sandbox },
	{ "no-sandbox", 0, ECO_OPTION_FLAG, NULL, .value = &given.without_sandbox },
	{ "config", 0, ECO_OPTION_TEXT, "FILE", .value = &given.settings },
	{ "check-config", 0, ECO_OPTION_FLAG, NULL, .value = &given.only_check }, { 0 }
};

static const struct eco_command command = { .name = "ecoserve",
	.synopsis = "[--listen HOST:PORT] [OPTIONS] "
		    "[NAME=]OUT.eco ...",
	.says = "Serves packs made by ecopack over HTTP.",
	.options = options,
	.notes =
		"Prints one line when ready, with the names of the scenes. SIGTERM and SIGINT finish running answers, "
		"for at most 10 s, and end; a second one ends at once. SIGHUP, or POST /v1/admin/reload, reads packs "
		"and folders again: later requests get the changed packs, and a bad pack leaves its scene as it was. "
		"A pack that is bad at the start is not served; the others are, and /readyz counts it.\n"
		"The command line wins over the environment (ECOSERVE_ and the option's name, as "
		"ECOSERVE_PLAN_WORK=5), the environment over the file of --config.\n"
		"ECO_TRACE=plan,cuts,cache,connection prints on stderr the reasons for decisions.\n" };

static enum eco_code announce(const char *what, const struct srv_store *store, const char *rest,
	struct eco_error *error)
{
	bool bad = printf("ecoserve: %s (%u scene%s", what, store->count, store->count == 1 ? "" : "s") < 0;
	for (uint32_t i = 0; i < store->count && i < NAMES_SHOWN; i++)
		bad |= printf("%s%s", i ? ", " : " named ", store->scenes[i]->name) < 0;
	if (printf("%s)%s\n", store->count > NAMES_SHOWN ? ", ..." : "", rest) < 0 || fflush(stdout) || bad)
		return eco_fail(error, ECO_IO, "cannot write to stdout");
	return ECO_OK;
}

static void end_at_once(int number)
{
	(void)number;
	_exit(1);
}

/* Threads that still run are waited for; a signal need not wait. */
static void let_signals_end(void)
{
	sigset_t ends;
	signal(SIGTERM, end_at_once);
	signal(SIGINT, end_at_once);
	sigemptyset(&ends);
	sigaddset(&ends, SIGTERM);
	sigaddset(&ends, SIGINT);
	sigprocmask(SIG_UNBLOCK, &ends, NULL);
}

/* Signals stay blocked in all threads and are taken here, one after the other: no handler, no race. */
static void serve(struct srv_daemon *daemon, const sigset_t *signals)
{
	const struct timespec pause = { 0, DRAIN_ROUND_MS * 1000000L }, second = { 1, 0 };
	for (int number; (number = sigtimedwait(signals, NULL, &second)) < 0 || number == SIGHUP;) {
		if (number == SIGHUP)
			srv_daemon_reload(daemon);
		srv_daemon_tick(daemon);
	}
	srv_daemon_quiesce(daemon);
	for (uint32_t waited = 0; srv_daemon_busy(daemon) && waited < DRAIN_MS; waited += DRAIN_ROUND_MS) {
		int number = sigtimedwait(signals, NULL, &pause);
		if (number == SIGTERM || number == SIGINT)
			_exit(1);
	}
	let_signals_end();
	srv_daemon_stop(daemon);
}

/* A pack that is served in place and cut short, or a disk that fails, is met here, wherever that is. Nothing
 * can be trusted then. */
static void pack_is_gone(int number)
{
	static const char text[] = "ecoserve: a pack was cut short while it was served, or its disk failed "
		"(SIGBUS): start ecoserve again. With --in-place put a new pack in place by renaming it (mv, "
		"or ecopack make), not by writing over the old one (cp)\n";
	struct pollfd room = { .fd = STDERR_FILENO, .events = POLLOUT };
	(void)number;
	_exit(poll(&room, 1, 0) == 1 && write(STDERR_FILENO, text, sizeof text - 1) < 0 ? 3 : 1);
}

static const char *copies_folder(void)
{
	const char *folder = given.copies ? given.copies : getenv("TMPDIR");
	return given.in_place ? NULL : folder && *folder ? folder : "/var/tmp";
}

/* The user that it becomes. */
static enum eco_code find_user(struct srv_user *user, struct eco_error *error)
{
	if (given.without_sandbox && (given.require_sandbox || given.user))
		return eco_fail(error, ECO_BAD_USAGE, "--no-sandbox and --%s exclude each other: leave one out",
			given.user ? "user" : "require-sandbox");
	return given.without_sandbox ? ECO_OK : srv_user_find(user, given.user, error);
}

/* The daemon shares the scenes: `store` lets go of them, so that none stays that a reload replaced. */
static enum eco_code serve_scenes(struct srv_store *store, const struct srv_user *user, const sigset_t *signals,
	struct eco_error *error)
{
	struct srv_daemon *daemon;
	struct srv_endpoint endpoint;
	char what[NI_MAXHOST + 40];
	enum eco_code code = srv_endpoint_take(&endpoint, given.config.listen, error);
	if (!code && !given.without_sandbox)
		code = srv_sandbox_enter(&(struct srv_sandbox){ .sources = given.config.sources, .store = store,
			.user = user, .log_form = (enum srv_log_form)given.config.log_form,
			.required = given.require_sandbox }, error);
	if (!code)
		srv_typical_find_all(store, NULL);       /* a signal may end it here */
	sigprocmask(SIG_BLOCK, signals, NULL);
	given.config.endpoint = &endpoint;
	code = code ? code : srv_daemon_start(&daemon, &given.config, store, error);
	if (code)
		return code;
	snprintf(what, sizeof what, "ready on %s", endpoint.url);
	code = announce(what, store, srv_site_find(given.config.site, SRV_SITE_INDEX) ? ""
		: "; the viewer is missing, `make web` builds it", error);
	srv_store_free(store);
	if (!code)
		serve(daemon, signals);
	else
		srv_daemon_stop(daemon);
	return code;
}

/* SIGHUP waits from the start: a reload that is asked for while packs are read comes after that. Signals that
 * mean something to other servers, such as SIGUSR1 (open the log again), are ignored: each would end this
 * one. */
static sigset_t prepare_signals(void)
{
	static const int others[] = { SIGPIPE, SIGUSR1, SIGUSR2, SIGALRM, SIGVTALRM, SIGIO, SIGPWR, SIGSTKFLT,
		SIGXFSZ };
	sigset_t signals, reload;
	for (size_t i = 0; i < sizeof others / sizeof *others; i++)
		signal(others[i], SIG_IGN);
	for (int number = SIGRTMIN; number <= SIGRTMAX; number++)
		signal(number, SIG_IGN);
	signal(SIGBUS, pack_is_gone);
	sigemptyset(&reload);
	sigaddset(&reload, SIGHUP);
	sigprocmask(SIG_BLOCK, &reload, NULL);
	signals = reload;
	sigaddset(&signals, SIGTERM);
	sigaddset(&signals, SIGINT);
	return signals;
}

/* The other packs are served. */
static enum eco_code tell_bad(const struct srv_reload *report, struct eco_error *error)
{
	if (given.only_check)
		return eco_fail(error, ECO_BAD_INPUT, "%s", report->why);
	srv_log_event((enum srv_log_form)given.config.log_form, true, "warning: not served until a reload "
		"finds it well: %s", report->why);
	return ECO_OK;
}

static enum eco_code run(struct eco_error *error)
{
	struct srv_store store;
	struct srv_site site;
	struct srv_reload report;
	struct srv_user user;
	const struct srv_sources sources = { given.scenes.names, given.scenes.count, copies_folder(), NULL };
	const sigset_t signals = prepare_signals();
	raise_descriptors(given.config.connections_max);
	given.config.site = &site;
	given.config.access = &given.access;
	given.config.sources = &sources;
	srv_store_init(&store);
	enum eco_code code = srv_site_open(&site, given.viewer, error);
	code = code ? code : srv_trace_set(getenv("ECO_TRACE"), error);
	code = code ? code : srv_endpoint_check(given.config.listen, error);
	code = code ? code : find_user(&user, error);
	code = code ? code : srv_sources_load(&sources, NULL, &store, &report, error);
	if (!code && report.bad)
		code = tell_bad(&report, error);
	given.config.bad_packs = report.bad;
	code = code ? code : srv_access_check(&given.access, &store, &sources, NULL, error);
	if (!code)
		code = given.only_check ? announce("the configuration is good", &store, "", error)
			: serve_scenes(&store, &user, &signals, error);
	srv_store_free(&store);
	srv_site_free(&site);
	return code;
}

/* The value that these arguments give an option, or else `value`, before all of them can be read. */
static const char *find_option(const char *option, const char *value, int argc, char *const *argv)
{
	size_t size = strlen(option);
	for (int i = 0; i < argc && strcmp(argv[i], "--") != 0; i++)
		if (strncmp(argv[i], option, size) == 0)
			value = argv[i][size] == '=' ? argv[i] + size + 1
				: !argv[i][size] && i + 1 < argc ? argv[i + 1] : value;
	return value;
}

/* Says what failed, in the form of the log. */
static int end_failed(enum eco_code code, const struct eco_error *error, const char *form)
{
	bool json = form && strcmp(form, log_forms[SRV_LOG_JSON]) == 0;
	if (error->text[0])
		srv_log_event(json ? SRV_LOG_JSON : SRV_LOG_TEXT, true, "%s", error->text);
	return json ? eco_exit_status(code) : eco_command_end(&command, code, &(struct eco_error){ 0 });
}

int main(int argc, char **argv)
{
	struct eco_error error = { 0 };
	struct eco_arguments arguments = { 0 };
	const char *file = find_option("--config", getenv(ENVIRONMENT "CONFIG"), argc - 1, argv + 1);
	const struct eco_settings settings = { file, ENVIRONMENT, "pack" };
	srv_log_start();
	mallopt(M_TRIM_THRESHOLD, KEPT_BYTES);
	mallopt(M_MMAP_THRESHOLD, KEPT_BYTES);
	if (eco_command_answers(&command, argc - 1, argv + 1))
		return eco_command_end(&command, ECO_OK, &error);
	enum eco_code code = eco_settings_read(&command, &settings, argc - 1, argv + 1, &arguments, &error);
	code = code ? code : eco_command_read(&command, arguments.count, arguments.items, &error);
	code = code ? code : run(&error);
	const char *form = find_option("--log", NULL, arguments.count, arguments.owned);
	const char *variable = getenv(ENVIRONMENT "LOG");
	form = find_option("--log", variable ? variable : form, argc - 1, argv + 1);
	int status = code ? end_failed(code, &error, form) : eco_command_end(&command, code, &error);
	/* only now: options point into them, and inputs were moved to the front */
	eco_arguments_free(&arguments);
	return status;
}
