#include "client-min/view_threads.h"

#include <pthread.h>
#include <stdbool.h>

#define THREADS_MAX 64u

struct share {
	void (*work)(void *ctx, uint32_t number);
	void *ctx;
	uint32_t number;
	pthread_t thread;
	bool started;
};

static void *run(void *ctx)
{
	const struct share *share = ctx;
	share->work(share->ctx, share->number);
	return NULL;
}

uint32_t view_thread_count(uint32_t wanted)
{
	uint32_t count = wanted ? wanted : 2;
	return count < THREADS_MAX ? count : THREADS_MAX;
}

void view_threads_run(uint32_t count, void (*work)(void *ctx, uint32_t number), void *ctx)
{
	struct share shares[THREADS_MAX];
	for (uint32_t i = 0; i < count; i++) {
		shares[i] = (struct share){ .work = work, .ctx = ctx, .number = i };
		shares[i].started = i && pthread_create(&shares[i].thread, NULL, run, &shares[i]) == 0;
	}
	for (uint32_t i = 0; i < count; i++)
		if (!shares[i].started)
			work(ctx, i);
	for (uint32_t i = 0; i < count; i++)
		if (shares[i].started)
			pthread_join(shares[i].thread, NULL);
}
