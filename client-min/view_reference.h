/* Drawing a selection in software: the reference that pictures are scored against, and what draws where there
 * is no OpenGL. Plants front to back, hidden ones skipped, by `threads` rasterisers whose pictures are
 * merged: the same pixels whatever the number. */
#ifndef VIEW_REFERENCE_H
#define VIEW_REFERENCE_H

#include <signal.h>

#include "client-min/view_picture.h"
#include "client-min/view_select.h"

struct view_reference_job {
	const struct view_store *store;
	const struct view_selection *selection;
	const struct lod_eye *eye;
	double near_m;
	uint32_t threads;                        /* 0: 2 */
	const volatile sig_atomic_t *stop;       /* not 0: end with ECO_INTERRUPTED; may be NULL */
};

/* Fills cover, owner, flat colours in rgb, vertices (those of the selection: hidden ones count as drawn) and
 * draw_ms. */
enum eco_code view_reference_draw(const struct view_reference_job *job, struct view_picture *picture,
	struct eco_error *error);

#endif
