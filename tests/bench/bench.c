/* The frame that sections run in: units kept on disk, records of results, progress, the command line. A
 * record holds all results of a section, as CACHE/sections/NAME.json:
 *
 *   {"name", "title", "program": hash, "full", "state": "done" | "missing" | "failed", "why", "seconds",
 *    "keys": [{"key", "value", "bar"}], "items": [item]}
 *
 * and an item is
 *
 *   {"kind": "head" | "say", "text"}, {"kind": "picture", "file", "caption"},
 *   {"kind": "table", "name", "columns", "show", "rows": ["cell,cell"]} or
 *   {"kind": "plot", "name", "title", "x", "y", "log_x", "log_y",
 *    "series": [{"name", "points", "x": [], "y": []}]}
 *
 * report/report.py draws them; it shows sections that did not run this time as they were. */
#include "lod/arena.h"
#include "tests/bench/bench.h"

#include <assert.h>
#include <math.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>
#include <xxhash.h>

#include "client-min/view_store.h"
#include "ecofiles/base/files.h"
#include "ecofiles/base/memory.h"
#include "ecofiles/base/options.h"
#include "ecofiles/base/text.h"
#include "ecofiles/format/image.h"

#define PATH 1024
#define SECTIONS_MAX 64u

/* The section that runs. */
static const struct bench_section *section;
static json_t *record, *items, *keys;        /* the latter two within the first */
static json_t *left_out;                     /* an object whose keys are names */
static json_t *held;                         /* units that were given out */
static uint32_t made, recalled;              /* units */
static jmp_buf failed;
static struct eco_error section_error;
struct eco_error *const must_error = &section_error;

/* ---- Progress ---- */

void bench_progress(double share, const char *what) { eco_progress(section->name, what, share); }

/* ---- Programs ---- */

/* As vasprintf, but there is always a text. The caller frees it. */
static char *text_of(const char *format, va_list args)
{
	char *text = NULL;
	if (vasprintf(&text, format, args) < 0)
		eco_end("no memory for a text");
	return text;
}

void bench_command(const char *format, ...)
{
	va_list args;
	va_start(args, format);
	char *command = text_of(format, args);
	va_end(args);
	eco_progress_end();
	int status = system(command);
	if (WIFSIGNALED(status))
		raise(WTERMSIG(status));         /* Ctrl-C, which system() keeps from this program */
	must(status ? eco_fail(must_error, ECO_IO, "this fails: %.400s", command) : ECO_OK);
	free(command);
}

void must(enum eco_code code)
{
	if (code)
		longjmp(failed, 1);
}

/* ---- Units ---- */

uint64_t bench_file_hash(const char *path)
{
	static char part[1 << 16];
	FILE *file = fopen(path, "rb");
	if (!file)
		return 0;
	XXH3_state_t *hash = XXH3_createState();
	XXH3_64bits_reset(hash);
	for (size_t n; (n = fread(part, 1, sizeof part, file)) > 0;)
		XXH3_64bits_update(hash, part, n);
	uint64_t value = XXH3_64bits_digest(hash);
	XXH3_freeState(hash);
	fclose(file);
	return value;
}

/* A hash of this program. */
static const char *program_hash(void)
{
	static char stamp[17];
	if (!*stamp)
		snprintf(stamp, sizeof stamp, "%016llx",
			(unsigned long long)bench_file_hash("/proc/self/exe"));
	return stamp;
}

static enum eco_code write_json(const char *path, const json_t *value, struct eco_error *error)
{
	char *text = value ? json_dumps(value, JSON_COMPACT) : NULL;
	enum eco_code code = text ? eco_file_write(path, text, strlen(text), error)
		: eco_fail(error, ECO_BAD_INPUT, "%s: holds a NaN, or text that is not UTF-8", path);
	free(text);
	return code;
}

