/* Draws what casts shadows into a map (view_shadow.h), in software. */
#ifndef VIEW_SHADOW_CAST_H
#define VIEW_SHADOW_CAST_H

#include "client-min/draw/view_shadow.h"

/* Raises shadow->top, which has been made, to all that the job's casters reach: triangles, with what their
 * textures cut out, lines, points, splats and impostors. */
enum eco_code view_shadow_cast(struct view_shadow *shadow, const struct view_shadow_job *job,
	struct eco_error *error);

#endif
