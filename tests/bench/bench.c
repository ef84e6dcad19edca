/* The frame that sections run in: units kept on disk, records of results, progress, Ctrl-C.
 *
 * A unit's file holds the stamp that it was made under; a unit of another program or input is made anew, and
 * so is a damaged one. Files are written beside and renamed. */
#include "tests/bench/bench_state.h"

#include <math.h>
#include <signal.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>
#include <xxhash.h>

#include "ecofiles/base/guard.h"

#define PATH 1024

/* ---- Interruption ---- */

static volatile sig_atomic_t interrupted, reported;

#define TWICE_S 1.0               /* wrappers (timeout, make) may pass one Ctrl-C on twice */

/* A second Ctrl-C ends the program at once and loses the unit at hand. */
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
	sigaction(SIGINT, &action, NULL);
	sigaction(SIGTERM, &action, NULL);
}

bool bench_stopped(const struct bench *bench)
{
	if (interrupted && !reported) {
		reported = 1;
		bench_note(bench,
			"stopping after this piece of work; finished pieces are kept (Ctrl-C again stops at "
			"once)");
	}
	return interrupted != 0;
}

bool bench_goes_on(void *bench, double share)
{
	(void)share;
	return !bench_stopped(bench);
}

/* ---- Progress ---- */

static bool line_shown;