json_t *bench_unit(struct bench *bench, const char *unit, const char *stamp, json_t *(*make)(void *ctx), void *ctx)
{
	char path[PATH], key[PATH];
	struct eco_error why = { 0 };
	snprintf(path, sizeof path, "%s/units/%016llx.json", bench->cache,
		(unsigned long long)XXH3_64bits_withSeed(unit, strlen(unit), !bench->sky.shadows));
	snprintf(key, sizeof key, "%s, %s, %s%s", unit, stamp ? stamp : "", program_hash(),
		bench->sky.shadows ? "" : ", no shadows");
	json_t *kept = json_load_file(path, 0, NULL), *result = json_object_get(kept, "result");
	const char *as = json_string_value(json_object_get(kept, "key"));
	if (result && as && !strcmp(as, key)) {
		recalled++;
	} else {
		json_decref(kept);
		result = make(ctx);
		kept = json_pack("{s:s, s:o}", "key", key, "result", result);
		/* a full disk costs the next run some time, not this one its result */
		if (write_json(path, kept, &why))
			eco_progress_note("%s; not kept", why.text);
		made++;
	}
	json_array_append_new(held, kept);
	return result;
}

/* ---- Records ---- */

static void add_item(struct bench *bench, json_t *item) { json_array_append_new(items, item); }

void bench_say(struct bench *bench, const char *format, ...)
{
	va_list args;
	va_start(args, format);
	char *text = text_of(format, args);
	va_end(args);
	add_item(bench, json_pack("{s:s, s:s}", "kind", "say", "text", text));
	free(text);
}

void bench_head(struct bench *bench, const char *text)
{
	add_item(bench, json_pack("{s:s, s:s}", "kind", "head", "text", text));
}

void bench_left_out(struct bench *bench, const char *name)
{
	json_object_set_new(left_out, name, json_true());
}

static json_t *number_or_null(double value) { return isfinite(value) ? json_real(value) : json_null(); }

void bench_key(struct bench *bench, const char *key, double value, const char *bar)
{
	json_array_append_new(keys, json_pack("{s:s, s:o, s:s}", "key", key, "value",
		number_or_null(value), "bar", bar));
}

json_t *bench_reals(const double *values, uint32_t count)
{
	json_t *all = json_array();
	for (uint32_t i = 0; i < count; i++)
		json_array_append_new(all, number_or_null(values[i]));
	return all;
}

double bench_cell(const json_t *array, size_t i)
{
	const json_t *value = json_array_get(array, i);
	return json_is_number(value) ? json_number_value(value) : NAN;
}

void bench_cells(const json_t *array, double *values, uint32_t count)
{
	for (uint32_t i = 0; i < count; i++)
		values[i] = bench_cell(array, i);
}

void bench_plot(struct bench *bench, const struct bench_plot *plot)
{
	json_t *all = json_array();
	for (uint32_t i = 0; i < plot->series_count; i++) {
		const struct bench_series *s = &plot->series[i];
		json_array_append_new(all, json_pack("{s:s, s:o, s:o, s:b}", "name", s->name, "x",
			bench_reals(s->x, s->count), "y", bench_reals(s->y, s->count), "points",
			(int)s->points));
	}
	add_item(bench, json_pack("{s:s, s:s, s:s, s:s, s:s, s:b, s:b, s:o}", "kind", "plot", "name",
		plot->name, "title", plot->title, "x", plot->x, "y", plot->y, "log_x", (int)plot->log_x,
		"log_y", (int)plot->log_y, "series", all));
}

void bench_picture(struct bench *bench, const char *file, const char *caption)
{
	add_item(bench, json_pack("{s:s, s:s, s:s}", "kind", "picture", "file", file, "caption", caption));
}

void bench_picture_write(struct bench *bench, const char *file, uint32_t width, uint32_t height, const uint8_t *rgb)
{
	char path[PATH];
	snprintf(path, sizeof path, "%s/%s", bench->out, file);
	must(eco_png_write(&(struct eco_pixels){ width, height, 3, rgb }, path, must_error));
}

void bench_pictures_write(struct bench *bench, const char *file, uint32_t width, uint32_t height,
	const uint8_t *const *rgb, uint32_t count)
{
	size_t row = 3 * (size_t)width;
	uint8_t *all = eco_alloc(row * count, height);
	for (size_t i = 0; i < (size_t)height * count; i++)
		memcpy(all + i * row, rgb[i % count] + i / count * row, row);
	bench_picture_write(bench, file, count * width, height, all);
	free(all);
}

