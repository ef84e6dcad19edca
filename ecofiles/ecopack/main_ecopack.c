/* ecopack: chooses the command. make, link, info, verify and generate only call other files, and are short
 * enough to be here. */
#include <inttypes.h>
#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/guard.h"
#include "ecofiles/base/memory.h"
#include "ecofiles/base/text.h"
#include "ecofiles/format/chunk/draco_shim.h"
#include "ecofiles/generate/generate.h"
#include "ecofiles/ecopack/command.h"
#include "ecofiles/ecopack/inspect.h"
#include "ecofiles/ecopack/link.h"
#include "ecofiles/ecopack/make.h"
#include "ecofiles/ecopack/run.h"
#include "server/publish/publish.h"

/* ---- make ---- */

static struct {
	struct make_options make;
	uint64_t jobs, cache_mb;
	int order, season;
	bool times, uncached, order_given;
	const char *confined_to;     /* NULL: it may read everywhere; "": below the scene's folder */
} make_given;

static enum eco_code read_confine(const char *text, void *value, struct eco_error *error)
{
	(void)error;
	*(const char **)value = text ? text : "";
	return ECO_OK;
}

/* A reader finds a file missing or forbidden and knows no more; the option that forbids it is named here. */
static enum eco_code made_confined(const struct make_options *make, struct eco_error *error)
{
	struct eco_error why = { 0 };
	ECO_PASS(make_confine(make, make_given.confined_to, error));
	enum eco_code code = make_pack(make, &why);
	if (code && code != ECO_INTERRUPTED && !strstr(why.text, "--confine"))
		return eco_fail(error, code, "%s (--confine: only what lies below %s is read)", why.text,
			*make_given.confined_to ? make_given.confined_to : "the scene's folder");
	return code ? eco_fail(error, code, "%s", why.text) : ECO_OK;
}

/* Names of columns, separated by commas. */
static enum eco_code read_columns(const char *text, void *value, struct eco_error *error)
{
	struct eco_string_pool *columns = value;
	eco_string_pool_free(columns);
	for (const char *end = text; text == end || *end; text = end + 1) {
		char name[ECO_INVENTORY_NAME_MAX + 1];
		end = text + strcspn(text, ",");
		if (end == text || end - text > (ptrdiff_t)ECO_INVENTORY_NAME_MAX || columns->count == ECO_CELLS_MAX
				|| !eco_utf8_valid(text, (size_t)(end - text)))
			return eco_fail(error, ECO_BAD_USAGE, "--columns: must be 1 to %u names of columns with commas between",
				ECO_CELLS_MAX);
		snprintf(name, sizeof name, "%.*s", (int)(end - text), text);
		if (strcmp(name, ECO_INVENTORY_HEIGHT_FROM) == 0 || strcmp(name, ECO_INVENTORY_CROWN_FROM) == 0)
			return eco_fail(error, ECO_BAD_USAGE, "--columns: %s is kept in any case", name);
		eco_string_number(columns, name);
	}
	return ECO_OK;
}

static void print_times(bool by_stage)
{
	double elapsed_s, most_mb;
	main_times_total(&elapsed_s, &most_mb);
	if (by_stage)
		main_times_print(stdout);
	if (by_stage || !main_is_quiet)
		printf("built in %.2f s with at most %.0f MB of memory\n", elapsed_s, most_mb);
}

static enum eco_code run_make(int argc, char **argv, struct eco_error *error)
{
	char folder[MAIN_CACHE_PATH] = "";
	struct make_options *make = &make_given.make;
	memset(&make_given, 0, sizeof make_given);
	make_given.order = LOD_ORDER_GREEDY;
	make_given.cache_mb = MAIN_CACHE_LIMIT_MB;
	enum eco_code code = main_read(&main_command_make, argc, argv, error);
	if (!code && make->cache && (!make->cache[0] || strlen(make->cache) > sizeof folder / 2))
		code = eco_fail(error, ECO_BAD_USAGE, "--cache %.40s: must be the name of a folder",
			make->cache);
	if (!code && make->draft && make_given.order_given)
		code = eco_fail(error, ECO_BAD_USAGE, "--draft has an order of its own: leave out --order, "
			"or --draft");
	make->order = make->draft ? LOD_ORDER_COMBINED : (enum lod_order_method)make_given.order;
	make->season = (enum eco_season)make_given.season;
	make->jobs = (uint32_t)make_given.jobs;
	make->cache_bytes = make_given.cache_mb << 20;
	if (make_given.uncached)
		make->cache = NULL;
	else if (!make->cache && main_cache_default(folder))
		make->cache = folder;
	if (!code)
		code = make_given.confined_to ? made_confined(make, error) : make_pack(make, error);
	eco_string_pool_free(&make->columns);
	/* open the written pack as any reader would */
	if (!code && !main_is_quiet)
		code = inspect_info(make->pack, false, stdout, error);
	if (!code)
		print_times(make_given.times);
	return code;
}

