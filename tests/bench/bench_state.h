/* Inside ecobench: what bench.c, bench_report.c and ecobench.c share. Sections do not include this.
 *
 *   bench_open(&bench, &error)                    folders, the program's own stamp
 *   bench_begin(&bench, section); section->run(); bench_end(&bench, code, &error);
 *         its record is kept: sections/NAME.json
 *   bench_report_write(&bench, sections, &error)  report.html and summary.json from all records that are kept
 *   bench_close(&bench)
 *
 * A record holds all that a section said: {"name", "title", "state", "seconds", "program", "full", "items":
 * [...], "keys": [...]}. So the report of one section's run has the others in it as they were, and says which
 * are of an earlier program. */
#ifndef TESTS_BENCH_STATE_H
#define TESTS_BENCH_STATE_H

#include "tests/bench/bench.h"

struct bench_state {
	char program[17];            /* a hash of what units come from now, in hex: of `objects` */
	const char *objects;
	bool trust;                  /* units of earlier programs count too */
	bool quiet;
	const struct bench_section *section;
	json_t *record, *items, *keys;
	json_t *left_out;            /* an object whose keys are names */
	json_t *held;                /* units that were given out */
	/* of the section; of what is done since the last unit */
	double begun_s, begun_cpu_s, unit_cpu_s;
	double units_cpu_s;          /* of all its units, whenever they were done */
	double longest_cpu_s;        /* of one of them: what stopping may lose */
	uint32_t kept, recalled;     /* units of this section that were done, and that were there */
};

enum eco_code bench_open(struct bench *bench, struct eco_error *error);
void bench_close(struct bench *bench);

/* A hash of objects (see bench_section); of this program where they are not there. Each is made once. */
void bench_objects_stamp(const struct bench *bench, const char *objects, char stamp[17]);
void bench_begin(struct bench *bench, const struct bench_section *section);
enum eco_code bench_end(struct bench *bench, enum eco_code code, struct eco_error *error);

/* `sections`: as many as there are, NULL ends. */
enum eco_code bench_report_write(struct bench *bench, const struct bench_section *const *sections,
	struct eco_error *error);

/* The whole program: reads the command line, runs sections (NULL ends), returns the exit status. */
int bench_main(int argc, char **argv, const struct bench_section *const *sections);

double bench_now_s(void);
/* of this process, and of those that it started and waited for */
double bench_cpu_s(void);
/* Says what became of a section whose process ended without a word. */
void bench_lost(struct bench *bench, const struct bench_section *section, int status);
void bench_catch_interrupts(void);
bool bench_interrupted(void);
void bench_note(const struct bench *bench, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* One process at a time makes what lies in the cache for all: scenes, packs, models. -1 where no file can be
 * locked. */
int bench_lock(const struct bench *bench);
void bench_unlock(int lock);

/* A whole file, beside and renamed; "" in `bytes` makes an empty one. */
enum eco_code bench_file_write(const char *path, const char *bytes, size_t size, struct eco_error *error);
enum eco_code bench_folder_make(const char *path, struct eco_error *error);      /* with those above it */
/* JSON that is there and is whole, or NULL. */
json_t *bench_json_read(const char *path);

#endif