/* ---- Tables ---- */

struct bench_table {
	struct bench *bench;
	const char *name, *columns;
	json_t *rows;
	uint32_t commas;
	const struct bench_column *described;
	uint32_t described_count;
};

static uint32_t commas_of(const char *text)
{
	uint32_t count = 0;
	for (; *text; text++)
		count += *text == ',';
	return count;
}

struct bench_table *bench_table_open(struct bench *bench, const char *name, const char *columns, bool show)
{
	struct bench_table *table = eco_alloc(1, sizeof *table);
	json_t *item = json_pack("{s:s, s:s, s:s, s:b, s:[]}", "kind", "table", "name", name, "columns",
		columns, "show", (int)show, "rows");
	*table = (struct bench_table){ bench, json_string_value(json_object_get(item, "name")),
		json_string_value(json_object_get(item, "columns")), json_object_get(item, "rows"),
		commas_of(columns), NULL, 0 };
	/* in the report where it was opened */
	add_item(bench, item);
	return table;
}

void bench_table_row(struct bench_table *table, const char *format, ...)
{
	va_list args;
	va_start(args, format);
	char *text = text_of(format, args);
	va_end(args);
	assert(commas_of(text) == table->commas);
	json_array_append_new(table->rows, json_string(text));
	free(text);
}

struct bench_table *bench_table_described(struct bench *bench, const char *name, const char *first,
	const struct bench_column *columns, uint32_t count, bool show)
{
	char heads[1024];
	size_t used = (size_t)snprintf(heads, sizeof heads, "%s", first);
	for (uint32_t i = 0; i < count; i++)
		used += (size_t)snprintf(heads + used, sizeof heads - used, ",%s", columns[i].head);
	struct bench_table *table = bench_table_open(bench, name, heads, show);
	table->described = columns;
	table->described_count = count;
	return table;
}

void bench_table_values(struct bench_table *table, const double *values, const char *format, ...)
{
	char cells[1024];
	va_list args;
	va_start(args, format);
	size_t used = (size_t)vsnprintf(cells, sizeof cells, format, args);
	va_end(args);
	for (uint32_t i = 0; i < table->described_count; i++)
		used += (size_t)snprintf(cells + used, sizeof cells - used, ",%.*f",
			(int)table->described[i].decimals, values[i]);
	bench_table_row(table, "%s", cells);
}

/* Names in cells come from files. */
static void write_cells(FILE *out, const char *row)
{
	for (;; row++) {
		char *cell = strndup(row, strcspn(row, ",")), *end = NULL;
		if (cell && (strtod(cell, &end), *end == 0))
			fputs(cell, out);
		else if (cell)
			eco_csv_write_text(out, cell);
		free(cell);
		row += strcspn(row, ",");
		fputc(*row == 0 ? '\n' : ',', out);
		if (*row == 0)
			return;
	}
}

void bench_table_close(struct bench_table *table)
{
	char path[PATH], *bytes = NULL;
	size_t size = 0, i;
	struct eco_error error = { 0 };
	json_t *row;
	FILE *out = open_memstream(&bytes, &size);
	if (!out)
		abort();
	fprintf(out, "%s\n", table->columns);
	json_array_foreach(table->rows, i, row)
		write_cells(out, json_string_value(row));
	fclose(out);
	snprintf(path, sizeof path, "%s/%s.csv", table->bench->out, table->name);
	if (eco_file_write(path, bytes, size, &error))
		eco_progress_note("%s", error.text);
	free(bytes);
	free(table);
}

/* ---- Runs ---- */

static struct bench bench;
static const struct bench_section *const *sections;          /* NULL ends */
static bool asked[SECTIONS_MAX], some;       /* --only; all sections without */

static void say_left_out(void)
{
	char text[4096] = "";
	size_t used = 0;
	const char *name;
	json_t *value;
	json_object_foreach(left_out, name, value)
		if (used < sizeof text)
			used += (size_t)snprintf(text + used, sizeof text - used, "%s%s", used ? ", " : "",
				name);
	if (used)
		bench_say(&bench, "Left out without FULL=1: %s.", text);
}

