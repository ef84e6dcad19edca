/* ecoserve: serves packs over HTTP until SIGTERM or SIGINT, then finishes what runs; a second signal ends at
 * once. */
#include <limits.h>
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

#include "ecofiles/base/data_path.h"
#include "ecofiles/base/options_file.h"
#include "server/access.h"
#include "server/caps.h"
#include "server/daemon.h"
#include "server/log.h"
#include "server/sandbox.h"
#include "server/site.h"
#include "server/trace.h"
#include "server/typical.h"

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
	struct srv_caps caps;
	struct eco_inputs scenes;
	const char *copies, *viewer, *settings, *user;
	bool in_place, only_check, without_sandbox, require_sandbox;
} given;

static enum eco_code read_networks(const char *text, void *networks, struct eco_error *error)
{
	return srv_networks_parse(networks, text, error);
}

static enum eco_code read_token(const char *text, void *access, struct eco_error *error)
{
	return srv_access_add_token(access, text, error);
}

static enum eco_code read_cap_vertices(const char *text, void *caps, struct eco_error *error)
{
	return srv_cap_add(caps, text, ECO_OPTION_COUNT, "cap-vertices", error);
}

static enum eco_code read_cap_bytes(const char *text, void *caps, struct eco_error *error)
{
	return srv_cap_add(caps, text, ECO_OPTION_BYTES, "cap-bytes", error);
}

static enum eco_code read_operator(const char *text, void *access, struct eco_error *error)
{
	return srv_access_add_operator(access, text, error);
}

static enum eco_code read_origin(const char *text, void *access, struct eco_error *error)
{
	return srv_access_add_origin(access, text, error);
}

