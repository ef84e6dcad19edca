/* ecopack: the command line. */
#include <getopt.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/generate.h"
#include "ecofiles/main_inspect.h"
#include "ecofiles/main_make.h"
#include "ecofiles/main_progress.h"
#include "ecofiles/main_version.h"

static const char usage_text[] =
	"ecopack packs a scene (plants, positions, ground) into one file that ecoserve serves.\n"
	"\n"
	"  ecopack make SCENE.json -o OUT.eco [--order combined] [--jobs N] [--quiet]\n"
	"      builds a pack; every field of SCENE.json is described in ecofiles/README.md\n"
	"  ecopack info OUT.eco [--json]\n"
	"      says what is in a pack\n"
	"  ecopack verify OUT.eco\n"
	"      checks every byte of a pack and names what is damaged\n"
	"  ecopack generate NAME -o DIR [--plants N] [--seed S]\n"
	"      writes an example scene with models of its own into a folder, where files of the same names are replaced:\n";

static const char rest_text[] =
	"\n"
	"  -o, --output PATH   what to write: a pack, which appears complete or not at all and replaces nothing but a pack; a folder\n"
	"      --order NAME    priority order of leaves: combined (the default)\n"
	"      --jobs N        threads; as many as there are processors if not given\n"
	"      --plants N      about so many plants\n"
	"      --seed S        another scene of the same kind; 1 if not given\n"
	"      --quiet         no progress\n"
	"      --help, --version\n"
	"\n"
	"Exit status: 0 done, 1 failed, 2 wrong usage.\n";

struct arguments {
	const char *command, *input, *output, *order;
	uint64_t jobs, plants, seed;
	bool json, help, version, quiet;
	bool has_jobs, has_plants, has_seed, has_order, has_output;
};

static void print_help(FILE *out)
{
	fputs(usage_text, out);
	for (const struct eco_generate_kind *k = eco_generate_kinds; k->name; k++)
		fprintf(out, "        %-8s %s (%u plants)\n", k->name, k->says, k->plants);
	fputs(rest_text, out);
}

static enum eco_code parse_number(const char *option, const char *text, uint64_t least, uint64_t most, uint64_t *value,
	struct eco_error *error)
{
	char *end;
	*value = strtoull(text, &end, 10);
	if (text[0] < '0' || text[0] > '9' || *end || *value < least || *value > most)
		return eco_fail(error, ECO_BAD_USAGE, "--%s %s: must be a whole number from %" PRIu64 " to %" PRIu64, option, text, least, most);
	return ECO_OK;
}

enum { OPTION_ORDER = 256, OPTION_JOBS, OPTION_PLANTS, OPTION_SEED, OPTION_JSON, OPTION_HELP, OPTION_VERSION, OPTION_QUIET };

static enum eco_code parse_option(struct arguments *a, int option, struct eco_error *error)
{
	switch (option) {
	case 'o': a->output = optarg; a->has_output = true; return ECO_OK;
	case OPTION_ORDER: a->order = optarg; a->has_order = true; return ECO_OK;
	case OPTION_JOBS: a->has_jobs = true; return parse_number("jobs", optarg, 1, 64, &a->jobs, error);
	case OPTION_PLANTS: a->has_plants = true; return parse_number("plants", optarg, 1, ECO_GENERATE_PLANTS_MAX, &a->plants, error);
	case OPTION_SEED: a->has_seed = true; return parse_number("seed", optarg, 0, UINT64_MAX, &a->seed, error);
	case OPTION_JSON: a->json = true; return ECO_OK;
	case 'h': case OPTION_HELP: a->help = true; return ECO_OK;
	case OPTION_VERSION: a->version = true; return ECO_OK;
	case 'q': case OPTION_QUIET: a->quiet = true; return ECO_OK;
	case ':': return eco_fail(error, ECO_BAD_USAGE, "%s: a value is missing after it", optopt < 256 ? (char[]){ '-', (char)optopt, 0 } : "an option");
	default: return eco_fail(error, ECO_BAD_USAGE, "there is no such option");
	}
}

static enum eco_code parse(struct arguments *a, int argc, char **argv, struct eco_error *error)
{
	static const struct option options[] = { { "output", required_argument, NULL, 'o' }, { "order", required_argument, NULL, OPTION_ORDER },
		{ "jobs", required_argument, NULL, OPTION_JOBS }, { "plants", required_argument, NULL, OPTION_PLANTS },
		{ "seed", required_argument, NULL, OPTION_SEED }, { "json", no_argument, NULL, OPTION_JSON },
		{ "help", no_argument, NULL, OPTION_HELP }, { "version", no_argument, NULL, OPTION_VERSION },
		{ "quiet", no_argument, NULL, OPTION_QUIET }, { NULL, 0, NULL, 0 } };
	int option;
	opterr = 0;
	*a = (struct arguments){ .seed = 1 };
	while ((option = getopt_long(argc, argv, ":o:hq", options, NULL)) != -1) {
		enum eco_code code = parse_option(a, option, error);
		if (option == '?' && code)
			snprintf(error->text, sizeof error->text, "%s: there is no such option", optopt ? (char[]){ '-', (char)optopt, 0 } : argv[optind - 1]);
		else if (option == ':' && code)
			snprintf(error->text, sizeof error->text, "%s: a value must follow it", argv[optind - 1]);
		if (code)
			return code;
	}
	a->command = optind < argc ? argv[optind++] : NULL;
	a->input = optind < argc ? argv[optind++] : NULL;
	return optind < argc ? eco_fail(error, ECO_BAD_USAGE, "%s: one argument too many", argv[optind]) : ECO_OK;
}

