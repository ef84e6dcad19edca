/* The frame that sections run in: units kept on disk, records of what was said, progress, Ctrl-C.
 *
 * A unit's file holds the stamp that it was done under, so that one of another program or input is not taken
 * for this one's; a file that is damaged counts as none. Nothing is ever half there: files are written beside
 * and renamed. */
#include "tests/bench/bench_state.h"

#include <assert.h>
#include <errno.h>
#include <fcntl.h>
#include <glob.h>
#include <math.h>
#include <signal.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>
#include <xxhash.h>

#include "ecofiles/base/csv.h"
#include "ecofiles/base/guard.h"

#define PATH 1024
#define BAR 28

/* ---- Interruption ---- */

static volatile sig_atomic_t interrupted, reported;

#define TWICE_S 1.0               /* wrappers (timeout, make) may pass one Ctrl-C on twice */

/* A second Ctrl-C ends the program at once, and costs the unit that runs. */
static void ask_to_stop(int number)
{
	static double first_s;
	double now = bench_now_s();
	if (interrupted && now - first_s > TWICE_S) {
		signal(number, SIG_DFL);
		raise(number);
	}
	if (!interrupted)
		first_s = now;
	interrupted = number;
	eco_guard_interrupt();
}

void bench_catch_interrupts(void)
{
	struct sigaction action = { .sa_handler = ask_to_stop };
	sigemptyset(&action.sa_mask);
	sigaction(SIGINT, &action, NULL);
	sigaction(SIGTERM, &action, NULL);
}

bool bench_interrupted(void) { return interrupted != 0; }

bool bench_stopped(const struct bench *bench)
{
	if (interrupted && !reported) {
		reported = 1;
		bench_note(bench, "stopping after this piece of work; what is done is kept (once more to "
			"stop at once)");
	}
	return interrupted != 0;
}

/* ---- Progress ---- */

static bool bar_shown;

