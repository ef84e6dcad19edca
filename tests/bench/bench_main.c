/* The command line of ecobench. Every section runs even if one before it fails. */
#include <getopt.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "tests/bench/bench_state.h"

#define EXIT_INTERRUPTED 130
#define JOBS_MAX 16u

static void print_help(FILE *out)
{
	fputs("ecobench [--full] [--data DIR] [--out DIR] [--cache DIR] [--build DIR] [--only SECTION]... [--extreme] [--jobs N] [--trust] [--list]\n"
		"      error against run time of the methods of the literature and ours, on the same scenes\n"
		"\n"
		"      --full          all methods, scenes and frames; else fewer of them, and the same keys\n"
		"      --data DIR      a folder with models/, inventories/ and terrain/; generated plants and scenes only, if not given\n"
		"      --out DIR       tables (CSV), plots, report.html and summary.json; BUILD/bench if not given\n"
		"      --cache DIR     scenes, packs and finished pieces of work; OUT/cache if not given\n"
		"      --build DIR     where the programs are; build if not given\n"
		"      --only SECTION  this one only, or these (commas, or said again); the report keeps what is known of the others\n"
		"      --extreme       --only extreme: the cases at the edge of what numbers can say; status 1 if one does not hold\n"
		"      --jobs N        sections that run at the same time, each in a process of its own; 1 if not given. Those that measure time run alone\n"
		"      --trust         pieces of work that another build of ecobench did are taken as they are\n"
		"      --list          names of sections, and which are finished\n"
		"      --quiet         no progress\n"
		"\n"
		"Ctrl-C finishes the piece of work that runs and writes the report of what is there; run again, it goes on from there.\n"
		"\n"
		"Exit status: 0 done, 1 a section failed, 2 wrong usage, 130 interrupted.\n", out);
}

static void print_list(const struct bench *bench, const struct bench_section *const *sections)
{
	for (; *sections; sections++) {
		char path[1024];
		snprintf(path, sizeof path, "%s/sections/%s.json", bench->cache, (*sections)->name);
		json_t *record = bench_json_read(path);
		const char *state = json_string_value(json_object_get(record, "state"));
		printf("%-12s %-12s %s\n", (*sections)->name, state ? state : "-", (*sections)->title);
		json_decref(record);
	}
}

/* Whether `name` is one of the words that stand between commas. */
static bool has_word(const char *words, const char *name)
{
	size_t size = strlen(name);
	for (const char *at = words; *at; at += strcspn(at, ",") + (at[strcspn(at, ",")] == ','))
		if (strcspn(at, ",") == size && !strncmp(at, name, size))
			return true;
	return false;
}

static enum eco_code check_words(const char *words, const struct bench_section *const *sections, struct eco_error *error)
{
	for (const char *at = words; *at; at += strcspn(at, ",") + (at[strcspn(at, ",")] == ',')) {
		char name[64];
		const struct bench_section *const *s = sections;
		snprintf(name, sizeof name, "%.*s", (int)strcspn(at, ","), at);
		while (*s && strcmp((*s)->name, name))
			s++;
		if (!*s)
			return eco_fail(error, ECO_BAD_USAGE, "no section is called %s; --list names them", name);
	}
	return ECO_OK;
}

static enum eco_code check_folders(const struct bench *bench, struct eco_error *error)
{
	char path[1024];
	struct stat status;
	if (bench->data) {
		snprintf(path, sizeof path, "%s/models", bench->data);
		if (stat(path, &status) || !S_ISDIR(status.st_mode))
			return eco_fail(error, ECO_BAD_USAGE, "%s is not there: --data is a folder that holds models/ (and inventories/ and terrain/)", path);
	}
	snprintf(path, sizeof path, "%s/ecopack", bench->build);
	if (access(path, X_OK))
		return eco_fail(error, ECO_BAD_USAGE, "%s is not there: --build is the folder that make writes programs to", path);
	return ECO_OK;
}

/* ---- Sections, one after the other or some at a time ---- */

static int run_one(struct bench *bench, const struct bench_section *section)
{
	struct eco_error error = { 0 };
	bench_begin(bench, section);
	enum eco_code code = bench_end(bench, section->run(bench, &error), &error);
	return code && code != ECO_INTERRUPTED;
}

struct run {                             /* of all sections that were asked for */
	struct bench *bench;
	const struct bench_section *const *sections;
	struct worker { pid_t pid; const struct bench_section *section; } workers[JOBS_MAX];
	uint32_t jobs, running;
	int exit_status;
};

static void write_report(struct run *run)
{
	struct eco_error why = { 0 };
	if (!bench_report_write(run->bench, run->sections, &why))
		return;
	fprintf(stderr, "ecobench: %s\n", why.text);
	run->exit_status = 1;
}

/* In a process of its own, so that a section that crashes takes no other with it. */
static void start(struct run *run, const struct bench_section *section)
{
	fflush(NULL);
	pid_t pid = fork();
	if (pid == 0) {
		int status = run_one(run->bench, section);
		fflush(NULL);
		_exit(status);
	}
	if (pid < 0)
		run->exit_status = 1;
	else
		run->workers[run->running++] = (struct worker){ pid, section };
}