static enum eco_code read_frame(const char *text, void *access, struct eco_error *error)
{
	return srv_access_add_frame(access, text, error);
}

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
	{ "a pack", 0, ECO_OPTION_INPUTS, "[NAME=]OUT.eco", &given.scenes, .is_required = true,
		.help = "a scene under /v1/scenes/NAME, or a folder of some; without NAME= it is the scene's "
			"own name where that is a word of a-z, 0-9, '_' and '-', else the file's, in small "
			"letters and with '-' for all else" },
	{ "listen", 'l', ECO_OPTION_TEXT, "HOST:PORT", &given.config.listen,
		.help = "where to listen; port 0 takes any free one; the socket that systemd hands over, or "
			SRV_LISTEN_DEFAULT ", if not given" },
	{ "copies", 0, ECO_OPTION_TEXT, "DIR", &given.copies,
		.help = "where private copies of the packs lie while they are served, so that nobody changes "
			"them; they take as much room as the packs and go with the process; $TMPDIR or "
			"/var/tmp if not given" },
	{ "in-place", 0, ECO_OPTION_FLAG, NULL, &given.in_place,
		.help = "serve the files themselves, for packs that nobody writes over: no room, no time to "
			"copy, and memory shared with other servers" },
	{ "connections", 0, ECO_OPTION_COUNT, "N", &given.config.connections_max, 1, 100000,
		.help = "at once; where all are taken, one that only waits gives way, or one of the address "
			"that holds most; 16 more are for addresses that hold none; 1000 if not given" },
	{ "connections-per-address", 0, ECO_OPTION_COUNT, "N", &given.config.connections_per_address, 1,
		100000, .help = "of them from one address, or from one IPv6 /64; 128 if not given" },
	{ "plans", 0, ECO_OPTION_COUNT, "N", &given.config.queue_max, 1, 100000,
		.help = "that may wait for a thread; where all places are taken, the address that holds most "
			"gives one to an address that holds less; 64 if not given" },
	{ "plans-per-address", 0, ECO_OPTION_COUNT, "N", &given.config.queue_share_max, 1, 100000,
		.help = "of them for one address; 32 if not given" },
	{ "plan-work", 0, ECO_OPTION_COUNT, "N", &given.config.plan_times, 1, 1000,
		.help = "what planning a request may cost, counted in ordinary plans of its scene; it ends "
			"there with what it has, which is the same on every machine; 5 if not given" },
	{ "head-ms", 0, ECO_OPTION_COUNT, "MS", &given.config.head_ms, 10, 3600000,
		.help = "to send a request's head, and to begin the next one; 20000 if not given" },
	{ "body-ms", 0, ECO_OPTION_COUNT, "MS", &given.config.body_ms, 10, 3600000,
		.help = "to send its body; 30000 if not given" },
	{ "send-ms", 0, ECO_OPTION_COUNT, "MS", &given.config.send_ms, 10, 3600000,
		.help = "in each of which an answer is taken at the least rate; 30000 if not given" },
	{ "send-rate", 0, ECO_OPTION_BYTES, "BYTES", &given.config.rate_bytes_s, 1, 1 << 30,
		.help = "a second, the least rate; 16384 if not given" },
	{ "body-bytes", 0, ECO_OPTION_BYTES, "BYTES", &given.config.body_max, 4, 1 << 30,
		.help = "of a request's body at most; 4 MiB if not given" },
	{ "bodies-bytes", 0, ECO_OPTION_BYTES, "BYTES", &given.config.bodies_max, 4, 1ull << 40,
		.help = "of all bodies, as far as they have arrived; 256 MiB if not given" },
	{ "answer-bytes", 0, ECO_OPTION_BYTES, "BYTES", &given.config.response_max, 1, 1ull << 40,
		.help = "of an answer at most; 2 GiB if not given, and 64 MiB of a plan as JSON" },
	{ "answers-bytes", 0, ECO_OPTION_BYTES, "BYTES", &given.config.answers_max, 4, 1ull << 40,
		.help = "of memory for all answers that are being sent, without the packs' own bytes; where they "
			"are taken, the address that holds most gives way; 256 MiB if not given" },
	{ "cap-vertices", 0, ECO_OPTION_READ, "[SCENE=]N", &given.caps.vertices, .read = read_cap_vertices,
		.times = ECO_ONCE_A_NAME,
		.help = "that an answer of the scene, or of any, draws at most: who asks for more gets so "
			"much; may be given more than once" },
	{ "cap-bytes", 0, ECO_OPTION_READ, "[SCENE=]BYTES", &given.caps.bytes, .read = read_cap_bytes,
		.times = ECO_ONCE_A_NAME,
		.help = "that an answer of the scene, or of any, takes at most, in the same way" },
	{ "kept-bytes", 0, ECO_OPTION_BYTES, "BYTES", &given.config.plan_cache_bytes, 1, 1ull << 40,
		.help = "of answers that are kept for who asks again; 64 MiB if not given" },
	{ "trust-proxy", 0, ECO_OPTION_READ, "ADDRESS[/BITS],...", &given.config.trusted,
		.read = read_networks,
		.help = "proxies that may open any number of connections, and whose "
			"X-Forwarded-For says who asks" },
	{ "viewer", 0, ECO_OPTION_TEXT, "DIR", &given.viewer,
		.help = "what / shows in a browser: the folder that `make web` makes, build/web/site; if not "
			"given, that one beside this program, or where `make install` put it; without any, / "
			"says how to get it" },
	{ "token", 0, ECO_OPTION_READ, "SCENE=FILE", &given.access, .read = read_token,
		.times = ECO_OFTEN,
		.help = "the scene is for whoever sends the token that is the first line of FILE "
			"(Authorization: Bearer); may be given more than once" },
	{ "admin-token", 0, ECO_OPTION_READ, "FILE", &given.access, .read = read_operator,
		.times = ECO_OFTEN,
		.help = "/metrics and /v1/admin are for whoever sends this one, which opens all scenes, too; "
			"else they are for this machine" },
	{ "cors", 0, ECO_OPTION_READ, "ORIGIN", &given.access, .read = read_origin,
		.times = ECO_OFTEN,
		.help = "whose pages may read answers, https://HOST[:PORT], or * for all; may be given more "
			"than once" },
	{ "embed", 0, ECO_OPTION_READ, "ORIGIN", &given.access, .read = read_frame, .times = ECO_OFTEN,
		.help = "whose pages may show the viewer in a frame, https://HOST[:PORT], or * for all; may be "
			"given more than once; only this server's own if not given" },
	{ "keep", 0, ECO_OPTION_COUNT, "SECONDS", &given.config.keep_s, 1, 86400,
		.help = "that chunks of a replaced pack are still served; 600 if not given" },
	{ "log", 0, ECO_OPTION_CHOICE, "FORM", &given.config.log_form, .choices = log_forms,
		.given = &given.config.log,
		.help = "one line a request on stderr, as text or json, which what the daemon says and errors "
			"have, too; lines that nobody reads are dropped and counted (/metrics)" },
	{ "slow", 0, ECO_OPTION_COUNT, "MS", &given.config.slow_ms, 1, 3600000,
		.help = "log requests whose plan took longer, with what the plan tried" },
	{ "user", 0, ECO_OPTION_TEXT, "NAME", &given.user,
		.help = "who it becomes when root has started it and packs and port are open; "
			SRV_USER_DEFAULT " if not given" },
	{ "require-sandbox", 0, ECO_OPTION_FLAG, NULL, &given.require_sandbox,
		.help = "end where the system cannot keep it to its packs and its system calls, instead of a "
			"warning" },
	{ "no-sandbox", 0, ECO_OPTION_FLAG, NULL, &given.without_sandbox,
		.help = "it may do whatever its user may, for debuggers and the like" },
	{ "config", 0, ECO_OPTION_TEXT, "FILE", &given.settings,
		.help = "lines of NAME = VALUE, as these options are named, and pack = [NAME=]OUT.eco; '#' and "
			"a space begin a comment; a value with '#' behind a space stands in double quotes" },
	{ "check-config", 0, ECO_OPTION_FLAG, NULL, &given.only_check,
		.help = "read everything, packs too, say whether it is good, and end" },
	{ 0 }
};

