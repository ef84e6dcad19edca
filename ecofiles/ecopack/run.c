#include "ecofiles/ecopack/command.h"
#include "ecofiles/ecopack/run.h"

#include <inttypes.h>
#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>

#include "ecofiles/base/guard.h"
#include "ecofiles/base/memory.h"

/* ---- Progress ---- */

static volatile sig_atomic_t interrupted;

static void ask_to_stop(int number)
{
	(void)number;
	interrupted = 1;
	eco_guard_interrupt();               /* a wait for a child would not notice */
}

void main_catch_interrupts(void)
{
	struct sigaction action = { .sa_handler = ask_to_stop };
	sigemptyset(&action.sa_mask);
	sigaction(SIGINT, &action, NULL);
	sigaction(SIGTERM, &action, NULL);
	action.sa_handler = SIG_IGN;
	sigaction(SIGXFSZ, &action, NULL);
}

void main_progress(const char *stage, const char *detail, double share)
{
	if (interrupted)
		eco_end("interrupted");
	eco_progress(stage, detail, share);
}

bool main_scatter_progress(void *path, double share)
{
	main_progress("scattering plants", path, share);
	return true;
}

void main_note_text(void *unused, const char *text)
{
	(void)unused;
	main_note("%s", text);
}

/* ---- Times ---- */

/* A thread that changes its stage adds the clock and processor time since its last change to the stage it
 * leaves. */

static const char *const names[MAIN_STAGE_COUNT] =
	{ [MAIN_STAGE_SCENE] = "scene", [MAIN_STAGE_GROUND] = "ground",
		[MAIN_STAGE_MODELS] = "reading models", [MAIN_STAGE_CACHE] = "cache",
		[MAIN_STAGE_ELEMENTS] = "organs and elements", [MAIN_STAGE_ORDERS] = "orders",
		[MAIN_STAGE_LISTS] = "levels lines points", [MAIN_STAGE_SPLATS] = "splats",
		[MAIN_STAGE_CURVES] = "curves and scales",
		[MAIN_STAGE_TEXTURES] = "textures", [MAIN_STAGE_PACKING] = "packing plants",
		[MAIN_STAGE_POSITIONS] = "positions", [MAIN_STAGE_TILES] = "tiles",
		[MAIN_STAGE_SUMMARIES] = "summaries", [MAIN_STAGE_WRITING] = "writing" };

static struct { double elapsed_s, cpu_s; } stages[MAIN_STAGE_COUNT];
static pthread_mutex_t times_lock = PTHREAD_MUTEX_INITIALIZER;
static double start_s;
static struct { char folder[1024]; uint64_t hits, misses; } times_cache;

static _Thread_local struct { enum main_stage stage; double since_s, cpu_s, readers_s; } mine;

static double of(struct timeval t) { return (double)t.tv_sec + 1e-6 * (double)t.tv_usec; }

/* Processor time of child processes that have ended. */
static double readers(void)
{
	struct rusage used;
	getrusage(RUSAGE_CHILDREN, &used);
	return of(used.ru_utime) + of(used.ru_stime);
}

void main_times_stage(enum main_stage stage)
{
	double now = eco_clock_s(CLOCK_MONOTONIC), cpu = eco_clock_s(CLOCK_THREAD_CPUTIME_ID), readers_s = readers();
	if (stage == mine.stage)
		return;
	pthread_mutex_lock(&times_lock);
	start_s = start_s > 0 ? start_s : now;
	if (mine.stage != MAIN_STAGE_NONE) {
		stages[mine.stage].elapsed_s += now - mine.since_s;
		stages[mine.stage].cpu_s += cpu - mine.cpu_s;
	}
	if (mine.stage == MAIN_STAGE_MODELS || mine.stage == MAIN_STAGE_GROUND
			|| mine.stage == MAIN_STAGE_POSITIONS)
		stages[mine.stage].cpu_s += readers_s - mine.readers_s;
	pthread_mutex_unlock(&times_lock);
	mine.stage = stage;
	mine.since_s = now;
	mine.cpu_s = cpu;
	mine.readers_s = readers_s;
}

void main_times_cache(const char *folder, uint64_t hits, uint64_t misses)
{
	snprintf(times_cache.folder, sizeof times_cache.folder, "%s", folder);
	times_cache.hits = hits;
	times_cache.misses = misses;
}