/* Options that a command does not have are mistakes, not noise. */
static enum eco_code check_options(const struct arguments *a, struct eco_error *error)
{
	bool make = !strcmp(a->command, "make"), info = !strcmp(a->command, "info"), generate = !strcmp(a->command, "generate");
	bool verify = !strcmp(a->command, "verify");
	if (!make && !info && !generate && !verify)
		return eco_fail(error, ECO_BAD_USAGE, "%s: the commands are make, info, verify and generate", a->command);
	if (!a->input)
		return eco_fail(error, ECO_BAD_USAGE, "ecopack %s: %s is missing", a->command,
			make ? "the scene file" : generate ? "the name of a scene" : "the pack");
	if ((make || generate) && !a->output)
		return eco_fail(error, ECO_BAD_USAGE, "ecopack %s: -o %s is missing", a->command, make ? "OUT.eco" : "DIR");
	struct { bool given, fits; const char *name; } given[] = { { a->has_output, make || generate, "-o" }, { a->has_order, make, "--order" },
		{ a->has_jobs, make, "--jobs" }, { a->has_plants, generate, "--plants" }, { a->has_seed, generate, "--seed" },
		{ a->json, info, "--json" } };
	for (size_t i = 0; i < sizeof given / sizeof *given; i++)
		if (given[i].given && !given[i].fits)
			return eco_fail(error, ECO_BAD_USAGE, "ecopack %s has no %s", a->command, given[i].name);
	if (a->order && strcmp(a->order, "combined") != 0)
		return eco_fail(error, ECO_BAD_USAGE, "--order %s: the only order is combined", a->order);
	return ECO_OK;
}

static bool generate_progress(void *ctx, const char *stage, double share)
{
	(void)ctx;
	return main_progress("generating", stage, share);
}

static enum eco_code run_make(const struct arguments *a, struct eco_error *error)
{
	enum eco_code code = make_pack(&(struct make_options){ .scene = a->input, .pack = a->output, .jobs = (uint32_t)a->jobs }, error);
	/* what was written is opened as any reader would */
	return code || a->quiet ? code : inspect_info(a->output, false, stdout, error);
}

static enum eco_code run_generate(const struct arguments *a, struct eco_error *error)
{
	enum eco_code code = eco_generate(&(struct eco_generate_options){ .name = a->input, .folder = a->output, .plants = (uint32_t)a->plants,
		.seed = a->seed, .progress = generate_progress }, error);
	main_progress_end();
	if (!code && !a->quiet)
		printf("%s/scene.json is ready: ecopack make %s/scene.json -o %s.eco\n", a->output, a->output, a->input);
	return code;
}

static enum eco_code run_verify(const struct arguments *a, struct eco_error *error)
{
	struct inspect_counts counts;
	enum eco_code code = inspect_verify(a->input, stdout, &counts, error);
	if (!code)
		printf("%s: all is well: %" PRIu64 " lists, %" PRIu64 " chunks, %" PRIu64 " primitives\n", a->input, counts.lists, counts.chunks,
			counts.primitives);
	return code;
}

static enum eco_code run(const struct arguments *a, struct eco_error *error)
{
	enum eco_code code = check_options(a, error);
	if (code)
		return code;
	main_catch_interrupts();
	main_progress_quiet(a->quiet);
	if (!strcmp(a->command, "make"))
		return run_make(a, error);
	if (!strcmp(a->command, "info"))
		return inspect_info(a->input, a->json, stdout, error);
	return !strcmp(a->command, "verify") ? run_verify(a, error) : run_generate(a, error);
}

int main(int argc, char **argv)
{
	struct arguments arguments;
	struct eco_error error = { 0 };
	enum eco_code code = parse(&arguments, argc, argv, &error);
	if (!code && arguments.help) {
		print_help(stdout);
	} else if (!code && arguments.version) {
		puts("ecostream " ECO_VERSION);
	} else if (!code && !arguments.command) {
		print_help(stderr);
		return eco_exit_status(ECO_BAD_USAGE);
	} else if (!code) {
		code = run(&arguments, &error);
	}
	if (code) {
		fprintf(stderr, "ecopack: %s\n", error.text);
		if (code == ECO_BAD_USAGE)
			fputs("ecopack --help says how it is used\n", stderr);
	} else if (fflush(stdout) != 0 || ferror(stdout)) {
		fputs("ecopack: cannot write the output\n", stderr);
		return eco_exit_status(ECO_IO);
	}
	return eco_exit_status(code);
}