/* Until fewer than `most` run. A signal that comes to this process alone is passed on. */
static void wait_for(struct run *run, uint32_t most)
{
	bool told = false;
	while (run->running > 0 && run->running >= most) {
		int status;
		for (uint32_t i = 0; i < run->running && bench_stopped(run->bench) && !told; i++)
			kill(run->workers[i].pid, SIGTERM);
		told = told || bench_stopped(run->bench);
		uint32_t i = 0;
		while (i < run->running && waitpid(run->workers[i].pid, &status, WNOHANG) == 0)
			i++;
		if (i == run->running) {
			nanosleep(&(struct timespec){ 0, 50000000 }, NULL);
			continue;
		}
		if (!WIFEXITED(status) || WEXITSTATUS(status) > 1)
			bench_lost(run->bench, run->workers[i].section, status);
		if (!WIFEXITED(status) || WEXITSTATUS(status))
			run->exit_status = 1;
		run->workers[i] = run->workers[--run->running];
		write_report(run);
	}
}

/* What it comes to: 0, 1, or 130. */
static int run_sections(struct bench *bench, const struct bench_section *const *sections, const char *only, uint32_t jobs)
{
	struct run run = { .bench = bench, .sections = sections, .jobs = jobs };
	for (const struct bench_section *const *s = sections; *s && !bench_stopped(bench); s++) {
		if (*only && !has_word(only, (*s)->name))
			continue;
		if (jobs == 1) {
			run.exit_status |= run_one(bench, *s);
			write_report(&run);
			continue;
		}
		wait_for(&run, (*s)->alone ? 1 : jobs);
		if (bench_stopped(bench))
			break;
		start(&run, *s);
		wait_for(&run, (*s)->alone ? 1 : jobs);
	}
	wait_for(&run, 1);
	return bench_interrupted() ? EXIT_INTERRUPTED : run.exit_status;
}

/* ---- The command line ---- */

struct arguments { const char *out, *cache; char only[1024]; uint32_t jobs; bool list, help; };

static enum eco_code read_arguments(int argc, char **argv, struct bench *bench, struct arguments *a, struct eco_error *error)
{
	enum { FULL = 256, DATA, OUT, CACHE, BUILD, ONLY, EXTREME, JOBS, TRUST, LIST, QUIET, HELP };
	static const struct option options[] = { { "full", 0, NULL, FULL }, { "data", 1, NULL, DATA }, { "out", 1, NULL, OUT },
		{ "cache", 1, NULL, CACHE }, { "build", 1, NULL, BUILD }, { "only", 1, NULL, ONLY },
		{ "extreme", 0, NULL, EXTREME }, { "jobs", 1, NULL, JOBS },
		{ "trust", 0, NULL, TRUST }, { "list", 0, NULL, LIST }, { "quiet", 0, NULL, QUIET }, { "help", 0, NULL, HELP }, { 0 } };
	char *end;
	for (int c; (c = getopt_long(argc, argv, "", options, NULL)) != -1;)
		switch (c) {
		case FULL: bench->full = true; break;
		case DATA: bench->data = *optarg ? optarg : NULL; break;
		case OUT: a->out = optarg; break;
		case CACHE: a->cache = optarg; break;
		case BUILD: bench->build = optarg; break;
		case EXTREME: optarg = "extreme"; /* fall through */
		case ONLY:
			if (strlen(a->only) + strlen(optarg) + 2 > sizeof a->only)
				return eco_fail(error, ECO_BAD_USAGE, "--only: too many names");
			strcat(strcat(a->only, *a->only ? "," : ""), optarg);
			break;
		case JOBS:
			a->jobs = (uint32_t)strtoul(optarg, &end, 10);
			if (*end || a->jobs < 1 || a->jobs > JOBS_MAX)
				return eco_fail(error, ECO_BAD_USAGE, "--jobs %s: 1 to %u sections can run at the same time", optarg, JOBS_MAX);
			break;
		case TRUST: bench->state->trust = true; break;
		case LIST: a->list = true; break;
		case QUIET: bench->state->quiet = true; break;
		case HELP: a->help = true; break;
		default: return eco_fail(error, ECO_BAD_USAGE, "see ecobench --help");
		}
	if (optind < argc)
		return eco_fail(error, ECO_BAD_USAGE, "what is %s? ecobench takes options only: see ecobench --help", argv[optind]);
	return ECO_OK;
}

static int fail(const struct eco_error *error)
{
	fprintf(stderr, "ecobench: %s\n", error->text);
	return eco_exit_status(error->code);
}

int bench_main(int argc, char **argv, const struct bench_section *const *sections)
{
	static struct bench_state state;
	static char out[1000], cache[1008];
	struct bench bench = { .build = "build", .out = out, .cache = cache, .state = &state };
	struct arguments a = { .jobs = 1 };
	struct eco_error error = { 0 };
	optind = 0;
	if (read_arguments(argc, argv, &bench, &a, &error))
		return fail(&error);
	if (a.help) {
		print_help(stdout);
		return 0;
	}
	snprintf(out, sizeof out, "%s%s", a.out ? a.out : bench.build, a.out ? "" : "/bench");
	snprintf(cache, sizeof cache, "%s%s", a.cache ? a.cache : out, a.cache ? "" : "/cache");
	if (a.list) {
		print_list(&bench, sections);
		return 0;
	}
	if (check_words(a.only, sections, &error) || check_folders(&bench, &error) || bench_open(&bench, &error))
		return fail(&error);
	bench_catch_interrupts();
	int status = run_sections(&bench, sections, a.only, a.jobs);
	bench_close(&bench);
	fprintf(stderr, "ecobench: %s/report.html, %s/summary.json\n", out, out);
	return status;
}
