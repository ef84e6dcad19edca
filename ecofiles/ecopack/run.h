/* Long runs: progress, time by stage, and work in threads. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "ecofiles/base/progress.h"
#include "ecofiles/base/status.h"

/* ---- Progress ---- */

/* As progress.h, for the program ecopack. */

/* After this Ctrl-C and SIGTERM end the program at the next call of main_progress, and a file beyond the
 * user's size limit is a failed write: so nothing half written stays. */
void main_catch_interrupts(void);

void main_progress(const char *stage, const char *detail, double share);
static inline void main_progress_end(void) { eco_progress_end(); }
bool main_scatter_progress(void *path, double share);    /* for eco_scatter_open; true */

#define main_note eco_progress_note
void main_note_text(void *unused, const char *text);     /* the same, as a callback */

/* ---- Times ---- */

/* Time of a build by stage, for `ecopack make --times`. Nothing of it goes into the pack. */

enum main_stage {
	MAIN_STAGE_NONE,
	MAIN_STAGE_SCENE,            /* scene files, inventories opened */
	MAIN_STAGE_GROUND,
	MAIN_STAGE_MODELS,           /* with the child processes */
	MAIN_STAGE_CACHE,            /* plants of earlier builds */
	MAIN_STAGE_ELEMENTS,         /* welding, organs, elements */
	MAIN_STAGE_ORDERS,
	MAIN_STAGE_LISTS,            /* cells, points, lines, levels */
	MAIN_STAGE_SPLATS,           /* fitted to whole plants */
	MAIN_STAGE_CURVES,           /* scales s_opt, and fineness of grids */
	MAIN_STAGE_TEXTURES,
	MAIN_STAGE_PACKING,          /* the plants' lists */
	MAIN_STAGE_POSITIONS,
	MAIN_STAGE_TILES,            /* the tile tree and its instance lists */
	MAIN_STAGE_SUMMARIES,
	MAIN_STAGE_WRITING,
	MAIN_STAGE_COUNT
};

/* Sets the calling thread's stage from now on. Times of threads in one stage add up. */
void main_times_stage(enum main_stage stage);

/* Plants found in the cache (a folder; "": none), and plants not found: for the line under the table. */
void main_times_cache(const char *folder, uint64_t hits, uint64_t misses);

/* A table: elapsed and processor seconds by stage. */
void main_times_print(FILE *out);

/* Since the first stage: seconds by the clock, and greatest memory of this process and of any child, in
 * MB. */
void main_times_total(double *elapsed_s, double *most_mb);

/* ---- Work in threads ---- */

#define MAIN_THREADS_MAX 64u

/* Does pieces 0 to count - 1 in so many threads (0: one), the caller's among them, each of which draws `run`
 * of them at once. The others are in the caller's stage. */
struct main_each { uint32_t threads, count, run; void (*piece)(void *ctx, uint32_t i); void *ctx; };
void main_each(const struct main_each *what);

/* Numbered pieces of work, done in threads, with results taken in order: the outcome does not depend on
 * the number of threads.
 *
 * Work is done in rounds: all threads work on some hundreds of pieces, then wait while the caller's thread
 * takes the results one by one. So `work` may read without locks what `take` changes. */

struct main_jobs {
	uint64_t count;
	uint32_t threads;            /* 0: one */
	size_t result_size;          /* results start as zeros */
	/* any thread, any order */
	enum eco_code (*work)(void *ctx, uint64_t i, void *result, struct eco_error *error);
	/* the caller's thread, ascending */
	enum eco_code (*take)(void *ctx, uint64_t i, void *result, struct eco_error *error);
	void (*drop)(void *result);  /* frees a result's content, after `take` or after a failure */
	void *ctx;
};

/* Returns the error of the lowest piece that failed; the pieces before it were taken. */
enum eco_code main_jobs_run(const struct main_jobs *jobs, struct eco_error *error);
