#include "tests/support/two_threads.h"

#include <pthread.h>

#include "tests/support/unit_test.h"

struct half { uint32_t first, count; void (*piece)(void *pieces, uint32_t i); void *pieces; };

static void *run_half(void *half_of)
{
	const struct half *half = half_of;
	for (uint32_t i = half->first; i < half->count; i += 2)
		half->piece(half->pieces, i);
	return NULL;
}

void in_two_threads(void *ctx, uint32_t count, void (*piece)(void *pieces, uint32_t i), void *pieces)
{
	struct half halves[2] = { { 0, count, piece, pieces }, { 1, count, piece, pieces } };
	pthread_t other;
	(void)ctx;
	assert_int_equal(pthread_create(&other, NULL, run_half, &halves[1]), 0);
	run_half(&halves[0]);
	pthread_join(other, NULL);
}
