/* Pieces of work for tests that ask whether threads change anything. */
#ifndef TWO_THREADS_H
#define TWO_THREADS_H

#include <stdint.h>

/* Runs all pieces, even ones in this thread and odd ones in another: as the `each` of builds. */
void in_two_threads(void *ctx, uint32_t count, void (*piece)(void *pieces, uint32_t i), void *pieces);

#endif
