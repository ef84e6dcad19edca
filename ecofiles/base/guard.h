/* Libraries that read files of strangers (assimp, OpenImageIO, GDAL) run in a child process, which hands
 * back plain bytes: a crash there is an error message here.
 *
 * The child has limits on memory, on processor time and on time by the clock. It has none of the parent's
 * descriptors but standard error's, and where the kernel allows (confine.h) it cannot open a file for
 * writing, a socket or a program. It may read whatever the user may read, as models name textures
 * anywhere, unless the program is confined (confine.h). Trust its result as little as the file. */
#pragma once

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "ecofiles/base/status.h"

struct eco_guard_limits {                /* a zero stands for the default */
	/* address space beyond the parent's; no limit under sanitizers */
	uint64_t memory_bytes;
	uint32_t cpu_s;                      /* processor time */
	uint32_t clock_s;                    /* time by the clock that the parent waits */
};
#define ECO_GUARD_MEMORY (24ull << 30)
#define ECO_GUARD_CPU_S 1800u
#define ECO_GUARD_CLOCK_S 3600u

/* Limits for files of `bytes` in all: a generous base (textures and Draco unpack small files to large
 * data), and more for each byte. */
struct eco_guard_limits eco_guard_limits_for(uint64_t bytes);

/* Memory for files of tables, and for others that eco_guard_unpacks: 1 GiB, and 64 bytes for each byte of the
 * files. A few kilobytes of a zip file or of a database's view can ask for any number of gigabytes. */
uint64_t eco_guard_small_memory(const char *const *paths, uint32_t count);
/* Whether the file is a zip file or an SQLite database, by its first bytes. */
bool eco_guard_unpacks(const char *path);

/* These environment variables replace any limit that a caller asks for: a rare file needs more, a server
 * may want less. Seconds are of processor time; the clock's limit is twice that. */
#define ECO_GUARD_MEMORY_VARIABLE "ECO_IMPORT_MEMORY_GB"
#define ECO_GUARD_SECONDS_VARIABLE "ECO_IMPORT_SECONDS"

/* The child's work: it writes its result to `out`. Its return value and error travel back. */
typedef enum eco_code eco_guard_work(void *ctx, FILE *out, struct eco_error *error);

/* Runs work(ctx, out, error) in a child and waits. On ECO_OK *result is a stream at the first byte
 * written, which the caller closes; trust its content as little as the file it came from. `what` names the
 * input in messages; `limits` may be NULL. The child is a copy of the calling thread alone: it must not
 * need locks that other threads may hold, nor descriptors that are open in the parent. Errors: those of
 * work; ECO_TOO_LARGE beyond a limit on time or memory, with the variable that lifts it; ECO_DAMAGED after
 * a crash; ECO_IO if the child was killed from outside; ECO_INTERRUPTED. */
enum eco_code eco_guard_run(eco_guard_work *work, void *ctx, const char *what,
	const struct eco_guard_limits *limits, FILE **result, struct eco_error *error);

/* As eco_guard_run, but *stream is a pipe from the running child, for results too large to hold whole.
 * Read it to its end or stop early; then eco_guard_finish closes it, ends the child if it still runs, and
 * gives the verdict: ECO_OK, what work returned, or how the child died. Stopping early is no error. A read
 * that met the end of the stream (fread gave less than was asked for) must be followed by the verdict,
 * which alone says how the child ended. The clock's limit is on the time that reading waits. One thread
 * reads and finishes; eco_guard_finish(NULL) is ECO_OK. */
struct eco_guard;
enum eco_code eco_guard_start(struct eco_guard **guard, eco_guard_work *work, void *ctx, const char *what,
	const struct eco_guard_limits *limits, FILE **stream, struct eco_error *error);
enum eco_code eco_guard_finish(struct eco_guard *guard, struct eco_error *error);

/* A child has this variable in its environment. It ends with this status where memory ran out (memory.h). */
#define ECO_GUARD_CHILD_VARIABLE "ECO_GUARD_CHILD"
#define ECO_GUARD_NO_MEMORY_STATUS 112

/* Notes in a child that memory ran out, for code that then ends the process. Does nothing elsewhere. */
void eco_guard_no_memory(void);

/* Ends all children that run now, within a tenth of a second; their parents' calls return ECO_INTERRUPTED.
 * Async-signal-safe, for signal handlers. */
void eco_guard_interrupt(void);
