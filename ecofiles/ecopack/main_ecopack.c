/* ecopack: chooses the command. make, link, info, verify and generate only call other files, and are short
 * enough to be here. */
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "ecofiles/generate/generate.h"
#include "ecofiles/ecopack/command.h"
#include "ecofiles/ecopack/inspect.h"
#include "ecofiles/ecopack/link.h"
#include "ecofiles/ecopack/make.h"
#include "ecofiles/ecopack/progress.h"
#include "ecofiles/ecopack/times.h"
#include "ecofiles/ecopack/pack_version.h"
#include "ecofiles/base/phrase.h"

static const struct main_command *const commands[] = { &main_command_make, &main_command_link, &main_command_info, &main_command_verify,
	&main_command_generate, &main_command_model, &main_command_sheet, &main_command_map, &main_command_camera };

/* ---- make ---- */

static void print_times(bool by_stage)
{
	double elapsed_s, most_mb;
	main_times_total(&elapsed_s, &most_mb);
	if (by_stage)
		main_times_print(stdout);
	if (by_stage || !main_is_quiet)
		printf("built in %.2f s with at most %.0f MB of memory\n", elapsed_s, most_mb);
}

static enum eco_code find_order(const char *name, enum lod_order_method *order, struct eco_error *error)
{
	char known[256] = "";
	for (int i = 0; i < LOD_ORDER_COUNT; i++) {
		if (strcmp(lod_order_names[i], name) == 0) {
			*order = (enum lod_order_method)i;
			return ECO_OK;
		}
		eco_phrase_add(known, sizeof known, lod_order_names[i]);
	}
	return eco_fail(error, ECO_BAD_USAGE, "--order %.100s: the orders are %s", name, known);
}

static enum eco_code run_make(int argc, char **argv, struct eco_error *error)
{
	char folder[MAIN_CACHE_PATH] = "";
	struct make_options make = { 0 };
	uint64_t jobs = 0, cache_mb = MAIN_CACHE_LIMIT_MB;
	const char *order = lod_order_names[LOD_ORDER_GREEDY];
	bool times = false, uncached = false;
	const struct main_option options[] = { { "output", 'o', MAIN_TEXT, &make.pack, 0, 0, 0, NULL },
		{ "times", 0, MAIN_FLAG, &times, 0, 0, 0, NULL },
		{ "jobs", 0, MAIN_COUNT, &jobs, 1, 64, 0, NULL }, { "order", 0, MAIN_TEXT, &order, 0, 0, 0, NULL },
		{ "cache", 0, MAIN_TEXT, &make.cache, 0, 0, 0, NULL }, { "no-cache", 0, MAIN_FLAG, &uncached, 0, 0, 0, NULL },
		{ "cache-mb", 0, MAIN_COUNT, &cache_mb, 1, 1048576, 0, NULL }, { 0 } };
	enum eco_code code = main_arguments(argc, argv, "make", options, "the scene file", &make.scene, 1, NULL, error);
	if (!code && !make.pack)
		code = eco_fail(error, ECO_BAD_USAGE, "ecopack make: -o OUT.eco is missing");
	if (!code)
		code = find_order(order, &make.order, error);
	if (!code && make.cache && (!make.cache[0] || strlen(make.cache) > sizeof folder / 2))
		code = eco_fail(error, ECO_BAD_USAGE, "--cache %.40s: must be the name of a folder", make.cache);
	make.jobs = (uint32_t)jobs;
	make.cache_bytes = cache_mb << 20;
	if (uncached)
		make.cache = NULL;
	else if (!make.cache && main_cache_default(folder))
		make.cache = folder;
	main_times_memory(times);
	if (!code)
		code = make_pack(&make, error);
	/* open the written pack as any reader would */
	if (!code && !main_is_quiet)
		code = inspect_info(make.pack, false, stdout, error);
	if (!code)
		print_times(times);
	return code;
}

