/* A lit picture, put into what the page's context draws to: colours, and depths that hide what the page
 * draws itself, and are hidden by it. */
#ifndef WEB_PRESENT_H
#define WEB_PRESENT_H

#include <stdbool.h>

#include "ecofiles/base/status.h"

struct web_present { unsigned program, vertex_array; };          /* zero is empty */

/* The page's depth of a pixel is depth[0] + depth[1] / distance, in [0, 1]; where nothing is, the sky, it is
 * 1, and without `sky` nothing is drawn there, nor without `ground` where no plant is. Into the framebuffer
 * that is bound, all of `viewport`: x, y, width, height. */
struct web_place { float depth[2]; int viewport[4]; bool sky, ground; };
/* Compiles what drawing needs, which that else does itself. */
enum eco_code web_present_prepare(struct web_present *present, struct eco_error *error);
/* Textures: colours (web_light.h), and what was recorded (view_gl_target). */
enum eco_code web_present_draw(struct web_present *present, unsigned lit, unsigned seen,
	const struct web_place *place, struct eco_error *error);
void web_present_free(struct web_present *present);

#endif
