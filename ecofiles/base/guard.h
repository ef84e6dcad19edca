/* Hostile ground: libraries that read files of strangers (assimp, OpenImageIO, GDAL) run in a child process, which hands back plain
 * bytes. A crash there is an error message here.
 *
 * The child has limits on memory, processor time, time by the clock and what it may write; it has none of the parent's descriptors but
 * standard error's; and where the kernel allows (guard_filter.h) it can open no file for writing, no socket and no program. It may read
 * whatever the user may read, as models name textures anywhere. What it hands back is as little to be trusted as the file. */
#ifndef ECO_GUARD_H
#define ECO_GUARD_H

#include <stdint.h>
#include <stdio.h>

#include "ecofiles/base/status.h"

struct eco_guard_limits {                /* a zero stands for the default */
	uint64_t memory_bytes;               /* of address space beyond what the parent has (not limited under sanitizers) */
	uint32_t cpu_s;                      /* processor time */
	uint32_t clock_s;                    /* time by the clock that the parent waits for it */
};
#define ECO_GUARD_MEMORY (24ull << 30)
#define ECO_GUARD_CPU_S 1800u
#define ECO_GUARD_CLOCK_S 3600u

/* Limits for files of `bytes` altogether: a generous base (small files unpack to large ones: textures, Draco) and so much a byte. */
struct eco_guard_limits eco_guard_limits_for(uint64_t bytes);

/* Whoever runs the program has the last word, for the rare file that needs more (or the server that wants less): these environment
 * variables replace whatever limit a caller asks for. Seconds are processor time; the clock's limit is twice that. */
#define ECO_GUARD_MEMORY_VARIABLE "ECO_IMPORT_MEMORY_GB"
#define ECO_GUARD_SECONDS_VARIABLE "ECO_IMPORT_SECONDS"

/* What the child does: writes its result to `out`. Its return value and error travel back. */
typedef enum eco_code eco_guard_work(void *ctx, FILE *out, struct eco_error *error);

/* Runs work(ctx, out, error) in a child and waits. On ECO_OK *result is a stream positioned at the first byte that was written,
 * to be closed by the caller; what is in it is as little to be trusted as the file it came from. `what` names the input in
 * messages; `limits` may be NULL. The child is a copy of the calling thread alone: it must not need locks that other threads may
 * hold, nor descriptors that are open in the parent. Errors: what work returned; ECO_TOO_LARGE beyond a limit on time or memory,
 * with the variable that lifts it; ECO_DAMAGED after a crash; ECO_IO if it was killed from outside; ECO_INTERRUPTED. */
enum eco_code eco_guard_run(eco_guard_work *work, void *ctx, const char *what, const struct eco_guard_limits *limits, FILE **result,
	struct eco_error *error);

/* The same while it runs: *stream is what the child writes, as it comes (a pipe), for results that nobody should hold whole. Read it
 * to its end, or stop early; then eco_guard_finish closes it, ends the child if it still runs, and gives the verdict: ECO_OK, what work
 * returned, or how the child died. A child that was ended early because nobody reads on is no error: only who has met the end of the
 * stream (fread gave less than was asked for) learns how it ended. The clock's limit is on the time that reading waits. One thread
 * reads and finishes; eco_guard_finish(NULL) is ECO_OK. */
struct eco_guard;
enum eco_code eco_guard_start(struct eco_guard **guard, eco_guard_work *work, void *ctx, const char *what,
	const struct eco_guard_limits *limits, FILE **stream, struct eco_error *error);
enum eco_code eco_guard_finish(struct eco_guard *guard, struct eco_error *error);

/* Ends all children that run now; who waits for them gets ECO_INTERRUPTED. For signal handlers: it is async-signal-safe. */
void eco_guard_interrupt(void);

#endif