static enum eco_code run_section(void)
{
	if (setjmp(failed))
		return section_error.code;
	section->run(&bench);
	return ECO_OK;
}

/* Runs one, and keeps its record. */
static bool record_section(void)
{
	char path[PATH];
	struct eco_error why = { 0 };
	double begun_ms = view_clock_ms();
	section_error = (struct eco_error){ 0 };
	record = json_pack("{s:s, s:s, s:s, s:b, s:[], s:[]}", "name", section->name, "title", section->title,
		"program", program_hash(), "full", (int)bench.full, "items", "keys");
	items = json_object_get(record, "items");
	keys = json_object_get(record, "keys");
	left_out = json_object();
	held = json_array();
	made = recalled = 0;
	enum eco_code code = run_section();
	const char *state = code == ECO_OK ? "done" : code == ECO_NOT_FOUND ? "missing" : "failed";
	double seconds = 1e-3 * (view_clock_ms() - begun_ms);
	say_left_out();
	json_object_set_new(record, "state", json_string(state));
	json_object_set_new(record, "seconds", json_real(seconds));
	json_object_set_new(record, "why", json_string(section_error.text));
	snprintf(path, sizeof path, "%s/sections/%s.json", bench.cache, section->name);
	if (write_json(path, record, &why))
		eco_progress_note("%s", why.text);
	eco_progress_note("%s: %s in %.1f s (%u pieces of work done, %u were there)%s%s", section->name,
		state, seconds, made, recalled, code ? ": " : "", section_error.text);
	json_decref(left_out);
	json_decref(record);
	json_decref(held);
	return code == ECO_OK;
}

#define SCRIPT "tests/bench/report/report.py"

static void write_report(void)
{
	char path[PATH], command[3 * PATH];
	struct eco_error why = { 0 };
	json_t *names = json_array();
	for (uint32_t i = 0; sections[i]; i++)
		json_array_append_new(names, json_string(sections[i]->name));
	json_t *run = json_pack("{s:b, s:s, s:s?, s:s, s:o}", "full", (int)bench.full, "program",
		program_hash(), "data", bench.data, "ran", section->name, "sections", names);
	snprintf(path, sizeof path, "%s/run.json", bench.cache);
	snprintf(command, sizeof command, SCRIPT " '%s' '%s'", bench.out, bench.cache);
	if (write_json(path, run, &why) || system(command))
		eco_progress_note("no report (" SCRIPT " needs python3 and the source tree as working folder) %s",
			why.text);
	json_decref(run);
}

static void print_list(void)
{
	for (uint32_t i = 0; sections[i]; i++) {
		char path[PATH];
		const char *done = "-";
		snprintf(path, sizeof path, "%s/sections/%s.json", bench.cache, sections[i]->name);
		json_t *was = json_load_file(path, 0, NULL);
		json_unpack(was, "{s:s}", "state", &done);
		printf("%-12s %-12s %s\n", sections[i]->name, done, sections[i]->title);
		json_decref(was);
	}
}

/* Every section runs even if one before it fails. */
static enum eco_code run_sections(int *status, struct eco_error *error)
{
	char path[PATH];
	struct stat folder;
	snprintf(path, sizeof path, "%s/models", bench.data ? bench.data : "");
	if (bench.data && (stat(path, &folder) || !S_ISDIR(folder.st_mode)))
		return eco_fail(error, ECO_BAD_USAGE, "%s is not there: --data is a folder that holds models/ (and "
			"inventories/ and terrain/)", path);
	snprintf(path, sizeof path, "%s/ecopack", bench.build);
	if (access(path, X_OK))
		return eco_fail(error, ECO_BAD_USAGE, "%s is not there: --build is the folder that make "
			"writes programs to", path);
	if (setjmp(failed))
		return eco_fail(error, ECO_IO, "%s", section_error.text);
	bench_command("mkdir -p '%s' '%s/units' '%s/truths' '%s/sections'", bench.out, bench.cache,
		bench.cache, bench.cache);
	for (uint32_t i = 0; sections[i]; i++) {
		if (some && !asked[i])
			continue;
		section = sections[i];
		*status |= !record_section();
		write_report();
	}
	fprintf(stderr, "ecobench: %s/report.html, %s/summary.json\n", bench.out, bench.out);
	return ECO_OK;
}

