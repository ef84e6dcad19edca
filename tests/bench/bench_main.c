/* The command line of ecobench. Every section runs even if one before it fails. */
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "ecofiles/base/options.h"
#include "tests/bench/bench_state.h"

#define EXIT_INTERRUPTED 130
#define JOBS_MAX 16u

/* What each section took: work that earlier runs did counts, work that two sections share counts in both. */
static void print_list(const struct bench *bench, const struct bench_section *const *sections)
{
	printf("%-12s %-12s %11s %11s\n", "section", "state", "processor s", "longest");
	for (; *sections; sections++) {
		char path[1024];
		snprintf(path, sizeof path, "%s/sections/%s.json", bench->cache, (*sections)->name);
		json_t *record = bench_json_read(path);
		const char *state = json_string_value(json_object_get(record, "state"));
		printf("%-12s %-12s %11.0f %11.0f  %s\n", (*sections)->name, state ? state : "-",
			json_number_value(json_object_get(record, "units_cpu_s")),
			json_number_value(json_object_get(record, "longest_cpu_s")), (*sections)->title);
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

static enum eco_code check_words(const char *words, const struct bench_section *const *sections,
	struct eco_error *error)
{
	for (const char *at = words; *at; at += strcspn(at, ",") + (at[strcspn(at, ",")] == ',')) {
		char name[64];
		const struct bench_section *const *s = sections;
		snprintf(name, sizeof name, "%.*s", (int)strcspn(at, ","), at);
		while (*s && strcmp((*s)->name, name))
			s++;
		if (!*s)
			return eco_fail(error, ECO_BAD_USAGE, "no section is called %s; --list names them",
				name);
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
			return eco_fail(error, ECO_BAD_USAGE, "%s is not there: --data is a folder that "
				"holds models/ (and inventories/ and terrain/)", path);
	}
	snprintf(path, sizeof path, "%s/ecopack", bench->build);
	if (access(path, X_OK))
		return eco_fail(error, ECO_BAD_USAGE, "%s is not there: --build is the folder that make "
			"writes programs to", path);
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

/* Returns the exit status: 0, 1, or 130. */
static int run_sections(struct bench *bench, const struct bench_section *const *sections, const char *only,
	uint32_t jobs)
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

struct arguments { struct bench bench; const char *out, *cache; char only[1024]; uint64_t jobs; bool list; };

static struct arguments given;
static struct bench_state state;

static enum eco_code read_only(const char *text, void *value, struct eco_error *error)
{
	char *only = value;
	if (strlen(only) + strlen(text) + 2 > sizeof given.only)
		return eco_fail(error, ECO_BAD_USAGE, "--only: too many names");
	strcat(strcat(only, *only ? "," : ""), text);
	return ECO_OK;
}

static enum eco_code read_extreme(const char *text, void *value, struct eco_error *error)
{
	return text ? eco_fail(error, ECO_BAD_USAGE, "--extreme takes no value")
		: read_only("extreme", value, error);
}

static const struct eco_option options[] = {
	{ "full", 0, ECO_OPTION_FLAG, NULL, &given.bench.full, .help = "all methods, scenes and frames; "
		"else fewer of them, and the same keys" },
	{ "data", 0, ECO_OPTION_TEXT, "DIR", &given.bench.data,
		.help = "a folder with models/, inventories/ and terrain/; generated plants and scenes "
		"only, if not given" },
	{ "out", 0, ECO_OPTION_TEXT, "DIR", &given.out,
		.help = "tables (CSV), plots, report.html and summary.json; BUILD/bench if not given" },
	{ "cache", 0, ECO_OPTION_TEXT, "DIR", &given.cache, .help = "scenes, packs and finished pieces of "
		"work; OUT/cache if not given" },
	{ "build", 0, ECO_OPTION_TEXT, "DIR", &given.bench.build,
		.help = "where the programs are; build if not given" },
	{ "only", 0, ECO_OPTION_READ, "SECTION", given.only, .read = read_only,
		.help = "this one only, or these (commas, or said again); the report keeps what is known of "
		"the others" },
	{ "extreme", 0, ECO_OPTION_READ, NULL, given.only, .read = read_extreme, .has_optional_value = true,
		.help = "--only extreme: the cases at the edge of what numbers can say; status 1 if one "
		"does not hold" },
	{ "jobs", 0, ECO_OPTION_COUNT, "N", &given.jobs, 1, JOBS_MAX,
		.help = "sections that run at the same time, each in a process of its own; 1 if not given. "
		"Those that measure time run alone" },
	{ "trust", 0, ECO_OPTION_FLAG, NULL, &state.trust,
		.help = "pieces of work that another build of ecobench did are taken as they are" },
	{ "list", 0, ECO_OPTION_FLAG, NULL, &given.list, .help = "names of sections, which are finished, "
		"and the processor time that they and their longest piece of work took" },
	{ "quiet", 'q', ECO_OPTION_FLAG, NULL, &state.quiet, .help = "no progress" }, { 0 } };

static const struct eco_command command = { .name = "ecobench", .options = options,
	.synopsis = "[--full] [--data DIR] [--out DIR] [--cache DIR] [--build DIR] [--only SECTION]... "
	"[--extreme] [--jobs N] [--trust] [--list]",
	.says = "Error against run time of the methods of the literature and ours, on the same scenes.",
	.notes = "Ctrl-C finishes the piece of work that runs, writes the report of what is there and ends "
	"with status 130; run again, it goes on "
		"from there.\n" };

static enum eco_code run(const struct bench_section *const *sections, int *status, struct eco_error *error)
{
	struct bench *bench = &given.bench;
	if (given.list) {
		print_list(bench, sections);
		return ECO_OK;
	}
	enum eco_code code = check_words(given.only, sections, error);
	if (!code)
		code = check_folders(bench, error);
	if (!code)
		code = bench_open(bench, error);
	if (code)
		return code;
	bench_catch_interrupts();
	*status = run_sections(bench, sections, given.only, (uint32_t)given.jobs);
	bench_close(bench);
	fprintf(stderr, "ecobench: %s/report.html, %s/summary.json\n", bench->out, bench->out);
	return ECO_OK;
}

int bench_main(int argc, char **argv, const struct bench_section *const *sections)
{
	static char out[1000], cache[1008];
	struct bench *bench = &given.bench;
	struct eco_error error = { 0 };
	int status = 0;
	state = (struct bench_state){ 0 };
	given = (struct arguments){ .bench = { .build = "build", .out = out, .cache = cache,
		.state = &state }, .jobs = 1 };
	if (eco_command_answers(&command, argc - 1, argv + 1))
		return eco_command_end(&command, ECO_OK, &error);
	enum eco_code code = eco_command_read(&command, argc - 1, argv + 1, &error);
	if (bench->data && !*bench->data)
		bench->data = NULL;
	snprintf(out, sizeof out, "%s%s", given.out ? given.out : bench->build, given.out ? "" : "/bench");
	snprintf(cache, sizeof cache, "%s%s", given.cache ? given.cache : out, given.cache ? "" : "/cache");
	if (!code)
		code = run(sections, &status, &error);
	int ended = eco_command_end(&command, code, &error);
	return ended ? ended : status;
}
