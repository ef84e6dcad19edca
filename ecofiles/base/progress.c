#include "ecofiles/base/progress.h"

#include <math.h>
#include <pthread.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "ecofiles/base/text.h"

#define BAR 28
#define TELLING_S 3              /* a stage tells what is left from then on */
#define TELLING_SHARE 0.02

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static const char *program = "";
static bool silent, shown;
static double last_s = -1000;
static struct { char name[64]; double since_s; } stage_now;

void eco_progress_begin(const char *name) { program = name; }

bool eco_progress_quiet(bool quiet)
{
	bool before = silent;
	silent = quiet;
	return before;
}

double eco_clock_s(clockid_t clock)
{
	struct timespec t;
	clock_gettime(clock, &t);
	return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void erase(void)
{
	if (shown)
		fputs("\r\033[K", stderr);
	shown = false;
}

/* "" while that is not known, else ", about 40 s left": of a stage of which `share` took `elapsed_s`. */
static void write_left(char text[32], double elapsed_s, double share)
{
	double left_s = share > 0 ? elapsed_s * (1 - share) / share : 0;
	text[0] = 0;
	if (elapsed_s < TELLING_S || share < TELLING_SHARE || !(left_s >= 1))
		return;
	if (left_s < 90)
		snprintf(text, 32, ", about %.0f s left", left_s);
	else
		snprintf(text, 32, ", about %.0f min left", fmin(left_s / 60, 1e6));
}

/* Estimates what is left of a stage from the time that it took so far. */
static void find_left(char text[32], const char *stage, double now, double share)
{
	if (strncmp(stage_now.name, stage, sizeof stage_now.name - 1) != 0) {
		snprintf(stage_now.name, sizeof stage_now.name, "%s", stage);
		stage_now.since_s = now;
	}
	write_left(text, now - stage_now.since_s, share);
}

static void say(const char *what, double share, const char *left)
{
	static char last[320];
	char text[sizeof last];
	snprintf(text, sizeof text, "%s, %.0f %%%s", what, 100 * share, left);
	if (strcmp(text, last) != 0)
		fprintf(stderr, "%s: %s\n", program, text);
	memcpy(last, text, sizeof last);
}

void eco_progress(const char *stage, const char *detail, double share)
{
	double now = eco_clock_s(CLOCK_MONOTONIC);
	bool terminal = isatty(STDERR_FILENO) == 1;
	char left[32], what[240];
	pthread_mutex_lock(&lock);
	share = share > 0 ? share < 1 ? share : 1 : 0;       /* not NaN */
	find_left(left, stage, now, share);
	if (!silent && now - last_s >= (terminal ? 0.1 : 4.0)) {
		/* a run that ends within a few seconds prints nothing */
		bool first = last_s < 0;
		last_s = now;
		snprintf(what, sizeof what, "%s%s%.150s", stage, detail ? ": " : "", detail ? detail : "");
		eco_utf8_tame(what, "", '?');        /* names from files must not steer a terminal */
		if (terminal) {
			char bar[BAR + 1];
			memset(bar, '.', BAR);
			memset(bar, '#', (size_t)(share * BAR));
			bar[BAR] = 0;
			fprintf(stderr, "\r\033[K[%s] %3.0f %%  %s%s", bar, 100 * share, what, left);
			fflush(stderr);
			shown = true;
		} else if (!first)
			say(what, share, left);
	}
	pthread_mutex_unlock(&lock);
}

void eco_progress_end(void)
{
	pthread_mutex_lock(&lock);
	erase();
	pthread_mutex_unlock(&lock);
}

void eco_progress_note(const char *format, ...)
{
	va_list args;
	char text[2048];
	va_start(args, format);
	vsnprintf(text, sizeof text, format, args);
	va_end(args);
	eco_utf8_tame(text, "", '?');
	pthread_mutex_lock(&lock);
	if (!silent) {
		erase();
		fprintf(stderr, "%s: %s\n", program, text);
	}
	pthread_mutex_unlock(&lock);
}
