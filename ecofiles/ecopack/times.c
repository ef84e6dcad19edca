/* A thread that changes its stage adds the clock and processor time since its last change to the stage it
 * leaves. Memory is the process's: the peak since the last change counts for every stage that was running. */
#include "ecofiles/ecopack/times.h"

#include <inttypes.h>
#include <pthread.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>

static const char *const names[MAIN_STAGE_COUNT] =
	{ [MAIN_STAGE_SCENE] = "scene", [MAIN_STAGE_GROUND] = "ground",
		[MAIN_STAGE_MODELS] = "reading models", [MAIN_STAGE_CACHE] = "cache",
		[MAIN_STAGE_ELEMENTS] = "organs and elements", [MAIN_STAGE_ORDERS] = "orders",
		[MAIN_STAGE_LISTS] = "levels lines points", [MAIN_STAGE_SPLATS] = "splats",
		[MAIN_STAGE_CURVES] = "curves and scales",
		[MAIN_STAGE_TEXTURES] = "textures", [MAIN_STAGE_PACKING] = "packing plants",
		[MAIN_STAGE_POSITIONS] = "positions", [MAIN_STAGE_TILES] = "tiles",
		[MAIN_STAGE_SUMMARIES] = "summaries", [MAIN_STAGE_WRITING] = "writing" };

static struct { double elapsed_s, cpu_s, peak_mb; uint32_t threads; } stages[MAIN_STAGE_COUNT];
static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static double start_s, total_mb;
static bool by_stage;
static struct { char folder[1024]; uint64_t hits, misses; } cache;

static _Thread_local struct { enum main_stage stage; double since_s, cpu_s, readers_s, readers_mb; } mine;

static double seconds(clockid_t clock)
{
	struct timespec t;
	clock_gettime(clock, &t);
	return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static double of(struct timeval t) { return (double)t.tv_sec + 1e-6 * (double)t.tv_usec; }

/* Child processes that have ended: processor time of all, memory of the largest. */
static void readers(double *cpu_s, double *most_mb)
{
	struct rusage used;
	getrusage(RUSAGE_CHILDREN, &used);
	*cpu_s = of(used.ru_utime) + of(used.ru_stime);
	*most_mb = (double)used.ru_maxrss / 1024;
}

/* The peak since the last reset. */
static double peak_mb(void)
{
	char line[128];
	double kb = 0;
	FILE *file = fopen("/proc/self/status", "re");
	while (file && fgets(line, sizeof line, file))
		if (sscanf(line, "VmHWM: %lf", &kb) == 1)
			break;
	if (file)
		fclose(file);
	if (by_stage && (file = fopen("/proc/self/clear_refs", "we"))) {
		fputs("5", file);
		fclose(file);
	}
	return kb / 1024;
}

static double max(double a, double b) { return a > b ? a : b; }

static void take_peak(void)
{
	double mb = peak_mb();
	total_mb = max(total_mb, mb);
	for (int i = 0; i < MAIN_STAGE_COUNT; i++)
		if (stages[i].threads)
			stages[i].peak_mb = max(stages[i].peak_mb, mb);
}

void main_times_stage(enum main_stage stage)
{
	double now = seconds(CLOCK_MONOTONIC), cpu = seconds(CLOCK_THREAD_CPUTIME_ID), readers_s, readers_mb;
	if (stage == mine.stage)
		return;
	readers(&readers_s, &readers_mb);
	pthread_mutex_lock(&lock);
	start_s = start_s > 0 ? start_s : now;
	take_peak();
	if (mine.stage != MAIN_STAGE_NONE) {
		stages[mine.stage].elapsed_s += now - mine.since_s;
		stages[mine.stage].cpu_s += cpu - mine.cpu_s;
		stages[mine.stage].threads--;
	}
	if (mine.stage == MAIN_STAGE_MODELS || mine.stage == MAIN_STAGE_GROUND
			|| mine.stage == MAIN_STAGE_POSITIONS) {
		stages[mine.stage].cpu_s += readers_s - mine.readers_s;
		if (readers_mb > mine.readers_mb)
			stages[mine.stage].peak_mb = max(stages[mine.stage].peak_mb, readers_mb);
	}
	if (stage != MAIN_STAGE_NONE)
		stages[stage].threads++;
	pthread_mutex_unlock(&lock);
	mine.stage = stage;
	mine.since_s = now;
	mine.cpu_s = cpu;
	mine.readers_s = readers_s;
	mine.readers_mb = readers_mb;
}

enum main_stage main_times_now(void) { return mine.stage; }

void main_times_memory(bool wanted) { by_stage = wanted; }

void main_times_cache(const char *folder, uint64_t hits, uint64_t misses)
{
	snprintf(cache.folder, sizeof cache.folder, "%s", folder);
	cache.hits = hits;
	cache.misses = misses;
}

void main_times_print(FILE *out)
{
	fprintf(out, "\n%-22s %9s %9s %9s\n", "stage", "elapsed", "processor", "memory");
	for (int i = 1; i < MAIN_STAGE_COUNT; i++)
		if (stages[i].elapsed_s > 0)
			fprintf(out, "%-22s %7.2f s %7.2f s %6.0f MB\n", names[i], stages[i].elapsed_s,
				stages[i].cpu_s, stages[i].peak_mb);
	if (cache.folder[0])
		fprintf(out, "%" PRIu64 " of %" PRIu64 " plants were built before and came from %s\n",
			cache.hits, cache.hits + cache.misses, cache.folder);
}

void main_times_total(double *elapsed_s, double *most_mb)
{
	double readers_s, readers_mb;
	readers(&readers_s, &readers_mb);
	pthread_mutex_lock(&lock);
	take_peak();
	*elapsed_s = seconds(CLOCK_MONOTONIC) - start_s;
	*most_mb = max(total_mb, readers_mb);
	pthread_mutex_unlock(&lock);
}
