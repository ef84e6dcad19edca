/* ecoserve: serves packs over HTTP until SIGTERM or SIGINT, then finishes what runs; a second signal ends at
 * once. */
#include <malloc.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

#include "ecofiles/base/options.h"
#include "server/daemon.h"
#include "server/site.h"
#include "server/trace.h"

#define NAMES_SHOWN 8u
/* Freed memory that a thread keeps: a plan needs a few MB, and to get them anew from the kernel, page by
 * page, took 6 % of its time. */
#define KEPT_BYTES (4 << 20)
#define DRAIN_MS 10000u
#define DRAIN_ROUND_MS 20u
#define DESCRIPTORS_BESIDE (SRV_SCENES_MAX + 100u)

static struct {
	struct srv_config config;
	struct eco_inputs scenes;
	const char *copies, *viewer;
	bool in_place;
} given;

static enum eco_code read_networks(const char *text, void *networks, struct eco_error *error)
{
	return srv_networks_parse(networks, text, error);
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

static const struct eco_option options[] = {
	{ "a pack", 0, ECO_OPTION_INPUTS, "[NAME=]OUT.eco", &given.scenes, .is_required = true,
		.help = "a scene under /v1/scenes/NAME; without NAME= it is the scene's own name where that "
		"is a word of a-z, 0-9, '_' and '-', else "
		"the file's, in small letters and with '-' for all else" },
	{ "listen", 'l', ECO_OPTION_TEXT, "HOST:PORT", &given.config.listen,
		.help = "where to listen; port 0 takes any free one; " SRV_LISTEN_DEFAULT " if not given" },
	{ "copies", 0, ECO_OPTION_TEXT, "DIR", &given.copies,
		.help = "where private copies of the packs lie while they are served, so that nobody changes "
		"them; they take as much room as the packs and go with the process; $TMPDIR or /var/tmp if "
		"not given" },
	{ "in-place", 0, ECO_OPTION_FLAG, NULL, &given.in_place,
		.help = "serve the files themselves, for packs that nobody writes over: no room, no time to "
		"copy, and memory shared with other servers" },
	{ "connections", 0, ECO_OPTION_COUNT, "N", &given.config.connections_max, 1, 100000,
		.help = "at once; where all are taken, one that only waits gives way; 1000 if not given" },
	{ "connections-per-address", 0, ECO_OPTION_COUNT, "N", &given.config.connections_per_address,
		1, 100000, .help = "of them from one address, or from one IPv6 /64; 128 if not given" },
	{ "plans", 0, ECO_OPTION_COUNT, "N", &given.config.queue_max, 1, 100000,
		.help = "that may wait for a thread; 64 if not given" },
	{ "plans-per-address", 0, ECO_OPTION_COUNT, "N", &given.config.queue_share_max, 1, 100000,
		.help = "of them for one address; addresses are served in turn; 32 if not given" },
	{ "plan-work", 0, ECO_OPTION_COUNT, "N", &given.config.plan_times, 1, 1000,
		.help = "what planning a request may cost, counted in ordinary plans of its scene; it ends "
		"there with what it has, which is the same on every machine; 3 if not given" },
	{ "trust-proxy", 0, ECO_OPTION_READ, "ADDRESS[/BITS],...", &given.config.trusted,
		.read = read_networks, .help = "proxies that may open any number of connections, and whose "
		"X-Forwarded-For says who asks" },
	{ "viewer", 0, ECO_OPTION_TEXT, "DIR", &given.viewer,
		.help = "what / shows in a browser: the folder that `make web` makes; web/site beside this "
		"program if not given" },
	{ "log", 0, ECO_OPTION_FLAG, NULL, &given.config.log, .help = "one line a request on stderr" },
	{ 0 } };

static const struct eco_command command = { .name = "ecoserve", .synopsis = "[--listen HOST:PORT] [OPTIONS] "
	"[NAME=]OUT.eco ...",
	.says = "Serves packs made by ecopack over HTTP.", .options = options,
	.notes = "Prints one line when ready, with the names. SIGTERM and SIGINT finish running answers "
	"(for at most 10 s) and end; a second one "
		"ends at once. SIGHUP changes nothing.\n"
		"A new pack in place of one that is served is seen when ecoserve starts again.\n"
		"ECO_TRACE=plan,cuts,cache,connection prints on stderr why things are as they are.\n" };

/* "NAME=FILE" or "FILE"; a '=' behind a '/' belongs to the file. */
static enum eco_code add_scene(struct srv_store *store, const char *argument, struct eco_error *error)
{
	const char *equals = strchr(argument, '='), *slash = strchr(argument, '/');
	char name[SRV_NAME_BYTES + 1];
	if (!equals || (slash && slash < equals))
		return srv_store_add(store, NULL, argument, error);
	snprintf(name, sizeof name, "%.*s", (int)(equals - argument), argument);
	return srv_store_add(store, name, equals + 1, error);
}

static enum eco_code announce(const struct srv_daemon *daemon, const struct srv_store *store,
	struct eco_error *error)
{
	bool bad = printf("ecoserve: ready on %s (%u scene%s", srv_daemon_url(daemon), store->count,
		store->count == 1 ? "" : "s") < 0;
	for (uint32_t i = 0; i < store->count && i < NAMES_SHOWN; i++)
		bad |= printf("%s%s", i ? ", " : " named ", store->scenes[i]->name) < 0;
	if (printf("%s)\n", store->count > NAMES_SHOWN ? ", ..." : "") < 0 || fflush(stdout) || bad)
		return eco_fail(error, ECO_IO, "cannot write to stdout: who started this does not want to "
			"know");
	return ECO_OK;
}

/* Signals stay blocked in all threads and are taken here, one after the other: no handler, no race. */
static void serve(struct srv_daemon *daemon, const sigset_t *signals)
{
	const struct timespec pause = { 0, DRAIN_ROUND_MS * 1000000L };
	for (int number; (number = sigwaitinfo(signals, NULL)) < 0 || number == SIGHUP;)
		if (number == SIGHUP)
			fputs("ecoserve: SIGHUP changes nothing: start again to serve other packs\n", stderr);
	srv_daemon_quiesce(daemon);
	for (uint32_t waited = 0; srv_daemon_busy(daemon) && waited < DRAIN_MS; waited += DRAIN_ROUND_MS) {
		int number = sigtimedwait(signals, NULL, &pause);
		if (number == SIGTERM || number == SIGINT)
			_exit(1);
	}
	srv_daemon_stop(daemon);
}

/* A pack that is served in place and cut short, or a disk that fails, is met here, wherever that is. Nothing
 * can be trusted then. */
static void pack_is_gone(int number)
{
	static const char text[] = "ecoserve: a pack was cut short while it was served, or its disk failed "
		"(SIGBUS): start ecoserve again. With --in-place put a new pack in place by renaming it (mv, "
		"or ecopack make), not by writing over the old one (cp)\n";
	(void)number;
	_exit(write(STDERR_FILENO, text, sizeof text - 1) < 0 ? 3 : 1);
}

static const char *copies_folder(void)
{
	const char *folder = given.copies ? given.copies : getenv("TMPDIR");
	return given.in_place ? NULL : folder && *folder ? folder : "/var/tmp";
}

/* web/site beside this program, where `make web` puts it. */
static enum eco_code read_site(struct srv_site *site, struct eco_error *error)
{
	static const char folder[] = "/web/site";
	char path[4096];
	if (given.viewer) {
		enum eco_code code = srv_site_read(site, given.viewer, error);
		return code || srv_site_find(site, SRV_SITE_INDEX) ? code : eco_fail(error, ECO_NOT_FOUND,
			"--viewer %s: no viewer there; `make web` makes one", given.viewer);
	}
	ssize_t size = readlink("/proc/self/exe", path, sizeof path - 1);
	char *slash = size > 0 ? memrchr(path, '/', (size_t)size) : NULL;
	*site = (struct srv_site){ .count = 0 };
	if (!slash || (size_t)(slash - path) + sizeof folder > sizeof path)
		return ECO_OK;
	memcpy(slash, folder, sizeof folder);
	return srv_site_read(site, path, error);
}

static enum eco_code run(struct eco_error *error)
{
	struct srv_store store;
	struct srv_site site;
	struct srv_daemon *daemon = NULL;
	sigset_t signals;
	signal(SIGPIPE, SIG_IGN);
	signal(SIGBUS, pack_is_gone);
	sigemptyset(&signals);
	sigaddset(&signals, SIGTERM);
	sigaddset(&signals, SIGINT);
	sigaddset(&signals, SIGHUP);
	raise_descriptors(given.config.connections_max);
	srv_store_init(&store);
	store.copies = copies_folder();
	enum eco_code code = read_site(&site, error);
	given.config.site = &site;
	if (!code)
		code = srv_trace_set(getenv("ECO_TRACE"), error);
	for (uint32_t i = 0; i < given.scenes.count && !code; i++)
		code = add_scene(&store, given.scenes.names[i], error);
	if (!code) {
		sigprocmask(SIG_BLOCK, &signals, NULL);
		code = srv_daemon_start(&daemon, &given.config, &store, error);
	}
	if (!code)
		code = announce(daemon, &store, error);
	if (!code)
		serve(daemon, &signals);
	else
		srv_daemon_stop(daemon);
	srv_store_free(&store);
	srv_site_free(&site);
	return code;
}

int main(int argc, char **argv)
{
	struct eco_error error = { 0 };
	mallopt(M_TRIM_THRESHOLD, KEPT_BYTES);
	mallopt(M_MMAP_THRESHOLD, KEPT_BYTES);
	if (eco_command_answers(&command, argc - 1, argv + 1))
		return eco_command_end(&command, ECO_OK, &error);
	enum eco_code code = eco_command_read(&command, argc - 1, argv + 1, &error);
	if (!code)
		code = run(&error);
	return eco_command_end(&command, code, &error);
}