static const struct eco_option make_options[] = {
	{ "the scene file", 0, ECO_OPTION_INPUT, "SCENE.json", .value = &make_given.make.scene,
		.is_required = true },
	{ "output", 'o', ECO_OPTION_TEXT, "OUT.eco", .value = &make_given.make.pack, .is_required = true },
	{ "draft", 0, ECO_OPTION_FLAG, NULL, .value = &make_given.make.draft },
	{ "order", 0, ECO_OPTION_CHOICE, "NAME", .value = &make_given.order, .choices = lod_order_names,
		.given = &make_given.order_given },
	{ "season", 0, ECO_OPTION_CHOICE, "NAME", .value = &make_given.season, .choices = eco_season_names,
		.given = &make_given.make.season_given },
	{ "jobs", 0, ECO_OPTION_COUNT, "N", .value = &make_given.jobs, 1, 64 },
	{ "no-rows", 0, ECO_OPTION_FLAG, NULL, .value = &make_given.make.no_rows },
	{ "columns", 0, ECO_OPTION_READ, "A,B,...", .value = &make_given.make.columns, .read = read_columns },
	{ "confine", 0, ECO_OPTION_READ, "DIR", .value = &make_given.confined_to, .read = read_confine,
		.has_optional_value = true },
	{ "times", 0, ECO_OPTION_FLAG, NULL, .value = &make_given.times },
	{ "cache", 0, ECO_OPTION_TEXT, "DIR", .value = &make_given.make.cache },
	{ "no-cache", 0, ECO_OPTION_FLAG, NULL, .value = &make_given.uncached },
	{ "cache-mb", 0, ECO_OPTION_COUNT, "N", .value = &make_given.cache_mb, 1, 1048576 }, { 0 }
};

const struct main_command main_command_make = { {
	"ecopack make", "SCENE.json -o OUT.eco [--draft | --order NAME] [--jobs N] [--no-rows] [--columns A,B,...] [--times] "
		"[--cache DIR | --no-cache]",
	"Builds a pack. ecofiles/README.md describes the fields of SCENE.json.", make_options,
	main_common, NULL, NULL }, run_make };

/* ---- link ---- */

static struct { struct eco_inputs parts; const char *pack; uint64_t jobs; } link_given;

static enum eco_code run_link(int argc, char **argv, struct eco_error *error)
{
	memset(&link_given, 0, sizeof link_given);
	ECO_PASS(main_read(&main_command_link, argc, argv, error));
	struct link_options link =
		{ .pack = link_given.pack, .parts = (const char *const *)link_given.parts.names,
			.count = link_given.parts.count, .jobs = (uint32_t)link_given.jobs };
	ECO_PASS(link_packs(&link, error));
	if (!main_is_quiet)
		ECO_PASS(inspect_info(link.pack, false, stdout, error));
	return ECO_OK;
}

static const struct eco_option link_options[] = {
	{ "a pack to be linked", 0, ECO_OPTION_INPUTS, "A.eco", .value = &link_given.parts,
		.high = LINK_PARTS_MAX, .is_required = true },
	{ "output", 'o', ECO_OPTION_TEXT, "OUT.eco", .value = &link_given.pack, .is_required = true },
	{ "jobs", 0, ECO_OPTION_COUNT, "N", .value = &link_given.jobs, 1, 64 }, { 0 }
};

const struct main_command main_command_link = { { "ecopack link", "A.eco B.eco ... -o OUT.eco [--jobs N]",
	"Makes one pack of packs that were built apart, each where its origin is.", link_options, main_common,
	"All packs must have the same CRS. Equal data are stored once. The ground comes from the first pack "
	"that has one.\n", NULL }, run_link };

/* ---- info, verify ---- */

static struct { const char *pack; bool json; } look_given;

static enum eco_code run_info(int argc, char **argv, struct eco_error *error)
{
	memset(&look_given, 0, sizeof look_given);
	enum eco_code code = main_read(&main_command_info, argc, argv, error);
	return code ? code : inspect_info(look_given.pack, look_given.json, stdout, error);
}

