/* How large what is drawn of some plants becomes at most, which says how OpenGL may draw it (view_gl.c). */
#ifndef VIEW_EXTENT_H
#define VIEW_EXTENT_H

#include "client-min/draw/view_gl.h"
#include "client-min/draw/view_gpu.h"

/* How wide or high the largest outline of the balls around these members of the job's selection is in a
 * picture of that size. Balls that reach the eye's plane are not drawn. */
double view_extent_balls_px(const struct view_gl_job *job, const uint32_t size[2],
	const struct lod_impostor *impostor, const uint32_t *members, uint32_t count);
/* The most that a half axis of these members' ellipses is of its distance from the eye's plane; INFINITY: it
 * may be more than half. */
double view_extent_ellipses(const struct view_gl_job *job, const struct view_gpu_list *g,
	const struct view_list *list, const struct eco_cut *cut, const uint32_t *members, uint32_t count);

#endif