const struct main_command main_command_make = { "make", "SCENE.json -o OUT.eco [--order NAME] [--jobs N] [--times] [--cache DIR | --no-cache]",
	"builds a pack; every field of SCENE.json is described in ecofiles/README.md",
	"  -o, --output PATH   the pack, which appears complete or not at all and replaces nothing but a pack\n"
	"      --order NAME    which leaves come first: greedy (the default: those that make most pixels right), or a method to compare with:\n"
	"                      stochastic, density, orientation, combined\n"
	"      --jobs N        threads; as many as there are processors if not given\n"
	"      --times         where the time went, and the memory, by stage\n"
	"      --cache DIR     finished plants are kept there for the next time; $XDG_CACHE_HOME/ecostream or ~/.cache/ecostream if not given\n"
	"      --no-cache      every plant is built, and nothing is taken from a pack that is there\n"
	"      --cache-mb N    the plants used least recently leave the cache beyond this size; 2048 if not given\n", run_make };

/* ---- link ---- */

static enum eco_code run_link(int argc, char **argv, struct eco_error *error)
{
	static const char *inputs[LINK_PARTS_MAX];
	struct link_options link = { .parts = inputs };
	uint64_t jobs = 0;
	const struct main_option options[] = { { "output", 'o', MAIN_TEXT, &link.pack, 0, 0, 0, NULL },
		{ "jobs", 0, MAIN_COUNT, &jobs, 1, 64, 0, NULL }, { 0 } };
	enum eco_code code = main_arguments(argc, argv, "link", options, "a pack to be linked", inputs, LINK_PARTS_MAX, &link.count, error);
	if (!code && !link.pack)
		code = eco_fail(error, ECO_BAD_USAGE, "ecopack link: -o OUT.eco is missing");
	link.jobs = (uint32_t)jobs;
	if (!code)
		code = link_packs(&link, error);
	if (!code && !main_is_quiet)
		code = inspect_info(link.pack, false, stdout, error);
	return code;
}

const struct main_command main_command_link = { "link", "A.eco B.eco ... -o OUT.eco",
	"packs that were built apart become one, each where its origin is",
	"  -o, --output PATH   the pack to write\n"
	"      --jobs N        threads; as many as there are processors if not given\n"
	"All must have one crs. What is alike is stored once. Ground is taken from the first pack that has some.\n", run_link };

/* ---- info, verify ---- */

static enum eco_code run_info(int argc, char **argv, struct eco_error *error)
{
	bool json = false;
	const char *pack;
	const struct main_option options[] = { { "json", 0, MAIN_FLAG, &json, 0, 0, 0, NULL }, { 0 } };
	enum eco_code code = main_arguments(argc, argv, "info", options, "the pack", &pack, 1, NULL, error);
	return code ? code : inspect_info(pack, json, stdout, error);
}

const struct main_command main_command_info = { "info", "OUT.eco [--json]", "says what is in a pack",
	"      --json          for scripts\n", run_info };

static enum eco_code run_verify(int argc, char **argv, struct eco_error *error)
{
	struct inspect_counts counts;
	const char *pack;
	enum eco_code code = main_arguments(argc, argv, "verify", NULL, "the pack", &pack, 1, NULL, error);
	if (!code)
		code = inspect_verify(pack, stdout, &counts, error);
	if (!code)
		printf("%s: all is well: %" PRIu64 " lists, %" PRIu64 " chunks, %" PRIu64 " primitives\n", pack, counts.lists, counts.chunks,
			counts.primitives);
	return code;
}

const struct main_command main_command_verify = { "verify", "OUT.eco", "checks every byte of a pack and names what is damaged", NULL,
	run_verify };

/* ---- generate ---- */

static bool generate_progress(void *ctx, const char *stage, double share)
{
	(void)ctx;
	return main_progress("generating", stage, share);
}

static enum eco_code run_generate(int argc, char **argv, struct eco_error *error)
{
	uint64_t plants = 0;
	struct eco_generate_options generate = { .seed = 1, .progress = generate_progress };
	const struct main_option options[] = { { "output", 'o', MAIN_TEXT, &generate.folder, 0, 0, 0, NULL },
		{ "plants", 0, MAIN_COUNT, &plants, 1, ECO_GENERATE_PLANTS_MAX, 0, NULL },
		{ "detail", 0, MAIN_NUMBER, &generate.detail, 0.1, ECO_GENERATE_DETAIL_MAX, 0, NULL },
		{ "seed", 0, MAIN_COUNT, &generate.seed, 0, 9007199254740992.0, 0, NULL }, { 0 } };
	enum eco_code code = main_arguments(argc, argv, "generate", options, "the name of a scene", &generate.name, 1, NULL, error);
	if (!code && !generate.folder)
		code = eco_fail(error, ECO_BAD_USAGE, "ecopack generate: -o DIR is missing");
	generate.plants = plants;
	if (!code)
		code = eco_generate(&generate, error);
	main_progress_end();
	if (!code && !main_is_quiet)
		printf("%s/scene.json is ready: ecopack make %s/scene.json -o %s.eco\n", generate.folder, generate.folder, generate.name);
	return code;
}