static const struct eco_option info_options[] = {
	{ "the pack", 0, ECO_OPTION_INPUT, "OUT.eco", .value = &look_given.pack, .is_required = true },
	{ "json", 0, ECO_OPTION_FLAG, NULL, .value = &look_given.json }, { 0 }
};

const struct main_command main_command_info =
	{ { "ecopack info", "OUT.eco [--json]", "Prints the contents of a pack.", info_options, main_common,
	NULL, NULL }, run_info };

static enum eco_code run_verify(int argc, char **argv, struct eco_error *error)
{
	struct inspect_counts counts;
	memset(&look_given, 0, sizeof look_given);
	enum eco_code code = main_read(&main_command_verify, argc, argv, error);
	if (!code)
		code = inspect_verify(look_given.pack, stdout, &counts, error);
	if (!code)
		printf("%s: all is well: %" PRIu64 " lists, %" PRIu64 " chunks, %" PRIu64 " primitives\n",
			look_given.pack, counts.lists, counts.chunks, counts.primitives);
	return code;
}

static const struct eco_option verify_options[] = {
	{ "the pack", 0, ECO_OPTION_INPUT, "OUT.eco", .value = &look_given.pack, .is_required = true }, { 0 }
};

const struct main_command main_command_verify =
	{ { "ecopack verify", "OUT.eco", "Checks every byte of a pack and names what is damaged.",
	verify_options, main_common, NULL, NULL }, run_verify };

/* ---- generate ---- */

static struct { struct eco_generate_options generate; uint64_t plants; } generate_given;

static bool generate_progress(void *ctx, const char *stage, double share)
{
	(void)ctx;
	main_progress("generating", stage, share);
	return true;
}

static enum eco_code run_generate(int argc, char **argv, struct eco_error *error)
{
	struct eco_generate_options *generate = &generate_given.generate;
	memset(&generate_given, 0, sizeof generate_given);
	*generate = (struct eco_generate_options){ .seed = 1, .progress = generate_progress };
	enum eco_code code = main_read(&main_command_generate, argc, argv, error);
	generate->plants = generate_given.plants;
	if (!code)
		code = eco_generate(generate, error);
	main_progress_end();
	if (!code && !main_is_quiet)
		printf("%s/scene.json is ready: ecopack make %s/scene.json -o %s.eco\n", generate->folder,
			generate->folder, generate->name);
	return code;
}

static const struct eco_option generate_options[] = {
	{ "the name of a scene", 0, ECO_OPTION_INPUT, "NAME", .value = &generate_given.generate.name,
		.is_required = true },
	{ "output", 'o', ECO_OPTION_TEXT, "DIR", .value = &generate_given.generate.folder,
		.is_required = true },
	{ "plants", 0, ECO_OPTION_COUNT, "N", .value = &generate_given.plants, 1, ECO_GENERATE_PLANTS_MAX },
	{ "detail", 0, ECO_OPTION_NUMBER, "D", .value = &generate_given.generate.detail, 0.1,
		ECO_GENERATE_DETAIL_MAX },
	{ "seed", 0, ECO_OPTION_COUNT, "S", .value = &generate_given.generate.seed, 0, 9007199254740992.0 },
		{ 0 }
};

const struct main_command main_command_generate = { { "ecopack generate", "NAME -o DIR [--plants N] "
	"[--detail D] [--seed S]",
	"Writes an example scene and its models into a folder; files of the same names are replaced.",
	generate_options, main_common, NULL, NULL }, run_generate };

/* ---- publish ---- */

static struct { struct srv_publish publish; struct eco_inputs packs; struct eco_string_pool columns; } publish_given;

static enum eco_code run_publish(int argc, char **argv, struct eco_error *error)
{
	struct srv_published published;
	char all[32], index[32], first[32];
	memset(&publish_given, 0, sizeof publish_given);
	enum eco_code code = main_read(&main_command_publish, argc, argv, error);
	publish_given.publish.packs = (char *const *)publish_given.packs.names;
	publish_given.publish.count = publish_given.packs.count;
	publish_given.publish.columns = &publish_given.columns;
	code = code ? code : srv_publish(&publish_given.publish, &published, error);
	if (!code && !main_is_quiet)
		printf("%s: %" PRIu64 " files, %s bytes; indices %s bytes, first answers %s. Any web server shows it, as "
			"python3 -m http.server -d %s\n", publish_given.publish.folder, published.files,
			eco_phrase_count(published.bytes, all), eco_phrase_count(published.index_bytes, index),
			eco_phrase_count(published.first_bytes, first), publish_given.publish.folder);
	eco_string_pool_free(&publish_given.columns);
	return code;
}

