/* Progress of a long run on standard error, shared by all threads: on a terminal a bar, redrawn at most ten
 * times a second; elsewhere lines at least four seconds apart, none equal to the one before.
 *
 *   eco_progress_begin("ecopack");
 *   eco_progress("reading models", path, 0.3);
 *   eco_progress_note("%s: 3 rows are left out", path);     a line for people, which does not spoil the bar
 *   eco_progress_end();                             before other output: removes the bar */
#pragma once

#include <stdbool.h>
#include <time.h>

void eco_progress_begin(const char *program);
/* quiet: neither progress nor notes are printed. Returns whether it was so before. */
bool eco_progress_quiet(bool quiet);
/* `share` of the stage in [0, 1]; `detail` may be NULL. */
void eco_progress(const char *stage, const char *detail, double share);
void eco_progress_end(void);
void eco_progress_note(const char *format, ...) __attribute__((format(printf, 1, 2)));

/* Seconds of a clock of <time.h>. */
double eco_clock_s(clockid_t clock);
