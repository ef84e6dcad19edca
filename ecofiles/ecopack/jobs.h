/* Numbered pieces of work, done in threads, with results taken in order: the outcome does not depend on
 * the number of threads.
 *
 * Work is done in rounds: all threads work on some hundreds of pieces, then wait while the caller's thread
 * takes the results one by one. So `work` may read without locks what `take` changes. */
#ifndef ECO_MAIN_JOBS_H
#define ECO_MAIN_JOBS_H

#include <stddef.h>
#include <stdint.h>

#include "ecofiles/base/status.h"

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

#endif
