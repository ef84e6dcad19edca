/* Hostile ground: libraries that read files of strangers (assimp, OpenImageIO, GDAL) run in a child process with limits on memory
 * and time, which hands back plain bytes. A crash there is an error message here. */
#ifndef ECO_GUARD_H
#define ECO_GUARD_H

#include <stdio.h>

#include "ecofiles/status.h"

#define ECO_GUARD_CPU_S 1800u            /* processor time of the child; twice as long by the clock */
#define ECO_GUARD_MEMORY (24ull << 30)   /* bytes of address space (not limited under sanitizers) */

/* What the child does: writes its result to `out`. Its return value and error travel back. */
typedef enum eco_code eco_guard_work(void *ctx, FILE *out, struct eco_error *error);

/* Runs work(ctx, out, error) in a child and waits. On ECO_OK *result is a stream positioned at the first byte that was written,
 * to be closed by the caller; what is in it is as little to be trusted as the file it came from. `what` names the input in
 * messages. The child is a copy of the calling thread alone: it must not need locks that other threads may hold. */
enum eco_code eco_guard_run(eco_guard_work *work, void *ctx, const char *what, FILE **result, struct eco_error *error);

#endif
