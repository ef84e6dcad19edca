/* Coarseness of a picture: the widest point that is seen in it. */
#ifndef TESTS_BENCH_WIDEST_H
#define TESTS_BENCH_WIDEST_H

#include "client-min/draw/view_picture.h"
#include "client-min/view_select.h"

/* Pixels across the widest ball or splat that a selection draws and that is nearest at its own centre in its
 * picture: 0 where there is none, the picture's width where the eye stands in one. A point always stands for
 * something finer. A splat counts by its longest half axis, as it is seen from the eye. NaN without memory. */
double bench_widest_px(const struct view_store *store, const struct view_selection *selection,
	const struct lod_eye *eye, const struct view_picture *picture);

#endif