double bench_now_s(void)
{
	struct timespec t;
	clock_gettime(CLOCK_MONOTONIC, &t);
	return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void erase_line(void)
{
	if (line_shown)
		fputs("\r\033[K", stderr);
	line_shown = false;
}

void bench_note(const struct bench *bench, const char *format, ...)
{
	va_list args;
	if (bench->state->quiet)
		return;
	erase_line();
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
	erase_line();
	fprintf(stderr, "ecobench: %s: %.60s, %.0f %%%s", bench->state->section->name, what,
		100 * fmin(fmax(share, 0), 1), terminal ? "" : "\n");
	line_shown = terminal;
}

/* ---- Files ---- */

json_t *bench_json_read(const char *path) { return json_load_file(path, JSON_REJECT_DUPLICATES, NULL); }

enum eco_code bench_json_write(const char *path, const json_t *value, struct eco_error *error)
{
	char *text = value ? json_dumps(value, JSON_COMPACT) : NULL;
	enum eco_code code = text ? eco_file_write(path, text, strlen(text), error)
		: eco_fail(error, ECO_BAD_INPUT, "%s: holds a NaN, or text that is not UTF-8", path);
	free(text);
	return code;
}

/* A readable name that no other text shares. */
static void unit_path(char out[PATH], const struct bench *bench, const char *unit)
{
	char clean[80];
	snprintf(clean, sizeof clean, "%s", unit);
	for (char *c = clean; *c; c++)
		if (!strchr("-_0123456789abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ", *c))
			*c = '-';
	snprintf(out, PATH, "%s/units/%s-%08x.json", bench->cache, clean,
		(unsigned)XXH3_64bits(unit, strlen(unit)));
}

/* ---- Units ---- */

static json_t *recall(struct bench *bench, const char *unit, const char *stamp)
{
	char path[PATH];
	struct bench_state *s = bench->state;
	unit_path(path, bench, unit);
	if (access(path, F_OK))
		return NULL;
	const char *name = "", *program = "", *under = "";
	json_t *kept = bench_json_read(path), *result = NULL;
	if (json_unpack(kept, "{s:s, s:s, s:s, s:o}", "unit", &name, "program", &program, "stamp", &under,
		"result", &result) || strcmp(name, unit)) {
		bench_note(bench, "%s is damaged: this piece of work is done anew", path);
		result = NULL;
	} else if (strcmp(under, stamp) || (strcmp(program, bench_program()) && !s->trust)) {
		result = NULL;
	} else {
		json_array_append(s->held, result);
		s->recalled++;
	}
	json_decref(kept);
	return result;
}

static void keep(struct bench *bench, const char *unit, const char *stamp, json_t *result)
{
	char path[PATH];
	struct bench_state *s = bench->state;
	struct eco_error error = { 0 };
	unit_path(path, bench, unit);
	json_t *kept = json_pack("{s:s, s:s, s:s, s:O}", "unit", unit, "program", bench_program(), "stamp",
		stamp, "result", result);
	/* a full disk costs the next run some time, not this one its result */
	if (bench_json_write(path, kept, &error))
		bench_note(bench, "%s; not kept", error.text);
	json_decref(kept);
	json_array_append_new(s->held, result);
	s->kept++;
}

enum eco_code bench_go_on(const struct bench *bench, struct eco_error *error)
{
	return bench_stopped(bench) ? eco_fail(error, ECO_INTERRUPTED, "interrupted") : ECO_OK;
}

enum eco_code bench_unit(struct bench *bench, const char *unit, const char *stamp, bench_make *make, void
	*ctx, json_t **result, struct eco_error *error)
{
	json_t *made = NULL;
	enum eco_code code = bench_go_on(bench, error);
	*result = code ? NULL : recall(bench, unit, stamp ? stamp : "");
	if (code || *result)
		return code;
	code = make(ctx, &made, error);
	if (code)
		json_decref(made);
	else
		keep(bench, unit, stamp ? stamp : "", *result = made);
	return code;
}

/* ---- Programs ---- */

/* As vasprintf, but there is always a text. The caller frees it. */
char *bench_text(const char *format, va_list args)
{
	char *text = NULL;
	if (vasprintf(&text, format, args) < 0 || !text)
		abort();
	return text;
}

/* Returns the status of waitpid, -1 where there is none. Not system(), which would swallow Ctrl-C. The shell
 * has a group of its own, so that Ctrl-C ends it and its children only where `stops`. */
static int shell(const char *command, bool stops)
{
	erase_line();
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
	/* polled: a blocking wait would miss a signal that came just before it */
	while (child > 0 && waitpid(child, &status, WNOHANG) == 0) {
		if (stops && interrupted && !told)
			told = kill(-child, SIGTERM) == 0;
		nanosleep(&(struct timespec){ 0, 20000000 }, NULL);
	}
	return status;
}

enum eco_code bench_command(struct bench *bench, struct eco_error *error, const char *format, ...)
{
	va_list args;
	va_start(args, format);
	char *command = bench_text(format, args);
	va_end(args);
	int status = shell(command, true);
	enum eco_code code = bench_go_on(bench, error);
	if (!code && (!WIFEXITED(status) || WEXITSTATUS(status)))
		code = eco_fail(error, ECO_IO, "this fails: %.400s", command);
	free(command);
	return code;
}

/* ---- Stamps ---- */

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
const char *bench_program(void)
{
	static char stamp[17];
	if (!*stamp)
		snprintf(stamp, sizeof stamp, "%016llx",
			(unsigned long long)bench_file_hash("/proc/self/exe"));
	return stamp;
}

/* ---- Runs ---- */

static void say_left_out(struct bench *bench)
{
	char text[4096] = "";
	size_t used = 0;
	const char *name;
	json_t *value;
	json_object_foreach(bench->state->left_out, name, value)
		if (used < sizeof text)
			used += (size_t)snprintf(text + used, sizeof text - used, "%s%s", used ? ", " : "",
				name);
	if (used)
		bench_say(bench, "Left out without FULL=1: %s.", text);
}

enum eco_code bench_open(struct bench *bench, struct eco_error *error)
{
	bench->state->held = json_array();
	return bench_command(bench, error, "mkdir -p '%s' '%s/units' '%s/sections'", bench->out, bench->cache,
		bench->cache);
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
	s->record = json_pack("{s:s, s:s, s:s, s:b, s:[], s:[]}", "name", section->name, "title",
		section->title, "program", bench_program(), "full", (int)bench->full, "items", "keys");
	s->items = json_object_get(s->record, "items");
	s->keys = json_object_get(s->record, "keys");
	s->left_out = json_object();
	s->kept = s->recalled = 0;
	s->begun_s = bench_now_s();
}

enum eco_code bench_end(struct bench *bench, enum eco_code code, struct eco_error *error)
{
	char path[PATH];
	struct bench_state *s = bench->state;
	struct eco_error why = { 0 };
	double seconds = bench_now_s() - s->begun_s;
	const char *state = code == ECO_OK ? "done" : code == ECO_INTERRUPTED ? "interrupted"
		: code == ECO_NOT_FOUND ? "missing" : "failed";
	bool told = code && code != ECO_INTERRUPTED;
	say_left_out(bench);
	json_t *more = json_pack("{s:s, s:f, s:s}", "state", state, "seconds", seconds, "why",
		code ? error->text : "");
	json_object_update(s->record, more);
	json_decref(more);
	snprintf(path, sizeof path, "%s/sections/%s.json", bench->cache, s->section->name);
	enum eco_code written = bench_json_write(path, s->record, &why);
	bench_note(bench, "%s: %s in %.1f s (%u pieces of work done, %u were there)%s%s", s->section->name,
		state, seconds, s->kept, s->recalled, told ? ": " : "", told ? error->text : "");
	if (written)
		bench_note(bench, "%s", why.text);
	json_decref(s->left_out);
	json_decref(s->record);
	json_array_clear(s->held);
	s->section = NULL;
	return code ? code : written;
}

#define SCRIPT "tests/bench/report/report.py"

enum eco_code bench_report_write(struct bench *bench, const struct bench_section *const *sections,
	struct eco_error *error)
{
	char path[PATH], command[3 * PATH];
	json_t *names = json_array();
	for (; *sections; sections++)
		json_array_append_new(names, json_string((*sections)->name));
	json_t *run = json_pack("{s:b, s:s, s:s?, s:o}", "full", (int)bench->full, "program",
		bench_program(), "data", bench->data, "sections", names);
	snprintf(path, sizeof path, "%s/run.json", bench->cache);
	enum eco_code code = bench_json_write(path, run, error);
	json_decref(run);
	snprintf(command, sizeof command, SCRIPT " '%s' '%s'", bench->out, bench->cache);
	return code || !shell(command, false) ? code
		: eco_fail(error, ECO_IO, "no report: " SCRIPT
		" needs python3 and the source tree as working folder");
}
