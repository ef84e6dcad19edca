/* Progress on stderr: one line redrawn on a terminal, plain lines elsewhere (one a second, none before the
 * first second is over). */
#ifndef VIEW_PROGRESS_H
#define VIEW_PROGRESS_H

#include <stdbool.h>

struct view_progress { const char *program; bool terminal, drawn; double last_ms; };

void view_progress_begin(struct view_progress *progress, const char *program);
/* `done` of `total` parts are done; `what` is being done. */
void view_progress_show(struct view_progress *progress, double done, double total, const char *what);
void view_progress_clear(struct view_progress *progress);        /* before other output */

#endif
