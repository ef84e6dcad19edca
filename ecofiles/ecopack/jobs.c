/* Threads draw numbers from a counter; at the end of each round all of them wait. */
#include "ecofiles/ecopack/jobs.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>

#include "ecofiles/ecopack/times.h"

#define ROUND 1024u
#define RUN 8u                   /* numbers drawn at once */
#define THREADS_MAX 64u

struct done { enum eco_code code; struct eco_error *error; };

struct round {
	const struct main_jobs *jobs;
	uint64_t first;
	uint32_t count;
	atomic_uint next;
	struct done *done;
	uint8_t *results;
	enum main_stage stage;
};

static void do_piece(struct round *r, uint32_t k)
{
	struct eco_error error = { .code = ECO_OK };
	struct done *done = &r->done[k];
	done->code = r->jobs->work(r->jobs->ctx, r->first + k, r->results + k * r->jobs->result_size, &error);
	if (done->code && (done->error = malloc(sizeof error)))
		*done->error = error;
}

static void do_pieces(struct round *r)
{
	for (;;) {
		uint32_t from = atomic_fetch_add(&r->next, RUN);
		if (from >= r->count)
			return;
		for (uint32_t k = from; k < from + RUN && k < r->count; k++)
			do_piece(r, k);
	}
}

static void *help(void *ctx)
{
	struct round *r = ctx;
	main_times_stage(r->stage);
	do_pieces(r);
	main_times_stage(MAIN_STAGE_NONE);
	return NULL;
}

static void do_round(struct round *r)
{
	pthread_t helpers[THREADS_MAX];
	uint32_t wanted = r->jobs->threads < THREADS_MAX ? r->jobs->threads : THREADS_MAX, started = 0;
	atomic_store(&r->next, 0);
	while (started + 1 < wanted && (started + 1) * RUN < r->count
			&& pthread_create(&helpers[started], NULL, help, r) == 0)
		started++;
	do_pieces(r);
	for (uint32_t i = 0; i < started; i++)
		pthread_join(helpers[i], NULL);
}

/* Takes the results before the first failure. */
static enum eco_code take_round(struct round *r, struct eco_error *error)
{
	enum eco_code code = ECO_OK;
	for (uint32_t k = 0; k < r->count; k++) {
		struct done *done = &r->done[k];
		void *result = r->results + k * r->jobs->result_size;
		if (!code && done->code)
			code = eco_fail(error, done->code, "%s", done->error ? done->error->text
				: "out of memory");
		if (!code)
			code = r->jobs->take(r->jobs->ctx, r->first + k, result, error);
		r->jobs->drop(result);
		free(done->error);
	}
	return code;
}

enum eco_code main_jobs_run(const struct main_jobs *jobs, struct eco_error *error)
{
	enum eco_code code = ECO_OK;
	for (uint64_t first = 0; first < jobs->count && !code; first += ROUND) {
		struct round r = { .jobs = jobs, .first = first, .count = jobs->count - first < ROUND
			? (uint32_t)(jobs->count - first) : ROUND, .stage = main_times_now() };
		r.done = calloc(r.count, sizeof *r.done);
		r.results = calloc(r.count, jobs->result_size);
		if (r.done && r.results) {
			do_round(&r);
			code = take_round(&r, error);
		} else
			code = eco_fail(error, ECO_NO_MEMORY, "no memory for %u results", r.count);
		free(r.done);
		free(r.results);
	}
	return code;
}