const struct main_command main_command_generate = { "generate", "NAME -o DIR [--plants N] [--detail D] [--seed S]",
	"writes an example scene with models of its own into a folder, where files of the same names are replaced",
	"  -o, --output DIR    the folder\n"
	"      --plants N      about so many plants\n"
	"      --detail D      woody plants have D times as many leaves, each as much smaller\n"
	"      --seed S        another scene of the same kind; 1 if not given\n", run_generate };

/* ---- Help ---- */

static void print_help(FILE *out)
{
	fputs("ecopack packs a scene (plants, positions, ground) into one file that ecoserve serves.\n\n", out);
	for (size_t i = 0; i < sizeof commands / sizeof *commands; i++)
		fprintf(out, "  ecopack %s %s\n      %s\n", commands[i]->name, commands[i]->synopsis, commands[i]->says);
	fputs("\nScenes to generate:\n", out);
	for (const struct eco_generate_kind *k = eco_generate_kinds; k->name; k++)
		fprintf(out, "      %-10s %s (%" PRIu64 " plants)\n", k->name, k->says, k->plants);
	fputs("\n  ecopack COMMAND --help says more, --quiet leaves out progress and notes, --version names the version.\n"
		"\nExit status: 0 done, 1 failed, 2 wrong usage.\n", out);
}

static void print_command_help(const struct main_command *command)
{
	printf("ecopack %s %s\n      %s\n", command->name, command->synopsis, command->says);
	printf("\n%s      --quiet         neither progress nor notes, only errors\n", command->help ? command->help : "");
	puts("\nExit status: 0 done, 1 failed, 2 wrong usage.");
}

static const struct main_command *find_command(const char *name, struct eco_error *error)
{
	char known[256] = "";
	for (size_t i = 0; i < sizeof commands / sizeof *commands; i++) {
		if (strcmp(commands[i]->name, name) == 0)
			return commands[i];
		eco_phrase_add(known, sizeof known, commands[i]->name);
	}
	eco_fail(error, ECO_BAD_USAGE, "%.100s: the commands are %s", name, known);
	return NULL;
}

static bool asks_for(int argc, char **argv, const char *option, const char *letter)
{
	for (int i = 1; i < argc && strcmp(argv[i], "--") != 0; i++)
		if (strcmp(argv[i], option) == 0 || strcmp(argv[i], letter) == 0)
			return true;
	return false;
}

int main(int argc, char **argv)
{
	struct eco_error error = { 0 };
	enum eco_code code = ECO_OK;
	const struct main_command *command = argc > 1 && argv[1][0] != '-' ? find_command(argv[1], &error) : NULL;
	if (asks_for(argc, argv, "--version", "--version")) {
		puts("ecostream " ECO_VERSION);
	} else if (asks_for(argc, argv, "--help", "-h") && !error.code) {
		if (command)
			print_command_help(command);
		else
			print_help(stdout);
	} else if (argc < 2) {
		print_help(stderr);
		return eco_exit_status(ECO_BAD_USAGE);
	} else if (!command) {
		code = eco_fail(&error, ECO_BAD_USAGE, "%.100s: a command comes first", argv[1]);
	} else {
		main_catch_interrupts();
		code = command->run(argc - 2, argv + 2, &error);
		main_progress_end();
	}
	if (code || error.code) {
		fprintf(stderr, "ecopack: %s\n", error.text);
		if (error.code == ECO_BAD_USAGE)
			fputs("ecopack --help says how it is used\n", stderr);
		return eco_exit_status(error.code);
	}
	if (fflush(stdout) != 0 || ferror(stdout)) {
		fputs("ecopack: cannot write the output\n", stderr);
		return eco_exit_status(ECO_IO);
	}
	return 0;
}
