/* Shadow maps as OpenGL casts them, beside those that are cast in software. */
#ifndef SHADOW_GL_H
#define SHADOW_GL_H

#include "client-min/draw/view_gl.h"
#include "client-min/draw/view_shadow.h"

/* Both maps of a job must have the same heights, but for one texel of 200: OpenGL rounds corners. Returns how
 * many texels are below something. */
size_t shadow_gl_compare(struct view_gl *gl, const struct view_shadow_job *job, const char *name);

#endif
