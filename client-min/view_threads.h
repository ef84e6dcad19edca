/* Work that is done in equal shares by several threads. */
#ifndef VIEW_THREADS_H
#define VIEW_THREADS_H

#include <stdint.h>

/* As many as are `wanted`, but at most 64; 0: 2. */
uint32_t view_thread_count(uint32_t wanted);
/* work(ctx, n) for each n below `count` (a view_thread_count), each on a thread of its own, 0 on the
 * caller's. The caller also does the shares whose threads the system refuses. Returns when all are done. */
void view_threads_run(uint32_t count, void (*work)(void *ctx, uint32_t number), void *ctx);

#endif
