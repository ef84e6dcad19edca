#include "client-min/view_progress.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "client-min/view_store.h"

#define BAR 24

void view_progress_begin(struct view_progress *progress, const char *program)
{
	*progress = (struct view_progress){ .program = program, .terminal = isatty(STDERR_FILENO),
		.last_ms = view_clock_ms() };
}

void view_progress_show(struct view_progress *progress, double done, double total, const char *what)
{
	double now = view_clock_ms(), share = total > 0 ? done / total : 0;
	if (!progress->terminal) {
		if (now - progress->last_ms < 1000)
			return;
		progress->last_ms = now;
		fprintf(stderr, "%s: %3.0f %%, %s\n", progress->program, 100 * share, what);
		return;
	}
	char bar[BAR + 1];
	int filled = (int)(share * BAR);
	filled = filled < 0 ? 0 : filled > BAR ? BAR : filled;
	memset(bar, '.', BAR);
	memset(bar, '#', (size_t)filled);
	bar[BAR] = '\0';
	fprintf(stderr, "\r\033[K[%s] %3.0f %%  %s", bar, 100 * share, what);
	fflush(stderr);
	progress->drawn = true;
}

void view_progress_clear(struct view_progress *progress)
{
	if (progress->drawn)
		fputs("\r\033[K", stderr);
	fflush(stderr);
	progress->drawn = false;
}
