/* The inside of ecobench: shared by bench.c, bench_main.c and bench_scene.c, not by sections.
 *
 *   bench_open(&bench, &error)                           folders
 *   bench_begin(&bench, section); section->run(); bench_end(&bench, code, &error);
 *         keeps the section's record in CACHE/sections/NAME.json
 *   bench_report_write(&bench, sections, &error)         report.html, papers.html, summary.json and plots
 *   bench_close(&bench)
 *
 * A record holds all results of a section:
 *   {"name", "title", "program": stamp, "full", "state": "done" | "interrupted" | "missing" | "failed",
 * "why",
 *    "seconds", "keys": [{"key", "value", "bar"}], "items": [item]}
 * and an item is
 *   {"kind": "head" | "say", "text"}, {"kind": "picture", "file", "caption"},
 *   {"kind": "table", "name", "columns", "show", "rows": ["cell,cell"]} or
 *   {"kind": "plot", "name", "title", "x", "y", "log_x", "log_y", "series": [{"name", "points", "x": [], "y":
 * []}]} report/report.py draws them; it shows sections that did not run this time as they were. */
#ifndef TESTS_BENCH_STATE_H
#define TESTS_BENCH_STATE_H

#include <stdarg.h>

#include "ecofiles/base/files.h"
#include "tests/bench/bench.h"

struct bench_state {
	bool trust;                  /* units of earlier programs count too */
	bool quiet;
	const struct bench_section *section;
	json_t *record, *items, *keys;       /* the latter two within the first */
	json_t *left_out;            /* an object whose keys are names */
	json_t *held;                /* units that were given out */
	double begun_s;              /* of the section */
	uint32_t kept, recalled;     /* units of this section that were done, and that were there */
};

enum eco_code bench_open(struct bench *bench, struct eco_error *error);
void bench_close(struct bench *bench);

const char *bench_program(void);         /* a hash of it, in hex */
void bench_begin(struct bench *bench, const struct bench_section *section);
enum eco_code bench_end(struct bench *bench, enum eco_code code, struct eco_error *error);
enum eco_code bench_report_write(struct bench *bench, const struct bench_section *const *sections,
	struct eco_error *error);

/* The whole program: reads the command line, runs sections (NULL ends), returns the exit status. */
int bench_main(int argc, char **argv, const struct bench_section *const *sections);

double bench_now_s(void);
void bench_catch_interrupts(void);
void bench_note(const struct bench *bench, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* As vasprintf, but there is always a text. The caller frees it. */
char *bench_text(const char *format, va_list args);
/* NULL where the file is missing or damaged. */
json_t *bench_json_read(const char *path);
enum eco_code bench_json_write(const char *path, const json_t *value, struct eco_error *error);

#endif