static const struct eco_option publish_options[] = {
	{ "a pack", 0, ECO_OPTION_INPUTS, "[NAME=]OUT.eco", .value = &publish_given.packs, .high = 32,
		.is_required = true },
	{ "output", 'o', ECO_OPTION_TEXT, "DIR", .value = &publish_given.publish.folder,
		.is_required = true },
	{ "views", 0, ECO_OPTION_TEXT, "FILE", .value = &publish_given.publish.views },
	{ "columns", 0, ECO_OPTION_READ, "A,B,...", .value = &publish_given.columns, .read = read_columns },
	{ "viewer", 0, ECO_OPTION_TEXT, "DIR", .value = &publish_given.publish.viewer }, { 0 }
};

const struct main_command main_command_publish = { { "ecopack publish",
	"[NAME=]OUT.eco ... -o DIR [--views FILE] [--columns A,B,...] [--viewer DIR]",
	"Writes a folder that shows packs in browsers from any web server or object store, without ecoserve.",
	publish_options, main_common,
	"The browser plans, by the same code as ecoserve, and fetches parts of one file of chunks. Inventories stay "
	"out of the folder, but for columns that --columns names: visitors see species, but no rows.\n", NULL }, run_publish };

/* ---- The program ---- */

static const struct main_command *const commands[] = { &main_command_start, &main_command_make,
	&main_command_link, &main_command_info, &main_command_verify, &main_command_generate,
	&main_command_model, &main_command_map, &main_command_camera,
	&main_command_export, &main_command_publish };

static void print_commands(FILE *out)
{
	char line[200];
	for (size_t i = 0; i < sizeof commands / sizeof *commands; i++) {
		const struct eco_command *c = &commands[i]->line;
		int at = fprintf(out, "  %s ", c->name);
		eco_help_wrap(out, c->synopsis, at > 0 ? (unsigned)at : 0, 8);
		fputs("      ", out);
		eco_help_wrap(out, c->says, 6, 6);
	}
	fputs("\nScenes to generate:\n", out);
	for (const struct eco_generate_kind *k = eco_generate_kinds; k->name; k++) {
		snprintf(line, sizeof line, "%s (%" PRIu64 " plants)", k->says, k->plants);
		fprintf(out, "      %-10s ", k->name);
		eco_help_wrap(out, line, 17, 17);
	}
	fputs("\necopack COMMAND --help says more, --quiet leaves out progress and notes.\n\n", out);
}

static const struct eco_command program = { .name = "ecopack", .synopsis = "COMMAND ...",
	.print_more = print_commands,
	.says = "Packs a scene (plants, positions, ground) into one file that ecoserve serves." };

static const struct main_command *find_command(const char *name, struct eco_error *error)
{
	char known[256] = "";
	for (size_t i = 0; i < sizeof commands / sizeof *commands; i++) {
		const char *own = commands[i]->line.name + strlen("ecopack ");
		if (name && strcmp(own, name) == 0)
			return commands[i];
		eco_phrase_add(known, sizeof known, own);
	}
	if (name)
		eco_fail(error, ECO_BAD_USAGE, "%.100s is not a command; commands: %s", name, known);
	else
		eco_fail(error, ECO_BAD_USAGE, "a command is missing: the commands are %s", known);
	return NULL;
}

static void *json_alloc(size_t size) { return eco_alloc(1, size); }

int main(int argc, char **argv)
{
	struct eco_error error = { 0 };
	const char *name = argc > 1 ? argv[1] : NULL;
	const struct main_command *command = find_command(name, &error);
	if (!command) {
		if (name && name[0] == '-' && eco_command_answers(&program, argc - 1, argv + 1))
			return eco_command_end(&program, ECO_OK, &error);
		return eco_command_end(&program, ECO_BAD_USAGE, &error);
	}
	enum eco_code code = ECO_OK;
	if (!eco_command_answers(&command->line, argc - 2, argv + 2)) {
		main_catch_interrupts();
		eco_draco_end_without_memory(eco_guard_no_memory);
		json_set_alloc_funcs(json_alloc, free);
		code = command->run(argc - 2, argv + 2, &error);
		main_progress_end();
	}
	return eco_command_end(&command->line, code, &error);
}