void main_times_print(FILE *out)
{
	fprintf(out, "\n%-22s %9s %9s\n", "stage", "elapsed", "processor");
	for (int i = 1; i < MAIN_STAGE_COUNT; i++)
		if (stages[i].elapsed_s > 0)
			fprintf(out, "%-22s %7.2f s %7.2f s\n", names[i], stages[i].elapsed_s, stages[i].cpu_s);
	if (times_cache.folder[0])
		fprintf(out, "%" PRIu64 " of %" PRIu64 " plants were built before and came from %s\n",
			times_cache.hits, times_cache.hits + times_cache.misses, times_cache.folder);
}

void main_times_total(double *elapsed_s, double *most_mb)
{
	struct rusage own, child;
	getrusage(RUSAGE_SELF, &own);
	getrusage(RUSAGE_CHILDREN, &child);
	*elapsed_s = eco_clock_s(CLOCK_MONOTONIC) - start_s;
	*most_mb = (double)(own.ru_maxrss > child.ru_maxrss ? own.ru_maxrss : child.ru_maxrss) / 1024;
}

/* ---- Work in threads ---- */

#define ROUND 1024u
#define RUN 8u                   /* numbers of a round that a thread draws at once */

struct each { const struct main_each *what; atomic_uint next; enum main_stage stage; };

static void do_pieces(struct each *each)
{
	const struct main_each *what = each->what;
	for (uint32_t from; (from = atomic_fetch_add(&each->next, what->run)) < what->count;)
		for (uint32_t i = from; i < from + what->run && i < what->count; i++)
			what->piece(what->ctx, i);
}

static void *help(void *ctx)
{
	main_times_stage(((struct each *)ctx)->stage);
	do_pieces(ctx);
	main_times_stage(MAIN_STAGE_NONE);
	return NULL;
}

void main_each(const struct main_each *what)
{
	struct each each = { .what = what, .stage = mine.stage };
	pthread_t helpers[MAIN_THREADS_MAX];
	uint32_t wanted = what->threads < MAIN_THREADS_MAX ? what->threads : MAIN_THREADS_MAX, started = 0;
	while (started + 1 < wanted && (started + 1) * what->run < what->count
			&& pthread_create(&helpers[started], NULL, help, &each) == 0)
		started++;
	do_pieces(&each);
	for (uint32_t i = 0; i < started; i++)
		pthread_join(helpers[i], NULL);
}

/* ---- Results in order ---- */

struct done { enum eco_code code; struct eco_error *error; };

struct round {
	const struct main_jobs *jobs;
	uint64_t first;
	uint32_t count;
	struct done *done;
	uint8_t *results;
};

static void do_piece(void *ctx, uint32_t k)
{
	struct round *r = ctx;
	struct eco_error error = { .code = ECO_OK };
	struct done *done = &r->done[k];
	done->code = r->jobs->work(r->jobs->ctx, r->first + k, r->results + k * r->jobs->result_size, &error);
	if (done->code)
		*(done->error = eco_alloc(1, sizeof error)) = error;
}

/* Takes the results before the first failure. */
static enum eco_code take_round(struct round *r, struct eco_error *error)
{
	enum eco_code code = ECO_OK;
	for (uint32_t k = 0; k < r->count; k++) {
		struct done *done = &r->done[k];
		void *result = r->results + k * r->jobs->result_size;
		if (!code && done->code)
			code = eco_fail(error, done->code, "%s", done->error->text);
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
			? (uint32_t)(jobs->count - first) : ROUND };
		r.done = eco_alloc(r.count, sizeof *r.done);
		r.results = eco_alloc(r.count, jobs->result_size);
		main_each(&(struct main_each){ jobs->threads, r.count, RUN, do_piece, &r });
		code = take_round(&r, error);
		free(r.done);
		free(r.results);
	}
	return code;
}

/* ---- Options of all commands ---- */

bool main_is_quiet;

const struct eco_option main_common[] = {
	{ "quiet", 'q', ECO_OPTION_FLAG, NULL, .value = &main_is_quiet }, { 0 }
};

enum eco_code main_read(const struct main_command *command, int argc, char **argv, struct eco_error *error)
{
	enum eco_code code = eco_command_read(&command->line, argc, argv, error);
	eco_progress_begin("ecopack");
	eco_progress_quiet(main_is_quiet);
	return code;
}
