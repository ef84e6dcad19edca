/* What a long run tells its user, on standard error: a bar with the stage's name on a terminal, else a line every few seconds; and
 * whether the user wants it to end. Shared by all threads. */
#ifndef ECO_MAIN_PROGRESS_H
#define ECO_MAIN_PROGRESS_H

#include <stdbool.h>

/* Ctrl-C and SIGTERM ask to stop instead of ending the program, and a file beyond the user's limit of sizes is a failure to write: so
 * nothing half written stays. */
void main_catch_interrupts(void);

/* `share` of the stage in [0, 1]; `detail` may be NULL. False when the user wants to stop. */
bool main_progress(const char *stage, const char *detail, double share);
void main_progress_end(void);        /* takes the bar away */
void main_progress_quiet(bool quiet);

/* A line for people that does not spoil the bar. */
void main_note(const char *format, ...) __attribute__((format(printf, 1, 2)));
void main_note_text(void *unused, const char *text);     /* the same, for who is called back */

#endif
