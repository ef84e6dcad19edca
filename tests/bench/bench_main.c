/* The command line of ecobench. Every section runs even if one before it fails. */
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "ecofiles/base/options.h"
#include "tests/bench/bench_state.h"

#define EXIT_INTERRUPTED 130
#define SECTIONS_MAX 64u

static struct arguments {
	struct bench bench;
	const struct bench_section *const *sections;         /* NULL ends */
	bool asked[SECTIONS_MAX], some;      /* --only; all sections without */
	const char *out, *cache;
	bool list;
} given;
static struct bench_state state;

static void print_list(void)
{
	for (const struct bench_section *const *s = given.sections; *s; s++) {
		char path[1024];
		const char *done = "-";
		snprintf(path, sizeof path, "%s/sections/%s.json", given.bench.cache, (*s)->name);
		json_t *record = bench_json_read(path);
		json_unpack(record, "{s:s}", "state", &done);
		printf("%-12s %-12s %s\n", (*s)->name, done, (*s)->title);
		json_decref(record);
	}
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

static int run_sections(struct bench *bench)
{
	int failed = 0;
	for (uint32_t i = 0; given.sections[i] && !bench_stopped(bench); i++) {
		struct eco_error error = { 0 }, why = { 0 };
		if (given.some && !given.asked[i])
			continue;
		bench_begin(bench, given.sections[i]);
		enum eco_code code = bench_end(bench, given.sections[i]->run(bench, &error), &error);
		failed |= code && code != ECO_INTERRUPTED;
		if (bench_report_write(bench, given.sections, &why))
			bench_note(bench, "%s", why.text);
	}
	return bench_stopped(bench) ? EXIT_INTERRUPTED : failed;
}

/* ---- The command line ---- */

static enum eco_code read_only(const char *text, void *value, struct eco_error *error)
{
	char words[1024], *rest = words;
	(void)value;
	snprintf(words, sizeof words, "%s", text);
	for (char *word; (word = strsep(&rest, ","));) {
		uint32_t i = 0;
		while (given.sections[i] && strcmp(given.sections[i]->name, word))
			i++;
		if (!given.sections[i])
			return eco_fail(error, ECO_BAD_USAGE, "no section is called %s; --list names them",
				word);
		given.asked[i] = given.some = true;
	}
	return ECO_OK;
}

static const struct eco_option options[] = {
	{ "full", 0, ECO_OPTION_FLAG, NULL, &given.bench.full,
		.help = "all methods, scenes and frames; else fewer of them, and the same keys" },
	{ "data", 0, ECO_OPTION_TEXT, "DIR", &given.bench.data,
		.help =
		"a folder with models/, inventories/ and terrain/; generated plants and scenes only without"
		},
	{ "out", 0, ECO_OPTION_TEXT, "DIR", &given.out,
		.help =
		"tables (CSV), plots, report.html, papers.html and summary.json; BUILD/bench if not given" },
	{ "cache", 0, ECO_OPTION_TEXT, "DIR", &given.cache,
		.help = "scenes, packs and finished pieces of work; OUT/cache if not given" },
	{ "build", 0, ECO_OPTION_TEXT, "DIR", &given.bench.build, .help =
	"folder of the programs; build if not given" },
	{ "only", 0, ECO_OPTION_READ, "SECTION", &given, .read = read_only,
		.help =
		"runs this section, or several (with commas, or the option again); the report keeps earlier "
		"results of the others" },
	{ "trust", 0, ECO_OPTION_FLAG, NULL, &state.trust,
		.help = "takes pieces of work that another build of ecobench did" },
	{ "list", 0, ECO_OPTION_FLAG, NULL, &given.list,
		.help = "names sections and their state" },
	{ "quiet", 'q', ECO_OPTION_FLAG, NULL, &state.quiet, .help = "no progress" }, { 0 } };

static const struct eco_command command = { .name = "ecobench", .options = options,
	.synopsis = "[--full] [--data DIR] [--out DIR] [--cache DIR] [--build DIR] [--only SECTION]... "
	"[--trust] [--list]",
	.says = "Error against run time of the methods of the literature and ours, on the same scenes.",
	.notes =
	"Ctrl-C finishes the piece of work at hand, writes the report and ends with status 130; the next run "
	"goes on from there.\n" };

static enum eco_code run(struct bench *bench, int *status, struct eco_error *error)
{
	if (given.list) {
		print_list();
		return ECO_OK;
	}
	enum eco_code code = check_folders(bench, error);
	if (!code)
		code = bench_open(bench, error);
	if (code)
		return code;
	bench_catch_interrupts();
	*status = run_sections(bench);
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
	given = (struct arguments){ .bench = { .build = "build", .out = out, .cache = cache, .state =
		&state }, .sections = sections };
	if (eco_command_answers(&command, argc - 1, argv + 1))
		return eco_command_end(&command, ECO_OK, &error);
	enum eco_code code = eco_command_read(&command, argc - 1, argv + 1, &error);
	if (bench->data && !*bench->data)
		bench->data = NULL;
	snprintf(out, sizeof out, "%s%s", given.out ? given.out : bench->build, given.out ? "" : "/bench");
	snprintf(cache, sizeof cache, "%s%s", given.cache ? given.cache : out, given.cache ? "" : "/cache");
	if (!code)
		code = run(bench, &status, &error);
	int ended = eco_command_end(&command, code, &error);
	return ended ? ended : status;
}