double bench_now_s(void)
{
	struct timespec t;
	clock_gettime(CLOCK_MONOTONIC, &t);
	return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

double bench_cpu_s(void)
{
	double sum = 0;
	for (int i = 0; i < 2; i++) {
		struct rusage used;
		getrusage(i ? RUSAGE_CHILDREN : RUSAGE_SELF, &used);
		sum += (double)(used.ru_utime.tv_sec + used.ru_stime.tv_sec)
			+ 1e-6 * (double)(used.ru_utime.tv_usec + used.ru_stime.tv_usec);
	}
	return sum;
}

static void erase_bar(void)
{
	if (bar_shown)
		fputs("\r\033[K", stderr);
	bar_shown = false;
}

void bench_note(const struct bench *bench, const char *format, ...)
{
	va_list args;
	if (bench->state->quiet)
		return;
	erase_bar();
	fputs("ecobench: ", stderr);
	va_start(args, format);
	vfprintf(stderr, format, args);
	va_end(args);
	fputc('\n', stderr);
}

void bench_progress(struct bench *bench, double share, const char *what)
{
	static double last_s = -1000;
	bool terminal = isatty(STDERR_FILENO) == 1;
	double now = bench_now_s();
	if (bench->state->quiet || now - last_s < (terminal ? 0.1 : 10))
		return;
	last_s = now;
	share = share >= 0 ? share > 1 ? 1 : share : 0;
	const char *name = bench->state->section ? bench->state->section->name : "";
	if (!terminal) {
		bench_note(bench, "%s: %s, %.0f %%", name, what ? what : "", 100 * share);
		return;
	}
	char bar[BAR + 1];
	memset(bar, '.', BAR);
	memset(bar, '#', (size_t)(share * BAR));
	bar[BAR] = 0;
	fprintf(stderr, "\r\033[K[%s] %3.0f %%  %s: %.60s", bar, 100 * share, name, what ? what : "");
	fflush(stderr);
	bar_shown = true;
}

/* ---- Files ---- */

enum eco_code bench_folder_make(const char *path, struct eco_error *error)
{
	char part[PATH];
	struct stat status;
	if (snprintf(part, sizeof part, "%s", path) >= (int)sizeof part)
		return eco_fail(error, ECO_BAD_INPUT, "%s: path too long", path);
	for (char *c = part + 1;; c++) {
		char was = *c;
		if (was && was != '/')
			continue;
		*c = 0;
		if (mkdir(part, 0777) && errno != EEXIST)
			return eco_fail(error, ECO_IO, "%s: cannot make this folder: %s", part,
				strerror(errno));
		*c = was;
		if (!was)
			break;
	}
	return stat(path, &status) == 0 && S_ISDIR(status.st_mode) ? ECO_OK
		: eco_fail(error, ECO_IO, "%s: is no folder", path);
}

enum eco_code bench_file_write(const char *path, const char *bytes, size_t size, struct eco_error *error)
{
	char beside[PATH + 32];
	snprintf(beside, sizeof beside, "%s.tmp-%ld", path, (long)getpid());
	FILE *file = fopen(beside, "wb");
	if (!file)
		return eco_fail(error, ECO_IO, "%s: cannot be written: %s", beside, strerror(errno));
	bool good = fwrite(bytes, 1, size, file) == size;
	good = !fclose(file) && good;
	if (good && rename(beside, path) == 0)
		return ECO_OK;
	enum eco_code code = eco_fail(error, ECO_IO, "%s: cannot be written: %s", path, strerror(errno));
	unlink(beside);
	return code;
}

json_t *bench_json_read(const char *path)
{
	json_error_t why;
	json_t *value = json_load_file(path, JSON_REJECT_DUPLICATES, &why);
	return value;
}

/* A readable name that no other text shares. */
static void file_name(char out[PATH], const struct bench *bench, const char *folder, const char *unit)
{
	char clean[80];
	size_t n = 0;
	for (const char *c = unit; *c && n + 1 < sizeof clean; c++)
		clean[n++] = (*c >= '0' && *c <= '9') || (*c >= 'a' && *c <= 'z') || (*c >= 'A' && *c <= 'Z')
			|| *c == '-' || *c == '_' ? *c : '-';
	clean[n] = 0;
	snprintf(out, PATH, "%s/%s/%s-%08x.json", bench->cache, folder, clean,
		(unsigned)XXH3_64bits(unit, strlen(unit)));
}

/* ---- Units ---- */

static void add_cpu(struct bench_state *state, double cpu_s)
{
	state->units_cpu_s += cpu_s;
	state->longest_cpu_s = fmax(state->longest_cpu_s, cpu_s);
}

json_t *bench_recall(struct bench *bench, const char *unit, const char *stamp)
{
	char path[PATH];
	struct bench_state *s = bench->state;
	file_name(path, bench, "units", unit);
	if (access(path, F_OK))
		return NULL;
	json_t *kept = bench_json_read(path), *result = json_object_get(kept, "result");
	const char *name = json_string_value(json_object_get(kept, "unit")),
		*program = json_string_value(json_object_get(kept, "program"));
	const char *under = json_string_value(json_object_get(kept, "stamp"));
	bool whole = result && name && program && under && !strcmp(name, unit);
	if (!whole)
		bench_note(bench, "%s is damaged: this piece of work is done anew", path);
	if (!whole || strcmp(under, stamp ? stamp : "") || (strcmp(program, s->program) && !s->trust)) {
		json_decref(kept);
		return NULL;
	}
	json_array_append(s->held, result);
	add_cpu(s, json_number_value(json_object_get(kept, "cpu_s")));
	s->unit_cpu_s = bench_cpu_s();
	json_decref(kept);
	s->recalled++;
	return result;
}

json_t *bench_keep(struct bench *bench, const char *unit, const char *stamp, json_t *result)
{
	char path[PATH];
	struct bench_state *s = bench->state;
	struct eco_error error = { 0 };
	double now_s = bench_cpu_s();
	file_name(path, bench, "units", unit);
	json_t *kept = json_pack("{s:s, s:s, s:s, s:f, s:O}", "unit", unit, "program", s->program, "stamp",
		stamp ? stamp : "", "cpu_s", now_s - s->unit_cpu_s, "result", result);
	add_cpu(s, now_s - s->unit_cpu_s);
	s->unit_cpu_s = now_s;
	char *text = kept ? json_dumps(kept, JSON_COMPACT) : NULL;
	/* A full disk costs the next run some time, not this one its result. */
	if (!text)
		bench_note(bench, "%s: not kept, as it holds what JSON cannot (a NaN, or text that is not "
			"UTF-8)", unit);
	else if (bench_file_write(path, text, strlen(text), &error))
		bench_note(bench, "%s; not kept", error.text);
	free(text);
	json_decref(kept);
	json_array_append_new(s->held, result);
	s->kept++;
	return result;
}

/* ---- What a section says ---- */

/* Takes the item over. */
static void add_item(struct bench *bench, json_t *item) { json_array_append_new(bench->state->items, item); }

/* As vasprintf, but there is always a text. The caller frees it. */
static char *text_of(const char *format, va_list args)
{
	char *text = NULL;
	if (vasprintf(&text, format, args) < 0 || !text)
		abort();
	return text;
}

void bench_say(struct bench *bench, const char *format, ...)
{
	va_list args;
	va_start(args, format);
	char *text = text_of(format, args);
	va_end(args);
	add_item(bench, json_pack("{s:s, s:s}", "kind", "say", "text", text));
	free(text);
}

void bench_left_out(struct bench *bench, const char *name)
{
	json_object_set_new(bench->state->left_out, name, json_true());
}

static void say_left_out(struct bench *bench)
{
	char *text = NULL;
	size_t size = 0;
	const char *name;
	json_t *value;
	FILE *out = json_object_size(bench->state->left_out) ? open_memstream(&text, &size) : NULL;
	if (!out)
		return;
	json_object_foreach(bench->state->left_out, name, value)
		fprintf(out, "%s%s", ftell(out) ? ", " : "", name);
	fclose(out);
	bench_say(bench, "Left out without FULL=1: %s.", text);
	free(text);
}

void bench_head(struct bench *bench, const char *text)
{
	add_item(bench, json_pack("{s:s, s:s}", "kind", "head", "text", text));
}

void bench_key(struct bench *bench, const char *key, double value, const char *bar)
{
	json_array_append_new(bench->state->keys,
		json_pack("{s:s, s:o, s:s}", "key", key, "value", isfinite(value) ? json_real(value)
		: json_null(),
		"bar", bar ? bar : ""));
}

struct bench_table { struct bench *bench; char name[64]; json_t *item, *rows; uint32_t commas; };

static uint32_t commas_of(const char *text)
{
	uint32_t count = 0;
	for (; *text; text++)
		count += *text == ',';
	return count;
}


/* So that programs can ask for columns by name. */
static bool all_differ(const char *columns)
{
	for (const char *a = columns; *a; a += strcspn(a, ",") + (a[strcspn(a, ",")] == ',')) {
		size_t size = strcspn(a, ",");
		for (const char *b = a + size; *b == ','; b += strcspn(b, ",")) {
			b++;
			if (strcspn(b, ",") == size && !strncmp(a, b, size))
				return false;
		}
	}
	return true;
}

struct bench_table *bench_table_open(struct bench *bench, const char *name, const char *columns, bool show)
{
	assert(all_differ(columns));
	struct bench_table *table = calloc(1, sizeof *table);
	if (!table)
		abort();
	table->bench = bench;
	snprintf(table->name, sizeof table->name, "%s", name);
	table->rows = json_array();
	table->commas = commas_of(columns);
	table->item = json_pack("{s:s, s:s, s:s, s:b, s:O}", "kind", "table", "name", name, "columns",
		columns, "show", (int)show, "rows", table->rows);
	/* in the report where it was opened */
	add_item(bench, json_incref(table->item));
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
	if (out) {
		fprintf(out, "%s\n", json_string_value(json_object_get(table->item, "columns")));
		json_array_foreach(table->rows, i, row)
			write_cells(out, json_string_value(row));
		fclose(out);
		snprintf(path, sizeof path, "%s/%s.csv", table->bench->out, table->name);
		if (bench_file_write(path, bytes, size, &error))
			bench_note(table->bench, "%s", error.text);
		free(bytes);
	}
	json_decref(table->rows);
	json_decref(table->item);
	free(table);
}

void bench_picture(struct bench *bench, const char *file, const char *caption)
{
	add_item(bench, json_pack("{s:s, s:s, s:s}", "kind", "picture", "file", file, "caption",
		caption ? caption : ""));
}

/* ---- Programs ---- */

enum eco_code bench_command(struct bench *bench, struct eco_error *error, const char *format, ...)
{
	va_list args;
	va_start(args, format);
	char *command = text_of(format, args);
	va_end(args);
	erase_bar();
	/* not system(), which would swallow Ctrl-C; a group of its own, so that what the shell started ends
	 * with it */
	pid_t child = fork();
	if (child == 0) {
		setpgid(0, 0);
		signal(SIGINT, SIG_DFL);
		signal(SIGTERM, SIG_DFL);
		dup2(STDERR_FILENO, STDOUT_FILENO);
		execl("/bin/sh", "sh", "-c", command, (char *)NULL);
		_exit(127);
	}
	int status = -1;
	bool told = false;
	if (child > 0)
		setpgid(child, child);
	/* asked for in turns: a signal that came just before waiting would be waited through */
	while (child > 0 && waitpid(child, &status, WNOHANG) == 0) {
		if (interrupted && !told)
			told = kill(-child, SIGTERM) == 0;
		nanosleep(&(struct timespec){ 0, 20000000 }, NULL);
	}
	enum eco_code code = ECO_OK;
	if (bench_stopped(bench))
		code = eco_fail(error, ECO_INTERRUPTED, "interrupted");
	else if (child < 0 || !WIFEXITED(status) || WEXITSTATUS(status))
		code = eco_fail(error, ECO_IO, "this fails: %.400s", command);
	free(command);
	return code;
}

/* ---- Runs ---- */

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

static uint64_t mix(uint64_t sum, uint64_t value) { return XXH3_64bits_withSeed(&value, sizeof value, sum); }

static void hash_objects(const struct bench *bench, const char *objects, char stamp[17])
{
	uint64_t sum = 0;
	for (const char *at = objects; *at; at += strspn(at, " ")) {
		char pattern[PATH];
		glob_t found;
		int size = (int)strcspn(at, " ");
		snprintf(pattern, sizeof pattern, "%s/obj/%.*s", bench->build, size, at);
		at += size;
		if (glob(pattern, 0, NULL, &found))
			continue;
		for (size_t i = 0; i < found.gl_pathc; i++)
			sum = mix(sum, bench_file_hash(found.gl_pathv[i]));
		globfree(&found);
	}
	snprintf(stamp, 17, "%016llx", (unsigned long long)(sum ? sum : bench_file_hash("/proc/self/exe")));
}

void bench_objects_stamp(const struct bench *bench, const char *objects, char stamp[17])
{
	static struct { char objects[256], stamp[17]; } made[32];
	size_t i = 0, room = sizeof made / sizeof *made;
	objects = objects ? objects : "";
	while (i + 1 < room && *made[i].stamp && strcmp(made[i].objects, objects))
		i++;
	if (!*made[i].stamp || strcmp(made[i].objects, objects)) {
		snprintf(made[i].objects, sizeof made[i].objects, "%s", objects);
		hash_objects(bench, objects, made[i].stamp);
	}
	memcpy(stamp, made[i].stamp, 17);
}

const char *bench_objects(struct bench *bench, const char *objects)
{
	const char *before = bench->state->objects;
	bench->state->objects = objects;
	bench_objects_stamp(bench, objects, bench->state->program);
	return before;
}

enum eco_code bench_open(struct bench *bench, struct eco_error *error)
{
	char path[PATH];
	struct bench_state *s = bench->state;
	s->held = json_array();
	enum eco_code code = bench_folder_make(bench->out, error);
	for (int i = 0; i < 2 && !code; i++) {
		snprintf(path, sizeof path, "%s/%s", bench->cache, i ? "sections" : "units");
		code = bench_folder_make(path, error);
	}
	return code;
}

void bench_close(struct bench *bench)
{
	json_decref(bench->state->held);
	bench->state->held = NULL;
}

void bench_begin(struct bench *bench, const struct bench_section *section)
{
	struct bench_state *s = bench->state;
	s->section = section;
	s->items = json_array();
	s->keys = json_array();
	s->left_out = json_object();
	s->kept = s->recalled = 0;
	s->begun_s = bench_now_s();
	s->begun_cpu_s = s->unit_cpu_s = bench_cpu_s();
	s->units_cpu_s = s->longest_cpu_s = 0;
	bench_objects(bench, section->objects);
	s->record = json_pack("{s:s, s:s, s:s, s:b, s:O, s:O}", "name", section->name, "title",
		section->title, "program", s->program, "full", (int)bench->full, "items", s->items, "keys",
		s->keys);
}

/* An interrupted section does not replace what the same program once finished. */
static bool better_there(const struct bench *bench, const char *path)
{
	json_t *old = bench_json_read(path);
	const char *state = json_string_value(json_object_get(old, "state")),
		*program = json_string_value(json_object_get(old, "program"));
	bool better = state && program && !strcmp(state, "done") && !strcmp(program, bench->state->program);
	json_decref(old);
	return better;
}

enum eco_code bench_end(struct bench *bench, enum eco_code code, struct eco_error *error)
{
	char path[PATH];
	struct bench_state *s = bench->state;
	double seconds = bench_now_s() - s->begun_s;
	const char *state = code == ECO_OK ? "done" : code == ECO_INTERRUPTED ? "interrupted"
		: code == ECO_NOT_FOUND ? "missing" : "failed";
	erase_bar();
	say_left_out(bench);
	json_object_set_new(s->record, "state", json_string(state));
	json_object_set_new(s->record, "seconds", json_real(seconds));
	json_object_set_new(s->record, "cpu_s", json_real(bench_cpu_s() - s->begun_cpu_s));
	json_object_set_new(s->record, "units_cpu_s", json_real(s->units_cpu_s));
	json_object_set_new(s->record, "longest_cpu_s", json_real(s->longest_cpu_s));
	if (code)
		json_object_set_new(s->record, "why", json_string(error->text));
	snprintf(path, sizeof path, "%s/sections/%s.json", bench->cache, s->section->name);
	char *text = json_dumps(s->record, JSON_INDENT(1));
	enum eco_code written = ECO_OK;
	struct eco_error why = { 0 };
	if (!text)
		written = eco_fail(&why, ECO_BAD_INPUT, "%s: its record cannot be written as JSON",
			s->section->name);
	else if (code != ECO_INTERRUPTED || !better_there(bench, path))
		written = bench_file_write(path, text, strlen(text), &why);
	free(text);
	bench_note(bench, "%s: %s in %.1f s, %.1f s of processor time (%u pieces of work done, %u were "
		"there)%s%s", s->section->name, state, seconds, bench_cpu_s() - s->begun_cpu_s, s->kept,
		s->recalled, code && code != ECO_INTERRUPTED ? ": " : "", code && code != ECO_INTERRUPTED
		? error->text : "");
	if (written)
		bench_note(bench, "%s", why.text);
	json_decref(s->items);
	json_decref(s->keys);
	json_decref(s->left_out);
	json_decref(s->record);
	json_array_clear(s->held);
	s->section = NULL;
	return code ? code : written;
}

void bench_lost(struct bench *bench, const struct bench_section *section, int status)
{
	struct eco_error error = { 0 };
	bench_begin(bench, section);
	if (WIFSIGNALED(status))
		eco_fail(&error, ECO_IO, "its process was ended by signal %d", WTERMSIG(status));
	else
		eco_fail(&error, ECO_IO, "its process ended with status %d and without a word",
			WEXITSTATUS(status));
	bench_end(bench, ECO_IO, &error);
}
