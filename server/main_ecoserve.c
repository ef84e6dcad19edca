/* ecoserve: serves packs over HTTP until SIGTERM or SIGINT, then finishes what runs; a second signal ends at once. */
#include <getopt.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "server/daemon.h"
#include "server/trace.h"
#include "server/version.h"

#define NAMES_SHOWN 8u
#define DRAIN_MS 10000u
#define DRAIN_ROUND_MS 20u

static const char usage[] =
	"usage: ecoserve [--listen HOST:PORT] [--log] [NAME=]OUT.eco ...\n"
	"\n"
	"Serves packs made by ecopack. Each is a scene under /v1/scenes/NAME; without NAME= it is the scene's own name where that is\n"
	"a word of a-z, 0-9, '_' and '-', else the file's, in small letters and with '-' for all else.\n"
	"\n"
	"  -l, --listen HOST:PORT  where to listen; port 0 takes any free one (" SRV_LISTEN_DEFAULT ")\n"
	"      --log               one line a request on stderr\n"
	"  -h, --help              this text\n"
	"  -V, --version           the version\n"
	"\n"
	"Prints one line when ready, with the names. SIGTERM and SIGINT finish running answers (for at most 10 s) and end; a\n"
	"second one ends at once.\n"
	"Put a new pack in place of one that is served by renaming it, as ecopack does, and start again.\n"
	"ECO_TRACE=plan,cuts,cache,connection prints on stderr why things are as they are.\n"
	"Exit status: 0 ended as asked, 1 failed, 2 wrong usage.\n";

enum { OPTION_LOG = 256 };

static const struct option options[] = {
	{ "listen", required_argument, NULL, 'l' },
	{ "log", no_argument, NULL, OPTION_LOG },
	{ "help", no_argument, NULL, 'h' },
	{ "version", no_argument, NULL, 'V' },
	{ NULL, 0, NULL, 0 },
};

static int fail(const struct eco_error *error)
{
	fprintf(stderr, "ecoserve: %s\n", error->text);
	return eco_exit_status(error->code);
}

static int print(const char *text)
{
	if (fputs(text, stdout) >= 0 && fflush(stdout) == 0)
		return 0;
	fputs("ecoserve: cannot write to stdout\n", stderr);
	return 1;
}

static int wrong_usage(const char *text)
{
	fprintf(stderr, "ecoserve: %s\nTry 'ecoserve --help'.\n", text);
	return 2;
}

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

static enum eco_code announce(const struct srv_daemon *daemon, const struct srv_store *store, struct eco_error *error)
{
	bool bad = printf("ecoserve: ready on %s (%u scene%s", srv_daemon_url(daemon), store->count, store->count == 1 ? "" : "s") < 0;
	for (uint32_t i = 0; i < store->count && i < NAMES_SHOWN; i++)
		bad |= printf("%s%s", i ? ", " : " named ", store->scenes[i].name) < 0;
	if (printf("%s)\n", store->count > NAMES_SHOWN ? ", ..." : "") < 0 || fflush(stdout) || bad)
		return eco_fail(error, ECO_IO, "cannot write to stdout: who started this does not want to know");
	return ECO_OK;
}

/* Signals stay blocked in all threads and are taken here, one after the other: no handler, no race. */
static void serve(struct srv_daemon *daemon, const sigset_t *signals)
{
	const struct timespec pause = { 0, DRAIN_ROUND_MS * 1000000L };
	while (sigwaitinfo(signals, NULL) < 0)
		continue;
	srv_daemon_quiesce(daemon);
	for (uint32_t waited = 0; srv_daemon_busy(daemon) && waited < DRAIN_MS; waited += DRAIN_ROUND_MS)
		if (sigtimedwait(signals, NULL, &pause) > 0)
			_exit(1);
	srv_daemon_stop(daemon);
}

/* Packs are mapped: one that is cut short, or a disk that fails, is met here, wherever that is. Nothing can be trusted then. */
static void pack_is_gone(int number)
{
	static const char text[] = "ecoserve: a pack was cut short while it was served, or its disk failed (SIGBUS): start ecoserve again. Put a new "
		"pack in place by renaming it (mv, or ecopack make), not by writing over the old one (cp)\n";
	(void)number;
	_exit(write(STDERR_FILENO, text, sizeof text - 1) < 0 ? 3 : 1);
}

static int run(struct srv_config *config, char **arguments, int count)
{
	struct eco_error error = { 0 };
	struct srv_store store;
	struct srv_daemon *daemon = NULL;
	sigset_t signals;
	signal(SIGPIPE, SIG_IGN);
	signal(SIGBUS, pack_is_gone);
	sigemptyset(&signals);
	sigaddset(&signals, SIGTERM);
	sigaddset(&signals, SIGINT);
	srv_store_init(&store);
	enum eco_code code = srv_trace_set(getenv("ECO_TRACE"), &error);
	for (int i = 0; i < count && !code; i++)
		code = add_scene(&store, arguments[i], &error);
	if (!code) {
		sigprocmask(SIG_BLOCK, &signals, NULL);
		code = srv_daemon_start(&daemon, config, &store, &error);
	}
	if (!code)
		code = announce(daemon, &store, &error);
	if (!code)
		serve(daemon, &signals);
	else
		srv_daemon_stop(daemon);
	srv_store_free(&store);
	return code ? fail(&error) : 0;
}

int main(int argc, char **argv)
{
	struct srv_config config = { 0 };
	for (int option; (option = getopt_long(argc, argv, "l:hV", options, NULL)) != -1;)
		switch (option) {
		case 'l':
			config.listen = optarg;
			break;
		case OPTION_LOG:
			config.log = true;
			break;
		case 'h':
			return print(usage);
		case 'V':
			return print(SRV_VERSION "\n");
		default:
			fputs("Try 'ecoserve --help'.\n", stderr);
			return 2;
		}
	if (optind == argc)
		return wrong_usage("no scene to serve: name at least one OUT.eco");
	return run(&config, argv + optind, argc - optind);
}
