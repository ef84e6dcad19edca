/* The views that clients of a load test ask for: those of a camera script, or made for the scene.
 *
 *   view_views_make(&views, &options, fetch, &error);
 *   view_views_free(&views);
 *
 * walk: round the middle of the scene, 1.7 m above the ground, looking ahead. flyover: to and fro above it,
 * looking down ahead. random: from anywhere in it and somewhat above, in any direction down to its ground. */
#ifndef VIEW_VIEWS_H
#define VIEW_VIEWS_H

#include "client-min/view_fetch.h"

struct view_views_options {
	const char *camera;              /* "walk", "flyover", "random", or the name of a file */
	uint32_t width, height;
	uint64_t seed;                   /* of random ones */
	double snap_m;                   /* as eco_view_snap */
	const volatile sig_atomic_t *stop;
};

struct view_views { struct eco_view *items; uint32_t count; };   /* owns its items */

/* Asks the scene for its size and, where views count from the ground, for its ground below each. */
enum eco_code view_views_make(struct view_views *views, const struct view_views_options *options,
	struct view_fetch *fetch, struct eco_error *error);
void view_views_free(struct view_views *views);

#endif