/* ---- The command line ---- */

static enum eco_code read_only(const char *text, void *value, struct eco_error *error)
{
	char words[1024], *rest = words;
	(void)value;
	snprintf(words, sizeof words, "%s", text);
	for (char *word; (word = strsep(&rest, ","));) {
		uint32_t i = 0;
		while (sections[i] && strcmp(sections[i]->name, word))
			i++;
		if (!sections[i])
			return eco_fail(error, ECO_BAD_USAGE, "no section is called %s; --list names them",
				word);
		asked[i] = some = true;
	}
	return ECO_OK;
}

int bench_main(int argc, char **argv, const struct bench_section *const *all)
{
	static const char *given_out, *given_cache;
	static char out[1000], cache[1008];
	static bool list, no_shadows;
	static const struct eco_option options[] = {
		{ "full", 0, ECO_OPTION_FLAG, NULL, &bench.full,
			.help = "all methods, scenes and frames; else fewer of them, and the same keys" },
		{ "data", 0, ECO_OPTION_TEXT, "DIR", &bench.data,
			.help = "a folder with models/, inventories/ and terrain/; generated plants and scenes "
			"only without" },
		{ "out", 0, ECO_OPTION_TEXT, "DIR", &given_out,
			.help = "tables (CSV), plots, report.html, papers.html and summary.json; BUILD/bench if "
			"not given" },
		{ "cache", 0, ECO_OPTION_TEXT, "DIR", &given_cache,
			.help = "scenes, packs and finished pieces of work; OUT/cache if not given" },
		{ "build", 0, ECO_OPTION_TEXT, "DIR", &bench.build,
			.help = "folder of the programs; build if not given" },
		{ "only", 0, ECO_OPTION_READ, "SECTION", &asked, .read = read_only,
			.help = "runs this section, or several (with commas, or the option again); the report "
			"keeps earlier results of the others" },
		{ "no-shadows", 0, ECO_OPTION_FLAG, NULL, &no_shadows,
			.help = "judges pictures without shadows; else with those that ecoview draws" },
		{ "list", 0, ECO_OPTION_FLAG, NULL, &list, .help = "names sections and their state" },
		{ "quiet", 'q', ECO_OPTION_FLAG, NULL, &bench.quiet, .help = "no progress" }, { 0 } };
	static const struct eco_command command = { .name = "ecobench", .options = options,
		.synopsis = "[--full] [--data DIR] [--out DIR] [--cache DIR] [--build DIR] [--only SECTION]... "
		"[--no-shadows] [--list]",
		.says = "Error against run time of the methods of the literature and ours, on the same scenes.",
		.notes = "Finished pieces of work are kept: after Ctrl-C the next run goes on from there.\n" };
	struct eco_error error = { 0 };
	int status = 0;
	sections = all;
	eco_progress_begin("ecobench");
	bench = (struct bench){ .build = "build", .out = out, .cache = cache };
	if (eco_command_answers(&command, argc - 1, argv + 1))
		return eco_command_end(&command, ECO_OK, &error);
	enum eco_code code = eco_command_read(&command, argc - 1, argv + 1, &error);
	eco_progress_quiet(bench.quiet);
	if (!no_shadows)
		bench.sky = (struct view_sky){ .shadows = VIEW_SHADOWS_PERSPECTIVE,
			.shadow_size = VIEW_SHADOW_SIZE };
	if (bench.data && !*bench.data)
		bench.data = NULL;
	snprintf(out, sizeof out, "%s%s", given_out ? given_out : bench.build, given_out ? "" : "/bench");
	snprintf(cache, sizeof cache, "%s%s", given_cache ? given_cache : out, given_cache ? "" : "/cache");
	if (!code && list)
		print_list();
	else if (!code)
		code = run_sections(&status, &error);
	int ended = eco_command_end(&command, code, &error);
	return ended ? ended : status;
}