static const struct eco_command command = { .name = "ecoserve",
	.synopsis = "[--listen HOST:PORT] [OPTIONS] "
		    "[NAME=]OUT.eco ...",
	.says = "Serves packs made by ecopack over HTTP.",
	.options = options,
	.notes =
		"Prints one line when ready, with the names, and whether the viewer is missing. SIGTERM and "
		"SIGINT finish running answers (for at most 10 s) and end; a second one "
		"ends at once. SIGUSR1, SIGUSR2 and the like do nothing. SIGHUP, or POST /v1/admin/reload, "
		"reads packs and folders again: what has "
		"changed is served to who comes from then on, and what is not well leaves the scene as it "
		"was. A pack that is not well at the start is not served; the others are, and /readyz "
		"counts it.\n"
		"Options hold in this order: the command line, the environment (ECOSERVE_ and the name in "
		"capitals, as ECOSERVE_PLAN_WORK=5), the file of --config.\n"
		"ECO_TRACE=plan,cuts,cache,connection prints on stderr why things are as they are.\n" };

static enum eco_code announce(const char *what, const struct srv_store *store, const char *rest,
	struct eco_error *error)
{
	bool bad = printf("ecoserve: %s (%u scene%s", what, store->count, store->count == 1 ? "" : "s") < 0;
	for (uint32_t i = 0; i < store->count && i < NAMES_SHOWN; i++)
		bad |= printf("%s%s", i ? ", " : " named ", store->scenes[i]->name) < 0;
	if (printf("%s)%s\n", store->count > NAMES_SHOWN ? ", ..." : "", rest) < 0 || fflush(stdout) || bad)
		return eco_fail(error, ECO_IO, "cannot write to stdout: who started this does not want to "
			"know");
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

/* Where `make web` puts the viewer, and `make install` (ECO_VIEWER_INSTALLED, from the Makefile). */
static enum eco_code read_site(struct srv_site *site, struct eco_error *error)
{
	static const char *const places[] = { "/web/site", "/" ECO_VIEWER_INSTALLED, NULL };
	char path[PATH_MAX];
	*site = (struct srv_site){ .count = 0 };
	if (given.viewer) {
		enum eco_code code = srv_site_read(site, given.viewer, error);
		return code || srv_site_find(site, SRV_SITE_INDEX) ? code : eco_fail(error, ECO_NOT_FOUND,
			"--viewer %s: no viewer there; `make web` makes one", given.viewer);
	}
	return eco_data_path(places, "", path) ? srv_site_read(site, path, error) : ECO_OK;
}

static enum eco_code check_sandbox(struct eco_error *error)
{
	struct srv_user user;
	if (given.without_sandbox && (given.require_sandbox || given.user))
		return eco_fail(error, ECO_BAD_USAGE, "--no-sandbox and --%s exclude each other: leave one out",
			given.user ? "user" : "require-sandbox");
	return given.without_sandbox ? ECO_OK : srv_user_find(&user, given.user, error);
}

static enum eco_code enter_sandbox(const struct srv_store *store, struct eco_error *error)
{
	struct srv_user user;
	enum eco_code code = given.without_sandbox ? ECO_OK : srv_user_find(&user, given.user, error);
	return code || given.without_sandbox ? code : srv_sandbox_enter(&(struct srv_sandbox){
		.sources = given.config.sources, .store = store, .user = &user,
		.log_form = (enum srv_log_form)given.config.log_form, .required = given.require_sandbox }, error);
}

/* The daemon shares the scenes: `store` lets go of them, so that none stays that a reload replaced. */
static enum eco_code serve_scenes(struct srv_store *store, const sigset_t *signals, struct eco_error *error)
{
	struct srv_daemon *daemon;
	struct srv_endpoint endpoint;
	char what[NI_MAXHOST + 40];
	enum eco_code code = srv_endpoint_take(&endpoint, given.config.listen, error);
	code = code ? code : enter_sandbox(store, error);
	if (!code)
		srv_typical_find_all(store, NULL);       /* a signal may end it here */
	sigprocmask(SIG_BLOCK, signals, NULL);
	given.config.endpoint = &endpoint;
	code = code ? code : srv_daemon_start(&daemon, &given.config, store, error);
	if (code)
		return code;
	snprintf(what, sizeof what, "ready on %s", srv_daemon_url(daemon));
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
	const struct srv_sources sources = { given.scenes.names, given.scenes.count, copies_folder(), NULL };
	const sigset_t signals = prepare_signals();
	raise_descriptors(given.config.connections_max);
	given.config.site = &site;
	given.config.access = &given.access;
	given.config.caps = &given.caps;
	given.config.sources = &sources;
	srv_store_init(&store);
	enum eco_code code = read_site(&site, error);
	code = code ? code : srv_trace_set(getenv("ECO_TRACE"), error);
	code = code ? code : srv_endpoint_check(given.config.listen, error);
	code = code ? code : check_sandbox(error);
	code = code ? code : srv_sources_load(&sources, NULL, &store, &report, error);
	if (!code && report.bad)
		code = tell_bad(&report, error);
	given.config.bad_packs = report.bad;
	code = code ? code : srv_access_check(&given.access, &store, &sources, NULL, error);
	code = code ? code : srv_caps_check(&given.caps, &store, &sources, error);
	if (!code)
		code = given.only_check ? announce("the configuration is good", &store, "", error)
			: serve_scenes(&store, &signals, error);
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
	srv_log_flush();
	return json ? eco_exit_status(code) : eco_command_end(&command, code, &(struct eco_error){ 0 });
}

int main(int argc, char **argv)
{
	struct eco_error error = { 0 };
	struct eco_arguments arguments = { 0 };
	const char *file = find_option("--config", getenv(ENVIRONMENT "CONFIG"), argc - 1, argv + 1);
	const struct eco_settings settings = { file, ENVIRONMENT, "pack" };
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
