/* Hostile ground: libraries that read files of strangers (assimp, OpenImageIO, GDAL) run in a child process with limits on memory
 * and time, which hands back plain bytes. A crash there is an error message here. */
#ifndef ECO_GUARD_H
#define ECO_GUARD_H

#include <stdint.h>
#include <stdio.h>

#include "ecofiles/status.h"

struct eco_guard_limits {                /* a zero stands for the default */
	uint64_t memory_bytes;               /* of address space (not limited under sanitizers) */
	uint32_t cpu_s;                      /* processor time */
	uint32_t clock_s;                    /* time by the clock */
};
#define ECO_GUARD_MEMORY (24ull << 30)
#define ECO_GUARD_CPU_S 1800u
#define ECO_GUARD_CLOCK_S 3600u

/* What the child does: writes its result to `out`. Its return value and error travel back. */
typedef enum eco_code eco_guard_work(void *ctx, FILE *out, struct eco_error *error);

/* Runs work(ctx, out, error) in a child and waits. On ECO_OK *result is a stream positioned at the first byte that was written,
 * to be closed by the caller; what is in it is as little to be trusted as the file it came from. `what` names the input in
 * messages; `limits` may be NULL. The child is a copy of the calling thread alone: it must not need locks that other threads may
 * hold. */
enum eco_code eco_guard_run(eco_guard_work *work, void *ctx, const char *what, const struct eco_guard_limits *limits, FILE **result,
	struct eco_error *error);

/* The same while it runs: *stream is what the child writes, as it comes (a pipe), for results that nobody should hold whole. Read it
 * to its end, or stop early; then eco_guard_finish closes it, ends the child if it still runs, and gives the verdict: ECO_OK, what work
 * returned, or how the child died. A child that was ended early because nobody reads on is no error. */
struct eco_guard;
enum eco_code eco_guard_start(struct eco_guard **guard, eco_guard_work *work, void *ctx, const char *what,
	const struct eco_guard_limits *limits, FILE **stream, struct eco_error *error);
enum eco_code eco_guard_finish(struct eco_guard *guard, struct eco_error *error);

#endif
