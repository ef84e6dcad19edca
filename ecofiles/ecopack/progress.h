/* Progress of a long run, on standard error: a bar with the stage's name on a terminal, else a line every
 * few seconds; and whether the user wants to stop. Shared by all threads. */
#ifndef ECO_MAIN_PROGRESS_H
#define ECO_MAIN_PROGRESS_H

#include <stdbool.h>

/* After this Ctrl-C and SIGTERM ask to stop instead of ending the program, and a file beyond the user's
 * size limit is a failed write: so nothing half written stays. */
void main_catch_interrupts(void);

/* "" while that is not known, else ", about 40 s left": of a stage of which `share` took `elapsed_s`. */
void main_progress_left(char text[32], double elapsed_s, double share);

/* `share` of the stage in [0, 1]; `detail` may be NULL. False when the user wants to stop. */
bool main_progress(const char *stage, const char *detail, double share);
void main_progress_end(void);        /* removes the bar */
void main_progress_quiet(bool quiet);

/* Prints a line for people without spoiling the bar. */
void main_note(const char *format, ...) __attribute__((format(printf, 1, 2)));
void main_note_text(void *unused, const char *text);     /* the same, as a callback */

#endif
